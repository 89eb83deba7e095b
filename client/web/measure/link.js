// Measures in the address, behind the view: `measures=d3.…~a2.…`, short enough for a link. Pure.
//
// One is its kind's letter, `y` or `n` where Y or -Y is up, `h` where it is hidden, the number of digits behind the point, and then
// whole numbers to base 36 between dots: coordinates in units of the last digit, the first point's, then differences from the point before.
// Behind `!` how the server is to compute it, behind `*` its name, where it has one of its own. Whole numbers of that size are exact, and so are the coordinates.

import { linkWord as word, measuresIn } from './beginning.js';
import { bases, isOptionOf, kinds } from './values.js';

const letters = { point: 'p', distance: 'd', horizontal: 'w', height: 'h', angle: 'a', area: 'f', circle: 'c', volume: 'v', cylinder: 't', fitCircle: 'o', plane: 'e', sphere: 's' };
const kindOf = Object.fromEntries(Object.entries(letters).map(([kind, letter]) => [letter, kind]));
const ups = { z: '', y: 'y', '-y': 'n' };
const mostDigits = 9;
const longest = 1500;
const longestName = 120;

/** Digits behind the point that all of these numbers have; undefined where they are too many to be whole numbers. */
function decimalsOf(numbers) {
  for (let decimals = 0; decimals <= mostDigits; ++decimals) {
    const factor = 10 ** decimals;
    if (!numbers.every((one) => Math.abs(one) * factor < 2 ** 52)) return undefined;
    if (numbers.every((one) => Math.round(one * factor) / factor === one)) return decimals;
  }
  return undefined;
}

function rounded(numbers) {
  const decimals = decimalsOf(numbers);
  if (decimals !== undefined) return { decimals, values: numbers };
  // Of scans whose numbers have no end, as many digits as there is room for.
  const largest = Math.max(...numbers.map(Math.abs), 1e-9);
  const fit = Math.max(0, Math.min(mostDigits, 14 - Math.ceil(Math.log10(largest))));
  return { decimals: fit, values: numbers };
}

const escaped = (name) => encodeURIComponent(name).replace(/[~*.]/g, (one) => `%${one.charCodeAt(0).toString(16)}`);

/** `usualNames`: those that need no saying, each kind's own word. */
function wordOf({ kind, points, up = 'z', visible = true, name = '', option = undefined }, usualNames) {
  const { decimals, values } = rounded(points.flat());
  const whole = values.map((one) => Math.round(one * 10 ** decimals));
  const steps = whole.map((one, i) => (i < 3 ? one : one - whole[i - 3]).toString(36));
  const isUsual = name === '' || new RegExp(`^${usualNames[kind]} \\d+$`).test(name);
  return `${letters[kind]}${ups[up]}${visible ? '' : 'h'}${decimals}.${steps.join('.')}${option === undefined ? '' : `!${option}`}${isUsual ? '' : `*${escaped(name)}`}`;
}

/** { word: '' or 'measures=…', left }: `left` are those for which there is no more room in an address that has `taken` characters. */
export function printMeasures(list, usualNames, taken = 0) {
  const room = Math.min(longest, 4000 - taken);
  let text = '';
  let count = 0;
  for (const one of list) {
    const next = `${text}${text && '~'}${wordOf(one, usualNames)}`;
    if (encodeURIComponent(next).length > room) break;
    text = next;
    count += 1;
  }
  return { word: text && `${word}=${encodeURIComponent(text)}`, left: list.length - count };
}

const pattern = /^([a-z])([yn]?)(h?)(\d)((?:\.-?[0-9a-z]{1,11})+)(?:!(lowest|mean|fit|-?[\d.e+-]{1,24}))?(?:\*(.*))?$/;

/** As it stands in an address; undefined where that kind has no such one. */
function optionOf(kind, text) {
  if (text === undefined) return undefined;
  const option = bases.includes(text) ? text : Number(text);
  return isOptionOf(kind, option) ? option : undefined;
}

function measureOf(text) {
  const [, letter, up, hidden, digits, numbers, how, name] = pattern.exec(text) ?? [];
  const kind = kindOf[letter];
  const whole = numbers?.slice(1).split('.').map((one) => parseInt(one, 36));
  if (!kind || whole.length % 3 !== 0) return undefined;
  const count = whole.length / 3;
  if (count < kinds[kind].least || count > kinds[kind].most) return undefined;
  for (let i = 3; i < whole.length; ++i) whole[i] += whole[i - 3];
  if (!whole.every((one) => Number.isSafeInteger(one))) return undefined;
  const factor = 10 ** Number(digits);
  const points = Array.from({ length: count }, (_, i) => whole.slice(3 * i, 3 * i + 3).map((one) => one / factor));
  let own = '';
  try {
    own = decodeURIComponent(name ?? '').slice(0, longestName);
  } catch {
    // An escape that is none: it has no name of its own, then.
  }
  const option = optionOf(kind, how);
  if (how !== undefined && option === undefined) return undefined;
  return { kind, points, ...(option === undefined ? {} : { option }), step: 1 / factor, up: { y: 'y', n: '-y' }[up] ?? 'z', visible: hidden === '', name: own };
}

/** The measures that an address's hash names; what is none is left out. */
export function parseMeasures(hash) {
  const part = measuresIn(hash);
  if (!part || part.length > 4096) return [];
  try {
    return decodeURIComponent(part.slice(word.length + 1)).split('~').map(measureOf).filter(Boolean);
  } catch {
    return [];
  }
}
