// What a saved picture is called, and how large it may be. Pure.

export const mostSide = 16384;
/** Pixels of a canvas that every browser makes and still has the memory for; larger pictures come as the server draws them. */
export const mostComposed = 100e6;

const two = (number) => String(number).padStart(2, '0');
const plain = (text) => String(text ?? '').toLowerCase().replace(/[^a-z0-9._-]+/g, '-').replace(/^[-.]+|[-.]+$/g, '').slice(0, 64);

/** "town-2026-11-26-ewa-3840x2160.png". `date`: a Date, by whose local day it goes. */
export function pictureName({ cloud, method, width, height, format, date }) {
  const day = `${date.getFullYear()}-${two(date.getMonth() + 1)}-${two(date.getDate())}`;
  const parts = [plain(cloud) || 'scan', day, plain(method), `${width}x${height}`].filter(Boolean);
  return `${parts.join('-')}.${format === 'jpg' ? 'jpg' : 'png'}`;
}

/** A number that somebody typed, as a side of a picture; undefined where it is none. */
export const sideOf = (value) => (Number.isInteger(value) && value >= 16 && value <= mostSide ? value : undefined);

/** [name, width, height]: what is offered for a canvas of that many pixels; none is larger than a picture may be. */
export function presetsOf({ width, height }) {
  const times = (factor) => /** @type {const} */ ([Math.round(width * factor), Math.round(height * factor)]);
  /** @type {[string, number, number][]} */
  const all = [
    ['screen', ...times(1)], ['twice', ...times(2)], ['four', ...times(4)], ['hd', 1920, 1080], ['uhd', 3840, 2160], ['square', 2160, 2160], ['a4', 3508, 2480],
    ['a3', 4961, 3508], ['a1', 9933, 7016], ['most', mostSide, 9216],
  ];
  return all.filter(([, wide, high]) => wide <= mostSide && high <= mostSide);
}
