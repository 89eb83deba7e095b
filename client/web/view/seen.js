// What a picture has seen of the cloud's surface: its depth and the camera from which it was drawn. Rays are followed
// through it, so that one knows where they first meet the surface - from that camera or from any other one nearby. Pure.
//
// A picture knows the surface's front only. What lies behind that is unknown, and counts as nothing.

import { inverseDepthAt } from '../protocol/frame_depth.js';
import { add, dot, length, scale, subtract } from './vectors.js';

const stepsPerCell = 1.5;
const mostSteps = 320;
const halvings = 10;
const sameSurface = 0.04; // relative difference in depth, of a ray that has just gone through the surface

/**
 * What a picture of `camera` has seen.
 * @param {import('../protocol/frame_depth.js').FrameDepth} depth
 * @param {import('./pose.js').Pose} pose from where it was drawn, and how much it shows
 */
export function seenFrom(camera, depth, pose) {
  const { eye, axes, orthographic, halfHeight, aspect } = pose;
  return { camera, depth, eye, ...axes, top: halfHeight, side: halfHeight * aspect, perspective: !orthographic };
}

/** { x, y } from -1 to 1 within the picture, times w; { z } the depth. */
function place(seen, vector, isPoint) {
  const offset = isPoint ? subtract(vector, seen.eye) : vector;
  const z = -dot(offset, seen.back);
  return { x: dot(offset, seen.right) / seen.side, y: dot(offset, seen.up) / seen.top, z };
}

const onPicture = (seen, { x, y, z }) => {
  const w = seen.perspective ? z : 1;
  return { u: 0.5 + x / w / 2, v: 0.5 - y / w / 2, z };
};

/** Where a point appears: u, v from 0 to 1, from the top left corner, and its depth; undefined where it does not. */
export function placeOf(seen, point) {
  const at = place(seen, point, true);
  if (!(at.z > 0)) return undefined;
  const on = onPicture(seen, at);
  return on.u >= 0 && on.u <= 1 && on.v >= 0 && on.v <= 1 ? on : undefined;
}

/** The stretch [first, last] of the ray that is in the picture, and before `range`; undefined where there is none. */
function clipped(seen, from, along, range) {
  let first = 0, last = range;
  const keep = (value, slope) => {
    // value + t · slope ≥ 0
    if (slope === 0) {
      if (value < 0) last = -1;
    } else if (slope > 0) first = Math.max(first, -value / slope);
    else last = Math.min(last, -value / slope);
  };
  const [w, dw] = seen.perspective ? [from.z, along.z] : [1, 0];
  for (const [value, slope] of [[from.x, along.x], [from.y, along.y]]) {
    keep(w - value, dw - slope);
    keep(w + value, dw + slope);
  }
  keep(from.z, along.z);
  return first < last ? [first, last] : undefined;
}

/** 1 / depth of the cell there; 0 where there is nothing. */
function cellAt({ width, height, inverse }, u, v) {
  const column = Math.min(width - 1, Math.max(0, Math.floor(u * width)));
  const row = Math.min(height - 1, Math.max(0, Math.floor(v * height)));
  return inverse[row * width + column];
}

/**
 * How far along the ray from `origin`, in lengths of `direction`, it first goes through the surface, at most `range`;
 * undefined where the picture does not see it do that.
 */
export function hitAlong(seen, origin, direction, range) {
  const from = place(seen, origin, true);
  const along = place(seen, direction, false);
  const stretch = clipped(seen, from, along, range);
  if (!stretch) return undefined;
  const at = (t) => onPicture(seen, { x: from.x + t * along.x, y: from.y + t * along.y, z: from.z + t * along.z });
  // A ray out of the eye itself is one place of the picture.
  const near = Math.max(stretch[0], 1e-6 * stretch[1]);
  const [start, end] = [at(near), at(stretch[1])];
  const { width, height } = seen.depth;
  const cells = Math.hypot((end.u - start.u) * width, (end.v - start.v) * height);
  if (cells < 0.1) {
    const inverse = inverseDepthAt(seen.depth, end.u, end.v);
    if (!(inverse > 0)) return undefined;
    const t = (1 / inverse - from.z) / along.z;
    return t >= 0 && t <= range ? t : undefined;
  }
  // Even steps in the picture: between two depths that is even in t / depth and 1 / depth.
  const steps = Math.min(mostSteps, Math.max(4, Math.ceil(cells * stepsPerCell)));
  const [w0, w1] = seen.perspective ? [1 / Math.max(start.z, 1e-12), 1 / end.z] : [1, 1];
  let before = near, wasAhead = false;
  for (let i = 0; i <= steps; ++i) {
    const s = i / steps;
    const t = ((1 - s) * near * w0 + s * stretch[1] * w1) / ((1 - s) * w0 + s * w1);
    const { u, v, z } = at(t);
    const inverse = cellAt(seen.depth, u, v);
    const isAhead = inverse === 0 || z * inverse < 1;
    if (wasAhead && !isAhead) {
      const found = refined(seen, at, before, t);
      if (found !== undefined) return found;
    }
    wasAhead = isAhead;
    before = t;
  }
  return undefined;
}

/** Between two steps, where the ray is exactly; undefined where it only went behind something. */
function refined(seen, at, low, high) {
  let [ahead, behind] = [low, high];
  for (let i = 0; i < halvings; ++i) {
    const t = (ahead + behind) / 2;
    const { u, v, z } = at(t);
    const inverse = inverseDepthAt(seen.depth, u, v);
    if (inverse === 0 || z * inverse < 1) ahead = t;
    else behind = t;
  }
  const { u, v, z } = at(behind);
  const inverse = inverseDepthAt(seen.depth, u, v);
  return inverse > 0 && Math.abs(z * inverse - 1) <= sameSurface ? behind : undefined;
}

/** Whether the way between two points is seen to be free of surface. What is outside of the picture is not seen. */
export function isSeenFree(seen, from, to, places = 16) {
  for (let i = 0; i <= places; ++i) {
    const on = placeOf(seen, add(scale(from, 1 - i / places), scale(to, i / places)));
    if (!on) return false;
    const inverse = cellAt(seen.depth, on.u, on.v);
    if (inverse > 0 && on.z * inverse > 1.02) return false;
  }
  return true;
}

/** Share of the picture in which there is something. */
export function coveredShare({ depth: { inverse } }) {
  let covered = 0;
  for (const value of inverse) if (value > 0) ++covered;
  return covered / inverse.length;
}

/** Whether two pictures were drawn from places so near to each other, and in directions so alike, that one of them will do. */
function sayTheSame(one, other) {
  const reach = Math.max(one.camera.distance, other.camera.distance);
  return one.perspective === other.perspective && length(subtract(one.eye, other.eye)) <= 0.15 * reach && dot(one.back, other.back) >= 0.94;
}

/** What is worth remembering: the newest picture, then older ones that say something else, the oldest of many forgotten. */
export function remembering(known, newest, most = 8) {
  const [last, ...older] = known;
  const kept = last && !older.some((one) => sayTheSame(one, last)) ? [last, ...older] : older;
  return [newest, ...kept].slice(0, most);
}
