// From where a picture is drawn, as mathematics has it, and how a place in one picture becomes a place in another: a
// matrix, composed in double precision and relative to the eye, so that coordinates of a survey do not jitter. Pure.

import { wireOf } from './camera_words.js';
import { dot, length, scale, subtract } from './vectors.js';

/**
 * From where a picture is drawn and how much of the world it shows.
 * @typedef {object} Pose
 * @property {number[]} eye
 * @property {{ right: number[], up: number[], back: number[] }} axes unit vectors of the picture
 * @property {boolean} orthographic
 * @property {number} halfHeight of what is shown: at depth 1, or anywhere where it is orthographic
 * @property {number} aspect width / height
 * @property {number} distance of what is looked at
 * @property {number} stretch how much higher the picture is than what is to be seen of it: 1 without a margin
 */

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (v) => scale(v, 1 / length(v));

/** Eye and axes of a camera in the protocol's words. */
function placeOf({ eye, target, up, viewMatrix: m }) {
  if (!m) {
    const back = unit(subtract(eye, target));
    const right = unit(cross(up, back));
    return { eye, axes: { right, up: cross(back, right), back } };
  }
  const [right, upwards, back] = [0, 1, 2].map((row) => [m[row], m[4 + row], m[8 + row]]);
  const shift = [m[12], m[13], m[14]];
  return { eye: [0, 1, 2].map((i) => -dot([right[i], upwards[i], back[i]], shift)), axes: { right, up: upwards, back } };
}

/**
 * The pose of a picture that the server draws of `camera` (camera.js) in a cloud with those bounds.
 * @param {number} aspect width / height of what is to be seen
 * @param {{ x: number, y: number }} stretch how much wider and higher the picture is than that
 * @returns {Pose}
 */
export function poseOf(camera, bounds, aspect, stretch = { x: 1, y: 1 }) {
  const words = wireOf(camera, bounds);
  const orthographic = words.type === 'orthographic';
  const place = placeOf(words);
  return {
    ...place,
    orthographic,
    halfHeight: (orthographic ? words.viewHeight / 2 : Math.tan((words.fov * Math.PI) / 360)) * stretch.y,
    aspect: (aspect * stretch.x) / stretch.y,
    distance: length(subtract(place.eye, camera.target)),
    stretch: stretch.y,
  };
}

/** Whether both see the same, but for a margin. */
export function seesTheSame(a, b) {
  const close = (x, y) => Math.abs(x - y) <= 1e-12 * Math.max(Math.abs(x), Math.abs(y), 1e-6);
  return (
    a.orthographic === b.orthographic && close(a.halfHeight / a.stretch, b.halfHeight / b.stretch) &&
    a.eye.every((value, i) => value === b.eye[i]) &&
    ['right', 'up', 'back'].every((axis) => a.axes[axis].every((value, i) => close(value, b.axes[axis][i])))
  );
}

/** Of a backdrop, which stays where it is on screen: how much larger `frame` is than `wanted`, to the right and upwards. */
export const backdropScale = (frame, wanted) => [
  (frame.stretch * frame.aspect) / (wanted.stretch * wanted.aspect),
  frame.stretch / wanted.stretch,
];

/**
 * The matrix, column by column, that takes a place of `frame` to clip space of `wanted`. A place of a perspective picture is
 * (x, y, 1, 1 / depth), of an orthographic one (x, y, depth, 1), x and y from -1 to 1, to the right and upwards.
 * @param {Pose} frame
 * @param {Pose} wanted
 * @param {{ least: number, greatest: number }} depths that there are in `frame`
 */
export function placeToClip(frame, wanted, { least, greatest }) {
  const shift = subtract(wanted.eye, frame.eye);
  const { right, up, back } = wanted.axes;
  // What each column means in the frame's world, whose origin is the frame's eye: a direction, or a point (w = 1).
  const wide = frame.halfHeight * frame.aspect;
  /** @type {[number[], number][]} */
  const columns = [
    [frame.axes.right.map((value) => value * wide), 0],
    [frame.axes.up.map((value) => value * frame.halfHeight), 0],
    [frame.axes.back.map((value) => -value), 0],
    [shift.map((value) => -value), 1],
  ];
  const near = least / 50; // nothing nearer is shown
  const farthest = 4 * (greatest + length(shift));
  return new Float32Array(columns.flatMap(([v, w]) => {
    const depth = -dot(v, back);
    const x = dot(v, right) / (wanted.halfHeight * wanted.aspect);
    const y = dot(v, up) / wanted.halfHeight;
    return wanted.orthographic ? [x, y, depth / farthest, w] : [x, y, depth - 2 * near * w, depth];
  }));
}

/**
 * Where nothing is known of depth: how the plane through what `frame` looks at moves on screen, as well as shifting and scaling
 * can do it.
 * @returns {{ scale: number, x: number, y: number } | undefined} of a place in -1 … 1 of what is to be seen; undefined where it is behind the eye
 */
export function similarityOf(frame, wanted) {
  const depths = { least: frame.distance, greatest: frame.distance };
  const m = placeToClip(frame, wanted, depths);
  const at = (x, y) => {
    const place = frame.orthographic ? [x, y, frame.distance, 1] : [x, y, 1, 1 / frame.distance];
    const [cx, cy, , cw] = [0, 1, 2, 3].map((row) => place.reduce((sum, value, column) => sum + value * m[4 * column + row], 0));
    return cw > 0 ? [cx / cw, cy / cw] : undefined;
  };
  const [middle, above, below] = [at(0, 0), at(0, 0.5), at(0, -0.5)];
  if (!middle || !above || !below) return undefined;
  return { scale: Math.hypot(wanted.aspect * (above[0] - below[0]), above[1] - below[1]), x: middle[0], y: middle[1] };
}
