// What the server is asked for a profile, and what it says of its picture (PROTOCOL.md, "A profile"). Pure.

import { coloursOf, regionOf } from '../export/region.js';
import { lengthOf, partOf } from './line.js';

/** Of the line that is looked at, how much more of it is asked for at either end: there points belong to places beyond. In widths. */
const beyond = 1;

/** Points of the corridor that the view shows, as a body of `POST /clouds/{id}/profile`. */
export function pointsQuestion({ line, width }, view, format) {
  const region = regionOf(view);
  return { line, width, format, ...(region ? { region } : {}) };
}

/** A point's side, so that neighbours nearly meet; `pixels` for a unit of the scan, at least `least`. */
export const pointSizeFor = (spacing, pixels, least) => Math.min(6, Math.max(least, Math.round(0.6 * (spacing ?? 0) * pixels)));

/** The picture of all of it, which fills `size` (device pixels). */
export function wholeQuestion(profile, view, size, pointSize = 1) {
  return { ...pointsQuestion(profile, view, 'png'), picture: { width: size.width, height: size.height, pointSize, background: 'transparent', ...coloursOf(view) } };
}

/**
 * { question, from }: the picture of what lies between `edges`, at `scale` device pixels for a unit of station; its left edge is the station `from`.
 * Undefined where that is beside the line.
 */
export function partQuestion({ line, width }, view, edges, { scale, exaggeration }, pointSize = 1) {
  const all = lengthOf(line);
  const from = Math.min(all, Math.max(0, edges.left - beyond * width));
  const part = partOf(line, from, edges.right + beyond * width);
  if (!part) return undefined;
  const region = { ...regionOf(view), z: [edges.bottom, edges.top] };
  const picture = {
    width: Math.min(8192, Math.max(2, Math.ceil(lengthOf(part) * scale))), exaggeration, pointSize, background: 'transparent', ...coloursOf(view),
  };
  return { question: { line: part, width, format: 'png', region, picture }, from };
}

/** What `Scancast-Profile` says; undefined where it says nothing. */
export function toldBy(response) {
  try {
    return JSON.parse(response.headers.get('Scancast-Profile'));
  } catch {
    return undefined;
  }
}

/** Nothing lies there: no failure. */
export const isEmpty = (error) => error.status === 422 && /no point/i.test(`${error.title} ${error.message}`);
