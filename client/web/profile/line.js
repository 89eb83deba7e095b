// The line of a profile, in plan: how far along it a place is, a part of it, and the corridor around it as shapes that cut and as an outline. Pure;
// lengths in the scan's unit. A station is the distance along the line from its first corner (docs/profile.md).

import { mostShapes } from '../clip/box.js';

const between = ([ax, ay], [bx, by]) => Math.hypot(bx - ax, by - ay);

/** The line's corners in plan, of points of which two in a row may stand above each other. */
export const lineOf = (points) => points.map(([x, y]) => [x, y]).filter(([x, y], i, all) => i === 0 || x !== all[i - 1][0] || y !== all[i - 1][1]);

/** Points in space, moved by that; there and back again is where they were. */
export const movedBy = (points, by) => points.map((point) => point.map((value, axis) => (by[axis] === 0 ? value : Number((value + by[axis]).toPrecision(15)))));

/** The station of each corner. */
export function stationsOf(line) {
  const stations = [0];
  for (let i = 1; i < line.length; ++i) stations.push(stations[i - 1] + between(line[i - 1], line[i]));
  return stations;
}

export const lengthOf = (line) => stationsOf(line).at(-1);

/** [x, y] of that station; what lies before the line's beginning, or behind its end, is there. */
export function placeAt(line, station) {
  const stations = stationsOf(line);
  const at = Math.min(stations.at(-1), Math.max(0, station));
  const i = Math.max(1, stations.findIndex((one, k) => k > 0 && one >= at));
  const long = stations[i] - stations[i - 1];
  const t = long > 0 ? (at - stations[i - 1]) / long : 0;
  return [0, 1].map((axis) => line[i - 1][axis] + (line[i][axis] - line[i - 1][axis]) * t);
}

/** The part of the line between two stations, as a line; undefined where that has no length. */
export function partOf(line, from, to) {
  const stations = stationsOf(line);
  const [first, last] = [Math.max(0, from), Math.min(stations.at(-1), to)];
  if (!(last > first)) return undefined;
  const part = lineOf([placeAt(line, first), ...line.filter((_, i) => stations[i] > first && stations[i] < last), placeAt(line, last)]);
  return part.length > 1 ? part : undefined;
}

/** The station of the place on the line that is nearest to [x, y]. */
export function nearestStation(line, [x, y]) {
  const stations = stationsOf(line);
  let [found, least] = [0, Infinity];
  for (let i = 1; i < line.length; ++i) {
    const [[ax, ay], [bx, by]] = [line[i - 1], line[i]];
    const long = stations[i] - stations[i - 1];
    const t = Math.min(1, Math.max(0, ((x - ax) * (bx - ax) + (y - ay) * (by - ay)) / (long * long)));
    const distance = between([x, y], [ax + (bx - ax) * t, ay + (by - ay) * t]);
    if (distance < least) [found, least] = [stations[i - 1] + long * t, distance];
  }
  return found;
}

/** The corridor as boxes of which the inside is kept, one for each of its parts; undefined where they are more than a view has. */
export function boxesAround(line, width, { min, max }) {
  if (line.length - 1 > mostShapes) return undefined;
  const high = Math.max(max[2] - min[2], 1e-3 * width);
  const tidy = (value) => Number(value.toPrecision(12));
  return line.slice(1).map((to, i) => {
    const from = line[i];
    const turn = (Math.atan2(to[1] - from[1], to[0] - from[0]) * 180) / Math.PI;
    const center = [(from[0] + to[0]) / 2, (from[1] + to[1]) / 2, (min[2] + max[2]) / 2];
    return { box: { center: center.map(tidy), size: [between(from, to), width, 1.01 * high].map(tidy), turn: [Number(turn.toFixed(6)), 0, 0] }, keep: 'inside' };
  });
}

/** Around each part of a line of points in space, a rectangle of that width, level across: lines of points. */
export function outlineOf(points, width) {
  return points.slice(1).flatMap((to, i) => {
    const from = points[i];
    const long = between(from, to);
    if (!(long > 0)) return [];
    const [dx, dy] = [((to[1] - from[1]) / long) * (width / 2), (-(to[0] - from[0]) / long) * (width / 2)];
    const at = (place, side) => [place[0] + side * dx, place[1] + side * dy, place[2]];
    return [[at(from, 1), at(to, 1), at(to, -1), at(from, -1), at(from, 1)]];
  });
}
