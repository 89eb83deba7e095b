// The public header block of LAS and LAZ (ASPRS LAS 1.0-1.4), parsed and checked. Pure functions on bytes.
// The rules and words are those of renderer/cloud/import/las/las_header.cpp: LAS and LAZ must not differ.
import { empty, malformed, truncated, unsupported } from './failure.mjs';

export const longestHeader = 375; // LAS 1.4
const shortestHeader = 227;

// Bytes, classification, mask of its bits, colour: ASPRS LAS 1.4 R15, tables 7-17.
const layouts = [
  [20, 15, 0x1f, -1],
  [28, 15, 0x1f, -1],
  [26, 15, 0x1f, 20],
  [34, 15, 0x1f, 28],
  [57, 15, 0x1f, -1],
  [63, 15, 0x1f, 28],
  [30, 16, 0xff, -1],
  [36, 16, 0xff, 30],
  [38, 16, 0xff, 30],
  [59, 16, 0xff, -1],
  [67, 16, 0xff, 30],
].map(([bytes, classification, classMask, color]) => Object.freeze({ bytes, classification, classMask, color }));

/// Shape of a record of point formats 0-10; -1 = not there.
export const recordLayout = (pointFormat) => layouts[pointFormat];

/// A 64-bit number as an exact Number; 0xffff… and other absurd ones become the largest exact one.
export const number64 = (bytes, at) => Number(minBig(bytes.readBigUInt64LE(at), BigInt(Number.MAX_SAFE_INTEGER)));
const minBig = (a, b) => (a < b ? a : b);

function checkGrid(bytes) {
  const scale = [];
  const offset = [];
  for (let i = 0; i < 3; ++i) {
    scale.push(bytes.readDoubleLE(131 + 8 * i));
    offset.push(bytes.readDoubleLE(155 + 8 * i));
    if (!Number.isFinite(scale[i]) || scale[i] <= 0)
      throw malformed(
        `byte ${131 + 8 * i}: the scale of ${'xyz'[i]} is ${scale[i]}; it must be a positive number`,
      );
    if (!Number.isFinite(offset[i]))
      throw malformed(`byte ${155 + 8 * i}: the offset of ${'xyz'[i]} is not a number`);
  }
  return { scale, offset };
}

function readBounds(bytes) {
  const bounds = [[], []];
  for (let i = 0; i < 3; ++i) {
    bounds[1].push(bytes.readDoubleLE(179 + 16 * i));
    bounds[0].push(bytes.readDoubleLE(187 + 16 * i));
  }
  return bounds[0].every((low, i) => low <= bounds[1][i]) ? bounds : undefined;
}

/// `bytes`: the first bytes of the file, up to longestHeader.
export function parseLasHeader(bytes) {
  if (bytes.length < 4 || bytes.toString('latin1', 0, 4) !== 'LASF')
    throw malformed('byte 0: it is not a LAS or LAZ file, it does not start with "LASF"');
  if (bytes.length < shortestHeader)
    throw truncated(`it ends at byte ${bytes.length}, within its LAS header of at least ${shortestHeader} bytes`);
  const [major, minor] = bytes.subarray(24, 26);
  if (major !== 1 || minor > 4)
    throw unsupported(`byte 24: LAS version ${major}.${minor} is not known here; LAS 1.0 to 1.4 are`);
  const marked = bytes[104];
  const pointFormat = marked & 0x3f;
  if (pointFormat > 10)
    throw unsupported(`byte 104: point format ${pointFormat} is not known here; point formats 0 to 10 are`);
  const headerBytes = bytes.readUInt16LE(94);
  const needed = minor >= 4 ? longestHeader : shortestHeader;
  if (headerBytes < needed)
    throw malformed(`byte 94: the header says that it has ${headerBytes} bytes; LAS 1.${minor} needs ${needed}`);
  if (bytes.length < needed)
    throw truncated(`it ends at byte ${bytes.length}, within its LAS header of ${needed} bytes`);
  const pointOffset = bytes.readUInt32LE(96);
  if (pointOffset < headerBytes)
    throw malformed(`byte 96: the points are said to start at byte ${pointOffset}, within the header`);
  const recordBytes = bytes.readUInt16LE(105);
  const least = layouts[pointFormat].bytes;
  if (recordBytes < least)
    throw malformed(
      `byte 105: a point record has ${recordBytes} bytes; point format ${pointFormat} needs ${least}`,
    );
  const { scale, offset } = checkGrid(bytes);
  let points = bytes.readUInt32LE(107);
  // The old 32-bit count is a courtesy to old readers: 0 for large clouds, and stale in some files.
  if (minor >= 4) points = number64(bytes, 247) || points;
  if (points === 0) throw empty('it is a LAZ file without points (byte 107: 0 points)');
  return {
    minor,
    adjustedTime: (bytes.readUInt16LE(6) & 1) !== 0,
    pointFormat,
    compressed: (marked & 0xc0) !== 0,
    headerBytes,
    pointOffset,
    recordBytes,
    points,
    vlrs: bytes.readUInt32LE(100),
    evlrOffset: minor >= 4 ? number64(bytes, 235) : 0,
    evlrs: minor >= 4 ? bytes.readUInt32LE(243) : 0,
    scale,
    offset,
    bounds: readBounds(bytes),
  };
}

/// False when no record can overflow to infinity.
export const mayOverflow = (las) =>
  las.scale.some((scale, i) => !Number.isFinite(Math.abs(las.offset[i]) + 2 ** 31 * scale));
