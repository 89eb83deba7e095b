// What is drawn onto the scan, click by click: a measure, a profile's line. Each point is the scan's own, which the server finds a moment after the click.

import { measure as words } from '../page/strings/measure.js';
import { stepOf } from './hand.js';
import { pickOr } from './picking.js';

export class Drawing {
  #viewer;
  #page;
  #does;
  #draft;

  /**
   * `page`: { overlays, reading }; `does`: begin(), the Draft of something new, or nothing where that cannot be; found(picked point, its index);
   * made(measure), which returns whether it is one; show(), after each change.
   */
  constructor(viewer, page, does) {
    this.#viewer = viewer;
    this.#page = page;
    this.#does = does;
  }

  /** Undefined while nothing is being drawn. */
  get draft() { return this.#draft; }

  /** For who places points by keys. */
  get middle() {
    const { width, height } = this.#viewer.cssSize;
    return { x: width / 2, y: height / 2 };
  }

  /** The next point, at the cursor. */
  async place(cursor) {
    const draft = this.#draft ?? this.#does.begin();
    if (!draft?.takesMore) return;
    this.#draft = draft;
    const place = draft.add(this.#viewer.surfaceAt(cursor)?.point);
    this.#does.show();
    const found = await pickOr(this.#viewer, this.#page.overlays, cursor);
    if (draft !== this.#draft || !draft.places.includes(place)) return; // given up meanwhile
    draft.settle(place, found);
    if (found) {
      this.#page.reading.coordinates.exact(found.position, stepOf(found), cursor, found.cloud);
      this.#does.found?.(found, draft.places.indexOf(place));
    }
    this.#settled();
  }

  /** The next point is that one, as the protocol has it. */
  add(found) {
    if (!this.#draft?.takesMore) return;
    this.#draft.settle(this.#draft.add(found.position), found);
    this.#settled();
  }

  /** It has all its points, or lacks some, which is said. */
  finish() {
    const draft = this.#draft;
    if (!draft) return;
    if (draft.lacks > 0) {
      this.#page.overlays.toast(words.messages.tooFew(draft.lacks), '', 'done');
      return;
    }
    draft.closing = true;
    this.#settled();
  }

  takeBack() {
    this.#draft?.removeLast();
    if (this.#draft?.places.length === 0) this.#draft = undefined;
    this.#does.show();
  }

  cancel() {
    this.#draft = undefined;
    this.#does.show();
  }

  /** { points, pending } of what is being drawn, the place under the cursor as its next point; undefined where nothing is. */
  get shown() {
    if (!this.#draft) return undefined;
    const placed = this.#draft.places.filter(({ at }) => at);
    const { cursor } = this.#page.reading;
    const under = this.#draft.takesMore && cursor ? this.#viewer.surfaceAt(cursor)?.point : undefined;
    return { points: [...placed.map(({ at }) => at), ...(under ? [under] : [])], pending: [...placed.map(({ pending }) => pending), true] };
  }

  #settled() {
    const draft = this.#draft;
    if (draft.places.length === 0) this.#draft = undefined;
    const { measure } = draft;
    if (measure) this.#draft = undefined;
    if (measure ? !this.#does.made(measure) : draft.closing && !draft.isPending) {
      draft.closing = false; // a point was clicked twice: more are needed
      this.#draft = draft;
    }
    this.#does.show();
  }
}
