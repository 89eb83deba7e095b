// A set of EPT made of a COPC file: the same voxels, each chunk a LAZ file of its own. So whoever shows the one shows the other, and real tiles
// are compressed by whoever compressed the COPC file.

import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

const [headerBytes, recordHeadBytes, entryBytes] = [375, 54, 32];

/** Levels that a page of the hierarchy has, before it refers to others. */
const levelsOfPage = 2;

function laszipRecord(copc) {
  let at = headerBytes;
  for (let left = copc.readUInt32LE(100); left > 0; --left) {
    const length = copc.readUInt16LE(at + 20);
    if (copc.toString('latin1', at + 2, at + 16) === 'laszip encoded') return copc.subarray(at, at + recordHeadBytes + length);
    at += recordHeadBytes + length;
  }
  throw new Error('no LASzip record');
}

/** Key → where its chunk is. */
function voxelsOf(copc) {
  const voxels = new Map();
  const pages = [[Number(copc.readBigUInt64LE(469)), Number(copc.readBigUInt64LE(477))]];
  for (const [start, bytes] of pages) {
    for (let at = start; at < start + bytes; at += entryBytes) {
      const key = [0, 4, 8, 12].map((field) => copc.readInt32LE(at + field));
      const [offset, size, points] = [Number(copc.readBigUInt64LE(at + 16)), copc.readInt32LE(at + 24), copc.readInt32LE(at + 28)];
      if (points === -1) pages.push([offset, size]);
      else if (points > 0) voxels.set(key.join('-'), { key, offset, size, points });
    }
  }
  return voxels;
}

/** A file with one chunk, whose table nobody wrote: all of it is that chunk. */
function tileOf(copc, { offset, size, points }) {
  const record = Buffer.from(laszipRecord(copc));
  record.writeUInt32LE(Math.max(points, 1), recordHeadBytes + 12);
  const head = Buffer.from(copc.subarray(0, headerBytes));
  const pointsAt = headerBytes + record.length;
  head.writeUInt32LE(pointsAt, 96);
  head.writeUInt32LE(1, 100);
  head.writeBigUInt64LE(0n, 235);
  head.writeUInt32LE(0, 243);
  head.writeBigUInt64LE(BigInt(points), 247);
  const table = Buffer.alloc(8);
  table.writeBigInt64LE(BigInt(pointsAt));
  return Buffer.concat([head, record, table, copc.subarray(offset, offset + size)]);
}

function pageOf([level, ...at]) {
  const above = level - Math.floor(level / levelsOfPage) * levelsOfPage;
  return [level - above, ...at.map((place) => place >> above)].join('-');
}

/** Writes it to `folder`, and returns how many points each tile has, by its key. */
export function writeEptOfCopc(file, folder) {
  const copc = readFileSync(file);
  const voxels = voxelsOf(copc);
  for (const part of ['ept-data', 'ept-hierarchy']) mkdirSync(join(folder, part), { recursive: true });
  const pages = { '0-0-0-0': {} };
  for (const [name, voxel] of voxels) {
    writeFileSync(join(folder, `ept-data/${name}.laz`), tileOf(copc, voxel));
    const page = pageOf(voxel.key);
    (pages[page] ??= {})[name] = voxel.points;
    const [level, ...at] = voxel.key;
    // The page above refers to the one that begins here.
    if (name === page && level > 0) (pages[pageOf([level - 1, ...at.map((place) => place >> 1)])] ??= {})[name] = -1;
  }
  for (const [name, page] of Object.entries(pages)) writeFileSync(join(folder, `ept-hierarchy/${name}.json`), JSON.stringify(page));
  const [x, y, z, half] = [429, 437, 445, 453].map((at) => copc.readDoubleLE(at));
  const [[maxX, minX], [maxY, minY], [maxZ, minZ]] = [179, 195, 211].map((at) => [copc.readDoubleLE(at), copc.readDoubleLE(at + 8)]);
  const axis = (name, scale, offset) => ({ name, type: 'signed', size: 4, scale: copc.readDoubleLE(scale), offset: copc.readDoubleLE(offset) });
  const number = (name, size) => ({ name, type: 'unsigned', size });
  writeFileSync(join(folder, 'ept.json'), JSON.stringify({
    version: '1.1.0', dataType: 'laszip', hierarchyType: 'json', span: 128,
    points: [...voxels.values()].reduce((sum, { points }) => sum + points, 0),
    bounds: [x - half, y - half, z - half, x + half, y + half, z + half], boundsConforming: [minX, minY, minZ, maxX, maxY, maxZ],
    schema: [axis('X', 131, 155), axis('Y', 139, 163), axis('Z', 147, 171), number('Intensity', 2), number('Classification', 1),
      number('Red', 2), number('Green', 2), number('Blue', 2)],
  }));
  return new Map([...voxels].map(([name, { points }]) => [name, points]));
}
