// Cutting the scan by boxes and half-spaces: the card with the list of them, and the hand on their handles. What cuts is the view's own word `clips`, so
// the address, undo and links hold it, and the server does it; here is only what a hand and a keyboard need.

import { focusOn, keyed } from '../page/cards/entries.js';
import { element } from '../page/parameter_fields.js';
import { clip as words } from '../page/strings/clip.js';
import { ToolCard } from '../page/cards/tool_card.js';
import { depthOf, eyeOf, heightAtTarget, pointUnderCursor, radiusOf } from '../view/camera.js';
import { subtract } from '../view/vectors.js';
import { Places } from '../measure/places.js';
import { alongNormal, mostShapes, onLevel, rounded, turnedTo, withFaceMoved, withPlaneMoved } from './box.js';
import { card } from './card.js';
import { ClipMarks } from './clip_marks.js';

/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);
const axisNames = ['X', 'Y', 'Z'];

export class Clipping extends ToolCard {
  #viewer;
  #marks;
  #chosen;
  #drag; // { handle, start, cursor, box }

  /** `active(isActive)` hears of it. */
  constructor(viewer, active) {
    super({ card, words, active });
    this.#viewer = viewer;
    const root = find('clips');
    this.#marks = new ClipMarks(root, viewer);
    viewer.addEventListener('view', ({ detail }) => detail.by !== 'hand' && this.#show());
    root.addEventListener('pointerdown', (event) => this.#take(event));
    root.addEventListener('pointermove', (event) => this.#move(event));
    for (const name of ['pointerup', 'pointercancel']) root.addEventListener(name, () => this.#let());
    root.addEventListener('wheel', (event) => {
      event.preventDefault();
      find('picture').dispatchEvent(new WheelEvent(event.type, event));
    }, { passive: false });
    find('clip-add').addEventListener('click', () => this.#add());
    find('clip-add-plane').addEventListener('click', () => this.#addPlane());
    find('clip-none').addEventListener('click', () => this.#put([]));
  }

  get #shapes() {
    return this.#viewer.view.clips ?? [];
  }

  opened(isActive) {
    if (isActive && this.#chosen === undefined) this.#chosen = this.#shapes.length > 0 ? 0 : undefined;
    this.#show();
  }

  #put(shapes) {
    this.#viewer.changeStyle({ clips: shapes.length > 0 ? shapes : null });
  }

  #change(index, shape) {
    this.#put(this.#shapes.map((one, i) => (i === index ? shape : one)));
  }

  /** Around what is in the middle of the picture, a third of it in size. */
  #add() {
    const { camera, cssSize, bounds } = this.#viewer;
    if (!camera || this.#shapes.length >= mostShapes) return;
    const surface = this.#viewer.surfaceAt({ x: cssSize.width / 2, y: cssSize.height / 2 });
    const height = camera.projection === 'orthographic' || !surface ? heightAtTarget(camera) : (heightAtTarget(camera) * surface.depth) / camera.distance;
    const side = Math.min(height / 3, radiusOf(bounds));
    this.#chosen = this.#shapes.length;
    this.#put([...this.#shapes, { box: rounded({ center: surface?.point ?? camera.target, size: [side, side, side], turn: [0, 0, 0] }), keep: 'inside' }]);
  }

  /** Below what is in the middle of the picture. */
  #addPlane() {
    const { camera, cssSize, bounds } = this.#viewer;
    if (!camera || this.#shapes.length >= mostShapes) return;
    const surface = this.#viewer.surfaceAt({ x: cssSize.width / 2, y: cssSize.height / 2 });
    const { center } = rounded({ center: surface?.point ?? camera.target, size: [1, 1, 1].map(() => radiusOf(bounds)) });
    this.#chosen = this.#shapes.length;
    this.#put([...this.#shapes, { plane: { point: center, normal: [0, 0, -1] } }]);
  }

  // ---- the hand

  #cursor(event) {
    const { left, top } = find('picture').getBoundingClientRect();
    return { x: event.clientX - left, y: event.clientY - top };
  }

  #take(event) {
    const handle = this.#marks.handleOf(event.target);
    const shape = this.#shapes[this.#chosen];
    if (!handle || handle.kind === 'side' || !shape || event.button !== 0 || !this.#viewer.shownPose) return;
    event.preventDefault();
    find('clips').setPointerCapture(event.pointerId);
    this.#drag = { handle, start: this.#cursor(event), shape, camera: this.#viewer.camera };
  }

  #move(event) {
    if (!this.#drag) return;
    const { handle, start, shape, camera } = this.#drag;
    const { cssSize, shownPose, bounds } = this.#viewer;
    const cursor = this.#cursor(event);
    let { box } = shape;
    const size = box ? Math.max(...box.size) : radiusOf(bounds);
    if (handle.kind === 'face') {
      const places = new Places(shownPose, cssSize);
      const reach = 0.01 * size;
      const [from, to] = [places.of(handle.at), places.of(handle.at.map((value, i) => value + handle.normal[i] * reach))];
      if (!from || !to) return;
      const unit = { x: (to.x - from.x) / reach, y: (to.y - from.y) / reach };
      const distance = alongNormal({ x: cursor.x - start.x, y: cursor.y - start.y }, unit);
      if (shape.plane) {
        this.#change(this.#chosen, { plane: withPlaneMoved(shape.plane, distance, Math.min(9, Math.max(0, 3 - Math.floor(Math.log10(size))))) });
        return;
      }
      box = withFaceMoved(box, handle, distance, 1e-4 * radiusOf(bounds));
    } else if (handle.kind === 'move') {
      const depth = depthOf(camera, box.center);
      const shift = subtract(pointUnderCursor(camera, cursor, cssSize, depth), pointUnderCursor(camera, start, cssSize, depth));
      box = { ...box, center: box.center.map((value, i) => value + shift[i]) };
    } else {
      const eye = camera.projection === 'orthographic' ? pointUnderCursor(camera, cursor, cssSize, -camera.distance) : eyeOf(camera);
      const point = onLevel(eye, subtract(pointUnderCursor(camera, cursor, cssSize), eye), handle.at[2]);
      if (!point) return;
      box = turnedTo(box, point);
    }
    this.#change(this.#chosen, { ...shape, box: rounded(box) });
  }

  #let() {
    this.#drag = undefined;
  }

  // ---- the list

  #show() {
    const shapes = this.#shapes;
    if (this.#chosen >= shapes.length) this.#chosen = shapes.length > 0 ? shapes.length - 1 : undefined;
    this.#marks.show(shapes, this.#chosen, this.isActive);
    if (!this.isActive) return;
    for (const id of ['clip-add', 'clip-add-plane']) find(id).disabled = shapes.length >= mostShapes;
    find('clip-none').disabled = shapes.length === 0;
    find('clip-empty').hidden = shapes.length > 0;
    const focused = /** @type {HTMLElement} */ (document.activeElement)?.dataset?.key;
    find('clip-list').replaceChildren(...shapes.map((shape, i) => this.#row(shape, i)));
    if (focused) focusOn(find('clip-list'), focused);
  }

  #row(shape, index) {
    const name = shape.box ? words.box(index + 1) : words.plane(index + 1);
    const isChosen = index === this.#chosen;
    const head = keyed(`row-${index}`, { textContent: name }, () => {
      this.#chosen = isChosen ? undefined : index;
      this.#show();
    });
    head.className = 'name';
    head.setAttribute('aria-expanded', String(isChosen));
    const row = element('li', {}, element('div', { className: 'head' }, head));
    if (!isChosen) return row;
    row.append(element('div', { className: 'details' }, ...this.#fields(shape, index), element('div', { className: 'buttons' },
      ...(shape.plane ? [keyed(`flip-${index}`, { textContent: words.flip }, () => this.#change(index, { plane: { ...shape.plane, normal: shape.plane.normal.map((value) => -value) } }))] : []),
      keyed(`remove-${index}`, { textContent: words.remove }, () => this.#put(this.#shapes.filter((_, i) => i !== index))))));
    return row;
  }

  #fields(shape, index) {
    const part = shape.box ? 'box' : 'plane';
    const { [part]: box } = shape;
    const number = (key, label, value, change) => {
      const field = element('input', { type: 'number', step: 'any', value: String(value), ariaLabel: label });
      field.dataset.key = `${key}-${index}`;
      field.addEventListener('change', () => {
        const next = change(field.valueAsNumber);
        if (Number.isFinite(field.valueAsNumber) && next) this.#change(index, { ...shape, [part]: { ...box, ...next } });
        else field.value = String(value);
      });
      return field;
    };
    const three = (label, values, change) => element('div', { className: 'three' }, element('span', { textContent: label }),
      ...values.map((value, axis) => number(`${label}-${axis}`, `${label} ${axisNames[axis]}`, value, (next) => change(axis, next))));
    if (shape.plane) {
      const { point, normal } = shape.plane;
      return [
        three(words.point, point, (axis, next) => ({ point: point.with(axis, next) })),
        three(words.normal, normal, (axis, next) => normal.with(axis, next).some((value) => value !== 0) && { normal: normal.with(axis, next) }),
      ];
    }
    const keep = element('select', { ariaLabel: words.keep },
      ...['inside', 'outside'].map((value) => element('option', { value, textContent: words.keeps[value], selected: value === shape.keep })));
    keep.dataset.key = `keep-${index}`;
    keep.addEventListener('change', () => this.#change(index, { ...shape, keep: keep.value }));
    return [
      keep,
      three(words.center, box.center, (axis, next) => ({ center: box.center.with(axis, next) })),
      three(words.size, box.size, (axis, next) => next > 0 && { size: box.size.with(axis, next) }),
      three(words.turn, box.turn ?? [0, 0, 0], (axis, next) => Math.abs(next) <= 360 && { turn: (box.turn ?? [0, 0, 0]).with(axis, next) }),
    ];
  }
}
