// One of several, all of them in sight: native radio buttons, which bring arrow keys and their announcement along, each with what
// it looks like - a swatch, a thumbnail - and its name. Three shapes, by class: `segments` in a row, `tiles` in a grid, `dots`.

import { element } from './parameter_fields.js';

let groups = 0;

export class Choices {
  #root;
  #name;
  #change;
  #value;

  /** `root`: a fieldset or an element with role radiogroup, which is filled; `change(value)` hears of what somebody chose. */
  constructor(root, change) {
    this.#root = root;
    this.#change = change;
    groups += 1;
    this.#name = `choice-${groups}`;
    root.addEventListener('change', (event) => {
      this.#value = event.target.value;
      this.#change(event.target.value);
    });
  }

  /**
   * `options`: [{ value, label, tip, swatch (its class), picture (an element), disabled, reason }]. A disabled one says why: the
   * reason stands behind its name for screen readers, and in its tip.
   */
  fill(options) {
    /** @type {any} */
    const active = document.activeElement;
    const focused = this.#root.contains(active) ? active.value : undefined;
    this.#root.replaceChildren(...options.map((option) => this.#option(option)));
    this.show(this.#value);
    if (focused !== undefined) this.#input(focused)?.focus({ preventScroll: true });
  }

  #option({ value, label, tip = '', swatch, picture, disabled = false, reason = '' }) {
    const input = element('input', { type: 'radio', name: this.#name, value, disabled });
    const seen = [];
    if (swatch) seen.push(Object.assign(element('i', { className: `swatch ${swatch}` }), { ariaHidden: 'true' }));
    if (picture) seen.push(picture);
    const name = element('span', { className: 'name', textContent: label });
    const why = reason ? [element('span', { className: 'reason', textContent: `(${reason})` })] : [];
    return element('label', { className: 'choice', title: [tip, reason && `${label}: ${reason}`].filter(Boolean).join(' ') }, input, ...seen, name, ...why);
  }

  #input(value) {
    return [...this.#root.querySelectorAll('input')].find((input) => input.value === value);
  }

  get values() {
    return [...this.#root.querySelectorAll('input')].map((input) => input.value);
  }

  /** Shows what is chosen; nothing where it is none of them. */
  show(value) {
    this.#value = value;
    for (const input of this.#root.querySelectorAll('input')) input.checked = input.value === value;
  }

  /** Where an option's picture is, to put another one in; undefined where there is no such option. */
  pictureOf(value) {
    return this.#input(value)?.parentElement.querySelector('.thumbnail');
  }
}
