// How the card of a tool opens and closes (styles/card.css): by its button and its letter (lazy_tools.js), by its ✕, by Escape, and when another one opens.
// A tool with a card extends this, and says by opened() what else it does then.

import { putCard } from '../lazy_tools.js';

/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);

export class ToolCard {
  #card;
  #active;
  #reading;
  #isActive = false;

  /**
   * `card`: its markup, whose first element is the card, with its ✕ in the head; `words` of it; `active(isActive)`: lazy_tools.js hears of it. A tool with `reading`
   * (measure/reading.js) takes the hand while it is open - `hand`, or itself -, which then hears of Escape as well, and the body has the class of the card's id.
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
      // Who goes by keys, and pressed its button, is in it; by its letter, he is on the picture, and stays there.
      if (document.activeElement?.matches('#rail :focus-visible')) this.#card.querySelector('header button').focus();
      return;
    }
    document.body.classList.remove('aiming');
    find('picture').focus({ preventScroll: true, focusVisible: false });
  }

  /** Whose the hand on the picture is while it is open. */
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
