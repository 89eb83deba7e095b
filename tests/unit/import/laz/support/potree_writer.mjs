// Writes small Potree octrees for tests, from the published descriptions of the formats; shares no code with what reads
// them. Bits are shuffled with big integers, by a table that is made bit by bit.
import { mkdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { brotliCompressSync, constants } from 'node:zlib';

/// Of every byte: bit i at place 3i.
const spread = Array.from({ length: 256 }, (_, byte) => {
  let code = 0n;
  for (let i = 0; i < 8; ++i) if (byte & (1 << i)) code |= 1n << BigInt(3 * i);
  return code;
});

/// Interleaves three numbers of 16 bits: bit i of number k becomes bit 3i + k.
function interleave(numbers) {
  let code = 0n;
  for (let k = 0; k < 3; ++k) code |= (spread[numbers[k] & 255] | (spread[(numbers[k] >>> 8) & 255] << 24n)) << BigInt(k);
  return code;
}

const words = (codes) => {
  const bytes = Buffer.alloc(8 * codes.length);
  codes.forEach((code, i) => bytes.writeBigUInt64LE(code, 8 * i));
  return bytes;
};

export const attributes2 = [
  { name: 'position', size: 12, numElements: 3, elementSize: 4, type: 'int32' },
  { name: 'intensity', size: 2, numElements: 1, elementSize: 2, type: 'uint16' },
  { name: 'classification', size: 1, numElements: 1, elementSize: 1, type: 'uint8' },
  { name: 'gps-time', size: 8, numElements: 1, elementSize: 8, type: 'double' },
  { name: 'rgb', size: 6, numElements: 3, elementSize: 2, type: 'uint16' },
  { name: 'NormalX', size: 4, numElements: 1, elementSize: 4, type: 'float' },
  { name: 'NormalY', size: 4, numElements: 1, elementSize: 4, type: 'float' },
  { name: 'NormalZ', size: 4, numElements: 1, elementSize: 4, type: 'float' },
];

/// Writes one attribute of one point - { xyz, intensity, classification, time, rgb, normal } - at `at`.
const writers2 = {
  position: (b, at, { xyz }) => xyz.forEach((v, i) => b.writeInt32LE(v, at + 4 * i)),
  intensity: (b, at, { intensity }) => b.writeUInt16LE(intensity, at),
  classification: (b, at, { classification }) => b.writeUInt8(classification, at),
  'gps-time': (b, at, { time }) => b.writeDoubleLE(time, at),
  rgb: (b, at, { rgb }) => rgb.forEach((v, i) => b.writeUInt16LE(v, at + 2 * i)),
  NormalX: (b, at, { normal }) => b.writeFloatLE(normal[0], at),
  NormalY: (b, at, { normal }) => b.writeFloatLE(normal[1], at),
  NormalZ: (b, at, { normal }) => b.writeFloatLE(normal[2], at),
};

/// `attributes` of every point, one point after the other.
function inRecords(points, attributes) {
  const bytes = Buffer.alloc(points.length * attributes.reduce((sum, { size }) => sum + size, 0));
  let at = 0;
  for (const point of points)
    for (const { name, size } of attributes) {
      writers2[name](bytes, at, point);
      at += size;
    }
  return bytes;
}

function encodeBrotli(points) {
  const columns = attributes2.map((attribute) => {
    if (attribute.name === 'position')
      return words(points.flatMap(({ xyz }) => [interleave(xyz.map((v) => v >>> 16)), interleave(xyz)]));
    if (attribute.name === 'rgb') return words(points.map(({ rgb }) => interleave(rgb)));
    return inRecords(points, [attribute]);
  });
  return brotliCompressSync(Buffer.concat(columns), { params: { [constants.BROTLI_PARAM_QUALITY]: 1 } });
}

/// `nodes`: a map from name ("r", "r4") to points. Names in `ownChunk` start a hierarchy chunk of their own.
export function writePotree2(folder, nodes, { encoding = 'DEFAULT', ownChunk = [], change = {} } = {}) {
  mkdirSync(folder, { recursive: true });
  const places = new Map();
  const pieces = [];
  let at = 0;
  for (const [name, points] of nodes) {
    const bytes = encoding === 'BROTLI' ? encodeBrotli(points) : inRecords(points, attributes2);
    places.set(name, { at, bytes: bytes.length, points: points.length });
    pieces.push(bytes);
    at += bytes.length;
  }
  writeFileSync(join(folder, 'octree.bin'), Buffer.concat(pieces));
  const { hierarchy, firstChunkSize } = hierarchy2(places, ownChunk);
  writeFileSync(join(folder, 'hierarchy.bin'), hierarchy);
  const metadata = {
    version: '2.0',
    points: [...nodes.values()].flat().length,
    projection: '',
    hierarchy: { firstChunkSize, stepSize: 4, depth: 3 },
    offset: [1000, -2000, 0.5],
    scale: [0.001, 0.002, 0.25],
    boundingBox: { min: [0, 0, 0], max: [1, 1, 1] },
    encoding,
    attributes: attributes2,
    ...change,
  };
  writeFileSync(join(folder, 'metadata.json'), JSON.stringify(metadata));
  return metadata;
}

function entry2(kind, mask, { points = 0, at = 0, bytes = 0 }) {
  const entry = Buffer.alloc(22);
  entry.writeUInt8(kind, 0);
  entry.writeUInt8(mask, 1);
  entry.writeUInt32LE(points, 2);
  entry.writeBigUInt64LE(BigInt(at), 6);
  entry.writeBigUInt64LE(BigInt(bytes), 14);
  return entry;
}

const childrenOf = (names, name) => [...Array(8).keys()].filter((i) => names.includes(name + i)).map((i) => name + i);
const maskOf = (names, name) => childrenOf(names, name).reduce((mask, child) => mask | (1 << Number(child.at(-1))), 0);

/// Chunks are laid out first, then written, because a reference needs the place of its chunk.
function hierarchy2(places, ownChunk) {
  const names = [...places.keys()];
  const chunks = ['r', ...ownChunk].map((root) => {
    const order = [root];
    for (const name of order) if (name === root || !ownChunk.includes(name)) order.push(...childrenOf(names, name));
    return { root, order };
  });
  let at = 0;
  const chunkPlaces = new Map();
  for (const { root, order } of chunks) {
    chunkPlaces.set(root, { at, bytes: 22 * order.length, points: places.get(root).points });
    at += 22 * order.length;
  }
  const entries = chunks.flatMap(({ root, order }) =>
    order.map((name) =>
      name !== root && ownChunk.includes(name)
        ? entry2(2, maskOf(names, name), chunkPlaces.get(name))
        : entry2(maskOf(names, name) ? 0 : 1, maskOf(names, name), places.get(name)),
    ),
  );
  return { hierarchy: Buffer.concat(entries), firstChunkSize: chunkPlaces.get('r').bytes };
}

/// A LAS 1.2 file of point format 0, points on a grid of 0.01.
function lasNode(points) {
  const head = Buffer.alloc(227);
  head.write('LASF', 'latin1');
  head.set([1, 2], 24);
  head.writeUInt16LE(227, 94);
  head.writeUInt32LE(227, 96);
  head.writeUInt16LE(20, 105);
  head.writeUInt32LE(points.length, 107);
  for (let i = 0; i < 3; ++i) head.writeDoubleLE(0.01, 131 + 8 * i);
  const records = points.map(({ xyz, intensity, classification }) => {
    const bytes = Buffer.alloc(20);
    xyz.forEach((v, i) => bytes.writeInt32LE(v, 4 * i));
    bytes.writeUInt16LE(intensity, 12);
    bytes.writeUInt8(classification, 15);
    return bytes;
  });
  return Buffer.concat([head, ...records]);
}

const binNode = (points) =>
  Buffer.concat(
    points.map((point) => {
      const bytes = Buffer.alloc(12 + 4 + 2 + 1);
      point.xyz.forEach((v, i) => bytes.writeInt32LE(v, 4 * i));
      bytes.set(point.rgba, 12);
      bytes.writeUInt16LE(point.intensity, 16);
      bytes.writeUInt8(point.classification, 18);
      return Buffer.concat([bytes, point.normal]);
    }),
  );

/// Potree 1.7 with BIN or LAS nodes; points are { xyz (steps from the node's corner; LAS: from 0), rgba, intensity,
/// classification, normal: Buffer }. `step`: levels of a .hrc file. `counted(name, points)`: what that says of a node, and
/// `maskedIn(root, name)`: whether the .hrc file of `root` knows that `name` has children.
export function writePotree1(
  folder,
  nodes,
  { step = 2, normal = 'NORMAL_OCT16', las = false, counted = (_, points) => points, maskedIn = () => true, change = {} } = {},
) {
  const names = [...nodes.keys()];
  const pathOf = (name) => {
    let path = 'data/r';
    for (let at = 1; at + step <= name.length; at += step) path += `/${name.slice(at, at + step)}`;
    return path;
  };
  const write = (name, extension, bytes) => {
    mkdirSync(join(folder, pathOf(name)), { recursive: true });
    writeFileSync(join(folder, pathOf(name), `${name}.${extension}`), bytes);
  };
  for (const [name, points] of nodes) write(name, las ? 'las' : 'bin', las ? lasNode(points) : binNode(points));
  for (const root of names.filter((name) => (name.length - 1) % step === 0)) {
    if (root !== 'r' && childrenOf(names, root).length === 0) continue;
    const order = [root];
    for (const name of order) if (name.length - root.length < step) order.push(...childrenOf(names, name));
    const bytes = Buffer.alloc(5 * order.length);
    order.forEach((name, i) => {
      bytes.writeUInt8(maskedIn(root, name) ? maskOf(names, name) : 0, 5 * i);
      bytes.writeUInt32LE(counted(name, nodes.get(name).length), 5 * i + 1);
    });
    write(root, 'hrc', bytes);
  }
  const cloud = {
    version: '1.7',
    octreeDir: 'data',
    boundingBox: { lx: 10, ly: 20, lz: 30, ux: 18, uy: 28, uz: 38 },
    pointAttributes: las ? 'LAS' : ['POSITION_CARTESIAN', 'RGBA_PACKED', 'INTENSITY', 'CLASSIFICATION', normal],
    spacing: 0.1,
    scale: 0.01,
    hierarchyStepSize: step,
    ...change,
  };
  writeFileSync(join(folder, 'cloud.js'), JSON.stringify(cloud));
}
