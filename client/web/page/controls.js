// The settings panel: what is shown and how. Shows a view, and says what of it the user changed; it keeps no view of
// its own, and everything it offers comes from the server's lists.

import { NumberField, rangeRefusal } from './number_field.js';
import { element, parameterFields } from './parameter_fields.js';

const find = (id) => document.getElementById(id);

const colorNames = {
  auto: 'Automatic', rgb: 'As scanned', cir: 'Infrared', intensity: 'Intensity', elevation: 'Height', classification: 'Classification', normal: 'Direction of the surface',
  curvature: 'Curvature',
  depth: 'Distance', lod: 'Level of detail', visibility: 'Hidden points (reconstructed surface only)',
};
const shadingNames = { unlit: 'None', phong: 'From the viewer', eyedome: 'Shaded edges' };
const colormapNames = { viridis: 'Viridis', turbo: 'Turbo', grey: 'Grey' };
const withRamp = ['intensity', 'elevation', 'depth', 'lod'];
/** Who removes hidden points, and so can show them. */
const findsHidden = 'pyramid';
const mayLack = ['rgb', 'cir', 'intensity', 'classification', 'normal', 'curvature'];
const dusk = JSON.stringify(['#3a424e', '#16191e']);

const named = (names, key) => names[key] ?? key.charAt(0).toUpperCase() + key.slice(1);
/** 'rgb*intensity' → ['rgb', 'intensity']: what colours come from, and what makes it brighter. */
const factorsOf = (color) => (color ?? '').split('*');

function fill(select, options) {
  const same = [...select.options].map(({ value, label, disabled }) => ({ value, label, disabled: disabled || undefined }));
  const wanted = options.map(({ value, label, disabled }) => ({ value, label, disabled: disabled || undefined }));
  if (JSON.stringify(same) === JSON.stringify(wanted)) return; // not while somebody has it open
  select.replaceChildren(
    ...options.map(({ value, label, disabled = false }) => Object.assign(new Option(label, value), { disabled })),
  );
}

export class Controls {
  #catalog;
  #view = {};
  #cloud;
  #ends; // fields of the range
  #fields;
  #fieldsOf;
  #on;

  /** `on` has style(changes), list() - somebody is about to choose a cloud -, cloud(id), upAxis('z', 'y' or '-y') and reset(). */
  constructor(on) {
    this.#on = on;
    find('controls').addEventListener('submit', (event) => event.preventDefault());
    find('cloud').addEventListener('focus', () => on.list());
    find('cloud').addEventListener('change', (event) => on.cloud(event.target.value));
    find('up-axis').addEventListener('change', (event) => on.upAxis(event.target.value));
    find('method').addEventListener('change', (event) => this.#methodChosen(event.target.value));
    find('color').addEventListener('change', () => this.#colorChosen());
    find('flat-color').addEventListener('input', () => on.style({ color: this.#flatColor() }));
    find('colormap').addEventListener('change', (event) => on.style({ colormap: event.target.value }));
    const note = element('p', { className: 'refusal', id: 'range-refusal' });
    const group = find('range-high').parentElement;
    group.after(note);
    this.#ends = ['range-low', 'range-high'].map(
      (id) => new NumberField(find(id), () => rangeRefusal(this.#typedRange()), () => this.#rangeChosen(), { note, group }));
    find('shading').addEventListener('change', (event) => on.style({ shading: event.target.value || null }));
    find('mirrors').addEventListener('change', (event) => on.style({ mirrors: event.target.checked }));
    find('behind-mirrors').addEventListener('change', (event) => on.style({ behindMirrors: event.target.checked }));
    find('background').addEventListener('change', () => this.#backgroundChosen());
    find('background-color').addEventListener('input', (event) => on.style({ background: event.target.value }));
    find('detail').addEventListener('change', (event) => {
      on.style({ detail: event.target.value === '' ? null : Number(event.target.value) });
    });
    find('reset-style').addEventListener('click', () => on.reset());
  }

  setCatalog(catalog) {
    this.#catalog = catalog;
    this.#fieldsOf = undefined;
    this.setClouds(catalog);
    fill(find('method'), catalog.methods.map((method) => ({ value: method.name, label: method.title || method.name })));
    fill(find('colormap'), catalog.colormaps.map((map) => ({ value: map, label: named(colormapNames, map) })));
    fill(find('shading'), [
      { value: '', label: 'Automatic' },
      ...catalog.shadings.map((shading) => ({ value: shading, label: named(shadingNames, shading) })),
    ]);
  }

  setClouds({ clouds, pending }) {
    const select = find('cloud');
    const chosen = select.value;
    fill(select, [
      // A cloud that is still being read can be looked at coarsely meanwhile.
      ...clouds.map((cloud) => ({
        value: cloud.id,
        label: `${cloud.title || cloud.id}${cloud.state === 'loading' ? ' (loading…)' : ''}`,
      })),
      ...pending.map((cloud) => ({
        value: cloud.id,
        label: `${cloud.title || cloud.id} (${cloud.state === 'failed' ? 'could not be loaded' : 'loading…'})`,
      })),
    ]);
    if (chosen) select.value = chosen;
  }

  /** Shows the view that is wanted of this cloud. */
  show(view, cloud) {
    if (!this.#catalog) return;
    if (cloud !== this.#cloud) this.#showCloud(cloud);
    this.#view = view;
    find('cloud').value = cloud.id;
    this.#showMethod(view);
    this.#showColor(view);
    find('shading').value = view.shading ?? '';
    find('mirrors').checked = view.mirrors ?? true;
    find('behind-mirrors').checked = view.behindMirrors ?? false;
    this.#showBackground(view.background);
    this.#showDetail(view.detail);
  }

  #has(attribute) {
    return (this.#cloud?.attributes ?? []).some((one) => one.name === attribute);
  }

  /** The values at the ramp's ends when nobody chose others, where they are known. */
  #usualRange(color) {
    const bounds = this.#cloud?.bounds;
    const [source] = factorsOf(color);
    if (source === 'elevation' && bounds) return [bounds.min[2], bounds.max[2]];
    return (this.#cloud?.attributes ?? []).find((one) => one.name === source)?.range;
  }

  /** Products are offered where the cloud has both; what else it lacks is greyed out. */
  #colorOptions() {
    const lacks = (color) => factorsOf(color).some((one) => mayLack.includes(one) && !this.#has(one));
    return this.#catalog.colors
      .filter((color) => !(color.includes('*') && lacks(color)))
      .map((color) => {
        const label = factorsOf(color).map((one) => named(colorNames, one)).join(' × ');
        return { value: color, label: label + (lacks(color) ? ' (not in this cloud)' : ''), disabled: lacks(color) };
      });
  }

  /** One colour for everything; by intensity, where a link said so. */
  #flatColor() {
    const [source, ...by] = factorsOf(this.#view.color);
    return [find('flat-color').value, ...(source.startsWith('#') ? by : [])].join('*');
  }

  #showCloud(cloud) {
    this.#cloud = cloud;
    find('mirror-options').hidden = !(cloud.mirrors?.length > 0);
    fill(find('color'), [...this.#colorOptions(), { value: 'flat', label: 'One colour…' }]);
    for (const option of find('method').options) {
      const method = this.#catalog.methods.find((one) => one.name === option.value);
      const lacking = (method?.needs ?? []).filter((need) => (need === 'surfels' ? !this.#cloud?.surfels : !this.#has(need)));
      option.disabled = lacking.length > 0;
      option.textContent = (method?.title || option.value) + (lacking.length > 0 ? ` (needs ${lacking.join(', ')})` : '');
    }
  }

  #showMethod(view) {
    const method = this.#catalog.methods.find((one) => one.name === view.method);
    find('method').value = view.method;
    if (this.#fieldsOf !== view.method) {
      this.#fieldsOf = view.method;
      find('method-summary').textContent = method?.summary ?? '';
      this.#fields = parameterFields(method?.parameters ?? [], (name, value) => {
        this.#on.style({ param: { ...this.#view.param, [name]: value } });
      });
      find('parameters').replaceChildren(...this.#fields.nodes);
      find('tuning').hidden = this.#fields.nodes.length === 0;
    }
    this.#fields.show(view.param);
  }

  #showColor(view) {
    const [source] = factorsOf(view.color);
    const flat = source.startsWith('#');
    find('color').value = flat ? 'flat' : view.color;
    for (const option of find('color').options)
      if (option.value === 'visibility') option.disabled = view.method !== findsHidden;
    find('flat-color').hidden = !flat;
    if (flat) find('flat-color').value = source;
    find('ramp').hidden = !withRamp.includes(source);
    find('colormap').value = view.colormap;
    find('ramp-preview').className = `ramp-${view.colormap}`;
    const usual = this.#usualRange(view.color);
    ['range-low', 'range-high'].forEach((id, i) => {
      const input = find(id);
      input.placeholder = usual ? String(Number(usual[i].toPrecision(6))) : ['lowest', 'highest'][i];
      this.#ends[i].show(view.range ? view.range[i] : '');
    });
  }

  #showBackground(background) {
    const select = find('background');
    const value = background === null || JSON.stringify(background) === dusk ? 'dusk' : background;
    const listed = [...select.options].some((option) => option.value === value);
    const custom = !listed || (select.value === 'custom' && value !== 'dusk');
    select.value = custom ? 'custom' : value;
    find('background-color').hidden = !custom;
    if (typeof value === 'string' && value.startsWith('#')) find('background-color').value = value;
  }

  #showDetail(detail) {
    const select = find('detail');
    const value = typeof detail === 'number' ? String(detail) : '';
    // A link may ask for something between the steps.
    if (![...select.options].some((option) => option.value === value)) select.append(new Option(`${value} px`, value));
    select.value = value;
  }

  #methodChosen(method) {
    const without = this.#view.color === 'visibility' && method !== findsHidden;
    this.#on.style({ method, param: {}, ...(without ? { color: 'auto' } : {}) });
  }

  #colorChosen() {
    const { value } = find('color');
    // The ends of one attribute's ramp mean nothing to another.
    this.#on.style({ color: value === 'flat' ? this.#flatColor() : value, range: null });
  }

  /** With the usual value for an end that is left open; NaN where that is not known. */
  #typedRange() {
    const usual = this.#usualRange(this.#view.color) ?? [NaN, NaN];
    return ['range-low', 'range-high'].map((id, i) => (find(id).value === '' ? usual[i] : find(id).valueAsNumber));
  }

  #rangeChosen() {
    const range = this.#typedRange();
    if (['range-low', 'range-high'].every((id) => find(id).value === '')) this.#on.style({ range: null });
    else if (!range.some(Number.isNaN)) this.#on.style({ range }); // else the other end is still to come
  }

  #backgroundChosen() {
    const { value } = find('background');
    if (value === 'custom') this.#on.style({ background: find('background-color').value });
    else this.#on.style({ background: value === 'dusk' ? null : value });
  }
}
