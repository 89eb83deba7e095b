// Which points of a scan somebody wants, in the words of `POST /clouds/{id}/points` and `…/profile`: what a view shows of it, by classes, boxes and
// shapes; a polygon that has been measured. Pure.

import { ownShift } from '../page/members.js';
import { columnOf } from '../protocol/view_words.js';

/** Columns that stand beside colours in a view and mean nothing for points. */
const coloursOfPoints = ['auto', 'rgb', 'intensity', 'elevation', 'classification', 'normal'];

const hasShapes = (view) => Boolean(view?.clip) || (view?.clips?.length ?? 0) > 0;
const hasClasses = (view) => view?.classes !== undefined && view.classes !== null && view.classes !== '';

const hasFilter = (view) => (view?.filter?.length ?? 0) > 0;

/** What a view leaves of the scan: { classes, shapes, filter }, each whether it takes something away. */
export const limitsOf = (view) => ({ classes: hasClasses(view), shapes: hasShapes(view), filter: hasFilter(view) });

/**
 * The region; undefined for all of the scan. `wanted`: { classes: only those that the view shows, shapes: only what its boxes and shapes leave,
 * filter: only the values that it shows, polygon: [[x, y], …] }. Places are the file's: a scan that is shifted in the view is seen elsewhere.
 */
export function regionOf(view, wanted = { classes: true, shapes: true, filter: true }) {
  const region = /** @type {any} */ ({});
  const shift = ownShift(view);
  const inFile = (place) => (shift ? place.map((value, axis) => value - shift[axis]) : place);
  if (wanted.shapes && view?.clip) region.clip = { min: inFile(view.clip.min), max: inFile(view.clip.max) };
  if (wanted.shapes && view?.clips?.length > 0) {
    region.clips = view.clips.map((shape) => (shape.box ? { ...shape, box: { ...shape.box, center: inFile(shape.box.center) } } : { plane: { ...shape.plane, point: inFile(shape.plane.point) } }));
  }
  if (wanted.classes && hasClasses(view)) region.classes = view.classes;
  if (wanted.filter && hasFilter(view)) region.filter = view.filter;
  if (wanted.polygon) region.polygon = wanted.polygon.map((point) => inFile(point).slice(0, 2));
  return Object.keys(region).length > 0 ? region : undefined;
}

/** How a profile is coloured: as the view is, as far as that has a meaning for points. */
export function coloursOf(view) {
  const color = view?.color;
  const plain = typeof color === 'string' ? color.replace('*intensity', '') : '';
  if (!coloursOfPoints.includes(plain) && !plain.startsWith('#') && columnOf(plain) === undefined) return {};
  return Object.fromEntries(['color', 'colormap', 'range', 'exposure'].filter((word) => view[word] !== undefined && view[word] !== null).map((word) => [word, view[word]]));
}

/** A file's name, of what a server said (`Content-Disposition`) or, where it says none, of the cloud and what it is. */
export function fileName(disposition, cloud, what, format) {
  const said = /filename="?([^";/\\]{1,120})"?/.exec(disposition ?? '')?.[1];
  return what || !said ? [cloud, what].filter(Boolean).join('-').replace(/[^A-Za-z0-9._-]+/g, '-') + `.${format}` : said;
}

/** { points, bytes } of the beginning of a LAS or PLY file: as many as its head says; undefined where that is none of these. */
export function countIn(bytes) {
  const text = new TextDecoder('latin1').decode(bytes.subarray(0, 4096));
  if (text.startsWith('LASF') && bytes.length >= 255) {
    const view = new DataView(bytes.buffer, bytes.byteOffset);
    const points = Number(view.getBigUint64(247, true));
    return { points, bytes: view.getUint32(96, true) + points * view.getUint16(105, true) };
  }
  const end = text.indexOf('end_header\n');
  const [, count] = /\nelement vertex (\d+)\n/.exec(text) ?? [];
  if (!text.startsWith('ply\n') || end < 0 || !count) return undefined;
  const sizes = { char: 1, uchar: 1, int8: 1, uint8: 1, short: 2, ushort: 2, int16: 2, uint16: 2, int: 4, uint: 4, int32: 4, uint32: 4, float: 4, float32: 4, double: 8, float64: 8 };
  const record = [...text.slice(0, end).matchAll(/\nproperty (\w+) \w+/g)].reduce((sum, [, type]) => sum + (sizes[type] ?? 0), 0);
  return { points: Number(count), bytes: end + 11 + Number(count) * record };
}
