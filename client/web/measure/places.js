// Where what is drawn over the picture is on screen, and what of it is behind something: by the pose that is shown and by the depth
// that the newest frame brought. Pure.

import { inverseDepthAt } from '../protocol/frame_depth.js';
import { placeOf } from '../view/seen.js';
import { dot, mix, subtract } from '../view/vectors.js';

const nearest = 1e-3; // share of the distance of what is looked at; nothing nearer is drawn
const guard = 4; // widths of the picture around it, beyond which a line is cut off

/** From the scan's coordinates to CSS pixels, as `pose` (pose.js) shows them on a canvas of that size. */
export class Places {
  #pose;
  #size;
  #scale;
  #near;

  constructor(pose, size) {
    this.#pose = pose;
    this.#size = size;
    this.#scale = size.height / 2 / (pose.halfHeight / pose.stretch);
    this.#near = nearest * pose.distance;
  }

  #depth(point) {
    return -dot(subtract(point, this.#pose.eye), this.#pose.axes.back);
  }

  #project(point, depth) {
    const { eye, axes, orthographic } = this.#pose;
    const way = subtract(point, eye);
    const scale = orthographic ? this.#scale : this.#scale / depth;
    return { x: this.#size.width / 2 + dot(way, axes.right) * scale, y: this.#size.height / 2 - dot(way, axes.up) * scale };
  }

  /** CSS pixels from the top left corner; undefined for what is behind the eye, or far beside the picture. */
  of(point) {
    const depth = this.#depth(point);
    if (!this.#pose.orthographic && !(depth > this.#near)) return undefined;
    const at = this.#project(point, depth);
    const { width, height } = this.#size;
    return Math.abs(at.x) <= guard * width && Math.abs(at.y) <= guard * height ? at : undefined;
  }

  /** Both ends of what is to be seen of a line from `a` to `b`; undefined where that is nothing. */
  line(a, b) {
    let [from, to] = [a, b];
    if (!this.#pose.orthographic) {
      const [first, last] = [this.#depth(a) - this.#near, this.#depth(b) - this.#near];
      if (first <= 0 && last <= 0) return undefined;
      const cut = mix(a, b, first / (first - last));
      if (first <= 0) from = cut;
      if (last <= 0) to = cut;
    }
    return this.#guarded(this.#project(from, Math.max(this.#depth(from), this.#near)), this.#project(to, Math.max(this.#depth(to), this.#near)));
  }

  /** Browsers draw lines of millions of pixels badly. */
  #guarded(a, b) {
    const { width, height } = this.#size;
    let [first, last] = [0, 1];
    for (const [from, way, most] of [[a.x, b.x - a.x, width], [a.y, b.y - a.y, height]]) {
      for (const [room, slope] of [[from + guard * most, way], [(guard + 1) * most - from, -way]]) {
        if (slope === 0 && room < 0) return undefined;
        if (slope > 0) first = Math.max(first, -room / slope);
        else if (slope < 0) last = Math.min(last, -room / slope);
      }
    }
    const at = (t) => ({ x: a.x + (b.x - a.x) * t, y: a.y + (b.y - a.y) * t });
    return first < last ? [at(first), at(last)] : undefined;
  }
}

/** Relative distances behind the surface at which something is hidden, and is seen again; and as many spacings of the scan. */
const hides = { share: 0.012, spacings: 3 };
const shows = { share: 0.005, spacings: 1.5 };

/** 1 / depth of the farthest surface around there; 0 where the background is. */
function farthestAround({ width, height, inverse }, u, v) {
  const column = Math.min(width - 1, Math.max(0, Math.floor(u * width)));
  const row = Math.min(height - 1, Math.max(0, Math.floor(v * height)));
  let least = Infinity;
  for (let j = Math.max(0, row - 1); j <= Math.min(height - 1, row + 1); ++j) {
    for (let i = Math.max(0, column - 1); i <= Math.min(width - 1, column + 1); ++i) least = Math.min(least, inverse[j * width + i]);
  }
  return least;
}

/**
 * Whether a point is behind what the picture has seen; `was`: whether it was, which it stays while it is undecided, or out of the picture.
 * A cell of the depth is many pixels: something is in the way only where all cells around say so.
 */
export function isCovered(seen, point, spacing, was) {
  const on = seen && placeOf(seen, point);
  if (!on) return was;
  const { share, spacings } = was ? shows : hides;
  const least = farthestAround(seen.depth, on.u, on.v);
  const middle = inverseDepthAt(seen.depth, on.u, on.v);
  if (!(least > 0) || !(middle > 0)) return false;
  return on.z - spacings * spacing > (1 / least) * (1 + share);
}

/** What a hand may have meant: the nearest of `places` (undefined ones are none) within `reach` px of the cursor; its index, or -1. */
export function nearestTo(places, cursor, reach) {
  let found = -1;
  let least = reach;
  places.forEach((at, i) => {
    const distance = at ? Math.hypot(at.x - cursor.x, at.y - cursor.y) : Infinity;
    if (distance <= least) [found, least] = [i, distance];
  });
  return found;
}
