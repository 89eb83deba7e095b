// What is measured: of points of the scan, the lengths, areas and angles between them, how exact they are, and what of them is
// drawn. Pure, in the scan's own coordinates and unit.
//
// A measure is { id, kind, name, points, step, up, visible, more, option, answer }: `points` [x, y, z] as they stand in the file, `step` the
// coarsest step of the grid that they lie on, `up` 'z', 'y' or '-y', `more` what the server tells of a single point. Of kinds
// that only the server can compute, `option` says how - a volume's base, how near to a cylinder's point its points are - and `answer` is
// what it said (answers.js). A measure is never changed; another one takes its place (measures.js).

import { add, areNumbers, dot, length, mix, scale, subtract } from '../view/vectors.js';
import { arc, cross, fits, fittedFigure, fittedValues, unit } from './fits.js';

/**
 * How many points each kind has; `closed`: from the last one back to the first; `asks`: the server computes it, of the scan's points; `fits`: a shape near
 * them (fits.js).
 * @type {{ [kind: string]: { least: number, most: number, closed?: boolean, asks?: boolean, fits?: boolean } }}
 */
export const kinds = {
  point: { least: 1, most: 1 },
  distance: { least: 2, most: 500 },
  horizontal: { least: 2, most: 500 },
  height: { least: 2, most: 2 },
  angle: { least: 3, most: 3 },
  area: { least: 3, most: 500, closed: true },
  circle: { least: 3, most: 3 },
  volume: { least: 3, most: 500, closed: true, asks: true },
  ...Object.fromEntries(Object.entries(fits).map(([kind, { least, most }]) => [kind, { least, most, asks: true, fits: true }])),
};

/** What a volume may stand on, but for a height: the lowest corner, the mean of the corners, the plane through them. */
export const bases = ['lowest', 'mean', 'fit'];

/** Whether that says how the server is to compute a measure of that kind. */
export const isOptionOf = (kind, option) =>
  (kind === 'volume' && (bases.includes(option) || Number.isFinite(option))) || (kinds[kind].fits === true && Number.isFinite(option) && option > 0);

const ups = { z: [0, 0, 1], y: [0, 1, 0], '-y': [0, -1, 0] };
export const upOf = ({ up }) => ups[up] ?? ups.z;

const between = (a, b) => length(subtract(a, b));
const rise = (a, b, up) => dot(subtract(b, a), up);
const level = (a, b, up) => {
  const way = subtract(b, a);
  return length(subtract(way, scale(up, dot(way, up))));
};
const pairs = (points, closed = false) =>
  points.slice(1).map((point, i) => [points[i], point]).concat(closed && points.length > 2 ? [[points.at(-1), points[0]]] : []);
const sum = (values) => values.reduce((a, b) => a + b, 0);

/** Twice the area that the points go round, along its normal, whatever their plane: Newell's sum. */
function newell(points) {
  const [origin] = points;
  return pairs(points, true).reduce((normal, [a, b]) => add(normal, cross(subtract(a, origin), subtract(b, origin))), [0, 0, 0]);
}

/** The circle through three points: { center, radius, normal }; undefined where they lie on a line, or on each other. */
export function circleThrough([a, b, c]) {
  const [u, v] = [subtract(b, a), subtract(c, a)];
  const normal = cross(u, v);
  const square = dot(normal, normal);
  if (!(square > 1e-18 * dot(u, u) * dot(v, v))) return undefined;
  const toCenter = scale(add(scale(cross(v, normal), -dot(u, u)), scale(cross(u, normal), dot(v, v))), -1 / (2 * square));
  return { center: add(a, toCenter), radius: length(toCenter), normal: unit(normal) };
}

/** At b, between the ways to a and c, in degrees; undefined where one of them is none. */
function angleAt(a, b, c) {
  const [u, v] = [subtract(a, b), subtract(c, b)];
  if (!(length(u) > 0 && length(v) > 0)) return undefined;
  return (Math.atan2(length(cross(u, v)), dot(u, v)) * 180) / Math.PI;
}

/** Whether the outline crosses itself, seen along its normal: then its area is not what one thinks. */
export function crossesItself(points) {
  const normal = newell(points);
  if (!(length(normal) > 0) || points.length < 4) return false;
  const edges = pairs(points, true);
  const side = (a, b, c) => dot(cross(subtract(b, a), subtract(c, a)), normal);
  return edges.some(([a, b], i) => edges.some(([c, d], j) => {
    if (j <= i + 1 || (i === 0 && j === edges.length - 1)) return false; // neighbours meet
    return side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0;
  }));
}

/** Where z is in another unit than x and y. */
const inSpace = (points, heights) => (heights === 1 ? points : points.map(([x, y, z]) => [x, y, z * heights]));

const value = (name, quantity, number, error) => ({ name, quantity, value: number, error });

/**
 * What a measure comes to, the main one first: [{ name, quantity, value, error }], `quantity` 'length', 'area', 'volume', 'angle'
 * (degrees) or 'count', `error` what the grid of the coordinates leaves open. `heights`: what z is multiplied by to be in the unit of x and y, in
 * which lengths are. Empty while the server has not answered, while it has too few points, or where they make no such figure.
 */
export function valuesOf(measure, heights = 1) {
  const { kind, step = 0, answer } = measure;
  const points = inSpace(measure.points, heights);
  const { least, closed = false } = kinds[kind];
  if (points.length < least || kind === 'point') return [];
  if (kinds[kind].asks) return answer ? answeredBy(kind, answer, step) : [];
  const up = upOf(measure);
  const [a, b, c] = points;
  const lengthOf = (name, number, error = step) => value(name, 'length', number, error);
  const path = sum(pairs(points, closed).map(([from, to]) => between(from, to)));
  const flat = sum(pairs(points, closed).map(([from, to]) => level(from, to, up)));
  const last = points.at(-1);
  switch (kind) {
    case 'distance': return [lengthOf('length', path), lengthOf('horizontal', flat), lengthOf('rise', rise(a, last, up))];
    case 'horizontal': return [lengthOf('horizontal', flat), lengthOf('length', path), lengthOf('rise', rise(a, last, up))];
    case 'height': return [lengthOf('rise', rise(a, b, up)), lengthOf('horizontal', flat), lengthOf('length', path)];
    case 'angle': {
      const angle = angleAt(a, b, c);
      if (angle === undefined) return [];
      const shortest = Math.min(between(a, b), between(b, c));
      return [value('angle', 'angle', angle, ((step / shortest) * 180) / Math.PI)];
    }
    case 'area': {
      const normal = newell(points);
      const areaOf = (name, number) => value(name, 'area', number, (path * step) / 2);
      return [areaOf('area', length(normal) / 2), areaOf('flatArea', Math.abs(dot(normal, up)) / 2), lengthOf('outline', path)];
    }
    default: {
      const circle = circleThrough(points);
      if (!circle) return [];
      const shortest = Math.min(between(a, b), between(b, c), between(c, a));
      const error = step * Math.max(1, (circle.radius / shortest) ** 2);
      return [
        lengthOf('radius', circle.radius, error), lengthOf('diameter', 2 * circle.radius, 2 * error),
        lengthOf('circumference', 2 * Math.PI * circle.radius, 2 * Math.PI * error),
      ];
    }
  }
}

/** The same of what the server said. */
function answeredBy(kind, answer, step) {
  const found = kind === 'volume'
    ? ['net', 'above', 'below'].map((name) => value(name, 'volume', answer[name], 5e-4 * Math.max(answer.above, answer.below)))
      .concat(['area', 'uncovered'].map((name) => value(name === 'area' ? 'flatArea' : name, 'area', answer[name], 5e-4 * answer.area)))
    : fittedValues(kind, answer, step).map(([name, quantity, number, error]) => value(name, quantity, number, error));
  return found.filter(({ value: number }) => Number.isFinite(number));
}

function angleArc([a, b, c]) {
  const [u, v] = [subtract(a, b), subtract(c, b)];
  const normal = cross(u, v);
  if (!(length(normal) > 0)) return [];
  const radius = 0.3 * Math.min(length(u), length(v));
  const along = scale(unit(u), radius);
  return arc(b, along, scale(unit(cross(normal, u)), radius), Math.atan2(length(normal), dot(u, v)), 24);
}

/** Half of the way along a line of points. */
function middleOf(points) {
  let left = sum(pairs(points).map(([a, b]) => between(a, b))) / 2;
  for (const [a, b] of pairs(points)) {
    const part = between(a, b);
    if (left <= part) return mix(a, b, part > 0 ? left / part : 0);
    left -= part;
  }
  return points[0];
}

/** The corners of a volume's base, straight below or above the points; undefined where it is not known. */
function baseUnder(points, base) {
  if (!areNumbers(base?.at)) return undefined;
  const [along, across] = areNumbers(base.slope, 2) ? base.slope : [0, 0];
  return points.map(([x, y]) => [x, y, base.at[2] + along * (x - base.at[0]) + across * (y - base.at[1])]);
}

const middle = (points) => scale(points.reduce(add), 1 / points.length);

/**
 * What is drawn of it, in the scan's coordinates: `lines` and thin `helpers`, each a line of points; `label`, where its value
 * stands; `legs`, [{ at, length }] where the parts of a longer line have theirs. `heights` as for valuesOf().
 * @returns {{ lines: number[][][], helpers: number[][][], label: number[], legs: { at: number[], length: number }[] }}
 */
export function figureOf(measure, heights = 1) {
  const { kind, points } = measure;
  const up = upOf(measure);
  const [a, b] = points;
  const figure = { lines: [points], helpers: /** @type {number[][][]} */ ([]), label: points.at(-1), legs: /** @type {{ at: number[], length: number }[]} */ ([]) };
  if (kinds[kind].fits) return measure.answer ? fittedFigure(measure, measure.answer, { ...figure, lines: [[a]] }) : { ...figure, lines: [[a]] };
  if (points.length < 2) return figure;
  if (kind === 'distance') {
    // Where the legs have their own, the whole stands at the end.
    if (points.length === 2) figure.label = middleOf(points);
    else figure.legs = pairs(points).map(([from, to]) => ({ at: mix(from, to, 0.5), length: between(...inSpace([from, to], heights)) }));
  } else if (kind === 'height') {
    const [low, high] = rise(a, b, up) >= 0 ? [a, b] : [b, a];
    const corner = add(low, scale(up, rise(low, high, up)));
    figure.lines = [[low, corner]];
    figure.helpers = [[corner, high]];
    figure.label = mix(low, corner, 0.5);
  } else if (kind === 'horizontal') {
    const beneath = points.map((point) => add(point, scale(up, rise(point, a, up))));
    figure.lines = [beneath];
    figure.helpers = points.slice(1).map((point, i) => [beneath[i + 1], point]);
    figure.label = middleOf(beneath);
  } else if (kind === 'angle' && points.length === 3) {
    figure.helpers = [angleArc(/** @type {any} */ (points))];
    figure.label = figure.helpers[0][12] ?? b;
  } else if (kind === 'area') {
    figure.lines = [points.length > 2 ? [...points, a] : points];
    figure.label = middle(points);
  } else if (kind === 'volume') {
    const onBase = baseUnder(points, measure.answer?.base);
    figure.lines = [points.length > 2 ? [...points, a] : points];
    figure.helpers = onBase ? [[...onBase, onBase[0]], ...points.map((point, i) => [point, onBase[i]])] : [];
    figure.label = middle(points);
  } else if (kind === 'circle' && points.length === 3) {
    const circle = circleThrough(points);
    if (!circle) return figure;
    const u = subtract(a, circle.center);
    figure.lines = [arc(circle.center, u, cross(circle.normal, u), 2 * Math.PI, 72)];
    figure.helpers = [[circle.center, a]];
    figure.label = circle.center;
  }
  return figure;
}

/** The box around the points, as bounds are. */
export const boundsOf = (points) => ({
  min: [0, 1, 2].map((axis) => Math.min(...points.map((point) => point[axis]))),
  max: [0, 1, 2].map((axis) => Math.max(...points.map((point) => point[axis]))),
});
