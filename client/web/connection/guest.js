// A guest's link: what stands behind its # as guest=TOKEN lets somebody without a token look at one cloud for a while. The
// token leaves the address bar at once and stays with this tab; the server gives a pass for it, which is used like any
// access token (access.js) and renewed before it ends.

import { keepToken } from './access.js';
import { tabStore } from './stores.js';
import { problemOf } from './catalog.js';

const key = 'scancast-guest';
const word = 'guest=';
const patienceMs = 10_000;

/** { token, rest }: a guest's token in a hash, and the hash without it; undefined where there is none. Pure. */
export function guestOf(hash) {
  const parts = hash.replace(/^#/, '').split('&');
  const found = parts.find((part) => part.startsWith(word) && part.length > word.length);
  if (!found) return undefined;
  const rest = parts.filter((part) => !part.startsWith(word)).join('&');
  return { token: found.slice(word.length), rest: rest ? `#${rest}` : '' };
}

/** Milliseconds until a pass is renewed that is good for so many seconds: well before its end, and never in a hurry. Pure. */
export const renewIn = (seconds) => Math.max(5000, Math.min(seconds * 800, 2 ** 31 - 1));

/** Takes the token out of the address bar; false where there is none. */
export function takeGuestToken() {
  const guest = guestOf(location.hash);
  if (!guest) return false;
  tabStore.set(key, guest.token);
  history.replaceState(null, '', location.pathname + location.search + guest.rest);
  return true;
}

export const isGuest = () => tabStore.get(key) !== undefined;

/** The link is over, or was none: from here on this tab is nobody's. */
export function forgetGuest() {
  tabStore.remove(key);
}

let timer;

/** Gets a pass for the link of this tab, and goes on renewing it; resolves to its cloud's id, throws what the server refuses with. */
export async function enterAsGuest() {
  clearTimeout(timer);
  const response = await fetch('/api/v1/guest-session', {
    method: 'POST',
    signal: AbortSignal.timeout(patienceMs),
    headers: { 'Content-Type': 'application/json' },
    body: JSON.stringify({ token: tabStore.get(key) }),
  });
  if (!response.ok) throw await problemOf(response);
  const pass = await response.json();
  keepToken(pass.token);
  // A renewal that fails is tried again by whatever needs the pass next: session.js comes here before it connects.
  timer = setTimeout(() => isGuest() && enterAsGuest().catch(() => {}), renewIn(pass.expiresInSeconds));
  return pass.cloud;
}
