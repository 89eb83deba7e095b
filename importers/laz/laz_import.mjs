// A LAZ file to the point stream: header, records, chunk table, colours, then every chunk through the workers.
import { grouped, malformed, truncated, unsupported } from './failure.mjs';
import { FileBytes } from './file_bytes.mjs';
import { colorDepth, lasColumns } from './las_columns.mjs';
import { furtherColumns } from './las_extra.mjs';
import { longestHeader, parseLasHeader } from './las_header.mjs';
import { readRecords } from './las_records.mjs';
import { parseLaszipRecord } from './laszip_record.mjs';
import { readChunks } from './chunk_table.mjs';
import { WorkerPool } from './worker_pool.mjs';

// Places across the file where a first look at the colours is taken; any 16-bit file is found out by it.
const firstLooks = 16;
const firstLookPoints = 256;
// Chunks across the file that a reader gets the first points of, to look at while the scan is decoded. Smaller scans are there at once.
const glances = 256;
const glancePoints = 200;
const fewestToGlanceAt = 1_000_000;
// What Scancast accepts at most; real scans have less than one.
const mostPointsPerByte = 1000;

export const workerUrl = new URL('./decode_worker.mjs', import.meta.url);

/// All that is known of a LAZ file before a point is decoded: { las, records, chunks }. `mayBePlain`: LAS will do.
export function openLaz(path, { mayBePlain = false } = {}) {
  const file = new FileBytes(path);
  try {
    const las = parseLasHeader(file.readSome(0, longestHeader));
    if (!las.compressed && mayBePlain) return { las, records: {}, chunks: plainChunks(file, las) };
    if (!las.compressed) throw unsupported('byte 104: it is LAS, not LAZ; Scancast reads that without this program');
    if (las.points > mostPointsPerByte * file.size)
      throw malformed(`it promises ${grouped(las.points)} points; ${grouped(file.size)} bytes cannot hold that`);
    const records = readRecords(file, las);
    const { chunkPoints, itemVersion } = parseLaszipRecord(records.laszip, las);
    las.itemVersion = itemVersion;
    return { las, records, chunks: readChunks(file, las, chunkPoints) };
  } finally {
    file.close();
  }
}

/// Uncompressed records, cut like chunks.
function plainChunks(file, las) {
  const bytes = las.points * las.recordBytes;
  if (las.pointOffset + bytes > file.size)
    throw truncated(`it ends at byte ${grouped(file.size)}: its header promises ${grouped(las.points)} points`);
  return [{ at: las.pointOffset, bytes, points: las.points, isPlain: true }];
}

const what = ({ chunk }) => `the chunk of ${grouped(chunk.points)} points at byte ${grouped(chunk.at)}`;

/// `pieces`: [{ path, las, chunk }]. The same rule as for LAS: 8 bits only if no number in the whole scan is above 255.
export async function judgeColors(pool, pieces, first = undefined) {
  const depth = first ?? (await firstColors(pool, pieces));
  if (depth === colorDepth.sixteenBits || !mayHaveColors(pieces)) return depth;
  return lookAtColors(pool, pieces, Infinity);
}

/// What a first look at a few of them says.
export function firstColors(pool, pieces) {
  if (!mayHaveColors(pieces)) return colorDepth.unknown;
  return lookAtColors(pool, everyFew(pieces, firstLooks), firstLookPoints);
}

const mayHaveColors = (pieces) => !pieces.every(({ las }) => las && !lasColumns(las).color);

/// At most so many, as far apart as they can be.
function everyFew(pieces, count) {
  const step = Math.ceil(pieces.length / count);
  return pieces.filter((_, i) => i % step === 0);
}

async function lookAtColors(pool, pieces, most) {
  let depth = colorDepth.unknown;
  await pool.run(pieces.map((piece) => ({ kind: 'look', what: what(piece), most, ...piece })), (found) => {
    depth = Math.max(depth, found.depth);
    return depth !== colorDepth.sixteenBits;
  });
  return depth;
}

async function writeGlance(pool, pieces, depth, writer) {
  const jobs = everyFew(pieces, glances).map((piece) => (
    { kind: 'decode', what: what(piece), depth, most: Math.min(glancePoints, piece.chunk.points), ...piece }));
  await pool.run(jobs, (part) => {
    if (part.points > 0) writer.glance(part.buffer);
  });
  writer.endGlance();
}

/// Decodes the pieces in their order into `writer`.
export function writePieces(pool, pieces, depth, writer) {
  const jobs = pieces.map((piece) => ({ kind: 'decode', what: what(piece), depth, ...piece }));
  return pool.run(jobs, (part) => writer.chunk(part.buffer, part.points, part.dropped));
}

export async function importLaz(path, writer, { keepAttributes = false } = {}) {
  const { las, records, chunks } = openLaz(path);
  const further = keepAttributes ? furtherColumns(las, records.extraBytes) : undefined;
  const pieces = chunks.map((chunk) => ({ path, las, chunk, further }));
  const pool = new WorkerPool(workerUrl, pieces.length);
  try {
    const first = await firstColors(pool, pieces);
    writer.header({
      format: `LAZ 1.${las.minor}, point format ${las.pointFormat}`,
      points: las.points,
      columns: lasColumns(las),
      bounds: las.bounds,
      gridStep: las.scale,
      gridOrigin: las.offset,
      wkt: records.wkt,
      epsg: records.epsg,
      further: further?.columns,
    });
    // Whether all colours have 8 bits takes a pass over the scan: meanwhile its reader has something to look at.
    if (las.points >= fewestToGlanceAt) await writeGlance(pool, pieces, first, writer);
    const depth = await judgeColors(pool, pieces, first);
    await writePieces(pool, pieces, depth, writer);
  } finally {
    await pool.close();
  }
}
