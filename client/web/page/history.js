// Where one has been: the address, which always holds the view that is wanted, so that reload, back and forward show it
// again; and undo. Neither knows a document or a viewer: what they need is given to them.

/** A browser refuses to change an address more often than about three times a second, for long. */
const leastBetweenMs = 500;
const quietMs = 300;
const settledMs = 600;
const mostSteps = 100;

/**
 * Writes the view into the address once it has been still for a moment. Where somebody jumps to another place, that
 * becomes an entry of its own, behind the one that he left, and back leads there.
 */
export class Address {
  #text;
  #write;
  #timer;
  #pushes = false;
  #last = -Infinity;

  /** `text()`: what the address should say now, undefined for nothing yet; `write(text, pushes)`: says it, in an entry of its own. */
  constructor(text, write) {
    this.#text = text;
    this.#write = write;
  }

  /** The view is another one. */
  changed() {
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.flush(), Math.max(quietMs, this.#last + leastBetweenMs - performance.now()));
  }

  /** The next view is another place; what is shown now is the one to come back to. */
  jump() {
    // Two jumps within a moment are one: nobody wants to come back to where the first one was cut off.
    if (!this.#pushes) this.flush();
    this.#pushes = true;
  }

  /** What the address says has just been gone to, by back, forward or a link. */
  arrived() {
    clearTimeout(this.#timer);
    this.#timer = undefined;
    this.#pushes = false;
  }

  /** Now, where something is still to be written. */
  flush() {
    if (this.#timer === undefined) return;
    clearTimeout(this.#timer);
    this.#timer = undefined;
    const text = this.#text();
    if (text === undefined) return;
    this.#last = performance.now();
    this.#write(text, this.#pushes);
    this.#pushes = false;
  }
}

/** Views that can be gone back to, and forward again. Pure. */
export class Steps {
  #past = [];
  #future = [];
  #now;

  /** `step`: { key, … }; equal keys are equal views. What was undone before is gone. */
  add(step) {
    if (step.key === this.#now?.key) return;
    if (this.#now) this.#past.push(this.#now);
    if (this.#past.length > mostSteps) this.#past.shift();
    this.#now = step;
    this.#future = [];
  }

  /** Nobody did that: it takes the place of the view that there is. */
  replace(step) {
    this.#now = step;
  }

  get canUndo() { return this.#past.length > 0; }
  get canRedo() { return this.#future.length > 0; }

  undo() {
    if (!this.canUndo) return undefined;
    this.#future.push(this.#now);
    this.#now = this.#past.pop();
    return this.#now;
  }

  redo() {
    if (!this.canRedo) return undefined;
    this.#past.push(this.#now);
    this.#now = this.#future.pop();
    return this.#now;
  }
}

/** Undo and redo of views: one is a step once it has been still for a moment. */
export class Undo {
  #steps = new Steps();
  #look;
  #show;
  #tell;
  #timer;
  #cloud; // of the step there is
  #byServer = false;

  /**
   * `look()`: the view there is, { key, cloud, … }, undefined for none; `show(view)`: shows one of these again;
   * `tell({ canUndo, canRedo })`: what there is to be gone to is another thing.
   */
  constructor(look, show, tell) {
    this.#look = look;
    this.#show = show;
    this.#tell = tell;
  }

  /** The view is another one, `byServer`: without anybody having done something. */
  changed(byServer = false) {
    const alone = this.#timer === undefined;
    this.#byServer = byServer && (alone || this.#byServer);
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.#settle(), settledMs);
    // What a cloud is first seen as is a view to come back to, however soon a hand is there.
    if (byServer && alone) this.#settle();
  }

  undo() {
    this.#settle(); // what was still moving is what redo leads back to
    this.#go(this.#steps.undo());
  }

  redo() {
    this.#settle();
    this.#go(this.#steps.redo());
  }

  #go(step) {
    if (!step) return;
    this.#cloud = step.cloud;
    this.#show(step);
    this.#say();
  }

  #settle() {
    if (this.#timer === undefined) return;
    clearTimeout(this.#timer);
    this.#timer = undefined;
    const step = this.#look();
    if (!step) return;
    // Of a cloud that is complete now, or of a view that was refused, the server chose another view.
    if (this.#byServer && step.cloud === this.#cloud) this.#steps.replace(step);
    else this.#steps.add(step);
    this.#cloud = step.cloud;
    this.#byServer = false;
    this.#say();
  }

  #say() {
    this.#tell({ canUndo: this.#steps.canUndo, canRedo: this.#steps.canRedo });
  }
}
