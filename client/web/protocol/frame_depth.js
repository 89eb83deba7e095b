// The small picture of its depth that a frame brings along where `hello` asked for it (PROTOCOL.md, "Depth of a frame"):
// packed bytes → inverse depth in cells → inverse depth anywhere in the picture. Pure.
//
// What is linear on a plane's picture is 1 / depth, not depth: cells hold that, and it is what lies between them.

import { FrameError } from './frame_header.js';

const mantissa = 9; // bits that each octave of 1 / depth has
const unit = 2 ** 24; // what 1 / near is in whole numbers
const largestCode = 8192; // that of 1 / near

/**
 * The cells of a frame's depth: `inverse` holds width · height values in rows from the top, each 1 / depth in 1 / cloud
 * units along the view direction, 0 = background.
 * @typedef {{ width: number, height: number, inverse: Float32Array }} FrameDepth
 */

/** Whole numbers proportional to 1 / depth: each octave has as many codes, so all depths are equally exact. */
const valueOf = (code) =>
  code < 2 << mantissa ? code : ((1 << mantissa) + (code & ((1 << mantissa) - 1))) * 2 ** ((code >> mantissa) - 1);

/** All that the zlib stream holds, which must be `length` bytes; more is never unpacked. */
async function inflated(bytes, length) {
  const unpacked = new Uint8Array(length);
  let filled = 0;
  const reader = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate')).getReader();
  try {
    for (let part = await reader.read(); !part.done; part = await reader.read()) {
      if (part.value.length > length - filled) {
        reader.cancel().catch(() => {});
        throw new FrameError(`the depth of a frame unpacks to more than its ${length} bytes`);
      }
      unpacked.set(part.value, filled);
      filled += part.value.length;
    }
  } catch (/** @type {any} */ error) {
    throw error instanceof FrameError ? error : new FrameError(`the depth of a frame is no zlib stream: ${error.message}`);
  }
  if (filled !== length) throw new FrameError(`the depth of a frame unpacks to ${filled} bytes instead of ${length}`);
  return unpacked;
}

/** What left, above and above left say of a cell: their plane, but nothing beyond left and above. */
const predicted = (left, above, corner) =>
  Math.max(Math.min(left, above), Math.min(Math.max(left, above), left + above - corner));

/**
 * Unpacks `packedDepth` of parseFrame().
 * @returns {Promise<FrameDepth>} rejected with a FrameError for bytes that mean nothing
 */
export async function unpackDepth({ width, height, near, bytes }) {
  const count = width * height;
  const symbols = await inflated(bytes, 2 * count); // all low bytes, then all high ones
  const codes = new Int16Array(count);
  const inverse = new Float32Array(count);
  for (let row = 0, i = 0; row < height; ++row) {
    for (let column = 0; column < width; ++column, ++i) {
      const left = column > 0 ? codes[i - 1] : row > 0 ? codes[i - width] : 0;
      const above = row > 0 ? codes[i - width] : left;
      const corner = row > 0 && column > 0 ? codes[i - width - 1] : above;
      const code = predicted(left, above, corner);
      const symbol = symbols[i] + 256 * symbols[count + i];
      codes[i] = code;
      if (symbol === 0) continue; // background; the cells beside it see through it
      const difference = symbol % 2 === 1 ? (symbol - 1) / 2 : -symbol / 2;
      codes[i] = code + difference;
      if (!(code + difference >= 1 && code + difference <= largestCode && near > 0)) {
        throw new FrameError(`cell ${column}, ${row} of the frame's depth lies nearer than its nearest, or nowhere`);
      }
      inverse[i] = valueOf(codes[i]) / unit / near;
    }
  }
  return { width, height, inverse };
}

/** Whether two neighbours are of one surface; before and after them lie `before` and `after`, where 0 is nothing. */
function joined(first, second, before, after) {
  if (first === 0 || second === 0) return false;
  const step = Math.abs(second - first);
  if (step <= 0.03 * Math.min(first, second)) return true;
  // Steep: then the surface goes on like that, which an edge does not.
  const slopes = [];
  if (before !== 0) slopes.push(Math.abs(first - before));
  if (after !== 0) slopes.push(Math.abs(after - second));
  return slopes.length > 0 && step <= 2 * Math.min(...slopes);
}

/** The covered cell whose centre is nearest to (x, y), px of cells; 0 where none is within `reach` of them. */
function nearestCovered({ width, height, inverse }, x, y, reach) {
  let found = 0;
  let least = reach * reach;
  for (let row = Math.max(0, Math.ceil(y - reach)); row <= Math.min(height - 1, y + reach); ++row) {
    for (let column = Math.max(0, Math.ceil(x - reach)); column <= Math.min(width - 1, x + reach); ++column) {
      const distance = (column - x) ** 2 + (row - y) ** 2;
      const value = inverse[row * width + column];
      if (value > 0 && distance <= least) [found, least] = [value, distance];
    }
  }
  return found;
}

/**
 * 1 / depth at a place of the picture; 0 = background.
 * @param {FrameDepth} depth
 * @param {number} u from the left edge, 0, to the right one, 1
 * @param {number} v from the top, 0, to the bottom, 1
 */
export function inverseDepthAt(depth, u, v) {
  const { width, height, inverse } = depth;
  const x = Math.min(Math.max(u, 0), 1) * width - 0.5; // cell centres lie at whole numbers
  const y = Math.min(Math.max(v, 0), 1) * height - 0.5;
  const at = (column, row) =>
    column >= 0 && column < width && row >= 0 && row < height ? inverse[row * width + column] : 0;
  // The outer half of the cells at the borders continues what lies inside.
  const i = Math.max(0, Math.min(Math.floor(x), width - 2));
  const j = Math.max(0, Math.min(Math.floor(y), height - 2));
  const [a, b, c, d] = [at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)];
  if (
    joined(a, b, at(i - 1, j), at(i + 2, j)) && joined(c, d, at(i - 1, j + 1), at(i + 2, j + 1)) &&
    joined(a, c, at(i, j - 1), at(i, j + 2)) && joined(b, d, at(i + 1, j - 1), at(i + 1, j + 2))
  ) {
    const [s, t] = [x - i, y - j];
    const value = (a * (1 - s) + b * s) * (1 - t) + (c * (1 - s) + d * s) * t;
    if (value > 0) return value;
  }
  return nearestCovered(depth, x, y, 2);
}
