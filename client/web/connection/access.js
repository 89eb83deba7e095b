// The access token, for servers that ask for one: kept for this tab only, sent in a header or, with a WebSocket, whose
// headers no page can set, as a second subprotocol. It never becomes part of an address.

const key = 'scancast-token';

/** What base64url makes of a text, without padding. Pure. */
export function base64url(text) {
  const bytes = String.fromCharCode(...new TextEncoder().encode(text));
  return btoa(bytes).replaceAll('+', '-').replaceAll('/', '_').replaceAll('=', '');
}

export const hasToken = () => sessionStorage.getItem(key) !== null;

export function keepToken(token) {
  sessionStorage.setItem(key, token.trim());
}

export function forgetToken() {
  sessionStorage.removeItem(key);
}

/** Headers of every request to the API. */
export function authorization() {
  const token = sessionStorage.getItem(key);
  return token === null ? {} : { Authorization: `Bearer ${token}` };
}

/** What a WebSocket offers; the server selects the first. */
export function subprotocols() {
  const token = sessionStorage.getItem(key);
  return token === null ? ['scancast.v1'] : ['scancast.v1', `base64url.bearer.authorization.${base64url(token)}`];
}
