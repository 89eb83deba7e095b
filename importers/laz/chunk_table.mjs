// Where the chunks of a LAZ file are and how many points each has: the chunk table, checked against the file before
// anything is believed.
import { ArithmeticDecoder, IntegerDecoder } from './arithmetic_decoder.mjs';
import { grouped, malformed, tooLarge, truncated } from './failure.mjs';
import { variableChunks } from './laszip_record.mjs';

/// A chunk is decoded in memory as a whole. Real ones have kilobytes; COPC nodes have a megabyte.
export const longestChunk = 512 * 2 ** 20;

// The table of a billion points in chunks of 50,000 has 20,000 entries.
const mostChunks = 50e6;
const tableHeadBytes = 8;

function placeOfTable(file, las) {
  const start = las.pointOffset + 8;
  if (start > file.size)
    throw truncated(`it ends at byte ${grouped(file.size)}, before its points (byte ${grouped(las.pointOffset)})`);
  const placeOf = (at) => file.readAll(at, 8, 'the place of the chunk table').readBigInt64LE(0);
  let table = placeOf(las.pointOffset);
  // A writer that could not go back has left the place at the end of the file.
  if (table === -1n && file.size >= start + 8) table = placeOf(file.size - 8);
  const place = Number(table);
  if (place >= start && place <= file.size - tableHeadBytes) return place;
  if (place > file.size - tableHeadBytes && place < 2 ** 53)
    throw truncated(
      `byte ${grouped(las.pointOffset)}: the chunk table is said to start at byte ${grouped(place)}; ` +
        `the file ends at byte ${grouped(file.size)}`,
    );
  throw malformed(
    `byte ${grouped(las.pointOffset)}: the place of the chunk table is wrong (${table}): the file was never ` +
      'finished, or it is damaged',
  );
}

function decodeTable(bytes, count, variable, place) {
  const decoder = new ArithmeticDecoder(bytes);
  const integers = new IntegerDecoder(2);
  const counts = variable ? new Uint32Array(count) : null;
  const sizes = new Uint32Array(count);
  for (let i = 0, points = 0, size = 0; i < count; ++i) {
    if (variable) counts[i] = points = integers.decode(decoder, points, 0);
    sizes[i] = size = integers.decode(decoder, size, 1);
    if (decoder.consumed > bytes.length + 8)
      throw malformed(`byte ${grouped(place)}: the chunk table is damaged after ${grouped(i)} of ${grouped(count)} chunks`);
  }
  return { counts, sizes };
}

/// One piece without a table: all that is between the start of the points and the end of the file.
function onlyChunk(file, las) {
  const bytes = file.size - las.pointOffset;
  if (bytes <= 0)
    throw truncated(`it ends at byte ${grouped(file.size)}, before its points (byte ${grouped(las.pointOffset)})`);
  return [{ at: las.pointOffset, bytes, points: las.points, isExact: false }];
}

/// [{ at, bytes, points, isExact }] in the order of the file. isExact: a sound chunk is read to its last byte.
export function readChunks(file, las, chunkPoints) {
  const chunks = chunkPoints === 0 ? onlyChunk(file, las) : readTable(file, las, chunkPoints);
  const longest = chunks.reduce((most, chunk) => Math.max(most, chunk.bytes), 0);
  if (longest > longestChunk)
    throw tooLarge(
      `one of its chunks has ${grouped(longest)} bytes; chunks of up to ${grouped(longestChunk)} can be decoded: ` +
        'write it again in chunks, for example with "laszip -i old.laz -o new.laz"',
    );
  return chunks;
}

function readTable(file, las, chunkPoints) {
  const place = placeOfTable(file, las);
  const start = las.pointOffset + 8;
  const wrong = (reason) => malformed(`byte ${grouped(place)}: the chunk table ${reason}`);
  const head = file.readAll(place, tableHeadBytes, 'the chunk table');
  if (head.readUInt32LE(0) !== 0) throw wrong(`has version ${head.readUInt32LE(0)}; only 0 is known`);
  const count = head.readUInt32LE(4);
  const variable = chunkPoints === variableChunks;
  // Every chunk starts with a whole record: no lie about their number gets past this.
  const most = Math.min(mostChunks, Math.floor((place - start) / las.recordBytes));
  if (count === 0 || count > most + 1)
    throw wrong(`promises ${grouped(count)} chunks; ${grouped(place - start)} bytes of points cannot hold that`);
  if (!variable && count !== Math.ceil(las.points / chunkPoints))
    throw wrong(
      `has ${grouped(count)} chunks of ${grouped(chunkPoints)} points; the header promises ` +
        `${grouped(las.points)} points`,
    );
  const tableBytes = Math.min(file.size - place - tableHeadBytes, 16 * count + 64);
  const { counts, sizes } = decodeTable(
    file.readSome(place + tableHeadBytes, tableBytes),
    count,
    variable,
    place,
  );
  const chunks = [];
  let at = start;
  let left = las.points;
  for (let i = 0; i < count; ++i) {
    const points = variable ? counts[i] : Math.min(chunkPoints, left);
    if (points > left)
      throw wrong(`has more points than the ${grouped(las.points)} that the header promises`);
    if (points > 0 && sizes[i] < las.recordBytes)
      throw wrong(`says that chunk ${grouped(i)} has ${grouped(sizes[i])} bytes for ${grouped(points)} points`);
    if (sizes[i] > place - at)
      throw wrong(`says that chunk ${grouped(i)} at byte ${grouped(at)} has ${grouped(sizes[i])} bytes, beyond the points`);
    if (points > 0) chunks.push({ at, bytes: sizes[i], points, isExact: true });
    at += sizes[i];
    left -= points;
  }
  if (left > 0)
    throw wrong(`has ${grouped(las.points - left)} points; the header promises ${grouped(las.points)}`);
  return chunks;
}
