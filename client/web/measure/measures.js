// The measures of one scan: a list that is never changed but replaced, so that every change can be taken back.

import { kinds } from './values.js';

const mostSteps = 200;
/** More than a list can be read with, and a page can draw. */
export const mostMeasures = 500;

/** `change` is told after each change. */
export class Measures extends EventTarget {
  #list = /** @type {any[]} */ ([]);
  #past = /** @type {any[][]} */ ([]);
  #future = /** @type {any[][]} */ ([]);
  #lastId = 0;

  get list() { return this.#list; }
  get canUndo() { return this.#past.length > 0; }
  get canRedo() { return this.#future.length > 0; }
  find(id) { return this.#list.find((one) => one.id === id); }

  #put(list) {
    this.#list = list;
    this.dispatchEvent(new Event('change'));
  }

  #step(list) {
    this.#past.push(this.#list);
    if (this.#past.length > mostSteps) this.#past.shift();
    this.#future = [];
    this.#put(list);
  }

  /** Another scan: these, and nothing to take back. */
  begin(list) {
    this.#past = [];
    this.#future = [];
    this.#put(list.map((one) => this.#numbered(one)));
  }

  #numbered(measure) {
    this.#lastId += 1;
    return { ...measure, id: this.#lastId };
  }

  /** A name that no other one has: `word` and a number. */
  nameFor(word) {
    const names = new Set(this.#list.map(({ name }) => name));
    for (let number = 1; ; ++number) if (!names.has(`${word} ${number}`)) return `${word} ${number}`;
  }

  /** Returns the id; undefined where there are too many. */
  add(measure) {
    if (this.#list.length >= mostMeasures) return undefined;
    const one = this.#numbered(measure);
    this.#step([...this.#list, one]);
    return one.id;
  }

  /** All of them at once, in place of what there is: one step. */
  replace(list) {
    this.#step(list.slice(0, mostMeasures).map((one) => this.#numbered(one)));
  }

  change(id, changes) {
    if (!this.find(id)) return;
    const isOther = 'points' in changes || 'option' in changes; // of which the server has said nothing yet
    this.#step(this.#list.map((one) => (one.id === id ? { ...one, ...(isOther ? { answer: undefined, trouble: undefined } : {}), ...changes } : one)));
  }

  /** What is known of that very measure, and nobody did: no step to take back. */
  tell(measure, facts) {
    if (this.find(measure.id) === measure) this.#put(this.#list.map((one) => (one === measure ? { ...one, ...facts } : one)));
  }

  /** A measure without that point; without the measure, where too few are left. */
  removePoint(id, index) {
    const one = this.find(id);
    if (!one?.points[index]) return;
    if (one.points.length <= kinds[one.kind].least) this.remove(id);
    else this.change(id, { points: one.points.filter((_, i) => i !== index) });
  }

  remove(id) {
    if (this.find(id)) this.#step(this.#list.filter((one) => one.id !== id));
  }

  undo() {
    if (!this.canUndo) return;
    this.#future.push(this.#list);
    this.#put(this.#past.pop());
  }

  redo() {
    if (!this.canRedo) return;
    this.#past.push(this.#list);
    this.#put(this.#future.pop());
  }
}

/** Those of `more` that `list` does not have: of the same kind, at the same points. Pure. */
export function unknownOf(list, more) {
  const keyOf = ({ kind, points }) => JSON.stringify([kind, points]);
  const known = new Set(list.map(keyOf));
  return more.filter((one) => !known.has(keyOf(one)));
}
