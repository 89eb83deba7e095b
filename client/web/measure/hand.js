// The hand that measures: clicks on the picture, drags of points, and keys. A drag of the picture still moves the camera, so one
// can go on looking while one measures. What is clicked is found by the server among the scan's own points, a moment later.

import { isForView } from '../view/keys.js';

const still = { mouse: 5, pen: 6, touch: 12 }; // px that a click may move
const clickMs = 700;
const doubleMs = 350;
const doublePx = 12;

/** Of a picked point, the step of its coordinates' grid that is the coarsest. */
export const stepOf = ({ precision }) => Math.max(0, ...(Array.isArray(precision) ? precision : [0]).filter(Number.isFinite));

export class Hand {
  #canvas;
  #roots = /** @type {any[]} */ ([]);
  #does;
  #down; // { id, x, y, time, kind } of the one that may become a click
  #last; // { x, y, time } of the last click
  #dragged; // { node, id, index, isNew, moved }
  #cursor;
  #scheduled = false;

  /**
   * `canvas`: the picture; `root`: what lies over it, with elements of class handle that have data-measure and data-index. `does`:
   * isActive, click(cursor), finish(), hover(cursor or undefined), drag({ id, index, isNew, cursor }), drop(the same) and
   * let() where a drag is given up, select(id, index), key(name, event), which returns whether it was of use.
   */
  constructor(canvas, root, does) {
    this.#canvas = canvas;
    this.#does = does;
    canvas.addEventListener('pointerdown', (event) => this.#pressed(event));
    canvas.addEventListener('pointermove', (event) => this.#moved(event));
    canvas.addEventListener('pointerleave', () => this.#hover(undefined));
    canvas.addEventListener('pointerup', (event) => this.#released(event));
    canvas.addEventListener('pointercancel', () => { this.#down = undefined; });
    // Before the picture's own, which flies there.
    addEventListener('dblclick', (event) => {
      if (this.#does.isActive && (event.target === canvas || this.#roots.some((one) => one.contains(event.target)))) event.stopPropagation();
    }, { capture: true });
    addEventListener('keydown', (event) => this.#key(event), { capture: true });
    this.watch(root);
  }

  /** One more element over the picture that has such handles. */
  watch(root) {
    this.#roots.push(root);
    root.addEventListener('pointerdown', (event) => this.#take(event));
    root.addEventListener('pointermove', (event) => this.#drag(event));
    root.addEventListener('pointerup', (event) => this.#drop(event));
    root.addEventListener('pointercancel', () => this.#give());
    root.addEventListener('wheel', (event) => {
      event.preventDefault();
      this.#canvas.dispatchEvent(new WheelEvent(event.type, event));
    }, { passive: false });
  }

  get cursor() { return this.#cursor; }

  #cursorOf(event) {
    const box = this.#canvas.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  }

  #pressed(event) {
    const isFirst = event.isPrimary && event.button === 0 && !event.shiftKey;
    this.#down = isFirst ? { id: event.pointerId, ...this.#cursorOf(event), time: event.timeStamp, kind: event.pointerType } : undefined;
  }

  #moved(event) {
    const cursor = this.#cursorOf(event);
    if (event.pointerType === 'touch') return; // nothing hovers under a finger
    this.#hover(event.buttons === 0 ? cursor : undefined);
  }

  #hover(cursor) {
    this.#cursor = cursor;
    if (this.#scheduled) return;
    this.#scheduled = true;
    requestAnimationFrame(() => {
      this.#scheduled = false;
      this.#does.hover(this.#cursor);
    });
  }

  #released(event) {
    const down = this.#down;
    this.#down = undefined;
    if (!down || event.pointerId !== down.id) return;
    const at = this.#cursorOf(event);
    const reach = still[down.kind] ?? still.mouse;
    if (Math.hypot(at.x - down.x, at.y - down.y) > reach || event.timeStamp - down.time > clickMs) return;
    const isSecond = this.#last && event.timeStamp - this.#last.time < doubleMs && Math.hypot(at.x - this.#last.x, at.y - this.#last.y) < doublePx;
    this.#last = isSecond ? undefined : { ...at, time: event.timeStamp };
    if (isSecond) this.#does.finish();
    else this.#does.click(at);
  }

  // ---- points that are there already

  #take(event) {
    const node = event.target.closest?.('.handle, .label');
    if (!node || event.button !== 0 || !event.isPrimary) return;
    event.preventDefault();
    this.#canvas.focus({ preventScroll: true, focusVisible: false });
    const { measure, index } = node.dataset;
    const isHandle = index !== undefined;
    if (!Number.isFinite(Number(measure))) return;
    event.currentTarget.setPointerCapture(event.pointerId);
    this.#dragged = {
      isHandle, id: Number(measure), index: isHandle ? Number(index) : undefined, isNew: node.classList.contains('middle'), start: this.#cursorOf(event), moved: false,
    };
  }

  #drag(event) {
    const dragged = this.#dragged;
    if (!dragged) return;
    const cursor = this.#cursorOf(event);
    const reach = still[event.pointerType] ?? still.mouse;
    dragged.moved ||= Math.hypot(cursor.x - dragged.start.x, cursor.y - dragged.start.y) > reach;
    if (dragged.moved && dragged.isHandle) this.#does.drag({ ...dragged, cursor });
  }

  #drop(event) {
    const dragged = this.#dragged;
    this.#dragged = undefined;
    if (!dragged) return;
    if (dragged.moved && dragged.isHandle) this.#does.drop({ ...dragged, cursor: this.#cursorOf(event) });
    else if (!dragged.moved) this.#does.select(dragged.id, dragged.isNew ? undefined : dragged.index);
  }

  #give() {
    if (this.#dragged) this.#does.let();
    this.#dragged = undefined;
  }

  // ---- keys

  #key(event) {
    if (!this.#does.isActive || event.isComposing) return;
    if (event.key === 'Escape' && this.#dragged) {
      this.#give();
      event.preventDefault();
      return;
    }
    const isUndo = (event.ctrlKey || event.metaKey) && !event.altKey && ['z', 'y'].includes(event.key.toLowerCase());
    const inField = event.target instanceof Element && event.target.closest('input:not([type=checkbox], [type=radio]), textarea, dialog');
    const isOurs = isUndo ? !inField : isForView(event);
    if (!isOurs || document.querySelector('dialog[open]')) return;
    const name = isUndo ? (event.key.toLowerCase() === 'y' || event.shiftKey ? 'redo' : 'undo') : event.key;
    if (!this.#does.key(name, event)) return;
    event.preventDefault();
    event.stopImmediatePropagation();
  }
}
