// Annotations as a project file has them: a title at a point of the scan, with a text and a link where somebody gave one. They may come
// from anywhere, so everything is checked. Pure.
//
// A note is { id, name, text, link, point, step, visible }: `name` is its title, `point` as it stands in the scan's file, `step` as of a measure.

import { check, isLength, isPoint, isText, listOf } from '../measure/checks.js';

export const mostNotes = 500;
export const longestTitle = 120;
export const longestText = 4000;
export const longestLink = 2000;

/** The address, as browsers spell it, if it leads to a page: http or https, and nothing that runs. Undefined for anything else. */
export function linkOf(text) {
  if (!isText(text, longestLink) || !/^https?:\/\//i.test(text)) return undefined;
  try {
    const { protocol, href } = new URL(text);
    return ['http:', 'https:'].includes(protocol) && href.length <= 3 * longestLink ? href : undefined;
  } catch {
    return undefined;
  }
}

export const readNotes = (file) => listOf(file, 'annotations', mostNotes, ({ title, text = '', link = '', point, step = 0, visible = true }, where) => {
  check(isText(title, longestTitle), `${where}.title is no text of up to ${longestTitle} letters.`);
  check(isText(text, longestText), `${where}.text is no text of up to ${longestText} letters.`);
  check(link === '' || linkOf(link) !== undefined, `${where}.link is no address that begins with http:// or https://.`);
  check(isPoint(point), `${where}.point is no point: three finite numbers, x, y and z.`);
  check(isLength(step), `${where}.step is no length.`);
  check(typeof visible === 'boolean', `${where}.visible is neither true nor false.`);
  return { name: title, text, link, point, step, visible };
});

export const writtenNotes = (list) => list.map(({ name, text, link, point, step, visible }) => (
  { title: name, ...(text ? { text } : {}), ...(link ? { link } : {}), ...(visible ? {} : { visible }), step, point }));

/** As points that were measured: what exports are made of, and what is drawn. */
export const pointOf = ({ id, name, text, link, point, step, visible }) => (
  { id, kind: 'point', name, points: [point], step, up: 'z', visible, note: { text, link } });
