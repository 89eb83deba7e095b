// The legend on the picture: what its colours mean. Classes have their names; of a ramp it has the values at both ends, which the server
// tells with each picture - it alone knows what suits the cloud.

import { columnIn, columnTitle, unitOfColumn } from '../columns.js';
import { membersOf } from '../members.js';
import { element } from '../parameter_fields.js';
import { strings } from '../strings.js';
import { planStrings } from '../strings/plan.js';
import { unitName } from './lengths.js';

const words = planStrings.legend;
const mostClasses = 24;
const withRange = ['intensity', 'elevation', 'depth', 'curvature', 'column'];
const inUnits = ['elevation', 'depth'];

const sourceOf = (color) => (color?.startsWith('column:') ? 'column' : (color ?? '').split('*')[0]);

/** "31.5", "1,204": as many digits as tell the ends apart. Pure. */
export function rangeText([low, high]) {
  const decimals = Math.min(9, Math.max(0, 2 - Math.floor(Math.log10(Math.abs(high - low) || 1))));
  return [low, high].map((value) => value.toLocaleString('en', { maximumFractionDigits: decimals }).replace('-', '−'));
}

/** The classes of a cloud, each with what it is called, how it is drawn and how many points it has. Pure. */
export function classesOf(cloud) {
  const nameOf = (number) => cloud.classNames?.[number];
  const numbers = cloud.classes ?? [];
  // "Reserved" and "user defined" are the names of many.
  const nameIsShared = (number) => numbers.filter((other) => nameOf(other) === nameOf(number)).length > 1;
  const { numbered, named, number: unnamed } = planStrings.classes;
  return numbers.map((number) => ({
    number,
    name: !nameOf(number) ? unnamed(number) : nameIsShared(number) ? numbered(nameOf(number), number) : named(nameOf(number)),
    color: cloud.classColors?.[number] ?? '#808080',
    count: cloud.classCounts?.[number] ?? 0,
  }));
}

/**
 * What the legend of a picture says: { title, classes: [{ name, color }] , more } or { title, colors, ends: [text, text] }, or
 * undefined where colours need no words. `stats` are those of the picture, as far as they are known; `clouds`: all that there are. Pure.
 *
 * @returns {any}
 */
export function legendOf({ view = undefined, cloud = undefined, ramps = /** @type {any} */ ({}), stats = undefined, clouds = /** @type {any[]} */ ([]) }) {
  if (!view?.color || !cloud) return undefined;
  const known = view.color === 'auto' || stats?.color === view.color ? stats : undefined;
  const source = sourceOf(known?.color ?? view.color);
  const column = columnIn(known?.color ?? view.color, cloud);
  const title = column ? columnTitle(column.name) : strings.colour.names[source] ?? source;
  if (source === 'cloud') return { title: words.clouds, classes: membersOf(view, cloud, clouds).filter(({ hidden }) => !hidden), more: 0 };
  if (source === 'classification') {
    const shown = classesOf(cloud).filter(({ number }) => !view.classes || view.classes.includes(number));
    const listed = shown.slice(0, mostClasses);
    return { title, classes: listed, more: shown.length - listed.length };
  }
  if (source === 'lod' && ramps.lod) return { title, colors: ramps.lod, isStepped: true, ends: [words.level(0), words.level(ramps.lod.length - 1)], note: words.levels };
  // What the view says holds at once; the rest the server tells with the picture.
  const colors = source === 'curvature' ? ramps.curvature : ramps[view.color === 'auto' ? known?.colormap : view.colormap];
  const range = view.range ?? known?.range;
  if (!withRange.includes(source) || !colors || !range) return undefined;
  if (column) return { title, colors, ends: rangeText(range), unit: unitOfColumn(column, cloud), ...(column.description && column.description !== title ? { note: column.description } : {}) };
  const unit = unitName(cloud.crsUnit);
  const of = inUnits.includes(source) ? unit : source === 'curvature' ? words.inverse(unit) : '';
  return { title, colors, ends: rangeText(range), unit: of };
}

/** The colours one after the other, or as bands of their own. */
function gradient({ colors, isStepped }) {
  const stops = isStepped ? colors.map((color, i) => `${color} ${(100 * i) / colors.length}% ${(100 * (i + 1)) / colors.length}%`) : colors;
  return `linear-gradient(to right, ${stops.join(', ')})`;
}

function swatch(color) {
  const made = element('i', { className: 'swatch' });
  made.style.background = color;
  return made;
}

/** What stands at a legend's head. Pure. */
export const legendTitle = ({ title, unit }) => (unit ? `${title} (${unit})` : title);

/** Its lines, [{ text, color }]: classes with their colours, what else there is to say without. Pure. */
export const legendLines = ({ classes, more, note }) => [
  ...(classes ?? []).map(({ name, color }) => ({ text: name, color })),
  ...(more > 0 ? [{ text: words.more(more) }] : []), ...(note ? [{ text: note }] : []),
];

export class Legend {
  #said = '';
  node = element('section', { id: 'plan-legend', hidden: true });

  constructor() {
    this.node.setAttribute('aria-label', words.label);
    this.node.tabIndex = 0; // it may be longer than its place is high
  }

  show(known) {
    const legend = legendOf(known);
    const said = JSON.stringify(legend ?? null);
    if (said === this.#said) return;
    this.#said = said;
    this.node.hidden = !legend;
    if (!legend) return;
    const title = element('h2', { textContent: legendTitle(legend) });
    this.node.replaceChildren(title, ...(legend.classes ? this.#classes(legend) : this.#ramp(legend)));
  }

  #classes(legend) {
    const rows = legendLines(legend).map(({ text, color }) => (
      color ? element('li', {}, swatch(color), element('span', { textContent: text })) : element('li', { textContent: text })));
    return [element('ul', {}, ...rows)];
  }

  #ramp(legend) {
    const ramp = element('i', { className: 'ramp' });
    ramp.style.background = gradient(legend);
    const ends = element('p', { className: 'ends' }, ...legend.ends.map((text) => element('span', { textContent: text })));
    return [ramp, ends, ...(legend.note ? [element('p', { className: 'note', textContent: legend.note })] : [])];
  }
}
