// A field for a number that says why it does not take one, and then goes back to the one that holds: a value that nobody
// uses is not left standing there as if it were used.

import { strings } from './strings.js';

const words = strings.refusals;
const shown = (value) => String(Number(Number(value).toPrecision(6)));

/** Why a value between two ends is none; '' where it is one. Pure. */
export function outside(value, { min, max, unit = '' }) {
  const of = unit ? ` ${unit}` : '';
  if (!Number.isFinite(value)) return words.noNumber;
  if (value < min) return words.least(shown(min) + of);
  if (value > max) return words.most(shown(max) + of);
  return '';
}

/** What is wrong with the ends of a range, [low, high], of which NaN is left open; '' for nothing. Pure. */
export function rangeRefusal(ends) {
  const [low, high] = ends;
  return low >= high ? words.range : '';
}

function ownNote(input) {
  const note = document.createElement('p');
  note.className = 'refusal';
  note.id = `${input.id}-refusal`;
  return note;
}

export class NumberField {
  #input;
  #note;
  #holding = '';
  #taken = NaN;

  /**
   * `judge(value)` → why it is refused, '' for one that is fine; NaN is an empty field. `take(value)` uses it. `note` is the
   * element that says why; one of its own is made where none is given. `group`: what holds fields that are judged together,
   * which keep what was typed until one leaves them all.
   */
  constructor(input, judge, take, { note = ownNote(input), group = input } = {}) {
    this.#input = input;
    this.#note = note;
    note.setAttribute('role', 'status');
    const refusal = () => (input.validity.badInput ? words.noNumber : judge(input.valueAsNumber));
    input.addEventListener('input', () => this.refuse(refusal()));
    input.addEventListener('change', () => {
      const why = refusal();
      this.refuse(why);
      if (why) return;
      this.#taken = input.valueAsNumber;
      take(input.valueAsNumber);
    });
    input.addEventListener('keydown', (event) => {
      if (event.key !== 'Escape') return;
      event.preventDefault();
      this.#back();
    });
    group.addEventListener('focusout', ({ relatedTarget }) => {
      if (!group.contains(relatedTarget)) this.#back();
    });
  }

  get note() { return this.#note; }

  /** The value that holds; '' for an empty field. Somebody who is typing is not disturbed. */
  show(value) {
    this.#holding = String(value);
    if (document.activeElement !== this.#input) this.#back();
    else if (Number(value) !== this.#taken && this.#input.valueAsNumber === this.#taken) this.refuse(words.server);
  }

  /** Says why what stands there is not taken; '' takes that back. */
  refuse(why) {
    this.#input.setCustomValidity(why);
    if (why) {
      this.#input.setAttribute('aria-invalid', 'true');
      this.#input.setAttribute('aria-describedby', this.#note.id);
    } else {
      this.#input.removeAttribute('aria-invalid');
      this.#input.removeAttribute('aria-describedby');
    }
    if (this.#note.textContent !== why) this.#note.textContent = why;
  }

  #back() {
    this.#taken = NaN;
    if (this.#input.value !== this.#holding || this.#input.validity.badInput) this.#input.value = this.#holding;
    this.refuse('');
  }
}
