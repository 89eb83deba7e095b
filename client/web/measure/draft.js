// A measure that is being made: points that were clicked, some of which the server is still looking for. Plain logic.

import { stepOf } from './hand.js';
import { kinds } from './values.js';

export class Draft {
  kind;
  up;
  option; // how the server is to compute it
  /** { at, step, more, pending }: `at` undefined while nobody knows it. */
  places = /** @type {{ at: number[], step: number, more: any, pending: boolean }[]} */ ([]);
  /** No more points are wanted; it is a measure as soon as all of them are found. */
  closing = false;

  constructor(kind, up, option = undefined) {
    this.option = option;
    this.kind = kind;
    this.up = up;
  }

  get points() { return this.places.filter(({ at }) => at).map(({ at }) => at); }
  get isPending() { return this.places.some(({ pending }) => pending); }
  /** How many points are still to be placed at least. */
  get lacks() { return Math.max(0, kinds[this.kind].least - this.places.length); }
  get takesMore() { return !this.closing && this.places.length < kinds[this.kind].most; }

  /** `at`: about where, if that is known. Returns the place, to be settled. */
  add(at) {
    const place = { at, step: 0, more: undefined, pending: true };
    this.places.push(place);
    this.closing = this.places.length === kinds[this.kind].most;
    return place;
  }

  /** The point that was found for it; nothing where there is none. */
  settle(place, found) {
    place.pending = false;
    if (!found) {
      this.places = this.places.filter((one) => one !== place);
      this.closing = false;
      return;
    }
    place.at = found.position;
    place.step = stepOf(found);
    place.more = moreOf(found);
  }

  removeLast() {
    this.places.pop();
    this.closing = false;
  }

  /** A measure without its name, where all is found and enough; a point that was clicked twice counts once. */
  get measure() {
    if (!this.closing || this.isPending) return undefined;
    const places = this.places.filter(({ at }, i) => i === 0 || at.some((value, axis) => value !== this.places[i - 1].at[axis]));
    const { least } = kinds[this.kind];
    if (places.length < least) return undefined;
    return {
      kind: this.kind, up: this.up, visible: true, points: places.map(({ at }) => at), step: Math.max(...places.map(({ step }) => step)),
      ...(this.option === undefined ? {} : { option: this.option }),
      ...(this.kind === 'point' ? { more: places[0].more } : {}),
    };
  }
}

/** What the scan says of a picked point itself, and not of the picture it was picked in. */
export const moreOf = ({ position, precision, depth, distance, crs, attributes, ...more }) => ({ ...more, ...attributes });
