// The settings panel: what is shown and how. Shows a view, and says what of it the user changed; it keeps no view of
// its own, and everything it offers comes from the server's lists.

import { Choices } from './choices.js';
import { ColourChoice, findsHidden } from './colour_choice.js';
import { MethodChoice } from './method_choice.js';
import { strings } from './strings.js';

/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);

/** What is offered behind the picture; `null` is the server's own. */
const backgrounds = { dusk: null, daylight: ['#f4f6f8', '#c3ccd5'], black: '#000000', white: '#ffffff' };
const dusk = JSON.stringify(['#3a424e', '#16191e']);

/** 'dusk', 'daylight', …; 'custom' for what is none of them. Pure. */
export function backgroundNamed(background) {
  const said = JSON.stringify(background ?? null);
  if (said === dusk) return 'dusk';
  return Object.keys(backgrounds).find((name) => JSON.stringify(backgrounds[name]) === said) ?? 'custom';
}

const named = (names, key) => names[key] ?? key.charAt(0).toUpperCase() + key.slice(1);

function fill(select, options) {
  const told = (list) => JSON.stringify([...list].map(({ value, label, disabled = false }) => [value, label, disabled]));
  if (told(select.options) === told(options)) return; // not while somebody has it open
  select.replaceChildren(
    ...options.map(({ value, label, disabled = false }) => Object.assign(new Option(label, value), { disabled })),
  );
}

export class Controls {
  #catalog;
  #view = {};
  #cloud;
  #on;
  #method;
  #colour;
  #background;

  /** `on` has style(changes), list() - somebody is about to choose a cloud -, cloud(id), upAxis('z', 'y' or '-y'), reset() and gallery(open), for pictures of the methods. */
  constructor(on) {
    this.#on = on;
    this.#method = new MethodChoice({
      change: (method) => this.#methodChosen(method),
      tune: (name, value) => on.style({ param: { ...this.#view.param, [name]: value } }),
      gallery: (open) => on.gallery(open),
    });
    this.#colour = new ColourChoice(on.style);
    this.#background = new Choices(find('background'), (name) => {
      on.style({ background: name === 'custom' ? find('background-color').value : backgrounds[name] });
    });
    this.#background.fill([...Object.keys(backgrounds), 'custom'].map((name) => (
      { value: name, label: strings.background[name], tip: strings.background[name], swatch: `swatch-${name}` })));
    find('controls').addEventListener('submit', (event) => event.preventDefault());
    find('cloud').addEventListener('focus', () => on.list());
    find('cloud').addEventListener('change', (event) => on.cloud(event.target.value));
    find('up-axis').addEventListener('change', (event) => on.upAxis(event.target.value));
    find('shading').addEventListener('change', (event) => on.style({ shading: event.target.value || null }));
    find('mirrors').addEventListener('change', (event) => on.style({ mirrors: event.target.checked }));
    find('behind-mirrors').addEventListener('change', (event) => on.style({ behindMirrors: event.target.checked }));
    find('background-color').addEventListener('input', (event) => on.style({ background: event.target.value }));
    find('detail').addEventListener('change', (event) => {
      on.style({ detail: event.target.value === '' ? null : Number(event.target.value) });
    });
    find('reset-style').addEventListener('click', () => on.reset());
  }

  setCatalog(catalog) {
    this.#catalog = catalog;
    this.#cloud = undefined; // what it can be shown with is another list now
    this.setClouds(catalog);
    this.#method.setCatalog(catalog);
    this.#colour.setCatalog(catalog);
    fill(find('shading'), [
      { value: '', label: strings.lighting.automatic },
      ...catalog.shadings.map((shading) => ({ value: shading, label: named(strings.lighting.names, shading) })),
    ]);
  }

  setClouds({ clouds, pending }) {
    const select = find('cloud');
    const chosen = select.value;
    const { loading, failed } = strings.panel;
    fill(select, [
      // A cloud that is still being read can be looked at coarsely meanwhile.
      ...clouds.map(({ id, title, state }) => ({ value: id, label: state === 'loading' ? loading(title || id) : title || id })),
      ...pending.map(({ id, title, state }) => ({ value: id, label: (state === 'failed' ? failed : loading)(title || id) })),
    ]);
    if (chosen) select.value = chosen;
  }

  /** Shows the view that is wanted of this cloud. */
  show(view, cloud) {
    if (!this.#catalog) return;
    this.#view = view;
    if (cloud !== this.#cloud) this.#showCloud(cloud);
    find('cloud').value = cloud.id;
    this.#method.show(view);
    this.#colour.show(view);
    find('shading').value = view.shading ?? '';
    find('mirrors').checked = view.mirrors ?? true;
    find('behind-mirrors').checked = view.behindMirrors ?? false;
    this.#showBackground(view.background);
    this.#showDetail(view.detail);
  }

  /** `stats` of a picture of the cloud that is shown. */
  told(stats) {
    this.#colour.told(stats);
  }

  /** Methods that a gallery may show: { method, place } each, the chosen one first. */
  get methodPictures() {
    return this.#method.pictures;
  }

  #showCloud(cloud) {
    this.#cloud = cloud;
    find('mirror-options').hidden = !(cloud.mirrors?.length > 0);
    this.#method.showCloud(cloud);
    this.#colour.showCloud(cloud);
  }

  #showBackground(background) {
    const name = backgroundNamed(background);
    this.#background.show(name);
    find('background-color').hidden = name !== 'custom';
    if (typeof background === 'string' && background.startsWith('#')) find('background-color').value = background;
  }

  #showDetail(detail) {
    const select = find('detail');
    const value = typeof detail === 'number' ? String(detail) : '';
    // A link may ask for something between the steps.
    if (![...select.options].some((option) => option.value === value)) select.append(new Option(strings.panel.detailPixels(value), value));
    select.value = value;
  }

  #methodChosen(method) {
    const without = this.#view.color === 'visibility' && method !== findsHidden;
    this.#on.style({ method, param: {}, ...(without ? { color: 'auto' } : {}) });
  }
}
