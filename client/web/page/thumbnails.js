// Small pictures of what a choice would look like: asked of the server on demand, one at a time, and given up as soon as the
// camera moves, so that they never take the device's time from whoever looks around. A server that has too much to do, or that
// draws none, leaves a gallery with names only.

import { snapshotUrl } from '../protocol/view_words.js';

const size = { width: 216, height: 144 };
const mostKept = 256; // more than a gallery with all saved views has
const restMs = 500; // after the last movement
const quality = 75;
const leastPart = 0.14; // of the height; less would show nothing that one knows again

/**
 * A camera, as the protocol has it, that sees only the middle of what this one sees, so that a small picture shows points as large
 * as they are in one of that height: what tells methods from each other is lost in a picture of everything. Pure.
 */
export function middleOf(camera, height) {
  const part = Math.min(1, Math.max(leastPart, size.height / height));
  if (camera.type === 'orthographic') return { ...camera, viewHeight: camera.viewHeight * part };
  const half = (camera.fov * Math.PI) / 360;
  return { ...camera, fov: (Math.atan(Math.tan(half) * part) * 360) / Math.PI };
}

/** The address of a small picture of this view. Pure. */
export const thumbnailUrl = (cloud, view) => snapshotUrl(cloud, { ...view, quality, detail: null }, size.width, size.height, 'jpg');

export class Thumbnails {
  #server;
  #kept = new Map(); // key → blob: address, the one that was used last at the end
  #queue = []; // [{ url, key, show }] that somebody still wants to see
  #loading; // AbortController of the one that is on its way
  #rest;
  #still = true;

  constructor(server) {
    this.#server = server;
  }

  /**
   * The pictures of a gallery that is open: [{ url, key, show(address) }], first things first; those of before are wanted no more. What has
   * the same key is the same picture.
   */
  want(pictures) {
    this.#giveUp();
    this.#queue = [];
    for (const picture of pictures) {
      const known = this.#kept.get(picture.key);
      if (known === undefined) this.#queue.push(picture);
      else {
        this.#kept.delete(picture.key);
        this.#kept.set(picture.key, known);
        picture.show(known);
      }
    }
    if (this.#still) this.#next();
  }

  /** The gallery has been closed. */
  forget() {
    this.want([]);
  }

  /** The camera has moved: `again()` is called when it has come to rest, for what is to be seen then. */
  moved(again) {
    this.#still = false;
    this.#giveUp();
    clearTimeout(this.#rest);
    this.#rest = setTimeout(() => {
      this.#still = true;
      again();
    }, restMs);
  }

  #giveUp() {
    this.#loading?.abort();
    this.#loading = undefined;
  }

  async #next() {
    if (this.#loading || this.#queue.length === 0) return;
    const { url, key, show } = this.#queue[0];
    const loading = new AbortController();
    this.#loading = loading;
    try {
      const response = await this.#server.fetch(url, { signal: loading.signal, cache: 'default' });
      // Busy, or refused: the names have to do until the gallery is opened again.
      if (!response.ok) this.#queue = [];
      else {
        const blob = await response.blob();
        if (loading !== this.#loading) return;
        const address = URL.createObjectURL(blob);
        this.#keep(key, address);
        show(address);
        this.#queue.shift();
      }
    } catch {
      if (loading !== this.#loading) return; // given up, and perhaps another one is on its way
      this.#queue = [];
    }
    this.#loading = undefined;
    if (this.#still) this.#next();
  }

  #keep(key, address) {
    this.#kept.set(key, address);
    if (this.#kept.size <= mostKept) return;
    const [oldest, old] = this.#kept.entries().next().value;
    this.#kept.delete(oldest);
    URL.revokeObjectURL(old);
  }
}
