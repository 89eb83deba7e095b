// Shapes that the server fits to the scan's points near picked places (docs/measure.md): what of its answer is a value, and what is drawn of the shape. Pure, in
// the scan's coordinates.

import { add, areNumbers, dot, length, scale, subtract } from '../view/vectors.js';

/** What each is called in the protocol, and how many places may be picked. */
export const fits = {
  fitCircle: { measure: 'circle', least: 1, most: 3 },
  plane: { measure: 'plane', least: 1, most: 500 },
  sphere: { measure: 'sphere', least: 1, most: 4 },
  cylinder: { measure: 'cylinder', least: 1, most: 1 },
};

export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const unit = (v) => scale(v, 1 / length(v));

/** `count` + 1 points of an arc about `center`, from `u` towards `v`, which are perpendicular and as long as its radius. */
export const arc = (center, u, v, angle, count) =>
  Array.from({ length: count + 1 }, (_, i) => add(center, add(scale(u, Math.cos((angle * i) / count)), scale(v, Math.sin((angle * i) / count)))));

/**
 * Two directions at right angles to `axis` and to each other.
 * @returns {[number[], number[]]}
 */
function across(axis) {
  const along = unit(axis);
  const aside = unit(cross(along, Math.abs(along[0]) < 0.8 ? [1, 0, 0] : [0, 1, 0]));
  return [aside, cross(along, aside)];
}

const ring = (center, [u, v], radius, count = 72) => arc(center, scale(u, radius), scale(v, radius), 2 * Math.PI, count);

/** [name, quantity, value, error] of what the server said of such a kind; some of them may be missing. `step`: of the coordinates' grid. */
export function fittedValues(kind, answer, step) {
  const { radius, rms, arc: seen, slope, falls, used } = answer;
  const error = Math.max(step, used > 3 ? rms / Math.sqrt(used) : 0) || 0;
  const spread = ['spread', 'length', rms, rms / 20];
  const count = ['used', 'count', used, 0.5];
  const round = [['radius', 'length', radius, error], ['diameter', 'length', 2 * radius, 2 * error]];
  if (kind === 'plane') {
    const strike = Number.isFinite(falls) ? (falls + 270) % 360 : undefined; // dips to the right of who walks along it
    return [['slope', 'angle', slope, 0.005], ['falls', 'angle', falls ?? undefined, 0.05], ['strike', 'angle', strike, 0.05], spread, count];
  }
  if (kind === 'sphere') return [...round, spread, count];
  if (kind === 'fitCircle') return [...round, ['arc', 'angle', seen, 0.5], spread, count];
  return [...round, ['seenLength', 'length', answer.length, step], spread];
}

function planeFigure({ center, normal }, points, within, figure) {
  if (!areNumbers(normal) || !(length(normal) > 0)) return figure;
  const up = unit(normal[2] < 0 ? scale(normal, -1) : normal);
  const level = cross([0, 0, 1], up); // along its contour lines
  const u = length(level) > 1e-6 ? unit(level) : [1, 0, 0];
  const v = cross(up, u); // up the slope
  const reach = (axis) => Math.max(...points.map((point) => Math.abs(dot(subtract(point, center), axis)))) + within;
  const [wide, high] = [reach(u), reach(v)];
  const at = (a, b) => add(center, add(scale(u, a * wide), scale(v, b * high)));
  const down = [center, at(0, -0.7)];
  const tips = [0.12, -0.12].map((side) => [at(side, -0.52), down[1]]);
  const normalLine = [center, add(center, scale(up, 0.4 * Math.min(wide, high)))];
  return { ...figure, lines: [[at(-1, -1), at(1, -1), at(1, 1), at(-1, 1), at(-1, -1)]], helpers: length(level) > 1e-6 ? [down, ...tips, normalLine] : [normalLine], label: center };
}

function cylinderFigure({ center, axis, radius, length: long }, figure) {
  if (!areNumbers(axis) || !(radius > 0)) return figure;
  const sides = across(axis);
  const ends = [-0.5, 0.5].map((share) => add(center, scale(unit(axis), share * (long > 0 ? long : 0))));
  const circles = ends.map((end) => ring(end, sides, radius, 48));
  return { ...figure, lines: circles, helpers: [ends, ...[0, 12, 24, 36].map((i) => [circles[0][i], circles[1][i]])], label: ends[1] };
}

/** What is drawn of the shape that `answer` says, in place of `figure`: as figureOf() has it. */
export function fittedFigure({ kind, points, option }, answer, figure) {
  const { center, axis, radius } = answer;
  if (!areNumbers(center)) return figure;
  if (kind === 'cylinder') return cylinderFigure(answer, figure);
  if (kind === 'plane') return planeFigure(answer, points, option > 0 ? option : 0, figure);
  if (!(radius > 0)) return figure;
  if (kind === 'sphere') {
    const [x, y, z] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
    return { ...figure, lines: [ring(center, [x, y], radius)], helpers: [ring(center, [x, z], radius), ring(center, [y, z], radius)], label: add(center, [0, 0, radius]) };
  }
  if (!areNumbers(axis) || !(length(axis) > 0)) return figure;
  const sides = across(axis);
  return { ...figure, lines: [ring(center, sides, radius)], helpers: [[center, add(center, scale(sides[0], radius))]], label: center };
}
