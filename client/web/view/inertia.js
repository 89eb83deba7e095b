// What a hand leaves behind when it lets go: how fast it was, and how that dies away. Pure.
//
// A step is { x, y, zoom, twist }: pixels, the natural logarithm of a size, radians.

const memoryMs = 80; // what the hand did longer ago says nothing about its speed
const stillMs = 50; // it has rested before it let go
const fadeMs = 75;
const glideMs = 300; // then it stands
const fastest = { x: 3, y: 3, zoom: 0.006, twist: 0.006 }; // per millisecond
const slowest = 0.03; // px per millisecond; a shape of 500 px for the rest

const keys = ['x', 'y', 'zoom', 'twist'];
const clamp = (value, most) => Math.min(most, Math.max(-most, value));

export const noStep = () => ({ x: 0, y: 0, zoom: 0, twist: 0 });

/** The steps of a hand, from which its speed follows. */
export class Momentum {
  #steps = [];

  add(step, now) {
    this.#steps.push({ step, now });
    while (this.#steps.length > 0 && now - this.#steps[0].now > memoryMs) this.#steps.shift();
  }

  /** Per millisecond, when it lets go at `now`; undefined when it stood still. */
  speed(now) {
    const last = this.#steps.at(-1);
    if (!last || now - last.now > stillMs) return undefined;
    const span = Math.max(16, now - this.#steps[0].now);
    const speed = noStep();
    for (const { step } of this.#steps) for (const key of keys) speed[key] += (step[key] ?? 0) / span;
    for (const key of keys) speed[key] = clamp(speed[key], fastest[key]);
    return Math.hypot(speed.x, speed.y, 500 * speed.zoom, 500 * speed.twist) > slowest ? speed : undefined;
  }
}

/** The step between two times, in milliseconds since the hand let go. */
export function glide(speed, from, to) {
  const end = Math.min(to, glideMs);
  const share = from < end ? fadeMs * (Math.exp(-from / fadeMs) - Math.exp(-end / fadeMs)) : 0;
  return Object.fromEntries(keys.map((key) => [key, speed[key] * share]));
}

export const glideEnds = (since) => since >= glideMs;
