// The panel below the picture: the profile's plot, what is read in it, how high it is, and what is saved of it.

import { element } from '../page/parameter_fields.js';
import { profile as words } from '../page/strings/profile.js';
import { exactText, heightFactor, unitOf, valueText } from '../measure/units.js';
import { Plot } from './plot.js';
import { apart, exaggerations } from './plot_view.js';

/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);
const least = 180; // px
const most = 0.75; // of the window
const usual = 300;

export class ProfilePanel {
  #does;
  #cloud;
  #height = usual;
  plot;

  /**
   * `does`: wants(edges, view, ratio) - a picture of that part; placeOf({ station, height }), in the scan's coordinates; hover(that, or undefined); again();
   * only(); save(format); mayExport(), whether points are to be had; stop(), of what is being saved; close()
   */
  constructor(does) {
    this.#does = does;
    this.plot = new Plot(find('profile-plot'), {
      wants: (edges, view, ratio) => does.wants(edges, view, ratio),
      moved: ({ exaggeration }) => { find('profile-exaggeration').value = String(exaggeration); },
      hover: (place) => this.#hover(place),
      measured: (places) => { find('profile-measured').textContent = places.length === 2 ? words.measured(this.#texts(places)) : ''; },
      text: (places) => words.short(this.#texts(places)),
      words: () => ({ station: words.station(this.#unit), height: words.height(this.#heightUnit) }),
    });
    find('profile-exaggeration').append(...exaggerations.map((times) => element('option', { value: String(times), textContent: words.times(times) })));
    find('profile-exaggeration').addEventListener('change', ({ target }) => { this.plot.exaggeration = Number(target.value); });
    find('profile-closer').addEventListener('click', () => this.plot.zoom(1.5));
    find('profile-farther').addEventListener('click', () => this.plot.zoom(1 / 1.5));
    find('profile-fit').addEventListener('click', () => this.plot.fit());
    find('profile-again').addEventListener('click', () => does.again());
    find('profile-only').addEventListener('click', () => does.only());
    find('profile-close').addEventListener('click', () => does.close());
    const files = find('profile-files');
    files.addEventListener('click', ({ target }) => {
      const format = target.closest('[data-format]')?.dataset.format;
      if (!format) return;
      files.hidePopover();
      does.save(format);
    });
    files.addEventListener('beforetoggle', () => {
      for (const button of files.querySelectorAll('[data-format]')) button.hidden = button.dataset.format !== 'png' && !does.mayExport();
      const { left, bottom } = find('profile-save').getBoundingClientRect();
      files.style.left = `${Math.max(4, Math.min(left, innerWidth - 190))}px`;
      files.style.top = `${Math.min(bottom + 4, innerHeight - 210)}px`;
    });
    find('profile-stop').addEventListener('click', () => does.stop());
    this.#resizer(find('profile-resize'));
    addEventListener('resize', () => this.isOpen && this.#setHeight(this.#height));
  }

  get isOpen() { return !find('profile-panel').hidden; }

  show(isOpen, cloud) {
    this.#cloud = cloud;
    find('profile-panel').hidden = !isOpen;
    document.body.classList.toggle('with-profile', isOpen);
    if (!isOpen) find('profile-files').hidePopover();
    this.#setHeight(this.#height);
  }

  /** `text`: how far the file is that is being saved; undefined where none is. */
  saving(text) {
    find('profile-stop').hidden = text === undefined;
    if (text !== undefined) find('profile-stop').title = text;
    find('profile-said').textContent = text ?? '';
  }

  /** What stands over the plot while there is no picture of it; '' for nothing. */
  say(text) { find('profile-state').textContent = text; }

  // ---- words

  get #unit() { return unitOf(this.#cloud?.crsUnit, undefined).name; }
  get #heightUnit() { return unitOf(this.#cloud?.crs?.verticalUnit ?? this.#cloud?.crsUnit, undefined).name; }

  /** To as many digits as a pixel is worth. */
  #text(value, perPixel) {
    const decimals = Math.min(4, Math.max(0, Math.ceil(-Math.log10(perPixel))));
    return value.toLocaleString('en', { minimumFractionDigits: decimals, maximumFractionDigits: decimals }).replace('-', '−');
  }

  #hover(place) {
    this.#does.hover(place);
    const { view } = this.plot;
    find('profile-at').textContent = place ? words.at(
      `${this.#text(place.station, 1 / view.scale)} ${this.#unit}`.trim(), `${this.#text(place.height, 1 / (view.scale * view.exaggeration))} ${this.#heightUnit}`.trim(),
      this.#does.placeOf(place).map((value) => exactText(Number(value.toFixed(4)))).map((text, i) => `${'xyz'[i]} ${text}`).join('  ')) : '';
  }

  #texts([a, b]) {
    const { scale, exaggeration } = this.plot.view;
    const found = apart(a, b, heightFactor(this.#cloud));
    const unit = unitOf(this.#cloud?.crsUnit, undefined);
    const lengthOf = (value, error) => valueText({ quantity: 'length', value, error }, { factor: 1, name: unit.name });
    const degrees = valueText({ quantity: 'angle', value: found.slope, error: 0.05 }, unit);
    return {
      distance: lengthOf(found.distance, 0.5 / scale), along: lengthOf(found.along, 0.5 / scale), rise: lengthOf(found.rise, 0.5 / (scale * exaggeration)),
      slope: found.percent !== undefined && Math.abs(found.percent) < 1000 ? `${degrees}, ${this.#text(found.percent, 0.1)} %` : degrees,
    };
  }

  // ---- how high it is

  #setHeight(height) {
    this.#height = Math.round(Math.min(most * innerHeight, Math.max(least, height)));
    document.body.style.setProperty('--profile', `${this.#height}px`);
    const bar = find('profile-resize');
    for (const [name, value] of [['valuemin', least], ['valuemax', Math.round(most * innerHeight)], ['valuenow', this.#height]]) bar.setAttribute(`aria-${name}`, String(value));
  }

  #resizer(bar) {
    let from;
    bar.addEventListener('pointerdown', (event) => {
      bar.setPointerCapture(event.pointerId);
      from = { y: event.clientY, height: this.#height };
    });
    bar.addEventListener('pointermove', (event) => from && this.#setHeight(from.height + from.y - event.clientY));
    for (const name of ['pointerup', 'pointercancel']) bar.addEventListener(name, () => { from = undefined; });
    bar.addEventListener('keydown', (event) => {
      const by = { ArrowUp: 24, ArrowDown: -24 }[event.key];
      if (!by) return;
      event.preventDefault();
      event.stopPropagation();
      this.#setHeight(this.#height + by);
    });
  }
}
