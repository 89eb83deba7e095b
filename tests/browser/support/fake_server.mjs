// A server that is not one: serves the page and plays the protocol with pictures of 8 px blocks, so that tests can make
// it slow, make it refuse, make it vanish, at will. What the real server does is tested against the real server.
//
//   node tests/browser/support/fake_server.mjs     serves the page on a port of its choice, for working on the page

import { createServer } from 'node:http';
import { readFileSync } from 'node:fs';
import { extname, join, normalize } from 'node:path';
import { fileURLToPath } from 'node:url';

import { fromProtocol, project } from '../../../client/web/view/camera.js';
import { blockJpeg } from './block_jpeg.mjs';
import { TestSocket } from './web_socket.mjs';

export const webRoot = fileURLToPath(new URL('../../../client/web/', import.meta.url));
export const types = { '.html': 'text/html; charset=utf-8', '.js': 'text/javascript', '.css': 'text/css', '.svg': 'image/svg+xml' };
export const policy =
  "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src 'self'; worker-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

const size = (name, meaning, min, max, value, unit = 'px') => ({ name, type: 'number', default: value, min, max, unit, meaning });
export const methods = [
  {
    name: 'paraboloid', title: 'Paraboloids', summary: 'Closes holes and keeps lettering and edges sharp.', source: 'test',
    needs: [], defaultDetail: 1, defaultShading: 'unlit',
    parameters: [
      size('sizePx', 'Fixed size of every point on screen; 0 takes the size from the world.', 0, 256, 0),
      size('scale', 'Factor on the world radius of every point.', 0.01, 100, 1, ''),
      { name: 'footprint', type: 'choice', default: 'circle', choices: ['circle', 'square'], meaning: 'Outline of a point.' },
      { name: 'smooth', type: 'boolean', default: false, meaning: 'Only here to show what a yes or no looks like.' },
    ],
  },
  { name: 'auto', title: 'Automatic', summary: 'Chooses among the others.', source: 'test', needs: [], defaultDetail: 1, defaultShading: 'unlit', parameters: [] },
  { name: 'point', title: 'Points', summary: 'One pixel each.', source: 'test', needs: [], defaultDetail: 1, defaultShading: 'unlit', parameters: [] },
  { name: 'surfel', title: 'Surfels', summary: 'Discs along the surface.', source: 'test', needs: ['normal'], defaultDetail: 1, defaultShading: 'phong', parameters: [] },
];

function makeCloud(id, title, halfHeight, attributes) {
  return {
    id, title, format: 'made up', revision: '1', points: 1_234_567, droppedPoints: 0,
    bounds: { min: [-10, -10, -halfHeight], max: [10, 10, halfHeight] }, origin: [0, 0, 0], spacing: 0.01, attributes,
    classes: [], mirrors: [], bytesResident: 1, state: 'ready',
    view: {
      camera: { type: 'perspective', eye: [14, -22, 12], target: [0, 0, 0], up: [0, 0, 1], fov: 60, near: null, far: null },
      width: 1280, height: 720, method: 'paraboloid', param: {}, color: 'auto', colormap: 'viridis', range: null,
      classes: null, clip: null, clips: null, filter: null, with: null, shading: null, mirrors: true, behindMirrors: false, background: ['#3a424e', '#16191e'], detail: null, budget: null, samples: null,
      quality: 90, subsampling: '4:2:0',
    },
  };
}

export const clouds = [
  makeCloud('ring', 'A ring of stones', 3, [{ name: 'rgb' }]),
  makeCloud('helix', 'Helix', 10, [{ name: 'intensity', range: [0, 255] }]),
];

const pointsOf = {
  ring: Array.from({ length: 900 }, (_, i) => {
    const a = i * 2.399963, t = (i / 900) * 2 * Math.PI;
    return [(7 + 3 * Math.cos(a)) * Math.cos(t), (7 + 3 * Math.cos(a)) * Math.sin(t), 3 * Math.sin(a)];
  }),
  helix: Array.from({ length: 900 }, (_, i) => [10 * Math.cos(i / 40), 10 * Math.sin(i / 40), i / 45 - 10]),
};

function colorOf(view, point, bounds) {
  if (view.color.startsWith('#')) return [1, 3, 5].map((at) => parseInt(view.color.slice(at, at + 2), 16));
  const t = (point[2] - bounds.min[2]) / (bounds.max[2] - bounds.min[2]);
  if (view.color === 'elevation') return [60 + 180 * t, 200 - 60 * t, 90];
  return [120 + 110 * t, 110 + 80 * t, 100 - 40 * t];
}

/** Draws points as blocks, nearest last; the method only changes how large they are. */
function draw(cloud, view, width, height) {
  const camera = fromProtocol(view.camera);
  const blocks = new Map();
  const reach = view.method === 'point' ? 0 : 1;
  const projected = pointsOf[cloud.id]
    .map((point) => ({ point, at: project(camera, point, { width, height }) }))
    .filter(({ at }) => at !== undefined)
    .sort((a, b) => b.at.depth - a.at.depth);
  for (const { point, at } of projected) {
    for (let dx = 0; dx <= reach; ++dx) {
      for (let dy = 0; dy <= reach; ++dy) {
        blocks.set(`${Math.floor(at.x / 8) + dx},${Math.floor(at.y / 8) + dy}`, colorOf(view, point, cloud.bounds));
      }
    }
  }
  const rows = height / 8;
  return blockJpeg(width, height, (column, row) => {
    const t = row / rows;
    return blocks.get(`${column},${row}`) ?? [58 - 36 * t, 66 - 41 * t, 78 - 48 * t];
  });
}

function headerOf({ frameId, seq, width, height, flags, length }) {
  const header = Buffer.alloc(48);
  header.write('SCFR');
  header.writeUInt16LE(1, 4);
  header.writeUInt16LE(48, 6);
  header[8] = 1;
  header[9] = flags;
  header.writeUInt32LE(length, 12);
  header.writeBigUInt64LE(BigInt(frameId), 16);
  header.writeBigUInt64LE(BigInt(seq), 24);
  header.writeUInt32LE(width, 32);
  header.writeUInt32LE(height, 36);
  header.writeUInt32LE(3200, 40);
  header.writeUInt32LE(1100, 44);
  return header;
}

const problem = (status, title, detail) => ({ type: 'about:blank', title, status, detail, errors: [] });

/** One client: latest wins, at most two frames unacknowledged, a final still when views stop. */
class FakeSession {
  constructor(server, socket) {
    this.server = server;
    this.socket = socket;
    this.frameId = 0;
    this.acked = 0;
    socket.onText = (text) => this.received(JSON.parse(text));
    socket.onClose = () => {
      clearTimeout(this.timer);
      server.sessions.delete(this);
    };
  }

  received(message) {
    this.server.received.push(message);
    if (message.type === 'hello' && message.depth !== undefined && !this.server.knowsDepth) {
      const unknown = { ...problem(400, 'A parameter is malformed or out of range', 'depth: unknown'), errors: [{ parameter: 'depth', detail: 'depth: unknown' }] };
      this.socket.sendText(JSON.stringify({ type: 'problem', problem: unknown }));
      return;
    }
    if (message.type === 'hello') {
      // At a server that takes its time; meanwhile the page may be drawn for by another one.
      if (message.resume && this.server.holdsHello) this.server.holdsHello.then(() => this.greet(message));
      else this.greet(message);
    }
    if (message.type === 'view') this.change(message);
    if (message.type === 'ack') {
      this.acked = Math.max(this.acked, message.frame);
      this.pump();
    }
    if (message.type === 'ping') this.socket.sendText(JSON.stringify({ type: 'pong', id: message.id }));
  }

  greet({ cloud, width = 1280, height = 720, view, seq, resume, frame }) {
    this.cloud = this.server.clouds.find((one) => one.id === cloud);
    if (!this.cloud) {
      this.socket.sendText(JSON.stringify({ type: 'problem', problem: problem(404, 'Not Found', `There is no cloud named "${cloud}" here.`) }));
      return;
    }
    this.view = { ...this.cloud.view, width, height, ...view };
    this.seq = view ? seq : 0;
    this.frameId = this.acked = this.first = resume && frame ? frame : 0;
    this.socket.sendText(JSON.stringify({
      type: 'welcome', session: 'test', resume: `token-${this.server.received.filter(({ type }) => type === 'hello').length}`, resumed: Boolean(resume && view), seq: this.seq, cloud: this.cloud.id, methods: methods.map((method) => method.name),
      limits: { maxMessageBytes: 65536, maxPixels: 8_300_000, maxUnacknowledged: 2 }, view: this.view,
    }));
    if (this.server.showsAtOnce) this.send(true);
    this.want(false);
  }

  /** As a server does that will be gone: pages are to go to another one, which is this one here. */
  drain(afterMilliseconds) {
    this.socket.sendText(JSON.stringify({ type: 'drain', afterMilliseconds, withinMilliseconds: 20_000 }));
  }

  /** As the server ends who looks at a cloud that is gone. */
  dismiss() {
    const reason = 'The cloud that this session showed has been removed, or cannot be read any more.';
    this.socket.sendText(JSON.stringify({ type: 'problem', problem: problem(404, 'Not Found', `There is no cloud named "${this.cloud.id}" here.`) }));
    this.socket.sendText(JSON.stringify({ type: 'bye', code: 1001, reason }));
    this.socket.close(1001, reason);
  }

  change({ type, seq, cloud, ...changes }) {
    const next = cloud && cloud !== this.cloud.id ? this.server.clouds.find((one) => one.id === cloud) : this.cloud;
    if (!next) {
      this.socket.sendText(JSON.stringify({ type: 'problem', seq, problem: problem(404, 'Not Found', `There is no cloud named "${cloud}" here.`) }));
      return;
    }
    if (changes.method && !methods.some((method) => method.name === changes.method)) {
      const detail = `method: there is no method "${changes.method}"; did you mean paraboloid?`;
      this.socket.sendText(JSON.stringify({ type: 'problem', seq, problem: problem(404, 'Not found', detail) }));
      return;
    }
    if (changes.param?.scale === 66) {
      this.socket.sendText(JSON.stringify({ type: 'problem', seq, problem: problem(400, 'Bad Request', 'param.scale: not today') }));
      return;
    }
    const { width, height } = this.view;
    this.view = { ...(next === this.cloud ? this.view : { ...next.view, width, height }), ...changes };
    this.cloud = next;
    this.seq = seq;
    this.want(true);
  }

  want(moving) {
    this.moving = moving;
    this.finalWanted = true;
    this.changedAt = Date.now();
    this.pump();
  }

  pump() {
    if (this.timer || this.frameId - this.acked >= 2) return;
    const quiet = Date.now() - this.changedAt > 150 || this.frameId === this.first;
    if (!this.moving && !this.finalWanted) return;
    const delay = this.moving ? this.server.frameDelay : quiet ? this.server.frameDelay : 160;
    this.timer = setTimeout(() => {
      this.timer = undefined;
      const final = !this.moving;
      if (final) this.finalWanted = false;
      this.moving = false;
      this.send(final);
      this.pump();
    }, delay);
  }

  send(final) {
    const scale = final ? 1 : 0.5;
    const width = Math.round(this.view.width * scale), height = Math.round(this.view.height * scale);
    const picture = draw(this.cloud, this.view, width, height);
    this.sendFrame(final, picture, width, height);
    if (this.server.statsOf === 'no frame') return;
    this.sendStats(this.frameId);
  }

  sendStats(frame) {
    const column = this.cloud.columns?.find(({ name }) => this.view.color === `column:${name}`);
    const ends = column?.range ?? { elevation: [this.cloud.bounds.min[2], this.cloud.bounds.max[2]], intensity: [0, 255] }[this.view.color] ?? null;
    const auto = this.view.method === 'auto' ? { methodReason: 'coloured points: they close the gaps' } : {};
    this.socket.sendText(JSON.stringify({
      type: 'stats', frame, seq: this.seq, fps: 30, method: auto.methodReason ? 'paraboloid' : this.view.method, ...auto, detail: 1, samples: 812_345, points: 1_100_000, dropped: 0,
      color: this.view.color, colormap: this.view.colormap, range: ends,
      stages: [{ name: 'select', milliseconds: 0.4 }, { name: 'nearest', milliseconds: 2.1 }, { name: 'encode', milliseconds: 1.1 }],
    }));
  }

  sendFrame(final, picture, width, height, id = ++this.frameId) {
    const flags = !final ? 1 : this.server.away ? 2 : this.server.damaged ? 14 : 6;
    this.socket.sendBinary(headerOf({ frameId: id, seq: this.seq, width, height, flags: flags | (this.server.away ? 16 : 0), length: picture.length }), picture);
  }
}

export class FakeServer {
  clouds = clouds;
  photos = []; // of every cloud that says that it has some: { name, file, … } as the API has them, and what is sent for each
  stations = [];
  busyFor = 0; // so many photos are refused for now
  pending = [];
  told = {}; // id → what it says of that cloud alone, beside what the list says
  statsOf = 'every frame'; // or 'no frame'
  frameDelay = 12;
  snapshotMs; // how long a small picture (JPEG) takes; undefined: it is refused
  mostSnapshots = 0; // that were on their way at once
  snapshotsGivenUp = 0;
  #snapshots = 0;
  damaged = false; // blocks of its clouds cannot be read
  away = false; // some cannot be had at present: stills are coarser, and none is final
  knowsDepth = true; // else it refuses that word, as older servers do
  holdsHello; // a promise: who comes back is welcomed when it resolves
  showsAtOnce = false; // a frame of the view of the hello comes right behind the welcome
  refusedStreams = 0; // so many are answered 503 from now on
  token = ''; // asked for, when there is one
  guestLink = ''; // what stands in the link of a guest, whose pass is the token
  passSeconds = 3600;
  received = []; // every message of every client
  sessions = new Set();
  #http;

  /** Returns the URL; `port` 0 takes a free one. */
  async start(port = 0) {
    this.#http = createServer((request, response) => this.#answer(request, response));
    this.#http.on('upgrade', (request, socket) => this.#upgrade(request, socket));
    await new Promise((done) => this.#http.listen(port, '127.0.0.1', done));
    this.port = this.#http.address().port;
    return `http://127.0.0.1:${this.port}/`;
  }

  /** Takes a cloud out of the list; who looks at it is sent away. */
  remove(id) {
    this.clouds = this.clouds.filter((cloud) => cloud.id !== id);
    for (const session of this.sessions) if (session.cloud?.id === id) session.dismiss();
  }

  /** What was away is there again: whoever waits gets the final picture. */
  comeBack() {
    this.away = false;
    for (const session of this.sessions) session.want(false);
  }

  async stop() {
    for (const session of this.sessions) session.socket.destroy();
    this.#http.closeAllConnections();
    await new Promise((done) => this.#http.close(done));
  }

  async #guestSession(request, reply, json) {
    let body = '';
    for await (const part of request) body += part;
    this.received.push({ type: 'guest-session', token: JSON.parse(body).token });
    if (JSON.parse(body).token === this.guestLink)
      return json({ token: this.token, cloud: this.clouds[0].id, expiresInSeconds: this.passSeconds, mayExport: false });
    return reply(401, 'application/problem+json', JSON.stringify(problem(401, 'Unauthorized', "The guest's time is over.")));
  }

  /** Of its points, the one that is nearest to the pixel; null where none is within 40 of it. */
  async #pick(pathname, request, json) {
    let body = '';
    for await (const part of request) body += part;
    const { view, x, y } = JSON.parse(body);
    this.received.push({ type: 'pick', x, y });
    const cloud = this.clouds.find(({ id }) => pathname.endsWith(`/clouds/${id}/pick`));
    const camera = fromProtocol(view.camera);
    const places = pointsOf[cloud.id].map((point) => ({ point, at: project(camera, point, view) })).filter(({ at }) => at)
      .map(({ point, at }) => ({ point, depth: at.depth, off: Math.hypot(at.x - x, at.y - y) })).sort((a, b) => a.off - b.off);
    const [found] = places;
    json(found.off > 40 ? null : { position: found.point, precision: [0.001, 0.001, 0.001], depth: found.depth, distance: 0, rgb: [200, 150, 100] });
  }

  /** After a while, unless nobody waits for it any more. */
  #snapshot(words, response, reply) {
    this.#snapshots += 1;
    this.mostSnapshots = Math.max(this.mostSnapshots, this.#snapshots);
    const [width, height] = ['width', 'height'].map((word) => Number(words.get(word)));
    const timer = setTimeout(() => reply(200, 'image/jpeg', blockJpeg(width, height, (column, row) => [16 * column % 256, 16 * row % 256, 90])), this.snapshotMs);
    response.on('close', () => {
      this.#snapshots -= 1;
      if (response.writableFinished) return;
      clearTimeout(timer);
      this.snapshotsGivenUp += 1;
    });
  }

  #upgrade(request, socket) {
    if (this.refusedStreams > 0) {
      this.refusedStreams -= 1;
      socket.end('HTTP/1.1 503 Service Unavailable\r\nContent-Length: 0\r\n\r\n');
      return;
    }
    const offered = (request.headers['sec-websocket-protocol'] ?? '').split(', ');
    const bearer = `base64url.bearer.authorization.${Buffer.from(this.token).toString('base64url')}`;
    if (this.token && !offered.includes(bearer)) {
      socket.end('HTTP/1.1 401 Unauthorized\r\n\r\n');
      return;
    }
    this.sessions.add(new FakeSession(this, new TestSocket(request, socket)));
  }

  #answer(request, response) {
    const { pathname, searchParams } = new URL(request.url, 'http://localhost');
    const reply = (status, type, body) => {
      response.writeHead(status, { 'Content-Type': type, 'Content-Security-Policy': policy, 'X-Content-Type-Options': 'nosniff' });
      response.end(body);
    };
    const json = (body) => reply(200, 'application/json', JSON.stringify(body));
    if (pathname === '/api/v1/guest-session') return this.#guestSession(request, reply, json);
    if (this.token && pathname.startsWith('/api/') && request.headers.authorization !== `Bearer ${this.token}`) {
      return reply(401, 'application/problem+json', JSON.stringify(problem(401, 'Unauthorized', 'A token is needed.')));
    }
    if (pathname === '/api/v1/clouds') return json({ clouds: this.clouds, pending: this.pending });
    if (pathname === '/api/v1/methods') {
      return json({
        methods, colors: [
          'auto', 'rgb*intensity', 'elevation*intensity', 'classification*intensity',
          'rgb', 'intensity', 'elevation', 'classification', 'normal', 'depth', 'lod', 'visibility', 'cloud',
        ],
        colormaps: ['viridis', 'turbo', 'grey'], ramps: { viridis: ['#440154', '#21918c', '#fde725'], turbo: ['#30123b', '#7a0403'], grey: ['#000000', '#ffffff'] }, shadings: ['unlit', 'phong', 'eyedome'],
      });
    }
    const one = this.clouds.find(({ id }) => pathname === `/api/v1/clouds/${id}`);
    if (one) return json({ ...one, ...this.told[one.id] });
    if (pathname.endsWith('/views')) {
      const cloud = this.clouds.find(({ id }) => pathname.endsWith(`/clouds/${id}/views`));
      return json({ views: (cloud?.look?.views ?? []).map(({ name, inside, camera }) => ({ name, inside, view: { ...cloud.view, camera } })) });
    }
    if (pathname.endsWith('/pick')) return this.#pick(pathname, request, json);
    if (pathname.endsWith('/stations')) return json({ stations: this.stations });
    const photo = /^(.*\/photos)(?:\/(\d+))?$/.exec(pathname);
    if (photo && photo[2] === undefined) {
      this.received.push({ type: 'photos', words: Object.fromEntries(searchParams) });
      return json({ photos: this.photos.map(({ file, ...known }, index) => ({ index, href: `${photo[1]}/${index}`, bytes: file.length, mediaType: 'image/jpeg', projection: 'visual', ...known })) });
    }
    if (photo) {
      const { file } = this.photos[photo[2]] ?? {};
      if (this.busyFor-- > 0) return reply(429, 'application/problem+json', JSON.stringify(problem(429, 'Too Many Requests', 'Ask again later.')));
      this.received.push({ type: 'photo', index: Number(photo[2]) });
      if (!file) return reply(500, 'application/problem+json', JSON.stringify(problem(500, 'Internal Server Error', 'This photo cannot be read.')));
      return reply(200, 'image/jpeg', file);
    }
    if (/\/snapshot\.(png|jpg)$/.test(pathname)) {
      this.received.push({ type: 'snapshot', words: Object.fromEntries(searchParams) });
      if (pathname.endsWith('.jpg') && this.snapshotMs !== undefined) return this.#snapshot(searchParams, response, reply);
      return reply(503, 'application/problem+json', JSON.stringify(problem(503, 'Not now', 'This test server draws no snapshots.')));
    }
    const file = normalize(pathname === '/' ? '/index.html' : pathname);
    try {
      return reply(200, types[extname(file)] ?? 'application/octet-stream', readFileSync(join(webRoot, file)));
    } catch {
      return reply(404, 'application/problem+json', JSON.stringify(problem(404, 'Not Found', `There is no ${file}.`)));
    }
  }
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  console.log(`The page, with pretended clouds: ${await new FakeServer().start()}`);
}
