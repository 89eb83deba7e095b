// The video of a connection, with a decoder that is a test double; and the way back to JPEG.

import assert from 'node:assert/strict';
import { afterEach, beforeEach, describe, it } from 'node:test';

import { Session } from '../../../client/web/connection/session.js';
import { MovingFrames } from '../../../client/web/view/moving_frames.js';
import { Video, codecOf } from '../../../client/web/view/video.js';

const key = new Uint8Array([0, 0, 0, 1, 0x67, 0x42, 0xc0, 0x1f, 0x8c, 0, 0, 1, 0x68, 1, 2, 0, 0, 1, 0x65, 9]);
const delta = new Uint8Array([0, 0, 1, 0x41, 9]);
const frame = (frameId, isKey) => ({ codec: 'h264', key: isKey, frameId, width: 33, height: 17, picture: isKey ? key : delta });
const settled = () => new Promise((done) => { setTimeout(done, 0); });

let decoders;
class FakeDecoder {
  state = 'unconfigured';
  decoded = [];
  static isConfigSupported = async () => ({ supported: true });
  constructor(handlers) {
    this.handlers = handlers;
    decoders.push(this);
  }
  configure(config) {
    this.state = 'configured';
    this.config = config;
  }
  decode(chunk) {
    this.decoded.push(chunk);
  }
  close() {
    this.state = 'closed';
  }
  /** Hands over the picture of the n-th chunk. */
  output(n) {
    this.handlers.output({ timestamp: this.decoded[n].timestamp, close: () => {} });
  }
}

const globals = { VideoDecoder: FakeDecoder, EncodedVideoChunk: class { constructor(init) { Object.assign(this, init); } },
  createImageBitmap: async (picture, ...area) => ({ of: picture.timestamp, area }), isSecureContext: true };

describe('video', () => {
  let before;
  beforeEach(() => {
    decoders = [];
    before = Object.fromEntries(Object.keys(globals).map((name) => [name, globalThis[name]]));
    Object.assign(globalThis, globals);
  });
  afterEach(() => { Object.assign(globalThis, before); });

  it('reads the codec from the parameter set', () => {
    assert.equal(codecOf(key), 'avc1.42c01f');
    assert.equal(codecOf(delta), '');
    assert.equal(codecOf(new Uint8Array()), '');
  });

  it('decodes frames in turn, each to its size', async () => {
    const video = new Video();
    const bitmaps = [video.decode(frame(1, true)), video.decode(frame(2, false))];
    const [decoder] = decoders;
    assert.deepEqual(decoder.config, { codec: 'avc1.42c01f', optimizeForLatency: true });
    assert.deepEqual(decoder.decoded.map(({ type }) => type), ['key', 'delta']);
    decoder.output(0);
    decoder.output(1);
    assert.deepEqual((await Promise.all(bitmaps)).map(({ area }) => area), [[0, 0, 33, 17], [0, 0, 33, 17]]);
  });

  it('begins with a key alone, and anew after what fails', async () => {
    const video = new Video();
    await assert.rejects(video.decode(frame(1, false)));
    const lost = video.decode(frame(2, true));
    decoders[0].handlers.error(new Error('broken'));
    await assert.rejects(lost, /broken/);
    await assert.rejects(video.decode(frame(3, false)));
    const again = video.decode(frame(4, true));
    decoders[1].output(0);
    assert.ok(await again);
    const closed = video.decode(frame(5, false));
    video.close();
    await assert.rejects(closed);
  });

  it('is asked for where the browser can, and not again where it failed', async (test) => {
    test.mock.method(console, 'warn', () => {});
    let failures = 0;
    const moving = new MovingFrames(() => { failures += 1; });
    assert.deepEqual(moving.words, {});
    await moving.ready;
    assert.deepEqual(moving.words, { codecs: ['h264', 'jpeg'] });
    moving.begin({ movingCodec: 'h264', codecReason: '' });
    assert.deepEqual(moving.now, { codec: 'h264', hasFailed: false, reason: '' });
    assert.equal(moving.decode({ codec: 'jpeg' }), undefined);
    const [first, second] = [moving.decode(frame(1, false)), moving.decode(frame(2, false))];
    await assert.rejects(first);
    await assert.rejects(second);
    await settled();
    assert.equal(failures, 1);
    assert.deepEqual(moving.words, {});
    assert.equal(moving.now.hasFailed, true);
  });

  it('is given up, too, where it failed while another connection was opening', async (test) => {
    test.mock.method(console, 'warn', () => {});
    const sockets = [];
    class FakeSocket {
      static OPEN = 1;
      readyState = 1;
      bufferedAmount = 0;
      said = [];
      constructor() { sockets.push(this); }
      send(text) { this.said.push(JSON.parse(text)); }
      close() { this.readyState = 3; }
      hear(message) { this.onmessage({ data: JSON.stringify(message) }); }
      /** The server has got its hello, and welcomes it with the codec that it asked for. */
      open() {
        this.onopen();
        this.hear({ type: 'welcome', session: 's', cloud: 'town', resume: 'token', movingCodec: this.said[0].codecs?.[0] ?? 'jpeg', codecReason: '' });
      }
    }
    const some = { WebSocket: FakeSocket, addEventListener: () => {}, document: { addEventListener: () => {} } };
    const were = Object.fromEntries(Object.keys(some).map((name) => [name, globalThis[name]]));
    Object.assign(globalThis, some);
    test.after(() => { Object.assign(globalThis, were); });
    const next = async (count) => {
        for (let rounds = 0; sockets.length < count && rounds < 1000; ++rounds) await settled();
        assert.equal(sockets.length, count, 'connections that were opened');
        return sockets.at(-1);
    };

    const moving = new MovingFrames(() => session.renew());
    await moving.ready;
    const session = new Session({ access: {}, streamUrl: '', clouds: async () => ({ clouds: [{ id: 'town' }], pending: [] }), methods: async () => ({}) }, {
      state: () => {}, catalog: () => {}, expect: async () => {}, seen: () => undefined, hello: () => moving.words,
      welcome: (message) => moving.begin(message), moved: (message) => moving.begin(message) });
    test.after(() => session.stop());
    session.start();
    const first = await next(1);
    first.open();
    first.hear({ type: 'drain', afterMilliseconds: 0, withinMilliseconds: 1000 });
    const second = await next(2);
    await assert.rejects(moving.decode(frame(1, false)));
    await settled();
    second.open();
    assert.equal(moving.now.codec, 'h264', 'as it was asked before');
    const third = await next(3);
    third.open();
    assert.equal(third.said[0].codecs, undefined);
    assert.equal(moving.now.codec, 'jpeg');
    await settled();
    assert.equal(sockets.length, 3);
  });

  it('is not asked for where the browser cannot', async () => {
    for (const missing of [{ isSecureContext: false }, { VideoDecoder: class { static isConfigSupported = async () => ({ supported: false }); } },
      { VideoDecoder: class { static isConfigSupported = async () => { throw new TypeError('no such codec'); }; } }]) {
      Object.assign(globalThis, globals, missing);
      const moving = new MovingFrames(() => {});
      await moving.ready;
      assert.deepEqual(moving.words, {});
    }
  });
});
