// Pointers that are down - a mouse, a pen, fingers - as one hand: how many, where their middle is, how far apart they are
// and how they are turned. What they do from one event to the next is one step. Plain logic without a document.

import { noStep } from './inertia.js';

const most = 3;
const leastApart = 10; // px; nearer together, two fingers say nothing of a size
const twistFrom = 0.12; // radians; less is how fingers move when they only pinch

const middleOf = (points) => ({
  x: points.reduce((sum, { x }) => sum + x, 0) / points.length,
  y: points.reduce((sum, { y }) => sum + y, 0) / points.length,
});

function shapeOf(points) {
  const [a, b] = points;
  if (points.length !== 2) return { middle: middleOf(points) };
  return { middle: middleOf(points), apart: Math.max(leastApart, Math.hypot(b.x - a.x, b.y - a.y)), angle: Math.atan2(b.y - a.y, b.x - a.x) };
}

export class Fingers {
  #points = new Map();
  #twist = 0; // since there have been two of them
  #twists = false;

  get count() {
    return this.#points.size;
  }

  get middle() {
    return middleOf([...this.#points.values()]);
  }

  /** False for one too many, which is left out. */
  down(id, point) {
    if (this.#points.size >= most) return false;
    this.#points.set(id, point);
    this.#twist = 0;
    this.#twists = false;
    return true;
  }

  /** False for one that was not down. */
  up(id) {
    return this.#points.delete(id);
  }

  /** The step that this is, clockwise being positive; undefined for a pointer that is not down. */
  move(id, point) {
    if (!this.#points.has(id)) return undefined;
    const before = shapeOf([...this.#points.values()]);
    this.#points.set(id, point);
    const after = shapeOf([...this.#points.values()]);
    const step = { ...noStep(), x: after.middle.x - before.middle.x, y: after.middle.y - before.middle.y };
    if (after.apart !== undefined) {
      step.zoom = Math.log(after.apart / before.apart);
      step.twist = this.#twistOf(after.angle - before.angle);
    }
    return step;
  }

  #twistOf(turn) {
    const shorter = Math.atan2(Math.sin(turn), Math.cos(turn));
    this.#twist += shorter;
    if (this.#twists) return shorter;
    this.#twists = Math.abs(this.#twist) > twistFrom;
    return 0;
  }
}
