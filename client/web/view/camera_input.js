// Mouse, pen, touch and keyboard to camera. Holds no camera of its own: it asks for the one there is and hands over the
// next. What is held while it moves is grip.js's, keys that are held are held_keys.js's.

import { anchorUnder } from './anchor.js';
import { eyeOf } from './camera.js';
import { Fingers } from './fingers.js';
import { Grip, zoomed } from './grip.js';
import { HeldKeys } from './held_keys.js';
import { glide, glideEnds, Momentum, noStep } from './inertia.js';
import { centerAhead, centerOn, focusOn } from './moves.js';
import { isSeenFree } from './seen.js';

const wheelRate = 0.002; // natural logarithm of the factor, per pixel of wheel
const wheelFadeMs = 45; // in which two thirds of a notch are done
const wheelRestMs = 500; // as long as this one comes nearer to the same point
const wheelSlack = 6; // px that the cursor may move meanwhile

/** Wheels count in pixels, lines or pages; a notch is about 100 pixels everywhere. */
export function wheelPixels(event, pageHeight, delta = event.deltaY) {
  const unit = event.deltaMode === 1 ? 33 : event.deltaMode === 2 ? pageHeight : 1;
  const pixels = delta * unit * (event.ctrlKey ? 6 : 1); // pinching a touch pad sends ctrl and small numbers
  return Math.min(400, Math.max(-400, pixels));
}

export class CameraInput {
  #element;
  #view;
  #fingers = new Fingers();
  #grip; // what they hold, until nothing moves any more
  #resting = false; // fingers that are left of more, and wait for the last one to be lifted
  #momentum;
  #glide; // { speed, start, done } when they have let go
  #wheel; // { anchor, cursor, time, left }: the point that notches lead to, and what of them is still to be done
  #keys = new HeldKeys();

  /**
   * `view` has: camera (undefined while there is nothing to steer), size in CSS pixels, pictures (what they have seen of the
   * surface, the newest first), limits (as for Grip), looksAround, collides, calm (whoever wants no motion);
   * changeCamera(camera), goTo(camera) for a jump worth animating, and wake() when something begins to move by itself.
   * `keys`: whose key events count.
   */
  constructor(element, view, /** @type {EventTarget} */ keys = globalThis) {
    this.#element = element;
    this.#view = view;
    const on = (name, handle, options) => element.addEventListener(name, handle.bind(this), options);
    on('pointerdown', this.#down);
    on('pointermove', this.#moved);
    for (const name of ['pointerup', 'pointercancel', 'lostpointercapture']) on(name, this.#up);
    on('wheel', this.#wheeled, { passive: false });
    on('dblclick', this.#doubleClick);
    on('contextmenu', (event) => this.#view.camera && event.preventDefault());
    keys.addEventListener('keydown', (event) => {
      if (!this.#view.camera || !this.#keys.down(event)) return;
      event.preventDefault(); // a menu would go to its next entry of that letter
      this.#wheel = this.#glide = undefined;
      this.#view.wake();
    });
    keys.addEventListener('keyup', (event) => this.#keys.up(event));
    for (const one of new Set([keys, globalThis])) one.addEventListener('blur', () => this.#keys.clear());
  }

  /** Whether a hand is on it. */
  get isHeld() {
    return this.#fingers.count > 0;
  }

  /** Whether advance() has something to do. */
  get isMoving() {
    return this.#keys.areHeld || this.#glide !== undefined || Math.abs(this.#wheel?.left ?? 0) > 0;
  }

  /** The camera after `seconds` more of what is going on by itself: keys that are held, and what hand and wheel left behind. */
  advance(camera, seconds, now = performance.now()) {
    let next = camera;
    if (this.#wheel && Math.abs(this.#wheel.left) > 0) next = this.#wheelOn(next, seconds * 1000);
    if (this.#glide) next = this.#glideOn(next, now);
    const { pictures, collides, looksAround } = this.#view;
    if (this.#keys.areHeld) next = this.#keys.advance(next, seconds, { ...this.#world(), known: pictures, stops: collides, looksAround });
    return next;
  }

  /** Somebody else moves the camera now. */
  rest() {
    this.#glide = this.#wheel = undefined;
    this.#keys.let();
    if (this.#fingers.count === 0) this.#grip = undefined;
  }

  #world() {
    const { size, pictures, limits, collides } = this.#view;
    return collides ? { size, limits, pictures } : { size, limits: { ...limits, hasGround: false }, pictures: [] };
  }

  #anchorAt(cursor) {
    const { camera, size, pictures, limits } = this.#view;
    return anchorUnder(pictures[0], camera, cursor, size, limits.bounds);
  }

  #cursor(event) {
    const box = this.#element.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  }

  // ---- mouse, pen and fingers

  #down(event) {
    if (!this.#view.camera) return;
    event.preventDefault(); // no text selection, no auto-scroll with the middle button
    this.rest();
    if (!this.#fingers.down(event.pointerId, this.#cursor(event))) return;
    this.#element.focus({ preventScroll: true, focusVisible: false });
    this.#element.setPointerCapture(event.pointerId);
    this.#element.classList.add('grabbed');
    this.#resting = false;
    const sideways = event.button === 1 || event.button === 2 || (event.buttons & 2) !== 0 || event.shiftKey;
    this.#take(sideways);
  }

  #take(sideways) {
    const { count, middle } = this.#fingers;
    const kind = count === 3 ? 'look' : count === 2 ? 'pinch' : sideways ? 'pan' : this.#view.looksAround ? 'look' : 'orbit';
    const anchor = this.#anchorAt(middle);
    // Who drags the background means what is in the middle.
    if (kind === 'orbit' && anchor.of === 'plane') anchor.point = this.#view.camera.target;
    this.#grip = new Grip(kind, anchor, middle);
    this.#momentum = new Momentum();
  }

  #moved(event) {
    const { camera } = this.#view;
    const step = this.#fingers.move(event.pointerId, this.#cursor(event));
    if (!step || !camera || !this.#grip || this.#resting) return;
    this.#momentum.add(step, event.timeStamp);
    this.#view.changeCamera(this.#grip.move(camera, step, this.#world()));
  }

  #up(event) {
    if (!this.#fingers.up(event.pointerId)) return;
    const speed = this.#resting ? undefined : this.#momentum?.speed(event.timeStamp);
    this.#resting = this.#fingers.count > 0; // one finger of two is not somebody who wants to orbit
    if (speed && !this.#view.calm && event.type === 'pointerup') {
      this.#glide = { speed, start: performance.now(), done: 0 };
      this.#view.wake();
    }
    if (this.#fingers.count === 0) this.#element.classList.remove('grabbed');
  }

  #glideOn(camera, now) {
    const { speed, start, done } = this.#glide;
    const since = Math.max(0, now - start);
    this.#glide = glideEnds(since) ? undefined : { speed, start, done: since };
    return this.#grip ? this.#grip.move(camera, glide(speed, done, since), this.#world()) : camera;
  }

  // ---- wheel and touch pad

  #wheeled(event) {
    const { camera, size, calm } = this.#view;
    if (!camera) return;
    event.preventDefault(); // the page itself neither scrolls nor zooms
    const pixels = wheelPixels(event, size.height);
    const sideways = wheelPixels(event, size.width, event.deltaX);
    if (this.#keys.changePace(-pixels)) return;
    this.#glide = undefined;
    if (!event.ctrlKey && (event.shiftKey || Math.abs(sideways) > Math.abs(pixels))) {
      this.#scroll(sideways, pixels, event);
      return;
    }
    const series = this.#wheelSeries(event);
    series.left += pixels * wheelRate;
    if (calm) this.#view.changeCamera(this.#wheelOn(camera, Infinity));
    this.#view.wake();
  }

  /** The point that this notch leads to: that of the last one, unless the cursor has gone on or a pause was made. */
  #wheelSeries(event) {
    const cursor = this.#cursor(event);
    const series = this.#wheel;
    const goesOn = series && !series.scrolls && event.timeStamp - series.time < wheelRestMs &&
      Math.hypot(series.cursor.x - cursor.x, series.cursor.y - cursor.y) <= wheelSlack;
    if (goesOn) series.time = event.timeStamp;
    else this.#wheel = { anchor: this.#anchorAt(cursor), cursor, time: event.timeStamp, left: 0 };
    return this.#wheel;
  }

  /** Two fingers on a touch pad, to the side, or a wheel with Shift: moves the picture. */
  #scroll(sideways, pixels, event) {
    const { camera } = this.#view;
    const cursor = this.#cursor(event);
    if (!this.#wheel?.scrolls || event.timeStamp - this.#wheel.time > wheelRestMs) {
      this.#wheel = { scrolls: new Grip('pan', this.#anchorAt(cursor), cursor), time: 0, left: 0 };
    }
    this.#wheel.time = event.timeStamp;
    const step = { ...noStep(), x: -sideways, y: event.shiftKey && sideways !== 0 ? 0 : -pixels };
    this.#view.changeCamera(this.#wheel.scrolls.move(camera, step, this.#world()));
  }

  #wheelOn(camera, milliseconds) {
    const series = this.#wheel;
    const share = Math.abs(series.left) < 2e-3 ? 1 : 1 - Math.exp(-milliseconds / wheelFadeMs);
    const step = series.left * share;
    series.left -= step;
    return zoomed(camera, series.anchor, Math.exp(step), this.#world());
  }

  // ---- jumps

  #doubleClick(event) {
    if (this.#view.camera) this.#jump(this.#cursor(event), event.shiftKey);
  }

  /** To the point there, stopping before it, or away from it. */
  #jump(cursor, away) {
    const { camera, pictures, limits } = this.#view;
    const anchor = this.#anchorAt(cursor);
    if (anchor.of === 'plane' && pictures[0] && !away) return; // there is nothing to go to
    const held = focusOn(camera, anchor.point);
    this.rest();
    if (away) {
      this.#view.goTo(zoomed(camera, anchor, 2.5, this.#world()));
      return;
    }
    const distance = Math.min(held.distance, Math.max(limits.least, held.distance * 0.4));
    const next = centerOn(held, anchor.point, distance);
    const orthographic = camera.projection === 'orthographic';
    const free = orthographic || !pictures[0] || isSeenFree(pictures[0], anchor.point, eyeOf(next));
    this.#view.goTo(free ? next : centerAhead(held, anchor.point, distance));
  }

  /** As a double-click in the middle. */
  goToMiddle(away = false) {
    const { camera, size } = this.#view;
    if (camera) this.#jump({ x: size.width / 2, y: size.height / 2 }, away);
  }
}
