// Boxes and half-spaces that cut, as the view's word `clips` has them (PROTOCOL.md, "Shapes that cut"): a box's axes, the edges of both, and
// what a hand does to them. Pure functions from one shape to the next; none of them changes its argument.

import { add, scale, subtract } from '../view/vectors.js';

export const mostShapes = 8; // in a view

const radians = (degrees) => (degrees * Math.PI) / 180;

/** The box's own axes: by yaw about Z, then by pitch about its Y, then by roll about its X. */
export function axesOf({ turn = [0, 0, 0] }) {
  const [[sy, cy], [sp, cp], [sr, cr]] = turn.map((angle) => [Math.sin(radians(angle)), Math.cos(radians(angle))]);
  return [[cy * cp, sy * cp, -sp], [cy * sp * sr - sy * cr, sy * sp * sr + cy * cr, cp * sr], [cy * sp * cr + sy * sr, sy * sp * cr - cy * sr, cp * cr]];
}

/** A place in the box, each of `at` from -1 to 1. */
export function placeIn(box, at) {
  return axesOf(box).reduce((point, axis, i) => add(point, scale(axis, (at[i] * box.size[i]) / 2)), box.center);
}

const signs = [-1, 1];

/** Twelve pairs of corners. */
export function edgesOf(box) {
  return [0, 1, 2].flatMap((axis) => signs.flatMap((one) => signs.map((other) => signs.map((end) => {
    const at = [one, other];
    at.splice(axis, 0, end);
    return placeIn(box, at);
  }))));
}

/** Six: { axis, side, at, normal }, the normal pointing out of the box. */
export const facesOf = (box) => [0, 1, 2].flatMap((axis) => signs.map((side) => {
  const at = [0, 0, 0];
  at[axis] = side;
  return { axis, side, at: placeIn(box, at), normal: scale(axesOf(box)[axis], side) };
}));

/** The box with one face drawn out by `distance`, or in; its opposite stays where it is. */
export function withFaceMoved(box, { axis, side }, distance, least) {
  const size = Math.max(least, box.size[axis] + distance);
  const shift = ((size - box.size[axis]) / 2) * side;
  return { ...box, center: add(box.center, scale(axesOf(box)[axis], shift)), size: box.size.with(axis, size) };
}

/** Turned about the vertical through its middle, so that its first axis points from there to `point`, seen from above. */
export function turnedTo(box, point) {
  const [x, y] = subtract(point, box.center);
  if (!(Math.hypot(x, y) > 0)) return box;
  const [, ...others] = box.turn ?? [0, 0, 0];
  return { ...box, turn: [Number(((Math.atan2(y, x) * 180) / Math.PI).toFixed(2)), ...others] };
}

const unit = (v) => scale(v, 1 / Math.hypot(...v));
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

/** What is drawn of a half-space: a square of its plane around its point, `side` long, as four pairs of corners. */
export function outlineOf({ point, normal }, side) {
  const out = unit(normal);
  const along = unit(cross(out, Math.abs(out[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0]));
  const across = cross(out, along);
  const corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([a, b]) => add(point, add(scale(along, (a * side) / 2), scale(across, (b * side) / 2))));
  return corners.map((corner, i) => [corner, corners[(i + 1) % 4]]);
}

/** The half-space with its plane moved by `distance` along its normal. */
export const withPlaneMoved = (plane, distance, decimals) =>
  ({ ...plane, point: add(plane.point, scale(unit(plane.normal), distance)).map((value) => Number(value.toFixed(decimals))) });

/** Numbers in as many digits as a hand means: a thousandth of the box. */
export function rounded(box) {
  const decimals = Math.min(9, Math.max(0, 3 - Math.floor(Math.log10(Math.max(...box.size)))));
  const plain = (values) => values.map((value) => Number(value.toFixed(decimals)));
  const size = plain(box.size);
  return { ...box, center: plain(box.center), size: size.every((value) => value > 0) ? size : box.size };
}

/** How far along `normal` a hand has moved that went by `step` px, where one unit along it is `unit` px on screen. */
export const alongNormal = (step, unit) => {
  const square = unit.x * unit.x + unit.y * unit.y;
  return square > 1e-9 ? (step.x * unit.x + step.y * unit.y) / square : 0;
};

/** Where the way of the eye through a place of the picture meets the level plane through `height`; undefined where it does not. */
export function onLevel(eye, direction, height) {
  const t = (height - eye[2]) / direction[2];
  return Number.isFinite(t) && t > 0 ? add(eye, scale(direction, t)) : undefined;
}
