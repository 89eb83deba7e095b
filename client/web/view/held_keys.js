// Keys that are held, and what they do to the camera as time goes by: walk or fly, turn about the middle of the picture,
// move that, come nearer to it. Everything a mouse can do they can do.

import { anchorUnder } from './anchor.js';
import { look, move } from './camera.js';
import { Grip, zoomed } from './grip.js';
import { reachAhead, walk } from './ground.js';
import { noStep } from './inertia.js';
import { heldKeys, isForView, placeOf } from './keys.js';

const zoomRate = 1.6; // per second, natural logarithm
const turnRate = 0.55; // picture heights a second
const panRate = 0.6; // the same
const moveRate = 0.8; // of the way to what is ahead, a second
const hurry = 4;
const pace = { least: 1 / 16, most: 16, perPixel: 0.0025 };

export class HeldKeys {
  #held = new Set();
  #fresh = new Set(); // those that have done nothing yet
  #leaving = new Set(); // let go before they had
  #shift = false;
  #pace = 1;
  #anchor; // what is in the middle of the picture, since keys are held
  #grip;
  #gripKind;

  get areHeld() {
    return this.#held.size > 0;
  }

  get #walks() {
    return [...this.#held].some((place) => ['ahead', 'right', 'up'].some((way) => heldKeys[place][way] !== undefined));
  }

  /** Whether this key is one of those. */
  down(event) {
    this.#shift = event.shiftKey;
    const place = placeOf(event);
    if (!Object.hasOwn(heldKeys, place) || !isForView(event)) return false;
    if (!this.areHeld) this.let();
    if (!this.#held.has(place)) this.#fresh.add(place);
    this.#leaving.delete(place);
    this.#held.add(place);
    return true;
  }

  up(event) {
    this.#shift = event.shiftKey;
    if (event.key === 'Meta') this.clear(); // on a Mac, keys that were let go while it was held are never told of
    this.#letGo(placeOf(event));
    // Shift may have come or gone while + was held.
    if (event.code === 'Equal' || event.code === 'BracketRight') this.#letGo('Plus');
    if (event.code === 'Minus' || event.code === 'Slash') this.#letGo('Minus');
  }

  /** A short press moves something, too, however long a frame of the display takes. */
  #letGo(place) {
    if (this.#fresh.has(place)) this.#leaving.add(place);
    else this.#held.delete(place);
  }

  clear() {
    for (const places of [this.#held, this.#fresh, this.#leaving]) places.clear();
    this.let();
  }

  /** Lets go of what was in the middle: another camera has come from elsewhere. */
  let() {
    this.#anchor = this.#grip = this.#gripKind = undefined;
  }

  /** A wheel turned while somebody walks: faster or slower from now on. False where nobody walks. */
  changePace(pixels) {
    if (!this.#walks) return false;
    this.#pace = Math.min(pace.most, Math.max(pace.least, this.#pace * Math.exp(pixels * pace.perPixel)));
    return true;
  }

  /**
   * The camera after `seconds` more. `world` as for Grip; `known`: all pictures, also where nobody is to be stopped by them;
   * looksAround: arrows turn the head.
   */
  advance(camera, seconds, world) {
    const wanted = { ahead: 0, right: 0, up: 0, turn: 0, tilt: 0, zoom: 0 };
    for (const place of this.#held) {
      for (const [way, amount] of Object.entries(heldKeys[place])) wanted[way] += amount;
    }
    this.#fresh.clear();
    for (const place of this.#leaving) this.#held.delete(place);
    this.#leaving.clear();
    const time = Math.min(seconds, 0.1);
    let next = camera;
    if (wanted.ahead || wanted.right || wanted.up) next = this.#walk(next, wanted, time, world);
    if (wanted.turn || wanted.tilt) next = this.#turn(next, wanted, time, world);
    if (wanted.zoom) {
      next = zoomed(next, this.#middle(next, world), Math.exp(-wanted.zoom * zoomRate * time * (this.#shift ? hurry : 1)), world);
    }
    return next;
  }

  #walk(camera, wanted, time, world) {
    // Without perspective, nearer is larger.
    if (camera.projection === 'orthographic' && wanted.ahead) {
      return zoomed(camera, this.#middle(camera, world), Math.exp(-wanted.ahead * moveRate * this.#pace * time * (this.#shift ? hurry : 1)), world);
    }
    this.let(); // something else comes to the middle
    const step = reachAhead(world.known, camera, world.limits) * moveRate * this.#pace * time * (this.#shift ? hurry : 1);
    const steps = { ahead: wanted.ahead * step, right: wanted.right * step, up: wanted.up * step };
    return world.stops ? walk(world.pictures, camera, steps, world.limits) : move(camera, steps);
  }

  /** Arrows orbit as a drag in their direction would push the cloud; with Shift they move it. */
  #turn(camera, wanted, time, world) {
    const { size, looksAround } = world;
    const kind = this.#shift ? 'pan' : looksAround ? 'look' : 'orbit';
    const way = size.height * (kind === 'pan' ? panRate : turnRate) * time;
    if (kind === 'look') return look(camera, -wanted.turn * 2 * way, wanted.tilt * 2 * way, size);
    if (kind !== this.#gripKind) {
      this.#grip = new Grip(kind, this.#middle(camera, world), { x: size.width / 2, y: size.height / 2 });
      this.#gripKind = kind;
    }
    if (kind === 'pan') this.#anchor = undefined;
    return this.#grip.move(camera, { ...noStep(), x: -wanted.turn * way, y: wanted.tilt * way }, world);
  }

  #middle(camera, { size, known, limits }) {
    const cursor = { x: size.width / 2, y: size.height / 2 };
    this.#anchor ??= anchorUnder(known[0], camera, cursor, size, limits.bounds);
    return this.#anchor;
  }
}
