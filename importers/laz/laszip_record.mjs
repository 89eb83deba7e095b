// LASzip's record: how the points are compressed, and whether laz-perf can undo it. Pure functions on bytes.
import { malformed, unsupported } from './failure.mjs';
import { recordLayout } from './las_header.mjs';

export const variableChunks = 0xffffffff;

const headBytes = 34;
const mostItems = 32;
const itemName = {
  0: 'BYTE',
  6: 'POINT10',
  7: 'GPSTIME11',
  8: 'RGB12',
  9: 'WAVEPACKET13',
  10: 'POINT14',
  11: 'RGB14',
  12: 'RGBNIR14',
  13: 'WAVEPACKET14',
  14: 'BYTE14',
};

// Items of the point formats that laz-perf decodes, without extra bytes: [kind, bytes].
const decodable = {
  0: [[6, 20]],
  1: [[6, 20], [7, 8]],
  2: [[6, 20], [8, 6]],
  3: [[6, 20], [7, 8], [8, 6]],
  6: [[10, 30]],
  7: [[10, 30], [11, 6]],
  8: [[10, 30], [12, 8]],
};
const waveforms = new Set([4, 5, 9, 10]);

/// From point format 6 on, LASzip compresses in layers, one for each field.
export const isLayered = (pointFormat) => pointFormat >= 6;

function parseItems(bytes) {
  const count = bytes.readUInt16LE(32);
  if (count > mostItems || headBytes + 6 * count > bytes.length)
    throw malformed(`its LASzip record is damaged: ${count} items in ${bytes.length} bytes`);
  const items = [];
  for (let at = headBytes; at < headBytes + 6 * count; at += 6)
    items.push({ kind: bytes.readUInt16LE(at), bytes: bytes.readUInt16LE(at + 2), version: bytes.readUInt16LE(at + 4) });
  return items;
}

const describe = (items) =>
  items.map((item) => `${itemName[item.kind] ?? `kind ${item.kind}`} version ${item.version}`).join(', ');

function checkItems(las, items) {
  const layered = isLayered(las.pointFormat);
  const extra = las.recordBytes - recordLayout(las.pointFormat).bytes;
  const wanted = [...decodable[las.pointFormat], ...(extra > 0 ? [[layered ? 14 : 0, extra]] : [])];
  const same =
    items.length === wanted.length &&
    items.every((item, i) => item.kind === wanted[i][0] && item.bytes === wanted[i][1]);
  if (!same)
    throw malformed(
      `its LASzip record (${describe(items)}) does not describe the records of ${las.recordBytes} bytes of ` +
        `point format ${las.pointFormat}`,
    );
  const known = layered ? [3, 4] : [2];
  const { version } = items[0];
  if (!known.includes(version) || items.some((item) => item.version !== version))
    throw unsupported(
      `it is LAZ with items that cannot be decoded here (${describe(items)}; version ${known.join(' and ')} can): ` +
        'write it again with a newer LASzip, for example with "laszip -i old.laz -o new.laz"',
    );
  return version;
}

/// Checks that the points can be decoded. Returns { chunkPoints, itemVersion }: how they are cut - variableChunks where
/// the chunk table says it for each, 0 for one single piece without a table -, and the version that all items have.
export function parseLaszipRecord(bytes, las) {
  if (waveforms.has(las.pointFormat))
    throw unsupported(
      `it is LAZ with point format ${las.pointFormat} (waveforms), which is not decoded here: decompress it to LAS ` +
        'first, for example with "laszip -i scan.laz -o scan.las"',
    );
  if (!bytes) throw malformed('it is marked as LAZ but has no LASzip record (user "laszip encoded", number 22204)');
  if (bytes.length < headBytes) throw malformed(`its LASzip record has ${bytes.length} bytes; ${headBytes} are needed`);
  const compressor = bytes.readUInt16LE(0);
  const coder = bytes.readUInt16LE(2);
  const chunkPoints = bytes.readUInt32LE(12);
  if (compressor < 1 || compressor > 3)
    throw unsupported(`LAZ compressor ${compressor} is not known here; 1 (point by point), 2 and 3 (chunks) are`);
  if (coder !== 0) throw unsupported(`LAZ coder ${coder} is not known here; 0 (arithmetic) is`);
  const layered = isLayered(las.pointFormat);
  if (layered !== (compressor === 3))
    throw malformed(`its LASzip record says compressor ${compressor}, which point format ${las.pointFormat} never has`);
  const itemVersion = checkItems(las, parseItems(bytes));
  if (compressor === 1) return { chunkPoints: 0, itemVersion };
  // Both 0 and all bits set mean that the table says how many points each chunk has; COPC files are written with either.
  return { chunkPoints: chunkPoints || variableChunks, itemVersion };
}
