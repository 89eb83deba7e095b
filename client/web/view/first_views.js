// The views that a cloud's look names, as the server fits them to a picture of the size that this canvas has free: it knows
// the cloud's outline, the page only its box. Asked for before a cloud is shown; who has none yet fits by the box.

import { farther, fromProtocol } from './camera.js';

const mostKept = 64;

const keyOf = (cloud, { width, height }) => `${cloud.id} ${cloud.revision} ${Math.round(width)}x${Math.round(height)}`;

export class FirstViews {
  #server;
  #kept = new Map(); // key → [{ name, inside, camera }, …], cameras as the protocol has them

  constructor(server) {
    this.#server = server;
  }

  /** Resolves when they are there, or are not to be had. */
  async load(cloud, free) {
    const key = keyOf(cloud, free);
    if (!cloud.look || this.#kept.has(key)) return;
    try {
      const views = await this.#server.views(cloud.id, { width: Math.round(free.width), height: Math.round(free.height) });
      if (this.#kept.size >= mostKept) this.#kept.clear();
      this.#kept.set(key, views.map(({ name, inside, view }) => ({ name, inside, camera: view?.camera })));
    } catch {
      // An older server, or one that is busy: what the list of clouds says is good enough.
    }
  }

  /** The best one for a canvas of `size` that is free in its middle, or undefined where it is not known. */
  first(cloud, size, free, upAxis) {
    const [view] = this.#kept.get(keyOf(cloud, free)) ?? [];
    const camera = view && fromProtocol(view.camera, upAxis);
    return camera && (view.inside ? camera : farther(camera, size.height / free.height));
  }
}
