// A Potree octree, 1.x or 2.x, to the point stream: description, nodes, then all points of all nodes.
import { empty } from '../failure.mjs';
import { colorDepth } from '../las_columns.mjs';
import { judgeColors, workerUrl, writePieces } from '../laz_import.mjs';
import { PotreeFolder } from './folder.mjs';
import { readVersion1 } from './version1.mjs';
import { readVersion2 } from './version2.mjs';
import { WorkerPool } from '../worker_pool.mjs';

/// All that is known of an octree before a point is decoded: { pieces, mayHave16Bits, scan, notes }.
export function openPotree(path) {
  const folder = new PotreeFolder(path);
  const json = folder.readJson();
  const octree = folder.entry === 'metadata.json' ? readVersion2(folder, json) : readVersion1(folder, json);
  if (octree.pieces.length === 0) throw empty('it is a Potree octree without points');
  return octree;
}

export async function importPotree(path, writer) {
  const octree = openPotree(path);
  const pool = new WorkerPool(workerUrl, octree.pieces.length);
  try {
    const depth = octree.mayHave16Bits ? await judgeColors(pool, octree.pieces) : colorDepth.eightBits;
    writer.header(octree.scan);
    for (const note of octree.notes) writer.note(note);
    await writePieces(pool, octree.pieces, depth, writer);
  } finally {
    await pool.close();
  }
}
