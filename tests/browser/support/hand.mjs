// Measures how firmly the hand holds what it has taken: a page of a real server, driven by a mouse, and the server's own
// pick for the truth - the surface under a pixel, from the pictures' full depth.

import { fromProtocol, pointUnderCursor, project } from '../../../client/web/view/camera.js';
import { openPage, waitUntilSharp } from './browser.mjs';
import { Wire } from './wire.mjs';

export const size = { width: 960, height: 600 };

export class HandPage {
  #url;

  /** `server` answers picks, `url` is the page's address: the same, or a proxy's before it. */
  static async open(browser, url, server = url, hash = '', options = {}) {
    const one = new HandPage();
    one.#url = server;
    one.page = await openPage(browser, 'about:blank', { viewport: size, ...options });
    one.wire = new Wire(one.page);
    await one.page.goto(url + hash);
    await waitUntilSharp(one.page, 60_000);
    return one;
  }

  close() {
    return this.page.context().close();
  }

  get camera() {
    return fromProtocol(this.wire.view.camera);
  }

  /** Once nothing moves any more, and the last picture is there. */
  async settle() {
    await this.page.waitForTimeout(450);
    await waitUntilSharp(this.page, 60_000);
  }

  /** Another view, by the address, as a link would bring it. `camera`: eye and target. */
  async look({ eye, target, fov = 45 }) {
    const words = `#cloud=${this.wire.view.cloud}&eye=${eye.join()}&target=${target.join()}&up=0,0,1&projection=perspective&fov=${fov}`;
    await this.page.evaluate((hash) => { location.hash = hash; }, words);
    await this.settle();
  }

  /** The true point under a cursor, undefined for the background; by the server. */
  async truth({ x, y }) {
    const { cloud, view } = { cloud: this.wire.view.cloud, view: this.wire.view };
    const { type, seq, frame, pixelRatio, resume, depth, codecs, cloud: _, ...rest } = view;
    const response = await fetch(`${this.#url}api/v1/clouds/${cloud}/pick`, {
      method: 'POST', headers: { 'Content-Type': 'application/json' }, body: JSON.stringify({ view: rest, x, y }),
    });
    if (!response.ok) throw new Error(`pick: ${response.status} ${await response.text()}`);
    const picked = await response.json();
    return picked ? pointUnderCursor(this.camera, { x, y }, size, picked.depth) : undefined;
  }

  /** CSS pixels from where the point is now to where it should be. */
  offBy(point, { x, y }) {
    const seen = project(this.camera, point, size);
    return seen ? Math.hypot(seen.x - x, seen.y - y) : Infinity;
  }

  async drag(from, to, button) {
    const { mouse } = this.page;
    await mouse.move(from.x, from.y);
    await mouse.down({ button });
    await mouse.move(to.x, to.y, { steps: 12 });
    await this.page.waitForTimeout(90);
    await mouse.up({ button });
    await this.settle();
  }

  async notches(cursor, count, delta = -100) {
    await this.page.mouse.move(cursor.x, cursor.y);
    for (let i = 0; i < count; ++i) {
      await this.page.mouse.wheel(0, delta);
      await this.page.waitForTimeout(50);
    }
    await this.settle();
  }

  async hold(key, milliseconds) {
    await this.page.keyboard.down(key);
    await this.page.waitForTimeout(milliseconds);
    await this.page.keyboard.up(key);
    await this.settle();
  }

  /** Pixels by which the surface at `cursor` is off after a pan, an orbit and five notches, each from the view that there is. */
  async errors(cursor) {
    const to = { x: cursor.x + (cursor.x < size.width / 2 ? 170 : -170), y: cursor.y + (cursor.y < size.height / 2 ? 90 : -90) };
    const view = this.wire.view.camera;
    const found = {};
    const each = { pan: () => this.drag(cursor, to, 'right'), orbit: () => this.drag(cursor, to, 'left'), zoom: () => this.notches(cursor, 5) };
    for (const [name, act] of Object.entries(each)) {
      await this.look(view);
      const point = await this.truth(cursor);
      if (!point) return undefined;
      await act();
      found[name] = this.offBy(point, name === 'pan' ? to : cursor);
    }
    return found;
  }
}
