// A Scancast server, as a page knows it: its address, who one is to it, and what it says over HTTP.

import { snapshotUrl } from '../protocol/view_words.js';
import { Access } from './access.js';
import { renewIn } from './guest.js';

const patienceMs = 10_000;
const mostPlaces = 1000; // that one question may have

/** An answer that is an error, in words that a person can read. */
export class ServerProblem extends Error {
  constructor(problem) {
    super(problem.detail || problem.title || 'The server could not do this.');
    this.title = problem.title ?? 'The server refused the request';
    this.status = problem.status ?? 0;
  }
}

/** The problem in a failed answer, whatever its body is. */
export async function problemOf(response) {
  let problem = {};
  try {
    problem = await response.json();
  } catch {
    // No JSON: a proxy's own page, or nothing at all.
  }
  return new ServerProblem({
    status: response.status,
    title: problem.title ?? `The server answered ${response.status}`,
    detail: problem.detail,
  });
}

const listOf = (value) => (Array.isArray(value) ? value : []);
const pathOf = (cloud) => `/api/v1/clouds/${encodeURIComponent(cloud)}`;

export class Server {
  access;
  #address;
  #renewal;

  /** `address`: of the server, such as https://scans.example.org/. Throws a TypeError for what is no address. */
  constructor(address = globalThis.location?.href) {
    this.#address = new URL('/', address);
    this.access = new Access(this.#address.origin);
  }

  get origin() {
    return this.#address.origin;
  }

  /** The WebSocket's. */
  get streamUrl() {
    const url = new URL('/api/v1/stream', this.#address);
    url.protocol = url.protocol === 'https:' ? 'wss:' : 'ws:';
    return url;
  }

  /** Any answer, errors as well. `path` begins with /api/; `options` as for fetch(). */
  fetch(path, { headers = {}, ...options } = {}) {
    return fetch(new URL(path, this.#address), { cache: 'no-cache', ...options, headers: { ...this.access.headers, ...headers } });
  }

  /** The same, but errors are thrown as ServerProblem. */
  async ask(path, options) {
    const response = await this.fetch(path, options);
    if (!response.ok) throw await problemOf(response);
    return response;
  }

  async #json(path) {
    return (await this.ask(path, { signal: AbortSignal.timeout(patienceMs) })).json();
  }

  /** { clouds, pending }: those that can be looked at, and those that are loading or failed. */
  async clouds() {
    const body = await this.#json('/api/v1/clouds');
    return { clouds: listOf(body.clouds), pending: listOf(body.pending) };
  }

  /** All that is known of one. */
  cloud(id) { return this.#json(pathOf(id)); }

  /** { methods, colors, colormaps, shadings, ramps }. */
  async methods() {
    const { methods, colors, colormaps, shadings, ramps = {} } = await this.#json('/api/v1/methods');
    return { methods: listOf(methods), colors: listOf(colors), colormaps: listOf(colormaps), shadings: listOf(shadings), ramps };
  }

  /** Views that show most of the cloud, the best first, complete and fitted to a picture of this size: [{ name, inside, view }]. */
  async views(cloud, { width, height }) {
    return listOf((await this.#json(`${pathOf(cloud)}/views?width=${width}&height=${height}`)).views);
  }

  /** Where the scanner stood, each with the view from there. */
  async stations(cloud) {
    return listOf((await this.#json(`${pathOf(cloud)}/stations`)).stations);
  }

  /** The photos that the scan brought along; those that say from where they were taken have a view, which fits a picture of this size. */
  async photos(cloud, { width, height }) {
    return listOf((await this.#json(`${pathOf(cloud)}/photos?width=${width}&height=${height}`)).photos);
  }

  /** A picture of a view in full quality, as a Blob. */
  async snapshot(cloud, view, { width, height }, { format = 'png', signal = undefined } = {}) {
    return (await this.ask(snapshotUrl(cloud, view, width, height, format), { signal, cache: 'default' })).blob();
  }

  /** The point of the scan that a pixel of that view's picture shows, or null. */
  async pick(cloud, view, { x, y }) {
    const response = await this.ask(`${pathOf(cloud)}/pick`, {
      method: 'POST', headers: { 'Content-Type': 'application/json' }, body: JSON.stringify({ view, x, y }), signal: AbortSignal.timeout(3 * patienceMs),
    });
    return response.json();
  }

  /** Where points of the file lie in WGS 84: [longitude, latitude] of each, in degrees. */
  async lonlat(cloud, points) {
    const found = [];
    for (let i = 0; i < points.length; i += mostPlaces) {
      const response = await this.ask(`${pathOf(cloud)}/lonlat`, {
        method: 'POST', headers: { 'Content-Type': 'application/json' }, body: JSON.stringify({ points: points.slice(i, i + mostPlaces).map(([x, y]) => [x, y]) }), signal: AbortSignal.timeout(patienceMs),
      });
      found.push(...listOf((await response.json()).points));
    }
    if (found.length !== points.length || found.includes(null)) throw new ServerProblem({ detail: 'Some of the points have no place in longitude and latitude.' });
    return found;
  }

  /** What the scan's points say: volumes, fitted shapes. `question` as the protocol has it ("A measurement"). */
  async measure(cloud, question) {
    const response = await this.ask(`${pathOf(cloud)}/measure`, {
      method: 'POST', headers: { 'Content-Type': 'application/json' }, body: JSON.stringify(question), signal: AbortSignal.timeout(12 * patienceMs),
    });
    return response.json();
  }

  /** Gets a pass for the guest's link of this tab, and goes on renewing it; resolves to its cloud's id, throws what the server refuses with. */
  async enterAsGuest() {
    clearTimeout(this.#renewal);
    const response = await fetch(new URL('/api/v1/guest-session', this.#address), {
      method: 'POST',
      signal: AbortSignal.timeout(patienceMs),
      headers: { 'Content-Type': 'application/json' },
      body: JSON.stringify({ token: this.access.guestToken }),
    });
    if (!response.ok) throw await problemOf(response);
    const pass = await response.json();
    this.access.keepToken(pass.token);
    this.access.guestMayExport = pass.mayExport !== false; // an older server says it where it refuses them
    // A renewal that fails is tried again by whatever needs the pass next: session.js comes here before it connects.
    this.#renewal = setTimeout(() => this.access.isGuest && this.enterAsGuest().catch(() => {}), renewIn(pass.expiresInSeconds));
    return pass.cloud;
  }
}
