// How the card of a tool (styles/card.css) opens and closes: by its button or letter (lazy_tools.js), its ✕, Escape, and when another one opens. Such a tool
// extends this; opened() is what else it does then.

import { putCard } from '../lazy_tools.js';

/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);

export class ToolCard {
  #card;
  #active;
  #reading;
  #isActive = false;

  /**
   * `card`: its markup, the ✕ first in its header; `active(isActive)` hears of it. A tool with `reading` (measure/reading.js) takes the hand while it is open,
   * which hears of Escape then, and the body has the class of the card's id.
   */
  constructor({ card, words, active, reading = undefined }) {
    this.#card = putCard(card, words);
    this.#active = active;
    this.#reading = reading;
    this.#card.querySelector('header button').addEventListener('click', () => this.close());
    if (!reading) addEventListener('keydown', (event) => this.#key(event));
  }

  get isActive() { return this.#isActive; }

  activate(isActive = !this.#isActive) {
    if (isActive === this.#isActive) return;
    this.#isActive = isActive;
    this.#card.hidden = !isActive;
    if (this.#reading) {
      document.body.classList.toggle(this.#card.id, isActive);
      this.#reading[isActive ? 'take' : 'give'](this.hand);
    }
    this.#active(isActive);
    this.opened(isActive);
    if (isActive) {
      // Who pressed its button by a key goes on in it; by its letter, on the picture.
      if (document.activeElement?.matches('#rail :focus-visible')) this.#card.querySelector('header button').focus();
      return;
    }
    document.body.classList.remove('aiming');
    find('picture').focus({ preventScroll: true, focusVisible: false });
  }

  get hand() { return /** @type {any} */ (this); }

  /** It has been opened, or closed. */
  opened(_isActive) {}

  /** By its ✕, or by Escape. */
  close() { this.activate(false); }

  #key(event) {
    if (event.key !== 'Escape' || !this.#isActive || event.defaultPrevented || document.querySelector('dialog[open], :popover-open')) return;
    event.preventDefault();
    this.close();
  }
}
