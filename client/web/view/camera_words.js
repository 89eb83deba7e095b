// A camera in the protocol's words, and back. camera.js has the cameras that a hand can steer, which stand upright; words
// may say others: rolled ones, matrices, clipping planes. Who gives such words sees just that, until the camera is moved.
// Pure.
//
// What is sent is rounded to less than a thousandth of a pixel, so that an address says it exactly, in few digits.

import { fromProtocol, heightAtTarget, toProtocol } from './camera.js';
import { areNumbers, dot, length, scale, subtract } from './vectors.js';

/** Digits of a coordinate behind the one that is as large as the distance to what is looked at. */
const digits = 7;
const mostDigits = 15; // that a double keeps whatever they are

/** camera → the words that it was made of. A camera that was moved is another object, so nothing of this is ever stale. */
const spoken = new WeakMap();

function rounded(values, decimals) {
  return values.map((value) => Number(Number(value.toFixed(decimals)).toPrecision(mostDigits)));
}

/** What to send for a camera: the words that it was made of, or its own. `bounds` as for toProtocol(). */
export function wireOf(camera, bounds) {
  const known = spoken.get(camera);
  if (known) return known;
  /** @type {any} */
  const { eye, target, up, viewHeight, fov, type } = toProtocol(camera, bounds);
  const decimals = Math.min(15, Math.max(0, digits - Math.floor(Math.log10(camera.distance))));
  return {
    type,
    eye: rounded(eye, decimals),
    target: rounded(target, decimals),
    up: rounded(up, 9),
    ...(type === 'orthographic' ? { viewHeight: Number(viewHeight.toPrecision(10)) } : { fov: Number(fov.toPrecision(10)) }),
    near: camera.near ?? null,
    far: camera.far ?? null,
  };
}

/** Eye and target of a matrix from world to view, 16 numbers column by column; `distance` from one to the other. */
function lookAtOf(matrix, distance) {
  const row = (i) => [matrix[i], matrix[4 + i], matrix[8 + i]];
  const [right, up, back] = [row(0), row(1), row(2)];
  const shift = [matrix[12], matrix[13], matrix[14]];
  const eye = [0, 1, 2].map((axis) => -dot([right[axis], up[axis], back[axis]], shift));
  return { eye, target: subtract(eye, scale(back, distance / Math.max(length(back), 1e-9))), up };
}

/** Which axis the words take for up, as far as they say it: a model's is Y, or -Y. */
function upAxisOf({ eye, target, up }) {
  const back = subtract(eye, target);
  const fromAbove = Math.hypot(back[0], back[1]) < 1e-3 * Math.abs(back[2]); // there, Y is north
  if (!areNumbers(up) || fromAbove || Math.abs(up[1]) < 0.9 * length(up)) return 'z';
  return up[1] > 0 ? 'y' : '-y';
}

/**
 * The camera that `words` say - any of type, eye, target, up, viewMatrix, fov, viewHeight, near, far -, with `usual`, a whole
 * one in the same words, for what they leave out. Undefined where that makes none.
 */
export function cameraOf(words, usual = {}, upAxis = undefined) {
  const { viewMatrix } = words;
  const base = { ...usual, ...words };
  if (viewMatrix) {
    const away = areNumbers(usual.eye) && areNumbers(usual.target) ? length(subtract(usual.eye, usual.target)) : 1;
    Object.assign(base, lookAtOf(viewMatrix, away));
  }
  if (!areNumbers(base.eye) || !areNumbers(base.target)) return undefined;
  const read = fromProtocol({ ...base, type: base.type ?? 'perspective' }, upAxis ?? upAxisOf(base));
  if (!read) return undefined;
  const { near, far } = base;
  const camera = { ...read, ...(near > 0 ? { near } : {}), ...(far > 0 ? { far } : {}) };
  /** @type {any} */
  const exact = { type: camera.projection, ...(viewMatrix ? { viewMatrix } : { eye: base.eye, target: base.target, up: base.up ?? [0, 0, 1] }) };
  if (exact.type === 'orthographic') exact.viewHeight = base.viewHeight > 0 ? base.viewHeight : heightAtTarget(camera);
  else exact.fov = base.fov > 0 && base.fov < 180 ? base.fov : camera.fov;
  spoken.set(camera, { ...exact, near: camera.near ?? null, far: camera.far ?? null });
  return camera;
}
