// A guest's link: what stands behind its # as guest=TOKEN lets somebody without a token look at one cloud for a while. The
// token leaves the address bar at once and stays with this tab; the server gives a pass for it (server.js), which is used like
// any access token and renewed before it ends.

const word = 'guest=';

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
export function takeGuestToken(access) {
  const guest = guestOf(location.hash);
  if (!guest) return false;
  access.keepGuestToken(guest.token);
  history.replaceState(null, '', location.pathname + location.search + guest.rest);
  return true;
}
