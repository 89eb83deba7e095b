// What cuts, over the picture: the edges of boxes, of half-spaces a square of their plane; and of the one that is chosen handles: for each
// face, for the middle, and one that turns it. Placed anew whenever what is on the canvas looks from elsewhere, as measures are (measure/marks.js).

import { Places } from '../measure/places.js';
import { svgIn } from '../page/plan/svg.js';
import { radiusOf } from '../view/camera.js';
import { add, scale } from '../view/vectors.js';
import { edgesOf, facesOf, outlineOf, placeIn } from './box.js';

const px = (number) => number.toFixed(2);

/**
 * Where the handles are: { kind: 'face', 'move', 'turn' or 'side' (it only shows which one is kept), at, … }. Pure.
 * @returns {any[]}
 */
export function handlesOf({ box, plane }, size = 1) {
  if (plane) {
    const normal = scale(plane.normal, 1 / Math.hypot(...plane.normal));
    return [{ kind: 'face', at: plane.point, normal }, { kind: 'side', at: add(plane.point, scale(normal, size / 5)), from: plane.point }];
  }
  return [
    ...facesOf(box).map((face) => ({ kind: 'face', ...face })), { kind: 'move', at: box.center },
    { kind: 'turn', at: placeIn(box, [1.3, 0, 1]), from: placeIn(box, [1, 0, 1]) },
  ];
}

export class ClipMarks {
  #root;
  #viewer;
  #drawing;
  #shapes = [];
  #chosen;
  #pose;
  #handles = [];

  constructor(root, viewer) {
    this.#root = root;
    this.#viewer = viewer;
    this.#drawing = svgIn(root, 'svg');
    viewer.addEventListener('shown', () => this.place());
    new ResizeObserver(() => this.place(true)).observe(root);
  }

  /** `shapes` as the view has them; `chosen`, the index of the one that has handles; nothing is drawn where `isActive` is false. */
  show(shapes, chosen, isActive) {
    this.#shapes = isActive ? shapes : [];
    this.#chosen = isActive ? chosen : undefined;
    this.#drawing.replaceChildren();
    for (const [i, shape] of this.#shapes.entries()) {
      svgIn(this.#drawing, 'path', `edges ${shape.keep === 'outside' ? 'outside' : ''} ${i === chosen ? 'chosen' : ''}`).dataset.shape = String(i);
    }
    const shape = this.#shapes[this.#chosen];
    this.#handles = (shape ? handlesOf(shape, this.#side) : []).map((handle, i) => {
      const node = svgIn(this.#drawing, 'g', `handle ${handle.kind}`);
      node.dataset.handle = String(i);
      if (handle.from) svgIn(node, 'path', 'arm');
      svgIn(node, 'circle', 'reach');
      svgIn(node, 'circle', 'dot');
      return { ...handle, node };
    });
    this.place(true);
  }

  /** Of what is drawn of a half-space, which has no end. */
  get #side() { return 0.5 * radiusOf(this.#viewer.bounds); }

  /** The handle of an element in it. */
  handleOf(node) {
    return this.#handles[Number(node?.closest?.('.handle')?.dataset.handle)];
  }

  place(anyway = false) {
    const { shownPose, cssSize } = this.#viewer;
    if (!anyway && shownPose === this.#pose) return;
    this.#pose = shownPose;
    this.#root.style.visibility = shownPose ? '' : 'hidden';
    if (!shownPose || this.#shapes.length === 0) return;
    const places = new Places(shownPose, cssSize);
    for (const path of this.#drawing.querySelectorAll('.edges')) {
      const { box, plane } = this.#shapes[Number(path.dataset.shape)];
      const lines = (box ? edgesOf(box) : outlineOf(plane, this.#side)).map(([a, b]) => places.line(a, b)).filter(Boolean);
      path.setAttribute('d', lines.map(([a, b]) => `M${px(a.x)} ${px(a.y)}L${px(b.x)} ${px(b.y)}`).join(''));
    }
    for (const { at, from, node } of this.#handles) {
      const on = places.of(at);
      node.style.display = on ? '' : 'none';
      if (!on) continue;
      node.setAttribute('transform', `translate(${px(on.x)} ${px(on.y)})`);
      const start = from && places.of(from);
      if (start) node.querySelector('.arm').setAttribute('d', `M0 0L${px(start.x - on.x)} ${px(start.y - on.y)}`);
    }
  }
}
