// For a GIS, in the dialog of exports: the addresses at which it finds the cloud as a map - as it looks now -, and elevation and orthophoto as GeoTIFFs.

import { NumberField } from '../page/number_field.js';
import { element } from '../page/parameter_fields.js';
import { unitName } from '../page/plan/lengths.js';
import { exporting as words } from '../page/strings/export.js';
import { ownShift } from '../page/members.js';
import { printQuery, styleKeys, wordsOf } from '../protocol/view_words.js';
import { pick } from '../view/usual.js';
import { sizeText } from './sizes.js';

/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);
const ofPoints = ['classes', 'clip', 'clips', 'filter', 'outliers', 'behindMirrors']; // which of them count
const notOfMaps = ['background', 'detail', 'budget', 'quality', 'subsampling'];
const places = [24, 16]; // at which the picture's extent is looked for

/** Of the words of a view, those that are not the cloud's own, as a query has them: '' or 'color=elevation&…'. Pure. */
export function wordsFor(view, usual, keys) {
  const known = new Map(/** @type {any} */ (wordsOf(usual ?? {})));
  return printQuery(wordsOf(pick(view, keys), usual).filter(([word, value]) => known.get(word) !== value));
}

/** The addresses of a cloud's maps at a server, in that look. Pure. */
export function addressesOf(origin, cloud, query) {
  const base = `${origin}/api/v1/clouds/${encodeURIComponent(cloud)}`;
  const behind = (mark) => (query ? mark + query : '');
  return {
    wms: `${base}/wms?SERVICE=WMS&REQUEST=GetCapabilities${behind('&')}`, wmts: `${base}/wmts?SERVICE=WMTS&REQUEST=GetCapabilities${behind('&')}`,
    tiles: `${base}/tiles/mercator/{z}/{x}/{y}.png${behind('?')}`,
  };
}

/** Columns, rows and bytes of a raster over that box, as it is unpacked; four bytes a cell are a height, and a pixel of four bands. Pure. */
export function rasterSize([x0, y0, x1, y1], cell) {
  const [columns, rows] = [x1 - x0, y1 - y0].map((length) => Math.max(1, Math.ceil(length / cell - 1e-9)));
  return { columns, rows, bytes: 4 * columns * rows };
}

/** A cell in which some points lie, and of which there are not too many: 1, 2 or 5 times a power of ten. Pure. */
export function usualCell({ spacing, bounds: { min, max } }) {
  const least = Math.max(2 * (spacing ?? 0), Math.max(max[0] - min[0], max[1] - min[1]) / 8000) || 1;
  const power = 10 ** Math.floor(Math.log10(least));
  return Number(([1, 2, 5, 10].find((times) => times * power >= least * (1 - 1e-9)) * power).toPrecision(3));
}

export class Maps {
  #viewer;
  #save;
  #cell;
  #field;
  #shown; // of the picture, as a box in plan

  /** `save(path, name)` saves what the server answers there. */
  constructor(viewer, save) {
    this.#viewer = viewer;
    this.#save = save;
    const gis = element('dl', { id: 'map-addresses' }, ...Object.keys(words.maps.services).flatMap((name) => {
      const field = element('input', { type: 'text', id: `map-${name}`, readOnly: true, ariaLabel: words.maps.services[name] });
      field.addEventListener('focus', () => field.select());
      const copy = element('button', { type: 'button', className: 'small', textContent: words.maps.copy, ariaLabel: words.maps.copyNamed(words.maps.services[name]) });
      copy.addEventListener('click', () => this.#copy(field));
      return [element('dt', { textContent: words.maps.services[name] }), element('dd', {}, field, copy)];
    }));
    find('map-services').append(gis);
    this.#field = new NumberField(find('raster-cell'), (value) => (value > 0 ? '' : words.maps.noCell), (value) => {
      this.#cell = value;
      this.#showSize();
    }, { note: find('raster-refusal') });
    for (const id of ['raster-kind', 'raster-extent']) find(id).addEventListener('change', () => this.#showSize());
    find('raster-save').addEventListener('click', () => this.#begin());
  }

  /** As the view is now. */
  show() {
    const { cloud, view, server } = this.#viewer;
    this.#offer(server.access);
    const addresses = addressesOf(server.origin, cloud.id, wordsFor(view, cloud.view, styleKeys.filter((key) => !notOfMaps.includes(key))));
    for (const [name, address] of Object.entries(addresses)) find(`map-${name}`).value = address;
    find('map-token').hidden = !server.access.hasToken;
    const isKnown = Boolean(cloud.crsEpsg || cloud.crsWkt || cloud.crs);
    find('map-web').hidden = isKnown;
    for (const node of [find('map-tiles').parentElement, find('map-tiles').parentElement.previousElementSibling]) node.hidden = !isKnown;
    this.#cell = usualCell(cloud);
    this.#field.show(this.#cell);
    find('raster-unit').textContent = unitName(cloud.crsUnit);
    this.#shown = this.#seen();
    this.#showSize();
  }

  /** Guests may have pictures alone, and have no token for other programs. */
  #offer({ mayExport, isGuest }) {
    const { value: chosen } = find('raster-kind');
    const kinds = Object.entries(words.maps.kinds).filter(([kind]) => mayExport || kind === 'ortho');
    find('raster-kind').replaceChildren(...kinds.map(([value, textContent]) => element('option', { value, textContent, selected: value === chosen })));
    find('rasters').open ||= !mayExport; // all that there is
    find('map-services').hidden = isGuest;
  }

  async #copy(field) {
    try {
      await navigator.clipboard.writeText(field.value);
      find('map-said').textContent = words.maps.copied;
    } catch {
      field.focus(); // selected, to be copied from there
    }
  }

  /** What the picture shows of the cloud, as a box in plan; undefined where it shows nothing. */
  #seen() {
    const { cssSize: { width, height } } = this.#viewer;
    const found = Array.from({ length: places[0] * places[1] }, (_, i) => this.#viewer.surfaceAt({
      x: ((i % places[0]) + 0.5) * (width / places[0]), y: (Math.floor(i / places[0]) + 0.5) * (height / places[1]),
    })?.point).filter(Boolean);
    return found.length > 0 ? [Math.min, Math.max].flatMap((most) => [0, 1].map((axis) => most(...found.map((point) => point[axis])))) : undefined;
  }

  get #isOrtho() { return find('raster-kind').value === 'ortho'; }

  /** A box in plan: of an orthophoto, of all that is seen; else of this cloud as its file has it. Undefined where the picture shows nothing of that. */
  get #box() {
    const { cloud, bounds, view } = this.#viewer;
    const { min, max } = this.#isOrtho ? bounds : cloud.bounds;
    const all = [min[0], min[1], max[0], max[1]];
    if (find('raster-extent').value !== 'shown') return all;
    const shift = (!this.#isOrtho && ownShift(view)) || [0, 0];
    const box = this.#shown?.map((value, i) => Math.min(all[2 + (i % 2)], Math.max(all[i % 2], value - shift[i % 2])));
    return box && box[0] < box[2] && box[1] < box[3] ? box : undefined;
  }

  #showSize() {
    const box = this.#box;
    find('raster-save').disabled = !box;
    find('raster-alone').hidden = this.#isOrtho || !this.#viewer.view.with;
    if (!box) {
      find('raster-size').textContent = words.maps.nothing;
      return;
    }
    const { columns, rows, bytes } = rasterSize(box, this.#cell);
    find('raster-size').textContent = words.maps.size(columns, rows, sizeText(bytes));
  }

  #begin() {
    const { cloud, view } = this.#viewer;
    const kind = find('raster-kind').value;
    const isOrtho = this.#isOrtho;
    const decimals = Math.max(0, 3 - Math.floor(Math.log10(this.#cell)));
    const query = [
      find('raster-extent').value === 'shown' ? `bbox=${this.#box.map((value) => Number(value.toFixed(Math.min(9, decimals)))).join()}` : '', `cell=${this.#cell}`,
      isOrtho ? '' : `value=${kind}`, wordsFor(view, cloud.view, isOrtho ? styleKeys.filter((key) => !notOfMaps.includes(key)) : ofPoints),
    ].filter(Boolean).join('&');
    const file = isOrtho ? 'ortho' : 'dem';
    this.#save(`/api/v1/clouds/${encodeURIComponent(cloud.id)}/${file}.tif?${query}`, isOrtho ? 'ortho' : `dem-${kind}`);
  }
}
