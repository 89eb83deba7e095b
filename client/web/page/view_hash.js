// A view in the URL's hash, so that a link shows what its sender saw: #cloud=town&eye=…&target=…&method=….
//
// Pure. Reading is strict about every value and lenient about the rest: a hash may come from anywhere, so what is not
// understood is left out, never passed on. What is left in has the right type; the server checks the rest.

import { fromProtocol } from '../view/camera.js';
import { areNumbers } from '../view/vectors.js';
import { printQuery, wordsOf } from '../protocol/view_words.js';

const longestHash = 4096;
const name = /^[A-Za-z0-9._-]{1,64}$/;
const parameterName = /^[A-Za-z0-9]{1,64}$/;
const color = /^#?[0-9a-f]{6}$/i;
const byIntensity = '*intensity';
const plainNumber = /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i;

/** `upAxis` is the page's own word: it changes how one moves on, not what the picture shows. */
export function printHash(cloud, view, upAxis) {
  const own = upAxis === 'y' || upAxis === '-y' ? [['upAxis', upAxis]] : [];
  return `#${printQuery([['cloud', cloud], ...wordsOf(view), ...own])}`;
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

const readNumber = (text) => (text !== undefined && plainNumber.test(text) ? Number(text) : NaN);

function readNumbers(text, count) {
  const values = (text ?? '').split(',').map(readNumber);
  return areNumbers(values, count) ? values : undefined;
}

function readCamera(pairs) {
  const wire = {
    type: pairs.get('projection') === 'orthographic' ? 'orthographic' : 'perspective',
    eye: readNumbers(pairs.get('eye'), 3),
    target: readNumbers(pairs.get('target'), 3),
    up: readNumbers(pairs.get('up'), 3) ?? [0, 0, 1],
    fov: readNumber(pairs.get('fov')),
    viewHeight: readNumber(pairs.get('viewHeight')),
  };
  return fromProtocol(wire, ['y', '-y'].includes(pairs.get('upAxis')) ? pairs.get('upAxis') : 'z');
}

function readParameters(pairs) {
  const param = {};
  for (const [word, text] of pairs) {
    const key = word.startsWith('param.') ? word.slice('param.'.length) : '';
    if (!parameterName.test(key) || Object.hasOwn(param, key)) continue;
    if (text === 'true' || text === 'false') param[key] = text === 'true';
    else if (plainNumber.test(text)) {
      if (Number.isFinite(Number(text))) param[key] = Number(text);
    } else if (name.test(text)) param[key] = text;
  }
  return param;
}

const withHash = (text) => (text.startsWith('#') ? text : `#${text}`).toLowerCase();

function readColor(text) {
  const by = text.endsWith(byIntensity) ? byIntensity : '';
  const source = text.slice(0, text.length - by.length);
  if (color.test(source)) return withHash(source) + by;
  return name.test(source) ? source + by : undefined;
}

function readBackground(text) {
  if (text === 'transparent') return text;
  const colors = (text ?? '').split(',');
  if (colors.length > 2 || !colors.every((one) => color.test(one))) return undefined;
  const spelled = colors.map(withHash);
  return spelled.length === 2 ? spelled : spelled[0];
}

/** { cloud, camera, style }, each undefined or partly empty where the hash does not say; undefined for no hash. */
export function parseHash(hash) {
  if (typeof hash !== 'string' || hash.length < 2 || hash.length > longestHash) return undefined;
  const pairs = pairsOf(hash);
  const style = {};
  for (const word of ['method', 'colormap', 'shading']) {
    if (name.test(pairs.get(word) ?? '')) style[word] = pairs.get(word);
  }
  if (style.method) style.param = readParameters(pairs);
  const source = readColor(pairs.get('color') ?? '');
  if (source) style.color = source;
  const range = readNumbers(pairs.get('range'), 2);
  if (range && range[0] < range[1]) style.range = range;
  for (const word of ['mirrors', 'behindMirrors']) {
    if (['true', 'false'].includes(pairs.get(word))) style[word] = pairs.get(word) === 'true';
  }
  const background = readBackground(pairs.get('background'));
  if (background) style.background = background;
  const detail = readNumber(pairs.get('detail'));
  if (detail >= 0 && detail <= 64) style.detail = detail;
  const cloud = name.test(pairs.get('cloud') ?? '') ? pairs.get('cloud') : undefined;
  return { cloud, camera: readCamera(pairs), style };
}
