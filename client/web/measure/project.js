// The project file: what somebody has done with a scan, as JSON that he can keep, send and open again (docs/project-file.md). It
// may come from anywhere, so everything is checked, and what is wrong is named; what a later version added is kept. Pure.

import { readNotes, writtenNotes } from '../annotate/notes.js';
import { readTours, readViews, writtenTours, writtenViews } from '../views/saved.js';
import { check, isLength, isObject, isPoint, isText, ProjectError } from './checks.js';
import { mostMeasures } from './measures.js';
import { isOptionOf, kinds } from './values.js';

export { ProjectError };

export const format = 'scancast-project';
const version = 1;
export const mostBytes = 4 << 20;
const longestName = 120;
const longestView = 4096;
const mostLevels = 64; // of lists and objects in each other; what is nested deeper may not be written again
const shortName = /^[A-Za-z0-9._-]{1,64}$/;
const ours = ['format', 'version', 'cloud', 'view', 'unit', 'measures', 'annotations', 'views', 'tours'];

/** `kept`: what else a file said that was opened, and this page does not know. */
export function printProject({ cloud, view, unit, measures, notes = [], views = [], tours = [], kept = {} }) {
  const written = measures.map(({ name, kind, visible, up, points, step, more, option }) => ({
    name, kind, ...(visible ? {} : { visible }), ...(up === 'z' ? {} : { up }), step, points, ...(option === undefined ? {} : { option }), ...(more ? { more } : {}),
  }));
  const { id, title, revision, crsName, crsUnit, crsEpsg } = cloud;
  const about = Object.fromEntries(Object.entries({ id, title, revision, crsName, crsUnit, crsEpsg }).filter(([, value]) => value));
  const parts = Object.entries({ annotations: writtenNotes(notes), views: writtenViews(views), tours: writtenTours(tours, views) }).filter(([, list]) => list.length > 0);
  return `${JSON.stringify({ format, version, cloud: about, view, unit, measures: written, ...Object.fromEntries(parts), ...kept }, undefined, 1)}\n`;
}

const isNested = (value, levels) => typeof value === 'object' && value !== null
  && (levels === 0 || Object.values(value).some((one) => isNested(one, levels - 1)));

/** Short facts about a point; anything else would be shown as what it is not. */
function moreOf(more, where) {
  if (more === undefined) return undefined;
  check(isObject(more) && JSON.stringify(more).length <= 4000, `${where}.more is no short list of names and values.`);
  return more;
}

function measureOf(one, where) {
  check(isObject(one), `${where} is no measure.`);
  const { kind, name = '', visible = true, up = 'z', step = 0, points, more, option } = one;
  check(typeof kind === 'string' && Object.hasOwn(kinds, kind), `${where}.kind: there is no kind ${JSON.stringify(kind)?.slice(0, 40)}; there are ${Object.keys(kinds).join(', ')}.`);
  check(isText(name, longestName), `${where}.name is no text of up to ${longestName} letters.`);
  check(typeof visible === 'boolean', `${where}.visible is neither true nor false.`);
  check(['z', 'y', '-y'].includes(up), `${where}.up is none of z, y, -y.`);
  check(isLength(step), `${where}.step is no length.`);
  const { least, most } = kinds[kind];
  check(Array.isArray(points), `${where}.points is no list of points.`);
  check(points.length >= least && points.length <= most,
    `${where}.points has ${points.length}; a measure of the kind ${kind} has ${least === most ? least : `${least} to ${most}`}.`);
  points.forEach((point, i) => check(isPoint(point), `${where}.points[${i}] is no point: three finite numbers, x, y and z.`));
  check(option === undefined || isOptionOf(kind, option), `${where}.option is none that a measure of the kind ${kind} has.`);
  check(!kinds[kind].fits || option !== undefined, `${where}.option is missing: how near to its points those are that a ${kind} is fitted to.`);
  const facts = moreOf(more, where);
  return { kind, name, visible, up, step, points, ...(option === undefined ? {} : { option }), ...(facts ? { more: facts } : {}) };
}

/** Why that text is no project file, '' where it is one: nothing is to be written that nobody can read again. */
export function refusalOf(text) {
  try {
    parseProject(text);
    return '';
  } catch (/** @type {any} */ error) {
    return error.message;
  }
}

/**
 * { cloud, view, unit, measures, notes, views, tours, kept } of a file's text; throws a ProjectError with a sentence for a person.
 * @param {string} text
 */
export function parseProject(text) {
  check(text.length <= mostBytes, `The file is larger than ${mostBytes >> 20} MiB, which no project file is.`);
  let file;
  try {
    file = JSON.parse(text);
  } catch (/** @type {any} */ error) {
    throw new ProjectError(`The file is no JSON: ${error.message}.`);
  }
  check(!isNested(file, mostLevels), `The file is nested more than ${mostLevels} levels deep, which no project file is.`);
  check(isObject(file) && file.format === format, `The file is no project file: it does not say "format": "${format}".`);
  check(Number.isInteger(file.version) && file.version >= 1, 'The file does not say which version it has.');
  check(file.version <= version, `The file is of version ${file.version}, and this page reads ${version}: a newer Scancast has written it.`);
  const { cloud, view = '', unit, measures = [] } = file;
  check(isObject(cloud) && typeof cloud.id === 'string' && shortName.test(cloud.id), 'cloud.id names no point cloud.');
  check(cloud.revision === undefined || isText(cloud.revision, 200), 'cloud.revision is no text.');
  check(isText(view, longestView), `view is no text of up to ${longestView} letters.`);
  check(unit === undefined || ['m', 'ft'].includes(unit), 'unit is neither m nor ft.');
  check(Array.isArray(measures), 'measures is no list.');
  check(measures.length <= mostMeasures, `There are ${measures.length} measures in the file; ${mostMeasures} is the most.`);
  const read = measures.map((one, i) => measureOf(one, `measures[${i}]`));
  const kept = Object.fromEntries(Object.entries(file).filter(([key]) => !ours.includes(key)));
  const [notes, views] = [readNotes(file), readViews(file)];
  const tours = readTours(file, views);
  return { cloud: { id: cloud.id, revision: cloud.revision }, view, unit, measures: read, notes, views, tours, kept };
}
