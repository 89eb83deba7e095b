// Mouse, touch and keyboard to camera. Holds no camera of its own: it asks for the one there is and hands over the
// next. What the keys do is in `keyTable`, which the help shows too.

import { look, move, orbit, pan, zoom } from './camera.js';

const wheelRate = 0.0015; // natural logarithm of the factor, per pixel of wheel
const keyZoomRate = 1.6; // per second, natural logarithm
const keyTurnRate = 0.55; // picture heights a second
const keyMoveRate = 0.8; // target distances a second
const hurry = 4;

/** Keys that act while they are held, by their place on the keyboard, whatever letter stands there - but for + and -. */
const heldKeys = {
  KeyW: { ahead: 1 }, KeyS: { ahead: -1 },
  KeyA: { right: -1 }, KeyD: { right: 1 },
  KeyE: { up: 1 }, KeyQ: { up: -1 },
  PageUp: { up: 1 }, PageDown: { up: -1 },
  ArrowLeft: { turn: -1 }, ArrowRight: { turn: 1 },
  ArrowUp: { tilt: 1 }, ArrowDown: { tilt: -1 },
  Plus: { zoom: 1 }, Minus: { zoom: -1 },
};

/** For the help. */
export const keyTable = [
  ['W A S D', 'walk'],
  ['Q E', 'down and up'],
  ['← → ↑ ↓', 'turn'],
  ['+ −', 'zoom'],
  ['Shift', 'faster'],
  ['F', 'fit everything'],
  ['1 2 3', 'from top, front, side'],
  ['L', 'drag to look around, or to orbit'],
  ['O', 'with or without perspective'],
  ['P', 'settings'],
  ['?', 'this help'],
];

const signs = { '+': 'Plus', '=': 'Plus', '-': 'Minus', '−': 'Minus' };
const placeOf = (event) => signs[event.key] ?? event.code;

const isTyping = (target) => target instanceof Element && target.closest('input, select, textarea, dialog') !== null;

/** Wheels count in pixels, lines or pages; a notch is about 100 pixels everywhere. */
export function wheelPixels(event, pageHeight) {
  const unit = event.deltaMode === 1 ? 33 : event.deltaMode === 2 ? pageHeight : 1;
  const pixels = event.deltaY * unit * (event.ctrlKey ? 6 : 1); // pinching a touch pad sends ctrl and small numbers
  return Math.min(400, Math.max(-400, pixels));
}

export class CameraInput {
  #element;
  #view;
  #pointers = new Map();
  #held = new Set();
  #hurried = false;

  /**
   * `view` has: camera (undefined while there is nothing to steer), size in CSS pixels, closest (distance below which
   * zooming moves on instead), looksAround; changeCamera(camera), goTo(camera) for a jump worth animating, and wake()
   * when a key starts to be held.
   */
  constructor(element, view) {
    this.#element = element;
    this.#view = view;
    const on = (name, handle, options) => element.addEventListener(name, handle.bind(this), options);
    on('pointerdown', this.#down);
    on('pointermove', this.#moved);
    on('pointerup', this.#up);
    on('pointercancel', this.#up);
    on('lostpointercapture', this.#up);
    on('wheel', this.#wheel, { passive: false });
    on('dblclick', this.#doubleClick);
    on('contextmenu', (event) => event.preventDefault());
    addEventListener('keydown', (event) => this.#key(event, true));
    addEventListener('keyup', (event) => this.#key(event, false));
    addEventListener('blur', () => this.#held.clear());
  }

  get keysAreHeld() {
    return this.#held.size > 0;
  }

  get isDragging() {
    return this.#pointers.size > 0;
  }

  #cursor(event) {
    const box = this.#element.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  }

  #down(event) {
    if (!this.#view.camera || this.#pointers.size >= 2) return;
    event.preventDefault(); // no text selection, no auto-scroll with the middle button
    this.#element.focus({ preventScroll: true, focusVisible: false });
    this.#element.setPointerCapture(event.pointerId);
    const sideways = event.button === 2 || event.button === 1 || event.shiftKey;
    this.#pointers.set(event.pointerId, { ...this.#cursor(event), sideways });
    this.#element.classList.add('grabbed');
  }

  #up(event) {
    this.#pointers.delete(event.pointerId);
    if (this.#pointers.size === 0) this.#element.classList.remove('grabbed');
  }

  #moved(event) {
    const before = this.#pointers.get(event.pointerId);
    const { camera, size } = this.#view;
    if (!before || !camera) return;
    const now = { ...before, ...this.#cursor(event) };
    if (this.#pointers.size === 2) {
      this.#pinch(event.pointerId, before, now);
    } else {
      const dx = now.x - before.x;
      const dy = now.y - before.y;
      if (before.sideways) this.#view.changeCamera(pan(camera, before, now, size));
      else if (this.#view.looksAround) this.#view.changeCamera(look(camera, dx, dy, size));
      else this.#view.changeCamera(orbit(camera, dx, dy, size));
    }
    this.#pointers.set(event.pointerId, now);
  }

  /** Two fingers: the point between them moves along, and their distance is the size. */
  #pinch(id, before, now) {
    const [other] = [...this.#pointers].filter(([key]) => key !== id).map(([, pointer]) => pointer);
    const between = (a) => ({ x: (a.x + other.x) / 2, y: (a.y + other.y) / 2 });
    const apart = (a) => Math.max(10, Math.hypot(a.x - other.x, a.y - other.y));
    const { camera, size, closest } = this.#view;
    const moved = pan(camera, between(before), between(now), size);
    this.#view.changeCamera(zoom(moved, apart(before) / apart(now), between(now), size, closest));
  }

  #wheel(event) {
    event.preventDefault(); // the page itself neither scrolls nor zooms
    const { camera, size, closest } = this.#view;
    if (!camera) return;
    const factor = Math.exp(wheelPixels(event, size.height) * wheelRate);
    this.#view.changeCamera(zoom(camera, factor, this.#cursor(event), size, closest));
  }

  #doubleClick(event) {
    const { camera, size, closest } = this.#view;
    if (camera) this.#view.goTo(zoom(camera, event.shiftKey ? 2.5 : 0.4, this.#cursor(event), size, closest));
  }

  #key(event, pressed) {
    this.#hurried = event.shiftKey;
    const place = placeOf(event);
    if (!pressed) {
      this.#held.delete(place);
      return;
    }
    if (!Object.hasOwn(heldKeys, place) || isTyping(event.target)) return;
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    this.#held.add(place);
    this.#view.wake();
  }

  /** The camera after `seconds` more of the keys that are held. */
  advance(camera, seconds) {
    const wanted = { ahead: 0, right: 0, up: 0, turn: 0, tilt: 0, zoom: 0 };
    for (const code of this.#held) {
      for (const [way, amount] of Object.entries(heldKeys[code])) wanted[way] += amount;
    }
    const { size, closest, looksAround } = this.#view;
    const pace = Math.min(seconds, 0.1) * (this.#hurried ? hurry : 1);
    const step = Math.max(camera.distance, closest) * keyMoveRate * pace;
    const turn = size.height * keyTurnRate * pace;
    let next = move(camera, { ahead: wanted.ahead * step, right: wanted.right * step, up: wanted.up * step });
    if (wanted.turn || wanted.tilt) {
      next = looksAround
        ? look(next, -wanted.turn * 2 * turn, wanted.tilt * 2 * turn, size)
        : orbit(next, -wanted.turn * turn, wanted.tilt * turn, size);
    }
    if (wanted.zoom) {
      const middle = { x: size.width / 2, y: size.height / 2 };
      next = zoom(next, Math.exp(-wanted.zoom * keyZoomRate * pace), middle, size, closest);
    }
    return next;
  }
}
