// Who one is to a server: its access token, kept for this tab, or on this device where somebody wants that; or a guest's link.
// A token is sent in a header or, with a WebSocket, whose headers no page can set, as a second subprotocol. It never becomes
// part of an address.

import { deviceStore, tabStore } from './stores.js';

/** What base64url makes of a text, without padding. Pure. */
export function base64url(text) {
  const bytes = String.fromCharCode(...new TextEncoder().encode(text));
  return btoa(bytes).replaceAll('+', '-').replaceAll('/', '_').replaceAll('=', '');
}

export class Access {
  #key;
  #guestKey;
  guestMayExport = true; // as the server says it with a pass

  /** `origin`: the server's. What is kept for one server is never sent to another. */
  constructor(origin) {
    const of = origin === globalThis.location?.origin ? '' : ` ${origin}`;
    this.#key = `scancast-token${of}`;
    this.#guestKey = `scancast-guest${of}`;
  }

  /** This tab's own token goes first: a guest's pass does not lose the token that the device remembers. */
  get #token() {
    return tabStore.get(this.#key) ?? deviceStore.get(this.#key);
  }

  get hasToken() {
    return this.#token !== undefined;
  }

  keepToken(text, onDevice = false) {
    if (onDevice) deviceStore.set(this.#key, text.trim());
    else tabStore.set(this.#key, text.trim());
  }

  forgetToken({ onDevice = true } = {}) {
    tabStore.remove(this.#key);
    if (onDevice) deviceStore.remove(this.#key);
  }

  /** Headers of every request to the API. */
  get headers() {
    return this.hasToken ? { Authorization: `Bearer ${this.#token}` } : {};
  }

  /** What a WebSocket offers; the server selects the first. */
  get subprotocols() {
    return this.hasToken ? ['scancast.v1', `base64url.bearer.authorization.${base64url(this.#token)}`] : ['scancast.v1'];
  }

  /** What stood in a guest's link. */
  get guestToken() {
    return tabStore.get(this.#guestKey);
  }

  get isGuest() {
    return this.guestToken !== undefined;
  }

  /** Points and elevations are for this guest; who has a token of his own gets them anyway. */
  get mayExport() {
    return !this.isGuest || this.guestMayExport;
  }

  keepGuestToken(token) {
    tabStore.set(this.#guestKey, token);
  }

  /** The link is over, or was none: from here on this tab is nobody's. */
  forgetGuest() {
    tabStore.remove(this.#guestKey);
  }
}
