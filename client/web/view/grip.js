// What one hand has taken hold of, and what its steps do to the camera: turn it about the held point, take that along,
// come nearer to it. Lives from the moment something is taken until nothing moves any more. No document.

import { look } from './camera.js';
import { lifted, liftOf, worthWalking } from './ground.js';
import { dragTo, focusOn, orbitAbout, turnAbout, zoomTo } from './moves.js';

/**
 * @typedef {object} World what moves have to know of where they are
 * @property {{ width: number, height: number }} size of the picture, CSS pixels
 * @property {object[]} pictures what has been seen, the newest first; empty where nobody is to be stopped
 * @property {{ least: number, most: number, bounds: object, hasGround: boolean }} limits how near to a surface one comes and how
 *   far from it; the cloud's bounds, and whether below them is nowhere to be: it stands on a ground
 */

export class Grip {
  #kind;
  #anchor;
  #at; // where the held point is, in the picture
  #begun = false;

  /** `kind`: orbit, look, pan or pinch; `anchor`: what anchorUnder() found at `cursor`. */
  constructor(kind, anchor, cursor) {
    this.#kind = kind;
    this.#anchor = anchor;
    this.#at = { ...cursor };
  }

  get point() {
    return this.#anchor.point;
  }

  /** The camera after one step of the hand. */
  move(camera, step, world) {
    const { size, pictures, limits } = world;
    if (this.#kind === 'look') return look(camera, step.x, step.y, size);
    // From here on later moves go by how far away this is; but a click alone changes nothing.
    const from = this.#begun ? camera : focusOn(camera, this.point);
    this.#begun = true;
    if (this.#kind === 'orbit') return orbited(from, this.point, step, world);
    this.#at = { x: this.#at.x + step.x, y: this.#at.y + step.y };
    let next = from;
    if (this.#kind === 'pinch') {
      // Seen from below, what turns clockwise in the picture turns the other way about the vertical.
      if (step.twist) next = turnAbout(next, this.point, camera.elevation >= 0 ? step.twist : -step.twist);
      if (step.zoom) next = nearer(next, this.#anchor, Math.exp(-step.zoom), world);
    }
    return lifted(pictures, camera, dragTo(next, this.point, this.#at, size), limits);
  }
}

/** Turns about the point, but not through the ground: there only sideways. */
function orbited(camera, point, { x, y }, { size, pictures, limits }) {
  const next = orbitAbout(camera, point, x, y, size);
  if (!(liftOf(pictures, camera, next, limits) > 0)) return next;
  const level = orbitAbout(camera, point, x, 0, size);
  return liftOf(pictures, camera, level, limits) > 0 ? camera : level;
}

/**
 * Comes nearer to an anchor by a factor, or goes away. Where that is no surface, one does not come so near, and no farther
 * than there is something to see.
 */
function nearer(camera, { point, of }, factor, { pictures, limits }) {
  if (of === 'surface' || of === undefined || factor >= 1) return zoomTo(camera, point, factor, limits);
  const least = Math.max(limits.least, of === 'plane' ? 0.002 * limits.most : 0);
  const to = (part) => zoomTo(camera, point, factor ** part, { ...limits, least });
  return to(Math.min(worthWalking(pictures, camera, limits), worthWalking(pictures, to(1), limits)));
}

/** The same, holding the point; who goes backwards does not sink into the ground. */
export function zoomed(camera, anchor, factor, world) {
  return lifted(world.pictures, camera, nearer(focusOn(camera, anchor.point), anchor, factor, world), world.limits);
}
