// The stream as protocol/PROTOCOL.md tells it, with libraries that share nothing with ours: npm's ws for the WebSocket,
// jpeg-js for the pictures, Node's own zlib for depth. The frame's offsets are written out here once more, from that page.

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { inflateSync } from 'node:zlib';

import jpeg from 'jpeg-js';
import WebSocket from 'ws';

import { RealServer } from '../browser/support/real_server.mjs';
import { writeScans } from '../browser/support/scans.mjs';

const patienceMs = 60_000;
let scans, server, url;

before(async () => {
  scans = writeScans();
  server = new RealServer(process.env.SCANCAST_PROGRAM, scans.files);
  url = await server.start();
  const end = Date.now() + patienceMs;
  while ((await fetch(new URL('/readyz', url))).status !== 200) assert.ok(Date.now() < end, 'the server never became ready');
});

after(async () => {
  await server?.stop();
  scans?.remove();
});

/** A connection whose messages are awaited one by one. */
class Stream {
  #messages = [];
  #waiting;

  constructor(address, protocols = ['scancast.v1']) {
    this.socket = new WebSocket(address.replace(/^http/, 'ws') + 'api/v1/stream', protocols);
    this.socket.on('message', (data, binary) => this.#put(binary ? readFrame(data) : JSON.parse(data.toString())));
    this.socket.on('close', (code) => this.#put({ type: 'closed', code }));
    this.socket.on('error', (error) => this.#put({ type: 'failed', error }));
  }

  open() {
    return new Promise((done, failed) => this.socket.once('open', done).once('error', failed));
  }

  send(message) {
    this.socket.send(JSON.stringify(message));
  }

  #put(message) {
    this.#messages.push(message);
    this.#waiting?.();
  }

  /** The next message of this type, those before it into `passed`; a problem or an end instead of it is an error. */
  async next(type, passed = []) {
    const timer = setTimeout(() => this.#put({ type: 'failed', error: new Error(`no ${type} came`) }), patienceMs).unref();
    try {
      for (;;) {
        while (this.#messages.length === 0) await new Promise((done) => { this.#waiting = done; });
        const message = this.#messages.shift();
        if (message.type === type) return message;
        if (['failed', 'closed', 'problem'].includes(message.type)) assert.fail(`${type} expected: ${JSON.stringify(message)} ${message.error ?? ''}`);
        passed.push(message);
      }
    } finally {
      clearTimeout(timer);
    }
  }

  /** Acknowledges frames until the final still of view `seq`. */
  async final(seq) {
    const frames = [];
    for (;;) {
      const frame = await this.next('frame');
      frames.push(frame);
      this.send({ type: 'ack', frame: frame.id });
      if (frame.final && frame.seq === seq) return frames;
    }
  }
}

function readFrame(data) {
  assert.equal(data.toString('latin1', 0, 4), 'SCFR');
  assert.equal(data.readUInt16LE(4), 1);
  assert.equal(data[8], 1);
  const picture = data.subarray(data.readUInt16LE(6));
  assert.equal(picture.length, data.readUInt32LE(12));
  const flags = data[9];
  return {
    type: 'frame',
    id: Number(data.readBigUInt64LE(16)),
    seq: Number(data.readBigUInt64LE(24)),
    width: data.readUInt32LE(32),
    height: data.readUInt32LE(36),
    moving: (flags & 1) !== 0,
    still: (flags & 2) !== 0,
    final: (flags & 4) !== 0,
    picture,
    header: data.subarray(0, data.readUInt16LE(6)),
  };
}

/** Cells of inverse depth, as PROTOCOL.md tells it: `{ width, height, inverse }` in rows, 0 = background. */
function readDepth(header) {
  const [width, height, length] = [header.readUInt16LE(48), header.readUInt16LE(50), header.readUInt32LE(52)];
  const near = header.readFloatLE(56);
  const count = width * height;
  const bytes = inflateSync(header.subarray(64, 64 + length));
  assert.equal(bytes.length, 2 * count);
  const codes = [];
  const inverse = [];
  for (let i = 0; i < count; ++i) {
    const [left, above] = [i % width > 0 ? codes[i - 1] : undefined, codes[i - width]];
    const plane = left + above - codes[i - width - 1];
    const expected = left === undefined ? above ?? 0 : above === undefined ? left
      : Math.max(Math.min(left, above), Math.min(plane, Math.max(left, above)));
    const symbol = bytes[i] + 256 * bytes[count + i];
    codes.push(symbol === 0 ? expected : expected + (symbol % 2 === 1 ? (symbol - 1) / 2 : -symbol / 2));
    const octave = Math.max(0, Math.floor(codes[i] / 512) - 1);
    inverse.push(symbol === 0 ? 0 : (codes[i] - 512 * octave) * 2 ** octave / 2 ** 24 / near);
  }
  return { width, height, inverse, near, far: header.readFloatLE(60) };
}

/** Decoded, of the size that its header says, and not of one colour. */
function decoded(frame) {
  const picture = jpeg.decode(frame.picture, { useTArray: true });
  assert.equal(picture.width, frame.width);
  assert.equal(picture.height, frame.height);
  assert.ok(new Set(new Uint32Array(picture.data.buffer)).size > 100, 'there is something in the picture');
  return picture;
}

test('hello, frames, acknowledgements, final still', async () => {
  const stream = new Stream(url);
  await stream.open();
  assert.equal(stream.socket.protocol, 'scancast.v1');
  stream.send({ type: 'hello', cloud: 'ring', width: 320, height: 200 });
  const welcome = await stream.next('welcome');
  assert.equal(welcome.cloud, 'ring');
  assert.equal(welcome.view.width, 320);

  const first = (await stream.final(0)).at(-1);
  assert.deepEqual([first.width, first.height], [320, 200]);
  decoded(first);

  const { eye, target } = welcome.view.camera;
  for (let seq = 1; seq <= 12; ++seq)
    stream.send({ type: 'view', seq, camera: { eye: [eye[0] + seq / 10, eye[1], eye[2]] } });
  const frames = await stream.final(12);
  for (const frame of frames) {
    assert.ok(frame.width >= 160 && frame.width <= 320, `half of the resolution at least, not ${frame.width}`);
    decoded(frame);
  }
  assert.deepEqual(frames.map((frame) => frame.id), frames.map((_, i) => frames[0].id + i), 'frames are counted');
  assert.deepEqual(frames.map((frame) => frame.seq), frames.map((frame) => frame.seq).sort((a, b) => a - b), 'never an older view');

  // The final still is the snapshot of the same view, byte for byte.
  const last = frames.at(-1);
  const query = `width=320&height=200&eye=${eye[0] + 12 / 10},${eye[1]},${eye[2]}&target=${target}`;
  const snapshot = await fetch(new URL(`/api/v1/clouds/ring/snapshot.jpg?${query}`, url));
  assert.equal(snapshot.status, 200);
  assert.ok(last.picture.equals(Buffer.from(await snapshot.arrayBuffer())));
  stream.socket.close(1000);
  assert.equal((await stream.next('closed')).code, 1000);
});

test('depth with every frame, for those who ask for it', async () => {
  const [width, height] = [330, 190];
  const finals = [];
  for (const depth of [false, true]) {
    const stream = new Stream(url);
    await stream.open();
    stream.send({ type: 'hello', cloud: 'ring', width, height, depth });
    const { eye } = (await stream.next('welcome')).view.camera;
    await stream.final(0);
    const camera = { eye: [eye[0] * 0.7, eye[1] * 0.7, eye[2]] };
    stream.send({ type: 'view', seq: 1, camera, samples: 1 });
    finals.push({ frames: await stream.final(1), camera });
    stream.socket.terminate();
  }
  const [without, { frames, camera }] = finals;
  for (const { header, moving, final } of frames) {
    assert.ok(header.length > 64 && moving !== final);
    assert.ok(readDepth(header).inverse.some((value) => value > 0));
  }
  const last = frames.at(-1);
  assert.equal(without.frames.at(-1).header.length, 48);
  assert.ok(last.picture.equals(without.frames.at(-1).picture), 'whoever skips the header sees the same picture');

  // Against the depth of every pixel, which a snapshot has: each cell asks all pixels.
  const snapshot = await fetch(new URL('/api/v1/clouds/ring/snapshot', url), {
    method: 'POST', headers: { 'Content-Type': 'application/json', Accept: 'application/octet-stream' },
    body: JSON.stringify({ width, height, camera, samples: 1 }),
  });
  assert.equal(snapshot.status, 200);
  const pixels = Buffer.from(await snapshot.arrayBuffer());
  const cells = readDepth(last.header);
  assert.deepEqual([cells.width, cells.height], [160, 92]);
  const near = new Map();
  for (let y = 0; y < height; ++y) {
    for (let x = 0; x < width; ++x) {
      const depth = pixels.readFloatLE(4 * (y * width + x));
      if (depth === Infinity) continue;
      const middle = (place, among, cell) => Math.floor(cell * place / among) + Math.floor((cell + 1) * place / among);
      const cellOf = (pixel, size, among) => {
        let cell = Math.floor(pixel * among / size);
        while (Math.floor((cell + 1) * size / among) <= pixel) ++cell;
        return cell;
      };
      const [i, j] = [cellOf(x, width, cells.width), cellOf(y, height, cells.height)];
      const distance = Math.hypot(2 * x + 1 - middle(width, cells.width, i), 2 * y + 1 - middle(height, cells.height, j));
      const cell = j * cells.width + i;
      if (!near.has(cell) || distance < near.get(cell).distance) near.set(cell, { distance, depth });
    }
  }
  assert.ok(near.size > 1000 && near.size < cells.inverse.length, 'there is a ring, and nothing around it');
  const depths = [...near.values()].map(({ depth }) => depth);
  assert.deepEqual([cells.near, cells.far], [Math.min(...depths), Math.max(...depths)]);
  cells.inverse.forEach((value, cell) => {
    const expected = near.get(cell)?.depth;
    if (expected === undefined) assert.equal(value, 0, `cell ${cell}`);
    else assert.ok(Math.abs(value * expected - 1) <= 1 / 1023, `cell ${cell}: ${1 / value} instead of ${expected}`);
  });
});

test('without acknowledgements there are two frames and no more; one acknowledgement is enough for both', async () => {
  const stream = new Stream(url);
  await stream.open();
  stream.send({ type: 'hello', cloud: 'corner', width: 96, height: 64 });
  const { view } = await stream.next('welcome');
  await stream.final(0);
  const eye = view.camera.eye;
  const move = (seq) => stream.send({ type: 'view', seq, camera: { eye: [eye[0], eye[1] + seq / 50, eye[2]] } });
  // A pong comes after what was sent before it: so much for "no more".
  const passed = [];
  const received = () => passed.filter((message) => message.type === 'frame');
  for (let seq = 1; seq <= 6; ++seq) {
    move(seq);
    if (received().length < 2) passed.push(await stream.next('frame', passed));
    stream.send({ type: 'ping', id: seq });
    await stream.next('pong', passed);
  }
  assert.equal(received().length, 2);
  stream.send({ type: 'ack', frame: received()[1].id });
  const frames = await stream.final(6);
  assert.equal(frames[0].id, received()[1].id + 1, 'nothing was sent in between');
  stream.socket.terminate();
});

test('a refused message names the field, and the session goes on', async () => {
  const stream = new Stream(url);
  await stream.open();
  stream.send({ type: 'hello', width: 64, height: 64 });
  await stream.final(0);
  stream.send({ type: 'view', seq: 1, camera: { fvo: 50 } });
  const { problem, seq } = await stream.next('problem');
  assert.equal(seq, 1);
  assert.match(JSON.stringify(problem), /camera\.fvo/);
  stream.send({ type: 'view', seq: 2, camera: { fov: 50 } });
  assert.equal((await stream.final(2)).at(-1).seq, 2);
  stream.socket.terminate();
});

test('another subprotocol is not spoken', async () => {
  const stream = new Stream(url, ['scancast.v9']);
  const ended = await Promise.race([stream.next('failed'), stream.next('closed')]).catch((error) => error);
  assert.ok(ended);
});
