// The view cube: how the cloud lies, and from where one looks at it. It turns with what the canvas shows; a click on a face, an edge or a
// corner looks from there. An arrow marks north, where the cloud's coordinate system says where that is; else it has the name of the
// axis that lies that way.

import { changed, toCloud } from '../../view/camera.js';
import { dot } from '../../view/vectors.js';
import { planStrings } from '../strings/plan.js';
import { svg } from './svg.js';

const words = planStrings.cube;

/** In a frame in which Z is up: the axes of each face as one sees it from outside. */
const faces = [
  { name: 'top', normal: [0, 0, 1], right: [1, 0, 0], up: [0, 1, 0] },
  { name: 'bottom', normal: [0, 0, -1], right: [1, 0, 0], up: [0, -1, 0] },
  { name: 'front', normal: [0, -1, 0], right: [1, 0, 0], up: [0, 0, 1] },
  { name: 'back', normal: [0, 1, 0], right: [-1, 0, 0], up: [0, 0, 1] },
  { name: 'side', normal: [1, 0, 0], right: [0, 1, 0], up: [0, 0, 1] },
  { name: 'left', normal: [-1, 0, 0], right: [0, -1, 0], up: [0, 0, 1] },
];
const inner = 0.58; // of a face's half: what is nearer to its border is an edge or a corner
const ends = [-1, -inner, inner, 1];
const cornersOfCell = [[0, 0], [1, 0], [1, 1], [0, 1]];
const step = Math.PI / 4;
const leastDrag = 4; // CSS pixels

const along = ({ normal, right, up }, x, y) => [0, 1, 2].map((i) => normal[i] + x * right[i] + y * up[i]);

/** Nine cells of each face: { face, direction, corners }, all in a frame in which Z is up. */
const cells = faces.flatMap((face) => [-1, 0, 1].flatMap((x) => [-1, 0, 1].map((y) => ({
  face,
  direction: along(face, x, y),
  corners: cornersOfCell.map(([i, j]) => along(face, ends[x + 1 + i], ends[y + 1 + j])),
}))));

/**
 * Where a place of that frame lies on the cube's drawing, x to the right and y down, for the axes of a picture of a cloud in which `upAxis`
 * is up. Pure.
 */
export function onCube(place, axes, upAxis) {
  const there = toCloud(place, upAxis);
  return [dot(there, axes.right), -dot(there, axes.up)];
}

/** Names of the faces that are to be seen, the one that is turned to the viewer most first. Pure. */
export function facesSeen(axes, upAxis) {
  return faces.map(({ name, normal }) => ({ name, towards: dot(toCloud(normal, upAxis), axes.back) }))
    .filter(({ towards }) => towards > 1e-3).sort((a, b) => b.towards - a.towards).map(({ name }) => name);
}

/** `camera` turned about what it looks at until it looks from that direction of a frame in which Z is up; from the top, north is up. Pure. */
export function turnedTo(camera, direction) {
  const [x, y, z] = direction;
  const flat = Math.hypot(x, y);
  return changed(camera, { azimuth: flat > 1e-9 ? Math.atan2(y, x) : -Math.PI / 2, elevation: Math.atan2(z, flat) });
}

/** `camera` turned by steps of 45° to the next direction of the cube. Pure. */
export function steppedTo(camera, aside, upwards) {
  const next = (angle, by) => (by === 0 ? Math.round(angle / step) : by > 0 ? Math.floor(angle / step + 1e-6) + 1 : Math.ceil(angle / step - 1e-6) - 1) * step;
  return changed(camera, { azimuth: next(camera.azimuth, aside), elevation: next(camera.elevation, upwards) });
}

/** "the south-east, above": from where a picture with that axis looks. `hasNorth`: whether Y is north. Pure. */
export function fromWhere(back, upAxis, hasNorth) {
  const [x, y, z] = ['x', 'y', 'z'].map((_, i) => dot(toCloud([0, 1, 2].map((j) => Number(j === i)), upAxis), back));
  const elevation = Math.atan2(z, Math.hypot(x, y));
  if (Math.abs(elevation) > 1.5 * step) return elevation > 0 ? words.above : words.below;
  const side = (hasNorth ? words.winds : words.sides)[Math.round(Math.atan2(y, x) / step + 8) % 8];
  return words.fromSide(side, elevation > step / 2 ? words.above : elevation < -step / 2 ? words.below : '');
}

/** What stands on a face: where north is known, sides are the points of the compass. Pure. */
export const faceText = (name, upAxis, hasNorth) => (hasNorth && upAxis === 'z' && words.compass[name]) || words.faces[name];

/** What lies where north is on a map: "N", or the cloud's axis that points there, where nobody says that it is north. Pure. */
export function northMark(upAxis, hasNorth) {
  if (hasNorth && upAxis === 'z') return words.north;
  const axis = toCloud([0, 1, 0], upAxis);
  const i = axis.findIndex((value) => Math.abs(value) > 0.5);
  return `${axis[i] < 0 ? '−' : ''}${'XYZ'[i]}`;
}

const numbers = (place) => place.map((value) => value.toFixed(3)).join(' ');

export class ViewCube {
  #arrow = svg('path', { class: 'north' });
  #mark = svg('text', { class: 'north' });
  #cells = cells.map((cell) => ({ ...cell, node: svg('path', { class: 'cell' }) }));
  #labels = faces.map((face) => ({ face, node: svg('text', { class: 'face' }) }));
  #cube = svg('g', {}, ...this.#cells.map(({ node }) => node), ...this.#labels.map(({ node }) => node));
  node = svg('svg', { id: 'cube', viewBox: '-1.8 -1.95 3.6 3.75', tabindex: '0', role: 'img' }, svg('title'), this.#cube, this.#arrow, this.#mark);

  /** `turn(next)`: `next` makes a camera of a camera, where to fly. `drag` has begin() and turn(azimuth, elevation), in radians. */
  constructor(turn, drag) {
    this.node.querySelector('title').textContent = words.tip;
    for (const { direction, node } of this.#cells) {
      node.dataset.direction = direction.join(' ');
      node.addEventListener('click', () => turn((camera) => turnedTo(camera, direction)));
      node.addEventListener('pointerenter', () => this.#hover(direction));
      node.addEventListener('pointerleave', () => this.#hover(undefined));
    }
    this.#bringDrags(drag);
    const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    this.node.addEventListener('keydown', (event) => {
      const by = Object.hasOwn(steps, event.key) && !event.shiftKey ? steps[event.key] : undefined;
      if (!by && event.key !== 'Home') return;
      event.preventDefault();
      event.stopPropagation(); // else the camera turns, too
      turn((camera) => (by ? steppedTo(camera, by[0], by[1]) : turnedTo(camera, [0, 0, 1])));
    });
  }

  /** What is grabbed follows the hand: across the cube's width is half a turn. A click is a drag that went nowhere. */
  #bringDrags(drag) {
    let last; // where the pointer was, and whether it has gone anywhere
    this.node.addEventListener('pointerdown', ({ clientX, clientY, button }) => {
      if (button === 0) last = { x: clientX, y: clientY, moves: false };
    });
    this.node.addEventListener('pointermove', ({ clientX, clientY, pointerId }) => {
      if (!last) return;
      const [x, y] = [clientX - last.x, clientY - last.y];
      if (!last.moves && Math.hypot(x, y) < leastDrag) return;
      if (!last.moves) {
        this.node.setPointerCapture(pointerId); // the cells hear of no click then
        drag.begin();
      }
      last = { x: clientX, y: clientY, moves: true };
      const turn = Math.PI / this.node.clientWidth;
      drag.turn(-x * turn, y * turn);
    });
    for (const name of ['pointerup', 'pointercancel']) this.node.addEventListener(name, () => { last = undefined; });
  }

  #hover(direction) {
    const said = direction?.join(' ');
    for (const { node } of this.#cells) node.classList.toggle('hovered', node.dataset.direction === said);
  }

  /** As the picture looks; `hasNorth`: whether the cloud's coordinate system says that Y is north. */
  show({ axes, upAxis, hasNorth }) {
    const at = (place) => onCube(place, axes, upAxis);
    const faceOn = new Map(faces.map((face) => [face, dot(toCloud(face.normal, upAxis), axes.back)]));
    for (const { face, corners, node } of this.#cells) {
      const seen = faceOn.get(face) > 1e-3;
      node.toggleAttribute('hidden', !seen);
      if (seen) node.setAttribute('d', `M${corners.map((corner) => numbers(at(corner))).join('L')}Z`);
    }
    for (const { face, node } of this.#labels) {
      // A word that is seen from the side can be read by nobody.
      const seen = faceOn.get(face) > 0.22;
      node.toggleAttribute('hidden', !seen);
      const text = faceText(face.name, upAxis, hasNorth);
      if (node.textContent !== text) node.textContent = text;
      if (seen) node.setAttribute('transform', `matrix(${numbers([...at(face.right), ...at(face.up.map((value) => -value)), ...at(face.normal)])})`);
    }
    this.#showNorth(at, dot(toCloud([0, 0, 1], upAxis), axes.back) < 0 ? -1 : 1, northMark(upAxis, hasNorth));
    const label = words.label(fromWhere(axes.back, upAxis, hasNorth && upAxis === 'z'));
    if (this.node.getAttribute('aria-label') !== label) this.node.setAttribute('aria-label', label);
  }

  /** On the cube's top, or on its bottom where that is what one sees: there nothing hides it. */
  #showNorth(at, height, mark) {
    this.#arrow.setAttribute('d', `M${[[0, 1.32, height], [0.3, 0.8, height], [-0.3, 0.8, height]].map((place) => numbers(at(place))).join('L')}Z`);
    const [x, y] = at([0, 1.62, height]);
    this.#mark.setAttribute('x', x.toFixed(3));
    this.#mark.setAttribute('y', y.toFixed(3));
    if (this.#mark.textContent !== mark) this.#mark.textContent = mark;
  }
}
