// Whose the hand on the picture is: a tool's that has taken it (measuring, the line of a profile); else a reader's, who is told the
// coordinates under the cursor, and of a click the exact ones.

import { Coordinates } from './coordinates.js';
import { Hand, stepOf } from './hand.js';

/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);
const clickMs = 320; // a second click makes it a double one, which flies there

export class Reading {
  #viewer;
  #tool; // that has the hand, or nobody
  #click;
  coordinates;
  hand;

  constructor(viewer) {
    this.#viewer = viewer;
    this.coordinates = new Coordinates(find('coordinates'), viewer);
    const reading = this;
    const tool = () => this.#tool;
    this.hand = new Hand(find('picture'), find('marks'), {
      get isActive() { return reading.#tool !== undefined; },
      click: (cursor) => (tool() ? tool().click(cursor) : this.#readSoon(cursor)),
      finish: () => {
        clearTimeout(this.#click);
        tool()?.finish();
      },
      hover: (cursor) => {
        const surface = cursor && viewer.surfaceAt(cursor);
        this.coordinates.about(surface, cursor);
        tool()?.hover(surface);
      },
      drag: (dragged) => tool()?.drag(dragged),
      drop: (dragged) => tool()?.drop(dragged),
      let: () => tool()?.let(),
      select: (id, index) => tool()?.select(id, index),
      key: (name) => tool()?.key(name) ?? false,
    });
  }

  get cursor() { return this.hand.cursor; }

  /** From now on the hand is `tool`'s, which has click(), finish(), … as Hand tells them, but hover(surface). */
  take(tool) {
    clearTimeout(this.#click);
    this.#tool = tool;
  }

  /** It was that tool's, if it still is. */
  give(tool) {
    if (this.#tool === tool) this.#tool = undefined;
  }

  /** Of a click that is no double-click: the exact coordinates. */
  #readSoon(cursor) {
    clearTimeout(this.#click);
    this.#click = setTimeout(async () => {
      const found = await this.#viewer.pickAt(cursor).catch(() => undefined);
      if (found && !this.#tool) this.coordinates.exact(found.position, stepOf(found), cursor, found.cloud);
    }, clickMs);
  }
}
