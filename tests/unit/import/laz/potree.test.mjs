// Potree octrees: what an independent writer wrote is read back, point for point; damage is told.
import assert from 'node:assert/strict';
import { copyFileSync, mkdirSync, readFileSync, rmSync, symlinkSync, truncateSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import test from 'node:test';

import { ScanFailure } from '../../../../importers/laz/failure.mjs';
import { importPotree, openPotree } from '../../../../importers/laz/potree/import.mjs';
import { CountingWriter, temporaryFolder, testData } from './support/files.mjs';
import { writePotree1, writePotree2 } from './support/potree_writer.mjs';
import { Random } from './support/random.mjs';
import { importHere, pointsDigest, runImporter, sortedPoints } from './support/stream.mjs';

const names = ['r', 'r0', 'r7', 'r03', 'r031', 'r0312', 'r75'];

function randomUnit(random) {
  for (;;) {
    const v = [0, 1, 2].map(() => random.below(2001) / 1000 - 1);
    const length = Math.hypot(...v);
    if (length > 0.1 && length < 1) return v.map((c) => c / length);
  }
}

/// Nodes with points all over the range of 32 bits; `large`: one of them with more than a record of the stream holds.
function nodes2(seed, mostColor, { large = false } = {}) {
  const random = new Random(seed);
  const number = (bits) => random.below(2 ** bits);
  const nodes = new Map(
    names.map((name, i) => [
      name,
      Array.from({ length: 1 + random.below(50 + i) }, () => ({
        xyz: [number(31) - number(30), number(31), -number(31)],
        intensity: number(16),
        classification: number(8),
        time: number(20) / 7,
        rgb: [random.below(mostColor + 1), random.below(mostColor + 1), random.below(mostColor + 1)],
        normal: randomUnit(random),
      })),
    ]),
  );
  const some = nodes.get('r7');
  if (large)
    nodes.set(
      'r7',
      Array.from({ length: 66000 }, (_, k) => ({ ...some[k % some.length], xyz: [k, 7 * k, -k], intensity: k & 0xffff })),
    );
  return nodes;
}

const scale = [0.001, 0.002, 0.25];
const offset = [1000, -2000, 0.5];

for (const encoding of ['DEFAULT', 'BROTLI'])
  for (const [mostColor, high] of [[255, false], [65535, true]])
    test(`Potree 2, ${encoding}, colours up to ${mostColor}`, async (t) => {
      const folder = temporaryFolder(t);
      const nodes = nodes2(mostColor, mostColor, { large: high });
      writePotree2(folder, nodes, { encoding, ownChunk: ['r03', 'r0312'], change: { projection: 'EPSG:25832' } });
      const scan = await importHere(importPotree, folder);
      assert.deepEqual(scan.notes, []);
      assert.equal(scan.format, `Potree 2.0, ${encoding}`);
      assert.equal(scan.epsg, 25832);
      assert.deepEqual([scan.gridStep, scan.gridOrigin], [scale, offset]);
      const points = [...nodes.values()].flat();
      assert.equal(scan.points, points.length);
      assert.equal(scan.declared, points.length);
      const expected = {
        points: points.length,
        position: Float64Array.from(points.flatMap(({ xyz }) => xyz.map((v, i) => offset[i] + v * scale[i]))),
        color: Uint8Array.from(points.flatMap(({ rgb }) => rgb.map((v) => (high ? v >> 8 : v)))),
        intensity: Uint16Array.from(points.map((p) => p.intensity)),
        classification: Uint8Array.from(points.map((p) => p.classification)),
      };
      assert.deepEqual(sortedPoints(scan), sortedPoints(expected));
      // Normals go with their points; in the order of the hierarchy file the root comes first.
      nodes.get('r').forEach(({ normal }, i) =>
        normal.forEach((v, k) => assert.ok(Math.abs(scan.normal[3 * i + k] - v) < 1e-6)),
      );
    });

// The cube of "r75" is the half, then the quarter, that its digits say: x is bit 2, y bit 1, z bit 0.
const corner1 = { r: [10, 20, 30], r0: [10, 20, 30], r7: [14, 24, 34], r03: [10, 22, 32], r031: [10, 22, 33], r0312: [10, 22.5, 33], r75: [16, 24, 36] };

const oct = ([x, y, z]) => {
  const sum = Math.abs(x) + Math.abs(y) + Math.abs(z);
  let [u, v] = [x / sum, y / sum];
  if (z < 0) [u, v] = [(1 - Math.abs(v)) * (x < 0 ? -1 : 1), (1 - Math.abs(u)) * (y < 0 ? -1 : 1)];
  return Buffer.from([u, v].map((c) => Math.round(((c + 1) / 2) * 255)));
};
const sphere = ([x, y, z]) => {
  const f = Math.sqrt(8 * z + 8) || 1;
  return Buffer.from([x / f + 0.5, y / f + 0.5].map((c) => Math.round(c * 255)));
};
const floats = (v) => Buffer.from(Float32Array.from(v).buffer);

// How far a normal may be off: the finest step of two bytes on a sphere; at the rim of the mirror ball much coarser.
for (const [kind, pack, within] of [
  ['NORMAL_OCT16', oct, 0.03],
  ['NORMAL_SPHEREMAPPED', sphere, 0.2],
  ['NORMAL', floats, 1e-6],
])
  test(`Potree 1.7, BIN, ${kind}`, async (t) => {
    const folder = temporaryFolder(t);
    const random = new Random(5);
    const unit = () => {
      const v = randomUnit(random);
      return v[2] < -0.9 ? [v[0], v[1], -v[2]] : v;
    };
    const nodes = new Map(
      names.map((name) => [
        name,
        Array.from({ length: 1 + random.below(30) }, () => {
          const direction = unit();
          return {
            direction,
            // Points just outside of their cube are there, too: numbers have a sign.
            xyz: [random.below(200) - 20, random.below(200), -random.below(3)],
            rgba: Buffer.from([random.below(256), random.below(256), random.below(256), 0]),
            intensity: random.below(65536),
            classification: random.below(256),
            normal: pack(direction),
          };
        }),
      ]),
    );
    writePotree1(folder, nodes, { normal: kind });
    const scan = await importHere(importPotree, join(folder, 'cloud.js'));
    assert.deepEqual(scan.notes, []);
    assert.equal(scan.format, 'Potree 1.7, BIN');
    const all = [...nodes].flatMap(([name, points]) => points.map((p) => ({ ...p, name })));
    const expected = {
      points: all.length,
      position: Float64Array.from(all.flatMap(({ name, xyz }) => xyz.map((v, i) => corner1[name][i] + v * 0.01))),
      color: Uint8Array.from(all.flatMap(({ rgba }) => [...rgba.subarray(0, 3)])),
      intensity: Uint16Array.from(all.map((p) => p.intensity)),
      classification: Uint8Array.from(all.map((p) => p.classification)),
    };
    assert.deepEqual(sortedPoints(scan), sortedPoints(expected));
    nodes.get('r').forEach(({ direction }, i) => {
      const found = scan.normal.subarray(3 * i, 3 * i + 3);
      assert.ok(Math.abs(Math.hypot(...found) - 1) < 1e-5);
      assert.ok(Math.hypot(...direction.map((v, k) => v - found[k])) < within, `${direction} / ${found}`);
    });
  });

const point1 = { xyz: [1, 2, 3], rgba: [1, 2, 3, 4], intensity: 5, classification: 6, normal: oct([0, 0, 1]) };
/// 1, 2, 3 … points in the nodes, as BIN or LAS.
const small1 = () => new Map(names.map((name, i) => [name, Array.from({ length: i + 1 }, () => point1)]));
const all1 = names.length * (names.length + 1) / 2;
const leaves = new Set(['r0312', 'r75']);

// What PotreeConverter 1.7 leaves behind, and the number of points that its .hrc files speak of.
const stale = {
  'leaves count 0': { counted: (name, points) => (leaves.has(name) ? 0 : points) },
  'all counts are of an earlier flush': { counted: (_, points) => points >> 1 },
  'a later child is in its own file only': { maskedIn: (root, name) => root === name || name.length - root.length < 2 },
};
for (const las of [false, true])
  for (const [what, how] of Object.entries(stale))
    test(`Potree 1.7, ${las ? 'LAS' : 'BIN'}: ${what}`, async (t) => {
      const folder = temporaryFolder(t);
      writePotree1(folder, small1(), { las, ...how, change: { points: all1 } });
      const writer = new CountingWriter();
      await importPotree(folder, writer);
      assert.equal(writer.scan.points, all1);
      assert.equal(writer.points, all1);
      assert.deepEqual(writer.notes, []);
    });

test('Potree 1.7: what hierarchy, cloud.js and files say differently is told', async (t) => {
  const told = async (how, change, words, points) => {
    const folder = temporaryFolder(t);
    writePotree1(folder, small1(), how);
    change(folder);
    const writer = new CountingWriter();
    await importPotree(folder, writer);
    assert.equal(writer.points, points);
    assert.equal(writer.notes.length, 1, writer.notes.join('; '));
    assert.match(writer.notes[0], words);
  };
  const nothing = () => {};
  await told({ change: { points: 5 } }, nothing, /^cloud.js says 5 points, the octree's files hold 28; these were read$/, all1);
  await told({ change: { points: 1e9 } }, nothing, /^cloud.js says 1,000,000,000 points/, all1);
  await told(
    { counted: (name, points) => (name === 'r03' ? 9 : points) },
    nothing,
    /^1 of its files hold fewer points than its hierarchy says \(data\/r\/03\/r03.bin 4 of 9\)/,
    all1,
  );
  await told(
    {},
    (f) => copyFileSync(join(f, 'data/r/r7.bin'), join(f, 'data/r/r5.bin')),
    /^1 of its files \(3 points; one is data\/r\/r5.bin\) are not in its hierarchy; they were read, too$/,
    all1 + 3,
  );
});

test('Potree 1.7: a node of 0 points may lack its file, unless the hierarchy counts 0 where points are', async (t) => {
  const empty = (nodes) => nodes.set('r75', []);
  const importOf = async (how) => {
    const folder = temporaryFolder(t);
    writePotree1(folder, empty(small1()), how);
    rmSync(join(folder, 'data/r/75/r75.bin'));
    const writer = new CountingWriter();
    await importPotree(folder, writer);
    return writer.points;
  };
  assert.equal(await importOf({}), all1 - names.length);
  await assert.rejects(importOf({ counted: () => 0 }), /file data\/r\/75\/r75.bin is missing$/);
});

test('Potree 1.7: nodes without a point', async (t) => {
  for (const las of [false, true]) {
    const folder = temporaryFolder(t);
    writePotree1(folder, small1().set('r7', []), { las });
    const writer = new CountingWriter();
    await importPotree(folder, writer);
    assert.equal(writer.points, all1 - 3);
  }
});

// PotreeConverter starts its search for the minimum at -1, so that BROTLI holds every number one step too high; Potree
// shows it so. Apart from that step, both encodings of the real lion hold the same points.
test('the lion in both encodings', (t) => {
  const plain = testData(t, 'potree/lion2_uncompressed');
  const brotli = plain && testData(t, 'potree/lion2_brotli');
  if (!brotli) return;
  const steps = (path, more) => {
    const scan = runImporter('scancast-import-potree', path);
    assert.deepEqual(scan.notes, []);
    const position = scan.position.map((v, i) => Math.round((v - scan.gridOrigin[i % 3]) / scan.gridStep[i % 3]) - more);
    return pointsDigest({ ...scan, position });
  };
  assert.deepEqual(steps(brotli, 1), steps(plain, 0));
});

/// A sound octree, something done to it, and the words that the importer has for that.
const damages2 = [
  [(f) => rmSync(join(f, 'octree.bin')), /file octree.bin is missing/],
  [(f) => rmSync(join(f, 'hierarchy.bin')), /file hierarchy.bin is missing/],
  [(f) => truncateSync(join(f, 'octree.bin'), 1000), /node r\d* is said to end at byte [\d,]+ of octree.bin, which has 1,000/],
  [(f) => truncateSync(join(f, 'hierarchy.bin'), 100), /chunk of the node r is said to have 110 bytes at byte 0; the file has 100/],
  [(f) => patch(f, 'hierarchy.bin', (b) => b.writeUInt8(9, 0)), /node r is of kind 9/],
  [(f) => patch(f, 'hierarchy.bin', (b) => b.writeUInt32LE(12345, 2)), /node r has [\d,]+ bytes; its 12,345 points need/],
  [(f) => patch(f, 'hierarchy.bin', (b) => b.writeBigUInt64LE(0n, 3 * 22 + 6)), /share the chunk there: a circle/],
  [(f) => json(f, 'metadata.json', (m) => (m.encoding = 'ZIP')), /encoding "ZIP" is not known/],
  [(f) => json(f, 'metadata.json', (m) => (m.version = '3.0')), /version "3.0"/],
  [(f) => json(f, 'metadata.json', (m) => (m.scale = [1, 2])), /"scale" must be three numbers/],
  [(f) => json(f, 'metadata.json', (m) => (m.scale = [1, -2, 1])), /scale must be positive/],
  [(f) => json(f, 'metadata.json', (m) => (m.attributes[1].size = 1e9)), /size of the attribute "intensity" is 1000000000/],
  [(f) => json(f, 'metadata.json', (m) => m.attributes.shift()), /no position/],
  [(f) => json(f, 'metadata.json', (m) => (m.hierarchy = null)), /"hierarchy.firstChunkSize" is undefined/],
  [(f) => writeFileSync(join(f, 'metadata.json'), '{"version": '), /metadata.json is not valid JSON/],
  [(f) => rmSync(join(f, 'octree.bin')) ?? symlinkSync('/etc/hostname', join(f, 'octree.bin')), /octree.bin is outside its folder/],
];

const damages1 = [
  [(f) => rmSync(join(f, 'data/r/03/r031.bin')), /data\/r\/03\/r031.bin is missing/],
  [(f) => rmSync(join(f, 'data/r/03/r03.hrc')), /data\/r\/03\/r03.hrc is missing/],
  [(f) => truncateSync(join(f, 'data/r/r7.bin'), 3), /r7.bin has 3 bytes, no whole number of points of 21 bytes/],
  [(f) => ['r', 'r7'].forEach((n) => rmSync(join(f, `data/r/${n}.bin`))), /r.bin is missing and so are 1 more/],
  [(f) => truncateSync(join(f, 'data/r/r.hrc'), 10), /r.hrc ends at byte 10, before the node/],
  [(f) => truncateSync(join(f, 'data/r/r.hrc'), 7), /no multiple of 5/],
  [(f) => patch(f, 'data/r/r.hrc', (b) => b.writeUInt8(0, 0)), /its 1 nodes need less/],
  [(f) => json(f, 'cloud.js', (c) => (c.octreeDir = '../..')), /outside its folder/],
  [(f) => json(f, 'cloud.js', (c) => (c.octreeDir = '/etc')), /missing|outside/],
  [(f) => json(f, 'cloud.js', (c) => (c.octreeDir = 7)), /"octreeDir" must be a folder/],
  [(f) => json(f, 'cloud.js', (c) => (c.hierarchyStepSize = 0)), /"hierarchyStepSize" is 0/],
  [(f) => json(f, 'cloud.js', (c) => (c.hierarchy = [['r', 1], ['r', 1]])), /the node r twice/],
  [(f) => json(f, 'cloud.js', (c) => (c.hierarchy = [['../../r', 1]])), /has no name like "r042"/],
  [(f) => json(f, 'cloud.js', (c) => (c.pointAttributes = ['POSITION_CARTESIAN', 'TASTE'])), /attribute "TASTE" is not known/],
  [(f) => json(f, 'cloud.js', (c) => (c.scale = 'big')), /"scale" is "big"/],
  [(f) => json(f, 'cloud.js', (c) => (c.version = '0.9')), /cloud.js has version "0.9"/],
  [(f) => rmSync(join(f, 'cloud.js')), /without cloud.js or metadata.json/],
];

function patch(folder, name, change) {
  const bytes = readFileSync(join(folder, name));
  change(bytes);
  writeFileSync(join(folder, name), bytes);
}

function json(folder, name, change) {
  const value = JSON.parse(readFileSync(join(folder, name), 'utf8'));
  change(value);
  writeFileSync(join(folder, name), JSON.stringify(value));
}

async function expectRefused(folder, words) {
  await assert.rejects(importPotree(folder, new CountingWriter()), (error) => {
    assert.ok(error instanceof ScanFailure, error.stack);
    assert.match(error.message, words);
    return true;
  });
}

const small2 = () => nodes2(3, 255);

test('damaged Potree 2 octrees are told', async (t) => {
  for (const [i, [damage, words]] of damages2.entries()) {
    const folder = join(temporaryFolder(t), String(i));
    writePotree2(folder, small2(), { ownChunk: ['r03', 'r0312'] });
    damage(folder);
    await expectRefused(folder, words);
  }
});

test('a damaged BROTLI node is told', async (t) => {
  const folder = temporaryFolder(t);
  writePotree2(folder, small2(), { encoding: 'BROTLI' });
  patch(folder, 'octree.bin', (b) => b.fill(0xff, 0, 16));
  await expectRefused(folder, /node r cannot be decompressed|node r has [\d,]+ bytes/);
});

test('damaged Potree 1 octrees are told', async (t) => {
  for (const [i, [damage, words]] of damages1.entries()) {
    const folder = join(temporaryFolder(t), String(i));
    mkdirSync(folder);
    writePotree1(folder, small1());
    damage(folder);
    await expectRefused(folder, words);
  }
});

/// Random bytes in the file `name` of a sound octree: reading it ends with all the points that it promises, or in words.
async function expectCleanEnds(folder, name, seeds, leastRefused) {
  const original = readFileSync(join(folder, name));
  let refused = 0;
  for (let seed = 1; seed <= seeds; ++seed) {
    const random = new Random(seed);
    const bytes = Buffer.from(original);
    for (let i = 1 + random.below(3); i > 0; --i) bytes[random.below(bytes.length)] = random.below(256);
    writeFileSync(join(folder, name), random.below(8) === 0 ? bytes.subarray(0, random.below(bytes.length)) : bytes);
    try {
      const { pieces, scan, notes } = openPotree(folder);
      assert.equal(pieces.reduce((sum, { node, chunk }) => sum + (node ?? chunk).points, 0), scan.points);
      assert.ok(notes.every((note) => note.length > 10 && note.length < 500));
      const writer = new CountingWriter();
      // What comes after is the same for all; threads take their time to start.
      if (seed % 8 === 0) await importPotree(folder, writer);
      assert.ok([0, scan.points].includes(writer.points));
    } catch (error) {
      if (!(error instanceof ScanFailure)) throw new Error(`${name}, seed ${seed}`, { cause: error });
      ++refused;
    }
  }
  writeFileSync(join(folder, name), original);
  assert.ok(refused >= leastRefused, `${name}: ${refused} refused`);
}

test('octrees of random bytes end cleanly', async (t) => {
  const second = temporaryFolder(t);
  writePotree2(second, small2(), { ownChunk: ['r03'] });
  await expectCleanEnds(second, 'hierarchy.bin', 30, 10);
  await expectCleanEnds(second, 'metadata.json', 10, 2);
  for (const las of [false, true]) {
    const first = temporaryFolder(t);
    writePotree1(first, small1(), { las, change: { points: all1 } });
    await expectCleanEnds(first, 'data/r/r.hrc', 20, 5);
    await expectCleanEnds(first, 'cloud.js', 10, 2);
    await expectCleanEnds(first, `data/r/r7.${las ? 'las' : 'bin'}`, 10, 0);
  }
});
