// Writes small Potree octrees for tests, from the published descriptions of the formats; shares no code with what reads
// them. Bits are shuffled one by one with big integers, slowly and plainly.
import { mkdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { brotliCompressSync } from 'node:zlib';

/// Interleaves three numbers of `bits` bits: bit i of number k becomes bit 3i + k.
function interleave(numbers, bits) {
  let code = 0n;
  for (let i = 0; i < bits; ++i)
    numbers.forEach((n, k) => {
      code |= ((BigInt(n >>> 0) >> BigInt(i)) & 1n) << BigInt(3 * i + k);
    });
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

/// Bytes of one attribute of one point: { xyz, intensity, classification, time, rgb, normal }.
function attributeBytes(point, name) {
  const make = (size, write) => {
    const bytes = Buffer.alloc(size);
    write(bytes);
    return bytes;
  };
  switch (name) {
    case 'position':
      return make(12, (b) => point.xyz.forEach((v, i) => b.writeInt32LE(v, 4 * i)));
    case 'intensity':
      return make(2, (b) => b.writeUInt16LE(point.intensity));
    case 'classification':
      return make(1, (b) => b.writeUInt8(point.classification));
    case 'gps-time':
      return make(8, (b) => b.writeDoubleLE(point.time));
    case 'rgb':
      return make(6, (b) => point.rgb.forEach((v, i) => b.writeUInt16LE(v, 2 * i)));
    default:
      return make(4, (b) => b.writeFloatLE(point.normal['XYZ'.indexOf(name.at(-1))]));
  }
}

function encodePlain(points) {
  return Buffer.concat(points.flatMap((point) => attributes2.map(({ name }) => attributeBytes(point, name))));
}

function encodeBrotli(points) {
  const columns = attributes2.map(({ name }) => {
    if (name === 'position')
      return words(
        points.flatMap(({ xyz }) => [interleave(xyz.map((v) => v >>> 16), 16), interleave(xyz.map((v) => v & 0xffff), 16)]),
      );
    if (name === 'rgb') return words(points.map(({ rgb }) => interleave(rgb, 16)));
    return Buffer.concat(points.map((point) => attributeBytes(point, name)));
  });
  return brotliCompressSync(Buffer.concat(columns));
}

/// `nodes`: a map from name ("r", "r4") to points. Names in `ownChunk` start a hierarchy chunk of their own.
export function writePotree2(folder, nodes, { encoding = 'DEFAULT', ownChunk = [], change = {} } = {}) {
  mkdirSync(folder, { recursive: true });
  const places = new Map();
  const pieces = [];
  let at = 0;
  for (const [name, points] of nodes) {
    const bytes = encoding === 'BROTLI' ? encodeBrotli(points) : encodePlain(points);
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

/// Potree 1.7 with BIN nodes; points are { xyz (steps from the node's corner), rgba, intensity, classification,
/// normal: Buffer }. `step`: levels of a .hrc file.
export function writePotree1(folder, nodes, { step = 2, normal = ['NORMAL_OCT16', 2], change = {} } = {}) {
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
  for (const [name, points] of nodes)
    write(
      name,
      'bin',
      Buffer.concat(
        points.map((point) => {
          const bytes = Buffer.alloc(12 + 4 + 2 + 1);
          point.xyz.forEach((v, i) => bytes.writeUInt32LE(v, 4 * i));
          bytes.set(point.rgba, 12);
          bytes.writeUInt16LE(point.intensity, 16);
          bytes.writeUInt8(point.classification, 18);
          return Buffer.concat([bytes, point.normal]);
        }),
      ),
    );
  for (const root of names.filter((name) => (name.length - 1) % step === 0)) {
    if (root !== 'r' && childrenOf(names, root).length === 0) continue;
    const order = [root];
    for (const name of order) if (name.length - root.length < step) order.push(...childrenOf(names, name));
    const bytes = Buffer.alloc(5 * order.length);
    order.forEach((name, i) => {
      bytes.writeUInt8(maskOf(names, name), 5 * i);
      bytes.writeUInt32LE(nodes.get(name).length, 5 * i + 1);
    });
    write(root, 'hrc', bytes);
  }
  const cloud = {
    version: '1.7',
    octreeDir: 'data',
    boundingBox: { lx: 10, ly: 20, lz: 30, ux: 18, uy: 28, uz: 38 },
    pointAttributes: ['POSITION_CARTESIAN', 'RGBA_PACKED', 'INTENSITY', 'CLASSIFICATION', normal[0]],
    spacing: 0.1,
    scale: 0.01,
    hierarchyStepSize: step,
    ...change,
  };
  writeFileSync(join(folder, 'cloud.js'), JSON.stringify(cloud));
}
