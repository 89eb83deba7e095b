// Somebody who looks at a cloud and moves, as protocol/PROTOCOL.md tells clients to behave, over npm's ws: acknowledges frames, comes back
// when the connection breaks, goes elsewhere when told to. Keeps what a measurement wants to know of it.

import { createRequire } from 'node:module';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

import { sleep } from './cluster.mjs';

const WebSocket = createRequire(join(dirname(fileURLToPath(import.meta.url)), '../../foreign/package.json'))('ws');
const againMs = 50;

export class Viewer {
  #url;
  #size;
  #socket;
  #leaving = false;
  #connecting = false;
  #timer;
  #angle;
  #first;
  #waiting = [];
  cookie = '';
  token = '';
  session = '';
  cloud = '';
  seq = 0;
  frame = 0;
  camera = null;
  /** When frames came, ms. */
  frames = [];
  /** What must not happen: sessions that began anew, views that were not those that were sent. */
  faults = [];
  connections = 0;
  refused = 0;
  drained = 0;
  /** Of the last frame: flags, seq, picture. */
  last = null;
  /** Called with each of them, and when it came, ms. */
  onFrame = () => {};

  constructor(url, { width = 192, height = 108, number = 0 } = {}) {
    this.#url = url;
    this.#size = { width, height };
    this.#angle = number;
  }

  /** Opens the page, for its cookie, and the stream; resolves when the first final still is there. */
  async start() {
    const page = await fetch(this.#url);
    await page.arrayBuffer();
    this.cookie = (page.headers.get('set-cookie') ?? '').split(';')[0];
    await this.#connect();
    await this.final();
  }

  /** Sends `perSecond` views a second along a circle, from now on. */
  move(perSecond) {
    this.#timer = setInterval(() => this.#step(), 1000 / perSecond);
  }

  rest() {
    clearInterval(this.#timer);
  }

  /** Moving frames are as sharp as stills, however long they take. */
  wantSharpness() {
    this.#send(this.#socket, { type: 'quality', minResolution: 1, maxDetail: 0 });
  }

  /** Back to where it began; with the next final still the picture of then. */
  lookAsAtFirst() {
    this.camera = this.#first;
    ++this.seq;
    this.#send(this.#socket, { type: 'view', seq: this.seq, camera: this.camera });
  }

  /** Resolves when the final still of the view that was sent last is there. */
  async final(patienceMs = 60_000) {
    for (const end = Date.now() + patienceMs; !(this.last?.final && this.last.seq === this.seq);) {
      if (Date.now() > end) throw new Error(`no final still of view ${this.seq} came: ${JSON.stringify({ ...this.last, picture: undefined })}`);
      await Promise.race([new Promise((done) => { this.#waiting.push(done); }), sleep(200)]);
    }
    return this.last.picture;
  }

  /** The longest time between two frames that came since `since`, the time until now included. */
  gap(since) {
    const times = [since, ...this.frames.filter((time) => time > since), performance.now()];
    return Math.max(...times.slice(1).map((time, i) => time - times[i]));
  }

  leave() {
    this.#leaving = true;
    this.rest();
    this.#socket?.close(1000);
  }

  #step() {
    const [[ex, ey, ez], [tx, ty]] = [this.#first.eye, this.#first.target];
    this.#angle += 0.02;
    const [cos, sin] = [Math.cos(this.#angle), Math.sin(this.#angle)];
    const [dx, dy] = [ex - tx, ey - ty];
    this.camera = { ...this.#first, eye: [tx + cos * dx - sin * dy, ty + sin * dx + cos * dy, ez] };
    ++this.seq;
    if (this.#socket?.readyState === WebSocket.OPEN) this.#send(this.#socket, { type: 'view', seq: this.seq, camera: this.camera });
  }

  #send(socket, message) {
    socket.send(JSON.stringify(message));
  }

  /** Until it succeeds: a connection that is welcome takes the place of the one that was. One at a time, whatever asks for it. */
  async #connect() {
    if (this.#connecting) return;
    this.#connecting = true;
    while (!this.#leaving && !await this.#try()) {
      ++this.refused;
      await sleep(againMs);
    }
    this.#connecting = false;
  }

  #try() {
    return new Promise((done) => {
      const socket = new WebSocket(`${this.#url.replace(/^http/, 'ws')}api/v1/stream`, ['scancast.v1'],
        { headers: { Cookie: this.cookie }, handshakeTimeout: 5000 });
      let welcome = false;
      socket.on('error', () => {});
      socket.on('open', () => this.#send(socket, { type: 'hello', ...this.#size, ...this.#memory() }));
      socket.on('message', (data, binary) => {
        if (binary) return this.#show(socket, data);
        const message = JSON.parse(data.toString());
        if (message.type === 'welcome') {
          welcome = true;
          this.#welcome(socket, message);
          done(true);
        } else if (message.type === 'drain') {
          ++this.drained;
          setTimeout(() => this.#connect(), message.afterMilliseconds);
        } else if (message.type === 'problem') {
          this.faults.push(`a problem: ${JSON.stringify(message.problem)}`);
        }
        return undefined;
      });
      socket.on('close', () => {
        done(welcome);
        if (welcome && socket === this.#socket && !this.#leaving) this.#connect();
      });
    });
  }

  /** What `hello` says of the session that was, once there was one. */
  #memory() {
    if (!this.token) return {};
    return { cloud: this.cloud, resume: this.token, frame: this.frame, view: { camera: this.camera }, seq: this.seq };
  }

  #welcome(socket, message) {
    const before = this.#socket;
    this.#socket = socket;
    ++this.connections;
    if (this.token) {
      if (!message.resumed) this.faults.push('the session began anew');
      if (message.session !== this.session) this.faults.push(`session ${this.session} became ${message.session}`);
      if (message.cloud !== this.cloud) this.faults.push(`cloud ${this.cloud} became ${message.cloud}`);
      // It shows a view that was sent; if not the last one, that follows at once.
      if (message.seq > this.seq) this.faults.push(`view ${message.seq} was never sent`);
    }
    this.#first ??= message.view.camera;
    this.camera ??= message.view.camera;
    this.token = message.resume;
    this.session = message.session;
    this.cloud = message.cloud;
    if (message.seq < this.seq) this.#send(socket, { type: 'view', seq: this.seq, camera: this.camera });
    before?.close(1000);
  }

  #show(socket, data) {
    const id = Number(data.readBigUInt64LE(16));
    if (socket.readyState === WebSocket.OPEN) this.#send(socket, { type: 'ack', frame: id });
    if (socket === this.#socket) this.frame = id;
    this.frames.push(performance.now());
    if (this.frames.length > 100_000) this.frames.splice(0, 50_000);
    this.last = { final: (data[9] & 4) !== 0, away: (data[9] & 16) !== 0, seq: Number(data.readBigUInt64LE(24)), picture: data.subarray(data.readUInt16LE(6)) };
    this.onFrame(this.last, this.frames.at(-1));
    this.#waiting.splice(0).forEach((done) => done());
  }
}

/** `count` viewers, started a few at a time. */
export async function startViewers(url, count, size = {}) {
  const viewers = Array.from({ length: count }, (_, number) => new Viewer(url, { ...size, number }));
  for (let i = 0; i < count; i += 8) await Promise.all(viewers.slice(i, i + 8).map((viewer) => viewer.start()));
  return viewers;
}
