// The bytes are written by hand from PROTOCOL.md's table, so that reader and table are held against each other.

import assert from 'node:assert/strict';
import { describe, it } from 'node:test';

import { FrameError, parseFrame } from '../../../client/web/protocol/frame_header.js';
import { random } from '../support/cameras.mjs';

const goodBytes = [
  0x53, 0x43, 0x46, 0x52, // "SCFR"
  1, 0, 48, 0, // version 1, header length 48
  1, 6, 0, 0, // JPEG; still and final; reserved
  3, 0, 0, 0, // picture of 3 bytes
  0x02, 0x01, 0, 0, 0, 0, 0, 0, // frame 258
  0, 0, 0, 0, 1, 0, 0, 0, // seq 2^32
  0x00, 0x05, 0, 0, 0xd0, 0x02, 0, 0, // 1280 × 720
  0x10, 0x27, 0, 0, 0x64, 0, 0, 0, // 10 ms, 100 µs
  0xff, 0xd8, 0xff, // the picture
];
const frameOf = (bytes) => new Uint8Array(bytes).buffer;
const changed = (...changes) => {
  const bytes = [...goodBytes];
  for (const [offset, ...values] of changes) values.forEach((value, i) => { bytes[offset + i] = value; });
  return frameOf(bytes);
};

describe('parseFrame', () => {
  it('reads every field', () => {
    const { picture, ...fields } = parseFrame(frameOf(goodBytes));
    assert.deepEqual(fields, {
      moving: false, still: true, final: true, damaged: false, away: false, key: false, codec: 'jpeg', frameId: 258, seq: 2 ** 32, width: 1280, height: 720,
      renderMicroseconds: 10000, encodeMicroseconds: 100, packedDepth: undefined,
    });
    assert.deepEqual([...picture], [0xff, 0xd8, 0xff]);
  });

  it('tells a final still that lacks blocks from one that is whole', () => {
    const { still, final, damaged } = parseFrame(changed([9, 14]));
    assert.deepEqual({ still, final, damaged }, { still: true, final: true, damaged: true });
    assert.equal(parseFrame(changed([9, 17])).away, true);
  });

  it('tells video from JPEG, and where a decoder may begin', () => {
    const { codec, key, moving } = parseFrame(changed([8, 2, 33]));
    assert.deepEqual({ codec, key, moving }, { codec: 'h264', key: true, moving: true });
  });

  it('skips a header that has grown', () => {
    const bytes = [...goodBytes.slice(0, 48), 9, 9, 9, 9, ...goodBytes.slice(48)];
    bytes[6] = 52;
    assert.deepEqual([...parseFrame(frameOf(bytes)).picture], [0xff, 0xd8, 0xff]);
  });

  it('finds the depth behind the fields, and skips what follows it', () => {
    const depth = [160, 0, 90, 0, 3, 0, 0, 0, 0, 0, 0, 0x40, 0, 0, 0x80, 0x40, 7, 8, 9]; // 2 to 4
    const bytes = [...goodBytes.slice(0, 48), ...depth, 1, 1, ...goodBytes.slice(48)];
    bytes[6] = 48 + depth.length + 2;
    const { picture, packedDepth } = parseFrame(frameOf(bytes));
    assert.deepEqual([...picture], [0xff, 0xd8, 0xff]);
    assert.deepEqual({ ...packedDepth, bytes: [...packedDepth.bytes] }, { width: 160, height: 90, near: 2, far: 4, bytes: [7, 8, 9] });

    const wrong = { 'no width': [48, 0], 'too high': [50, 161], 'beyond the header': [52, 6], 'near behind far': [63, 0x30],
      'a negative near': [59, 0xc0], 'a far that is none': [62, 0xc0, 0x7f] };
    for (const [what, [offset, ...values]] of Object.entries(wrong)) {
      const changedBytes = [...bytes];
      values.forEach((value, i) => { changedBytes[offset + i] = value; });
      assert.throws(() => parseFrame(frameOf(changedBytes)), FrameError, what);
    }
    bytes[52] = 0;
    assert.equal(parseFrame(frameOf(bytes)).packedDepth, undefined);
  });

  it('ignores unknown flags', () => {
    const frame = parseFrame(changed([9, 0xf9]));
    assert.deepEqual([frame.moving, frame.still, frame.final], [true, false, false]);
  });

  it('refuses every truncation', () => {
    for (let length = 0; length < goodBytes.length; ++length) {
      assert.throws(() => parseFrame(frameOf(goodBytes.slice(0, length))), FrameError, `${length} bytes`);
    }
  });

  it('refuses what is no frame', () => {
    const bad = {
      'another magic': changed([0, 0x54]), 'version 2': changed([4, 2]), 'a header below 48': changed([6, 47]),
      'a header beyond the end': changed([6, 0xff, 0xff]), 'another codec': changed([8, 3]), 'a longer picture': changed([12, 4]),
      'a huge picture': changed([12, 0xff, 0xff, 0xff, 0xff]), 'no width': changed([32, 0, 0]), 'a giant': changed([36, 1, 0x40]),
    };
    for (const [what, bytes] of Object.entries(bad)) assert.throws(() => parseFrame(bytes), FrameError, what);
    assert.throws(() => parseFrame(frameOf([...goodBytes, 0])), FrameError, 'bytes behind the picture');
  });

  it('answers garbage with a FrameError or a frame, never with anything else', () => {
    const next = random(3);
    for (let round = 0; round < 2000; ++round) {
      const bytes = [...goodBytes];
      for (let i = 0; i < 4; ++i) bytes[Math.floor(next() * 51)] = Math.floor(next() * 256);
      try {
        const { picture } = parseFrame(frameOf(bytes.slice(0, 30 + Math.floor(next() * 30))));
        assert.ok(picture.length <= 51);
      } catch (error) {
        assert.ok(error instanceof FrameError, String(error));
      }
    }
  });
});
