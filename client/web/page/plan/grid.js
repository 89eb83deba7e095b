// The grid of a plan: lines at round coordinates over the picture, and what they are at its border. Only where the picture is
// orthographic and looks along an axis of the cloud: only there is a line of equal coordinates a line, and as far from the next one
// everywhere.

import { planStrings } from '../strings/plan.js';
import { coordinateText, roundAbove } from './lengths.js';
import { svg } from './svg.js';

const words = planStrings.grid;
const leastApart = 84; // CSS pixels
const exactly = 1e-9; // what a direction may lack to be an axis
const farther = [2, 58, 116, 186]; // CSS pixels from the border
const lineOf = { height: 15, perLetter: 7.2, pad: 8 };

/** The axis of the cloud (0, 1, 2) along which that picture looks without perspective; undefined where it is no plan. Pure. */
export function planAxis(pose) {
  const axis = pose.axes.back.findIndex((value) => Math.abs(value) > 1 - exactly);
  return pose.orthographic && axis >= 0 ? axis : undefined;
}

/** The stretch of { x, y } with a·x + b·y = c within a picture, as [[x, y], [x, y]]; undefined where there is none. */
function acrossPicture(a, b, c, { width, height }) {
  const found = [];
  const add = (x, y) => {
    const within = x >= -1e-6 && x <= width + 1e-6 && y >= -1e-6 && y <= height + 1e-6;
    if (within && !found.some(([u, v]) => Math.abs(u - x) + Math.abs(v - y) < 1e-3)) found.push([x, y]);
  };
  if (Math.abs(b) > 1e-12) for (const x of [0, width]) add(x, (c - a * x) / b);
  if (Math.abs(a) > 1e-12) for (const y of [0, height]) add((c - b * y) / a, y);
  return found.length === 2 ? found : undefined;
}

/**
 * The lines of a plan: { step, lines: [{ axis, value, ends: [[x, y], [x, y]] }] } in CSS pixels, one for each multiple of `step`, which is
 * 1, 2 or 5 times a power of ten. Undefined where it is no plan. Pure.
 */
export function gridOf(pose, size, apart = leastApart) {
  const looks = planAxis(pose);
  if (looks === undefined) return undefined;
  const perPixel = (2 * pose.halfHeight) / pose.stretch / size.height;
  const step = roundAbove(perPixel * apart);
  const { right, up } = pose.axes;
  const lines = [0, 1, 2].filter((axis) => axis !== looks).flatMap((axis) => {
    // coordinate = eye + right · (x - width / 2) · perPixel + up · (height / 2 - y) · perPixel
    const [a, b] = [right[axis] * perPixel, -up[axis] * perPixel];
    const corner = pose.eye[axis] - (a * size.width) / 2 - (b * size.height) / 2;
    const corners = [0, a * size.width, b * size.height, a * size.width + b * size.height].map((value) => corner + value);
    const [first, last] = [Math.ceil(Math.min(...corners) / step), Math.floor(Math.max(...corners) / step)];
    return Array.from({ length: Math.max(0, last - first + 1) }, (_, i) => {
      const value = (first + i) * step;
      return { axis, value, ends: acrossPicture(a, b, value - corner, size) };
    }).filter(({ ends }) => ends);
  });
  return { step, lines };
}

/** What a coordinate of that axis is called in front of it: E and N on maps, else the axis's own name; heights need none. Pure. */
export function axisMark(axis, upAxis, hasNorth) {
  const isMap = hasNorth && upAxis === 'z';
  return (isMap ? [words.east, words.north, ''] : ['X', 'Y', 'Z'])[axis];
}

/**
 * Where a line's coordinate can stand: at its lower or right end, else at the other one, on either side of the line, else farther in;
 * nowhere in one of the `taken` boxes, { left, top, right, bottom }. Undefined where it cannot. Pure.
 */
export function labelPlace({ ends }, text, size, taken) {
  const isUpright = Math.abs(ends[0][1] - ends[1][1]) > Math.abs(ends[0][0] - ends[1][0]);
  const [width, height] = [text.length * lineOf.perLetter + lineOf.pad, lineOf.height];
  const [first, last] = [...ends].sort((one, other) => (isUpright ? other[1] - one[1] : other[0] - one[0]));
  const span = Math.hypot(first[0] - last[0], first[1] - last[1]);
  const places = farther.flatMap((inwards) => [[first, last], [last, first]].flatMap(([[x, y], [u, v]]) => {
    const t = (inwards + (isUpright ? height : width) / 2) / span;
    const [middleX, middleY] = [x + (u - x) * t, y + (v - y) * t];
    return [1, -1].map((side) => {
      const left = isUpright ? middleX + (side > 0 ? 3 : -width - 3) : middleX - width / 2;
      const top = isUpright ? middleY - height / 2 : middleY + (side > 0 ? -height - 1 : 2);
      return { left, top, right: left + width, bottom: top + height };
    });
  }));
  return places.find((place) => place.left >= 0 && place.right <= size.width && place.top >= 0 && place.bottom <= size.height
    && !taken.some((other) => place.left < other.right && other.left < place.right && place.top < other.bottom && other.top < place.bottom));
}

export class Grid {
  #shade = svg('path', { class: 'shade' });
  #line = svg('path', { class: 'line' });
  #labels = svg('g');
  node = svg('svg', { id: 'plan-grid', 'aria-hidden': 'true' }, this.#shade, this.#line, this.#labels);

  /** `taken`: boxes where nothing can be written. Returns whether there is a grid. */
  show({ pose, size, upAxis, hasNorth, taken }) {
    const grid = gridOf(pose, size);
    this.node.toggleAttribute('hidden', !grid);
    if (!grid) return false;
    const path = grid.lines.map(({ ends }) => `M${ends.map((end) => end.map((value) => value.toFixed(2)).join(' ')).join('L')}`).join('');
    this.#shade.setAttribute('d', path);
    this.#line.setAttribute('d', path);
    this.node.dataset.step = String(grid.step);
    const used = [...taken];
    const labels = grid.lines.flatMap((line) => {
      const text = [axisMark(line.axis, upAxis, hasNorth), coordinateText(line.value, grid.step)].filter(Boolean).join(' ');
      const place = labelPlace(line, text, size, used);
      if (!place) return [];
      used.push(place);
      const made = svg('text', { x: (place.left + lineOf.pad / 2).toFixed(1), y: (place.bottom - 4).toFixed(1) });
      made.textContent = text;
      return [made];
    });
    this.#labels.replaceChildren(...labels);
    return true;
  }
}
