// A view in the URL's hash, so that a link shows what its sender saw: #cloud=town&eye=…&target=…&method=….
//
// Pure. Reading is strict about every value and lenient about the rest: a hash may come from anywhere, so what is not
// understood is left out, never passed on. What is left in has the right type; the server checks the rest.

import { printQuery, readCamera, readStyle, wordsOf } from '../protocol/view_words.js';

const longestHash = 4096;
const name = /^[A-Za-z0-9._-]{1,64}$/;
const modelAxes = ['y', '-y'];

/**
 * `upAxis` is the page's own word: it changes how one moves on, not what the picture shows. `usual`: the cloud's default view,
 * which a link need not repeat.
 */
export function printHash(cloud, view, upAxis, usual = undefined) {
  const own = modelAxes.includes(upAxis) ? [['upAxis', upAxis]] : [];
  return `#${printQuery([['cloud', cloud], ...wordsOf(view, usual), ...own])}`;
}

function pairsOf(hash) {
  const pairs = new Map();
  for (const part of hash.replace(/^#/, '').split('&')) {
    const at = part.indexOf('=');
    if (at < 1) continue;
    try {
      pairs.set(decodeURIComponent(part.slice(0, at)), decodeURIComponent(part.slice(at + 1)));
    } catch {
      // An escape that is none: this word is left out.
    }
  }
  return pairs;
}

/**
 * { cloud, camera, upAxis, style }, each undefined or partly empty where the hash does not say; undefined for no hash. The
 * camera is what was said of it, in the protocol's words; upAxis is 'y' or '-y', or undefined.
 */
export function parseHash(hash) {
  if (typeof hash !== 'string' || hash.length < 2 || hash.length > longestHash) return undefined;
  const pairs = pairsOf(hash);
  const cloud = name.test(pairs.get('cloud') ?? '') ? pairs.get('cloud') : undefined;
  const upAxis = modelAxes.includes(pairs.get('upAxis')) ? pairs.get('upAxis') : undefined;
  return { cloud, camera: readCamera(pairs), upAxis, style: readStyle(pairs) };
}
