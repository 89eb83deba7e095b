// The access token, for servers that ask for one: kept for this tab, or on this device where somebody wants that; sent in a
// header or, with a WebSocket, whose headers no page can set, as a second subprotocol. It never becomes part of an address.

import { deviceStore, tabStore } from './stores.js';

const key = 'scancast-token';

/** What base64url makes of a text, without padding. Pure. */
export function base64url(text) {
  const bytes = String.fromCharCode(...new TextEncoder().encode(text));
  return btoa(bytes).replaceAll('+', '-').replaceAll('/', '_').replaceAll('=', '');
}

/** This tab's own token goes first: a guest's pass does not lose the token that the device remembers. */
const token = () => tabStore.get(key) ?? deviceStore.get(key);

export const hasToken = () => token() !== undefined;

export function keepToken(text, onDevice = false) {
  if (onDevice) deviceStore.set(key, text.trim());
  else tabStore.set(key, text.trim());
}

export function forgetToken({ onDevice = true } = {}) {
  tabStore.remove(key);
  if (onDevice) deviceStore.remove(key);
}

/** Headers of every request to the API. */
export function authorization() {
  return hasToken() ? { Authorization: `Bearer ${token()}` } : {};
}

/** What a WebSocket offers; the server selects the first. */
export function subprotocols() {
  return hasToken() ? ['scancast.v1', `base64url.bearer.authorization.${base64url(token())}`] : ['scancast.v1'];
}
