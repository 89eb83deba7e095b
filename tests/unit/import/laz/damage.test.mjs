// Damaged LAZ: whatever a file says, reading it ends, with as many points as it promises or with a plain sentence, and
// in little memory. Mutations of real files, seeded, in this process; the oracle is that nothing else ever happens.
import assert from 'node:assert/strict';
import { createHash } from 'node:crypto';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import test from 'node:test';

import { createChunkDecoder } from '../../../../importers/laz/chunk_decoder.mjs';
import { ScanFailure } from '../../../../importers/laz/failure.mjs';
import { FileBytes } from '../../../../importers/laz/file_bytes.mjs';
import { importLaz, openLaz } from '../../../../importers/laz/laz_import.mjs';
import { CountingWriter, temporaryFolder, testData } from './support/files.mjs';
import { Random } from './support/random.mjs';

const mostWasmBytes = 128 << 20;
// The last one has 65 chunks, and each takes its time to begin.
const files = {
  'laz/pdrf2-color.laz': 80,
  'laz/pdrf6-1.4.laz': 80,
  'laz/pdrf7-v4-1.4.laz': 80,
  'laz/pdrf8-1.4.laz': 80,
  'copc/1.2-with-color.copc.laz': 25,
};

// Where a lie is worth telling: header fields, LASzip's record, chunk table, the heads of chunks, anywhere.
function placeOf(random, bytes, table, las, chunks) {
  const places = [
    () => 90 + random.below(40),
    () => 227 + random.below(148),
    () => las.headerBytes + random.below(las.pointOffset - las.headerBytes),
    () => las.pointOffset + random.below(8),
    () => table + random.below(bytes.length - table),
    () => random.of(chunks).at + random.below(las.recordBytes + 60),
    () => random.below(bytes.length),
  ];
  return Math.min(bytes.length - 8, random.of(places)());
}

function mutate(random, original, las, chunks) {
  if (random.below(10) === 0) return original.subarray(0, random.below(original.length));
  const bytes = Buffer.from(original);
  const table = Number(original.readBigInt64LE(las.pointOffset));
  for (let i = 1 + random.below(4); i > 0; --i) {
    const at = placeOf(random, bytes, table, las, chunks);
    const ways = [
      () => bytes.writeUInt8(random.below(256), at),
      () => bytes.writeUInt8(bytes[at] ^ (1 << random.below(8)), at),
      () => bytes.writeUInt32LE(random.of([0, 1, 0x7fffffff, 0xffffffff, original.length, 65536]), at),
      () => bytes.writeUInt32LE(random.below(2 ** 31), at),
      () => bytes.writeBigInt64LE(random.of([-1n, 0n, 1n << 62n, BigInt(original.length), -(1n << 63n)]), at),
      () => bytes.writeDoubleLE(random.of([NaN, Infinity, -1, 1e308, 0]), at),
    ];
    random.of(ways)();
  }
  return bytes;
}

/// Everything the importer does, without its threads. Returns the number of points.
async function decodeAll(path, decoder) {
  const { las, chunks } = openLaz(path);
  const file = new FileBytes(path);
  let points = 0;
  try {
    for (const chunk of chunks)
      await decoder.decode(file, las, chunk, 65536, (heap, at, count) => {
        assert.ok(heap.length < mostWasmBytes);
        points += count;
      });
    assert.equal(points, las.points);
  } finally {
    file.close();
  }
  return points;
}

for (const [name, mutations] of Object.entries(files))
  test(`${name}: ${mutations} mutations end cleanly`, async (t) => {
    const path = testData(t, name);
    if (!path) return;
    const folder = temporaryFolder(t);
    const original = readFileSync(path);
    const { las, chunks } = openLaz(path);
    let decoder = await createChunkDecoder();
    await decodeAll(path, decoder);
    let refused = 0;
    for (let seed = 1; seed <= mutations; ++seed) {
      const mutated = join(folder, `${seed}.laz`);
      writeFileSync(mutated, mutate(new Random(seed), original, las, chunks));
      try {
        await decodeAll(mutated, decoder);
      } catch (error) {
        if (!(error instanceof ScanFailure)) throw new Error(`seed ${seed}`, { cause: error });
        assert.ok(error.code >= 1 && error.code <= 6 && error.message.length > 10, `seed ${seed}: ${error.message}`);
        decoder = await createChunkDecoder();
        ++refused;
      }
    }
    // A test that refuses nothing would not have damaged anything.
    assert.ok(refused > mutations / 5, `${refused} refused`);
  });

/// SHA-256 of all records as they are in an uncompressed file.
async function digestOf(path) {
  const { las, chunks } = openLaz(path);
  const decoder = await createChunkDecoder();
  const file = new FileBytes(path);
  const hash = createHash('sha256');
  for (const chunk of chunks)
    await decoder.decode(file, las, chunk, 100, (heap, at, count) => {
      hash.update(heap.subarray(at, at + count * las.recordBytes));
    });
  file.close();
  return hash.digest('hex');
}

// The digest is of the uncompressed file that LASzip made this one of: 1,024 points of all four scanner channels, in turn.
test('items of version 4 are what LASzip wrote', async (t) => {
  const path = testData(t, 'laz/pdrf7-v4-1.4.laz');
  if (path) assert.equal(await digestOf(path), '5c1f5876c2aa56021db223b39762ec6fb81555743cfa8e8ac18f2df74dc6fbf3');
});

test('chunks of 0 points are chunks of which the table says how many points they have', async (t) => {
  const withZero = (name) => {
    const path = testData(t, name);
    if (!path) return [];
    const bytes = readFileSync(path);
    const record = bytes.indexOf('laszip encoded') - 2 + 54;
    bytes.writeUInt32LE(0, record + 12);
    const file = join(temporaryFolder(t), 'zero.laz');
    writeFileSync(file, bytes);
    return [path, file];
  };
  const [copc, copcWithZero] = withZero('copc/ellipsoid.copc.laz');
  if (!copc) return;
  assert.deepEqual(openLaz(copcWithZero).chunks, openLaz(copc).chunks);
  // A table that does not say it is found out.
  const [, fixed] = withZero('laz/pdrf8-1.4.laz');
  if (fixed) assert.throws(() => openLaz(fixed), ScanFailure);
});

test('damage is told by byte and reason, through the worker threads', async (t) => {
  const path = testData(t, 'laz/pdrf8-1.4.laz');
  if (!path) return;
  const folder = temporaryFolder(t);
  const original = readFileSync(path);
  const { las, chunks } = openLaz(path);
  const table = Number(original.readBigInt64LE(las.pointOffset));
  const lies = [
    [(b) => b.writeUInt32LE(999, 107) && b.writeBigUInt64LE(999n, 247), /chunk table says|chunk .* damaged|has 4 chunks|header promises 999/],
    [(b) => b.writeUInt32LE(0, 107) && b.writeBigUInt64LE(0n, 247), /without points/],
    [(b) => b.writeUInt32LE(0xffffffff, table + 4), /chunk table promises 4,294,967,295 chunks/],
    [(b) => b.writeUInt32LE(7, table), /chunk table has version 7/],
    [(b) => b.writeBigInt64LE(-5n, las.pointOffset), /place of the chunk table is wrong \(-5\)/],
    [(b) => b.writeBigInt64LE(1n << 40n, las.pointOffset), /chunk table is said to start at byte 1,099,511,627,776/],
    [(b) => b.writeUInt32LE(257, chunks[1].at + las.recordBytes), /chunk of 256 points at byte [\d,]+ .* says that it has 257/],
    [(b) => b.writeUInt32LE(1 << 30, chunks[2].at + las.recordBytes + 8), /its layers would end after/],
    [(b) => b.writeUInt8(0x89, 104), /a point record has 42 bytes; point format 9 needs 59/],
    [(b) => b.writeUInt8(0x85, 104), /point format 5 needs 63/],
    [(b) => b.writeUInt8(0x87, 104), /its LASzip record .* does not describe the records/],
  ];
  for (const [lie, expected] of lies) {
    const bytes = Buffer.from(original);
    lie(bytes);
    const file = join(folder, 'lie.laz');
    writeFileSync(file, bytes);
    await assert.rejects(importLaz(file, new CountingWriter()), (error) => {
      assert.ok(error instanceof ScanFailure, error.stack);
      assert.match(error.message, expected);
      return true;
    });
  }
});

test('every truncation is told', async (t) => {
  const path = testData(t, 'laz/pdrf2-color.laz');
  if (!path) return;
  const folder = temporaryFolder(t);
  const original = readFileSync(path);
  for (let length = 1; length < original.length; length += 499) {
    const file = join(folder, 'cut.laz');
    writeFileSync(file, original.subarray(0, length));
    assert.throws(() => openLaz(file), ScanFailure, `${length} bytes`);
  }
});
