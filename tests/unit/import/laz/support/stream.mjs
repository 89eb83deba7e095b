// A point stream, read back: written from POINT_STREAM.md, sharing no code with what writes it.
import { execFileSync } from 'node:child_process';
import { closeSync, mkdtempSync, openSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

import { PointStreamWriter } from '../../../../../importers/laz/point_stream.mjs';

const importers = new URL('../../../../../importers/laz/', import.meta.url);

/// The stream that an importer program writes for a path.
export function runImporter(name, path) {
  const program = fileURLToPath(new URL(name, importers));
  return readStream(execFileSync(program, [path], { maxBuffer: 1 << 30, timeout: 120_000 }));
}

/// The stream that importLaz() or importPotree() writes, without a process of its own. Failures are thrown.
export async function importHere(importScan, path) {
  const folder = mkdtempSync(join(tmpdir(), 'scancast-test-'));
  const file = join(folder, 'stream');
  const descriptor = openSync(file, 'w');
  try {
    const writer = new PointStreamWriter(descriptor);
    await importScan(path, writer);
    writer.done();
    return readStream(readFileSync(file));
  } finally {
    closeSync(descriptor);
    rmSync(folder, { recursive: true });
  }
}

const columnBytes = [
  ['color', 1, 3],
  ['intensity', 2, 2],
  ['classification', 4, 1],
  ['normal', 8, 12],
];

/// { format, declared, gridStep, gridOrigin, wkt, epsg, points, position: Float64Array, color, intensity, …, failure }
export function readStream(bytes) {
  const bits = bytes.readUInt16LE(10);
  const known = bytes.readUInt32LE(12);
  const vector = (at) => [0, 8, 16].map((i) => bytes.readDoubleLE(at + i));
  const formatEnd = 136 + bytes.readUInt32LE(124);
  const scan = {
    declared: known & 1 ? Number(bytes.readBigUInt64LE(16)) : undefined,
    gridStep: vector(24),
    gridOrigin: vector(48),
    bounds: known & 2 ? [vector(72), vector(96)] : undefined,
    epsg: known & 4 ? bytes.readInt32LE(120) : undefined,
    format: bytes.toString('latin1', 136, formatEnd),
    wkt: bytes.toString('latin1', formatEnd, formatEnd + bytes.readUInt32LE(128)),
    points: 0,
    notes: [],
  };
  const parts = { position: [] };
  for (const [name, bit] of columnBytes) if (bits & bit) parts[name] = [];
  let at = formatEnd + bytes.readUInt32LE(128);
  for (;;) {
    const tag = bytes.toString('latin1', at, at + 4);
    const n = bytes.readUInt32LE(at + 4);
    at += 8;
    if (tag === 'FAIL') {
      scan.failure = { code: bytes.readUInt32LE(at), text: bytes.toString('latin1', at + 4, at + 4 + n) };
      break;
    }
    if (tag === 'NOTE') {
      scan.notes.push(bytes.toString('latin1', at, at + n));
      at += n;
      continue;
    }
    if (tag === 'DONE') {
      scan.sent = Number(bytes.readBigUInt64LE(at));
      scan.dropped = Number(bytes.readBigUInt64LE(at + 8));
      if (at + 16 !== bytes.length) throw new Error('bytes behind the end');
      break;
    }
    if (tag !== 'CHNK' || n < 1 || n > 65536) throw new Error(`a record ${tag} of ${n} at byte ${at - 8}`);
    scan.points += n;
    for (const [name, size] of [['position', 24], ...columnBytes.map(([name, , size]) => [name, size])]) {
      if (!parts[name]) continue;
      parts[name].push(bytes.subarray(at, at + size * n));
      at += size * n;
    }
  }
  const typed = { position: Float64Array, color: Uint8Array, intensity: Uint16Array, classification: Uint8Array, normal: Float32Array };
  for (const [name, pieces] of Object.entries(parts)) {
    const joined = new Uint8Array(Buffer.concat(pieces));
    scan[name] = new typed[name](joined.buffer, 0, joined.length / typed[name].BYTES_PER_ELEMENT);
  }
  return scan;
}

/// [[min, max] of every one of `width` interleaved numbers].
export function ranges(numbers, width) {
  return Array.from({ length: width }, (_, k) => {
    let [low, high] = [Infinity, -Infinity];
    for (let i = k; i < numbers.length; i += width) {
      low = Math.min(low, numbers[i]);
      high = Math.max(high, numbers[i]);
    }
    return [low, high];
  });
}

/// Every point as one text, sorted: the same for the same points in any order.
export function sortedPoints(scan) {
  const lines = [];
  for (let i = 0; i < scan.points; ++i)
    lines.push(
      [
        ...scan.position.subarray(3 * i, 3 * i + 3),
        ...(scan.color?.subarray(3 * i, 3 * i + 3) ?? []),
        scan.intensity?.[i],
        scan.classification?.[i],
      ].join(' '),
    );
  return lines.sort();
}

/// [points, digest]: the same for the same points in any order, for scans that are too large for sortedPoints(). Positions
/// are whole numbers.
export function pointsDigest({ points, position, color, intensity, classification }) {
  let [sum, mixed] = [0, 0];
  for (let i = 0; i < points; ++i) {
    let hash = 0;
    const add = (value) => (hash = Math.imul(hash ^ value, 0x01000193) ^ (hash >>> 15));
    for (let k = 3 * i; k < 3 * i + 3; ++k) add(position[k]);
    for (let k = 3 * i; k < 3 * i + 3; ++k) add(color[k]);
    add(intensity[i]);
    add(classification[i]);
    sum = (sum + hash) | 0;
    mixed = (mixed + Math.imul(hash, hash | 1)) | 0;
  }
  return [points, sum, mixed];
}
