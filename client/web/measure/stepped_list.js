// A list that is never changed but replaced, so that every change can be taken back: measures, notes, saved views.

const mostSteps = 200;

/** `change` is told after each change. Its entries are objects with an `id` that this list gives them, and a `name`. */
export class SteppedList extends EventTarget {
  #most;
  #list = /** @type {any[]} */ ([]);
  #past = /** @type {any[][]} */ ([]);
  #future = /** @type {any[][]} */ ([]);
  #lastId = 0;

  /** `most`: entries that it takes. */
  constructor(most) {
    super();
    this.#most = most;
  }

  get list() { return this.#list; }
  get isFull() { return this.#list.length >= this.#most; }
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

  #numbered(one) {
    this.#lastId += 1;
    return { ...one, id: this.#lastId };
  }

  /** A name that no other one has: `word` and a number. */
  nameFor(word) {
    const names = new Set(this.#list.map(({ name }) => name));
    for (let number = 1; ; ++number) if (!names.has(`${word} ${number}`)) return `${word} ${number}`;
  }

  /** Returns the id; undefined where there are too many. */
  add(one) {
    if (this.isFull) return undefined;
    const added = this.#numbered(one);
    this.#step([...this.#list, added]);
    return added.id;
  }

  /** All of them at once, in place of what there is: one step. */
  replace(list) {
    this.#step(list.slice(0, this.#most).map((one) => this.#numbered(one)));
  }

  change(id, changes) {
    if (this.find(id)) this.#step(this.#list.map((one) => (one.id === id ? { ...one, ...changes } : one)));
  }

  /** What is known of that very entry, and nobody did: no step to take back. */
  tell(known, facts) {
    if (this.find(known.id) === known) this.#put(this.#list.map((one) => (one === known ? { ...one, ...facts } : one)));
  }

  /** To the place `by` places further down (up, where it is negative), as far as there are any. */
  move(id, by) {
    const from = this.#list.findIndex((one) => one.id === id);
    const to = Math.min(this.#list.length - 1, Math.max(0, from + by));
    if (from >= 0 && to !== from) this.#step(this.#list.toSpliced(from, 1).toSpliced(to, 0, this.#list[from]));
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
