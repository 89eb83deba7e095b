// What colours show: a tile with a swatch for everything that this scan can be coloured by, and the ramp and its ends for those that
// have one.

import { colorOf, columnOf } from '../protocol/view_words.js';
import { Choices } from './choices.js';
import { columnIn, columnsOf, columnTitle } from './columns.js';
import { NumberField, rangeRefusal } from './number_field.js';
import { element } from './parameter_fields.js';
import { strings } from './strings.js';

/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);
const words = strings.colour;
const withRamp = ['intensity', 'elevation', 'depth', 'lod'];
const byIntensity = '*intensity';
/** Who removes hidden points, and so can show them. */
export const findsHidden = 'pyramid';
const mayLack = ['rgb', 'cir', 'intensity', 'classification', 'normal', 'curvature'];

const named = (names, key) => names[key] ?? key.charAt(0).toUpperCase() + key.slice(1);
/** 'rgb*intensity' → ['rgb', 'intensity']: what colours come from, and what makes it brighter. */
const factorsOf = (color) => (columnOf(color) === undefined ? (color ?? '').split('*') : [color]);

/**
 * What a cloud can be coloured by, and what not: { options, missing: [{ value, label, reason }] }. Intensity as a factor is no
 * choice of its own but a box beside them. Pure.
 */
export function colourOptions(colors, cloud, method, isTogether = false) {
  const has = (attribute) => (cloud?.attributes ?? []).some((one) => one.name === attribute);
  const reasonFor = (color) => {
    if (mayLack.includes(color) && !has(color)) return words.notInScan;
    if (color === 'cloud' && !isTogether) return words.onlyTogether;
    return color === 'visibility' && method !== findsHidden ? words.onlyReconstructed : '';
  };
  const all = [...colors.filter((color) => !color.includes('*')), 'flat']
    .map((color) => ({ value: color, label: named(words.names, color), swatch: `swatch-${color}`, reason: reasonFor(color) }));
  const columns = columnsOf(cloud).map(({ name, description }) => ({ value: colorOf(name), label: columnTitle(name), tip: description, swatch: 'swatch-column' }));
  return { options: [...all.filter(({ reason }) => !reason), ...columns], missing: all.filter(({ reason }) => reason) };
}

/** Whether what colours come from can be made darker where intensity is low. Pure. */
export function takesIntensity(source, colors, cloud) {
  if (!(cloud?.attributes ?? []).some(({ name }) => name === 'intensity')) return false;
  return source.startsWith('#') ? colors.some((color) => color.endsWith(byIntensity)) : colors.includes(source + byIntensity);
}

export class ColourChoice {
  #view = {};
  #cloud;
  #colors = [];
  #style;
  #choice;
  #ramps;
  #ends; // fields of the range
  #told = new Map(); // source → the ends that the server chose for this cloud
  #offered = ''; // what is offered now: filled in anew only when that is something else

  /** `style(changes)` hears of what was chosen. */
  constructor(style) {
    this.#style = style;
    this.#choice = new Choices(find('color'), (value) => this.#chosen(value === 'flat' ? find('flat-color').value : value));
    this.#ramps = new Choices(find('colormap'), (colormap) => style({ colormap }));
    find('flat-color').addEventListener('input', () => this.#chosen(find('flat-color').value));
    find('by-intensity').addEventListener('change', () => this.#chosen(factorsOf(this.#view.color)[0]));
    const note = element('p', { className: 'refusal', id: 'range-refusal' });
    const group = find('range-high').parentElement;
    group.after(note);
    this.#ends = ['range-low', 'range-high'].map(
      (id) => new NumberField(find(id), () => rangeRefusal(this.#typedRange()), () => this.#rangeChosen(), { note, group }));
  }

  setCatalog({ colors, colormaps }) {
    this.#colors = colors;
    this.#ramps.fill(colormaps.map((map) => ({ value: map, label: named(words.rampNames, map), swatch: `swatch-${map}` })));
  }

  showCloud(cloud) {
    this.#cloud = cloud;
    this.#told.clear();
    this.#offered = '';
  }

  show(view) {
    this.#view = view;
    const [source, by] = factorsOf(view.color);
    const flat = source.startsWith('#');
    this.#offer(view);
    this.#choice.show(flat ? 'flat' : source);
    find('flat-colour').hidden = !flat;
    if (flat) find('flat-color').value = source;
    find('shade-by-intensity').hidden = !takesIntensity(source, this.#colors, this.#cloud);
    find('by-intensity').checked = by === 'intensity';
    find('ramp').hidden = !withRamp.includes(source) && columnOf(source) === undefined;
    this.#ramps.show(view.colormap);
    const usual = this.#usualRange(view.color);
    ['range-low', 'range-high'].forEach((id, i) => {
      const input = find(id);
      input.placeholder = usual ? String(Number(usual[i].toPrecision(6))) : [words.lowHint, words.highHint][i];
      this.#ends[i].show(view.range ? view.range[i] : '');
    });
  }

  /** What the server says of a picture: the ends that it chose for a ramp. Those of depth are the camera's, and other ones each time. */
  told({ color, range }) {
    const source = factorsOf(color)[0];
    if (!range || this.#view.range || this.#view.color !== color || source === 'depth') return;
    this.#told.set(source, range);
    this.show(this.#view);
  }

  #offer({ method, with: others }) {
    const isTogether = (others?.length ?? 0) > 0;
    const offered = JSON.stringify([this.#cloud?.id, this.#cloud?.attributes, this.#cloud?.columns, method === findsHidden, isTogether]);
    if (offered === this.#offered) return;
    this.#offered = offered;
    const { options, missing } = colourOptions(this.#colors, this.#cloud, method, isTogether);
    this.#choice.fill(options);
    const lacking = missing.filter(({ reason }) => reason === words.notInScan).map(({ label }) => label);
    find('color-note').textContent = [
      lacking.length > 0 ? words.notInScanAre(lacking.join(', ')) : '',
      missing.some(({ value }) => value === 'visibility') ? words.hiddenPoints : '',
    ].filter(Boolean).join(' ');
  }

  #chosen(source) {
    const darker = find('by-intensity').checked && takesIntensity(source, this.#colors, this.#cloud);
    const color = source + (darker ? byIntensity : '');
    // The ends of one attribute's ramp mean nothing to another.
    const sameEnds = factorsOf(this.#view.color)[0] === source;
    this.#style(sameEnds ? { color } : { color, range: null });
  }

  /** The values at the ramp's ends when nobody chose others, where they are known. */
  #usualRange(color) {
    const bounds = this.#cloud?.bounds;
    const [source] = factorsOf(color);
    if (this.#told.has(source)) return this.#told.get(source);
    if (source === 'elevation' && bounds) return [bounds.min[2], bounds.max[2]];
    const column = columnIn(source, this.#cloud);
    if (column) return column.usual ?? column.range;
    return (this.#cloud?.attributes ?? []).find((one) => one.name === source)?.range;
  }

  /** With the usual value for an end that is left open; NaN where that is not known. */
  #typedRange() {
    const usual = this.#usualRange(this.#view.color) ?? [NaN, NaN];
    return ['range-low', 'range-high'].map((id, i) => (find(id).value === '' ? usual[i] : find(id).valueAsNumber));
  }

  #rangeChosen() {
    const range = this.#typedRange();
    if (['range-low', 'range-high'].every((id) => find(id).value === '')) this.#style({ range: null });
    else if (!range.some(Number.isNaN)) this.#style({ range }); // else the other end is still to come
  }
}
