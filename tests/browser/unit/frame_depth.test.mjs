// Packed here by an encoder of the test's own, written from PROTOCOL.md with floating-point arithmetic instead of bits: what it
// packs is known exactly, and what is unpacked may differ by half a step, 1 / 1024 of the value.

import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { deflateSync } from 'node:zlib';

import { inverseDepthAt, unpackDepth } from '../../../client/web/protocol/frame_depth.js';
import { FrameError } from '../../../client/web/protocol/frame_header.js';
import { random } from '../support/cameras.mjs';

const [width, height] = [160, 90];
const step = 1 / 1024;

const codeOf = (value) => {
  const octave = Math.max(0, Math.floor(Math.log2(value)) - 9);
  return 512 * octave + Math.round(value / 2 ** octave);
};

/** `depthOf(column, row)` → what a frame would bring; Infinity = background. */
function packed(depthOf, [w, h] = [width, height]) {
  const depths = Array.from({ length: w * h }, (_, i) => Math.fround(depthOf(i % w, Math.floor(i / w))));
  const covered = depths.filter(Number.isFinite);
  const near = covered.length > 0 ? Math.min(...covered) : 0;
  const codes = [];
  const symbols = depths.map((depth, i) => {
    const left = i % w > 0 ? codes[i - 1] : codes[i - w] ?? 0;
    const above = codes[i - w] ?? left;
    const corner = i % w > 0 ? codes[i - w - 1] ?? above : above;
    const middle = [left, above, left + above - corner].sort((a, b) => a - b)[1];
    codes[i] = Number.isFinite(depth) ? codeOf(near / depth * 2 ** 24) : middle;
    const difference = codes[i] - middle;
    return Number.isFinite(depth) ? (difference >= 0 ? 2 * difference + 1 : -2 * difference) : 0;
  });
  const bytes = new Uint8Array(deflateSync(Buffer.from([...symbols.map((s) => s % 256), ...symbols.map((s) => s >> 8)])));
  return { width: w, height: h, near, far: covered.length > 0 ? Math.max(...covered) : 0, bytes };
}

/** A plane's depth: 1 / depth is linear in the picture. */
const plane = (a, b, c) => (u, v) => 1 / (a * u + b * v + c);
const onCells = (depthAt) => (column, row) => depthAt((column + 0.5) / width, (row + 0.5) / height);

async function assertUnpacks(depthOf, size) {
  const given = packed(depthOf, size);
  const { inverse, ...rest } = await unpackDepth(given);
  assert.deepEqual(rest, { width: given.width, height: given.height });
  for (let i = 0; i < inverse.length; ++i) {
    const depth = depthOf(i % given.width, Math.floor(i / given.width));
    if (depth === Infinity) assert.equal(inverse[i], 0);
    else assert.ok(Math.abs(inverse[i] * depth - 1) <= step * 1.001, `cell ${i}: ${1 / inverse[i]} instead of ${depth}`);
  }
  return given;
}

describe('unpackDepth', () => {
  it('gives each cell within 1 / 1024, from planes to noise', async () => {
    const next = random(5);
    const noise = Array.from({ length: 160 * 160 }, () => next());
    const noiseAt = (column, row) => noise[row * 160 + column];
    await assertUnpacks(onCells(plane(0.01, 0.3, 0.02)));
    await assertUnpacks((column, row) => 0.001 * 32000 ** noiseAt(column, row));
    await assertUnpacks((column, row) => (noiseAt(column, row) < 0.5 ? Infinity : 300 * noiseAt(column, row)));
    await assertUnpacks((column, row) => 1 + row * column, [2, 2]);
    await assertUnpacks(() => 7, [1, 1]);
    await assertUnpacks((column, row) => 0.5 + noiseAt(column, row), [160, 160]);
  });

  it('knows pictures without anything in them', async () => {
    const { near, far, bytes } = await assertUnpacks(() => Infinity);
    assert.deepEqual([near, far], [0, 0]);
    assert.ok(bytes.length < 100);
  });

  it('refuses what means nothing with a FrameError', async () => {
    const good = packed(onCells(plane(0.01, 0.3, 0.02)));
    const bad = {
      'no zlib stream': { bytes: new Uint8Array([1, 2, 3]) },
      'an end too early': { bytes: good.bytes.slice(0, -20) },
      'too few cells': { bytes: new Uint8Array(deflateSync(new Uint8Array(100))) },
      'a bomb': { bytes: new Uint8Array(deflateSync(new Uint8Array(1 << 26))) },
      'a code beyond the nearest': { bytes: new Uint8Array(deflateSync(new Uint8Array(2 * width * height).fill(0xff))) },
      'no nearest': { near: 0, far: 0 },
    };
    for (const [what, change] of Object.entries(bad)) {
      await assert.rejects(unpackDepth({ ...good, ...change }), FrameError, what);
    }
  });
});

describe('inverseDepthAt', () => {
  it('lies on the surface: flat, steep and up to the horizon', async () => {
    const ground = plane(0, 0.5, -0.1); // its horizon is at v = 0.2
    for (const [what, depthAt] of Object.entries({
      flat: plane(0, 0, 0.1), slanted: plane(0.05, -0.02, 0.1), ground: (u, v) => (v > 0.2 ? ground(u, v) : Infinity),
    })) {
      const depth = await unpackDepth(packed(onCells(depthAt)));
      for (let n = 0; n < 500; ++n) {
        const [u, v] = [(n * 0.618034) % 1, (n * 0.7548777) % 1];
        if (v < 0.25) continue;
        const error = inverseDepthAt(depth, u, v) * depthAt(u, v) - 1;
        assert.ok(Math.abs(error) < 2 * step, `${what} at ${u}, ${v}: ${error}`);
      }
    }
  });

  it('does not mix what lies behind each other', async () => {
    const depth = await unpackDepth(packed((column) => (column < 80 ? 2 : 50)));
    for (let n = 0; n < 100; ++n) {
      const u = 0.49 + n * 0.0002;
      const found = 1 / inverseDepthAt(depth, u, 0.5);
      assert.ok(Math.abs(found / (u < 0.5 ? 2 : 50) - 1) < 2 * step, `${found} at ${u}`);
    }
  });

  it('finds what is near in holes, and nothing in the void', async () => {
    const lonely = await unpackDepth(packed((column, row) => (column === 20 && row === 20 ? 5 : Infinity)));
    const at = (column, row) => inverseDepthAt(lonely, (column + 0.5) / width, (row + 0.5) / height);
    assert.ok(Math.abs(at(21.2, 19) * 5 - 1) < step);
    assert.equal(at(22.5, 20), 0);
    assert.equal(at(100, 80), 0);
    const nothing = await unpackDepth(packed(() => Infinity));
    for (const [u, v] of [[0, 0], [1, 1], [0.5, 0.5], [-3, 7]]) assert.equal(inverseDepthAt(nothing, u, v), 0);
  });

  it('reaches to the borders, and knows pictures of one cell', async () => {
    const depthAt = plane(0.3, 0.2, 0.1);
    const depth = await unpackDepth(packed(onCells(depthAt)));
    for (const [u, v] of [[0, 0], [1, 0], [0, 1], [1, 1]]) {
      assert.ok(Math.abs(inverseDepthAt(depth, u, v) * depthAt(u, v) - 1) < 3 * step);
    }
    const one = await unpackDepth(packed(() => 4, [1, 1]));
    assert.equal(inverseDepthAt(one, 0.9, 0.1), 0.25);
  });
});
