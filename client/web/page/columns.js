// Columns that a scan keeps beside what is drawn - GPS time, returns, a file's own - as the page speaks of them: their names, their units, and the
// ends of a ramp over them. Pure.

import { columnOf } from '../protocol/view_words.js';
import { strings } from './strings.js';

const words = strings.columns;
/** Those that are drawn by colours of their own names. */
const drawn = ['intensity', 'classification'];

/** Whether a server filters and colours by columns: older ones do not have that word. */
export const knowsColumns = (cloud) => Object.hasOwn(cloud?.view ?? {}, 'filter');

/** All points have the same value. */
export const isOne = (range) => Boolean(range) && range[0] === range[1];

/** The columns that a scan can be coloured by: older cloud files keep them for exports alone. */
export const columnsOf = (cloud) => (knowsColumns(cloud) ? (cloud.columns ?? []).filter(({ name, drawn: isDrawn = true, range }) => isDrawn && !drawn.includes(name) && !isOne(range)) : []);

/** "GPS time", or the file's own word. */
export const columnTitle = (name) => words.names[name] ?? name.replaceAll('_', ' ');

/** The column that a colour comes from, as the scan has it; undefined for another colour. */
export const columnIn = (color, cloud) => {
  const name = columnOf(color);
  return name === undefined ? undefined : (cloud?.columns ?? []).find((one) => one.name === name) ?? { name };
};

/** In what its values are; '' where nobody knows. */
export const unitOfColumn = ({ name, unit }, cloud) => unit ?? words.units[name] ?? (/distance/i.test(name) ? strings.facts.units[cloud?.crsUnit] ?? '' : '');
