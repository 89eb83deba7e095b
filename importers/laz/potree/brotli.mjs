// A node of a Potree 2 octree with encoding BROTLI: attribute after attribute, positions and colours as Morton codes.
// Pure functions on bytes.
import { brotliDecompressSync } from 'node:zlib';

import { grouped, malformed } from '../failure.mjs';

const positionCodeBytes = 16; // three times 32 bits, interleaved
const colorCodeBytes = 8; // three times 16

/// Bytes of an attribute of one point in the compressed form.
const codeBytes = ({ role, stored, bytes }) => {
  if (role === 'position') return positionCodeBytes;
  return role === 'color' && stored === 'uint16' ? colorCodeBytes : bytes;
};

export const brotliBytes = (layout, points) =>
  points * layout.attributes.reduce((sum, attribute) => sum + codeBytes(attribute), 0);

/// Like inRecords() of columns.mjs.
export function inBrotli(layout, compressed, points, name) {
  const wanted = brotliBytes(layout, points);
  let bytes;
  try {
    bytes = brotliDecompressSync(compressed, { maxOutputLength: Math.max(1, wanted) });
  } catch (error) {
    throw malformed(`the node ${name} cannot be decompressed: ${error.message}`);
  }
  if (bytes.length !== wanted)
    throw malformed(`the node ${name} has ${grouped(bytes.length)} bytes; its ${grouped(points)} points need ${grouped(wanted)}`);
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
  const places = {};
  let base = 0;
  for (const attribute of layout.attributes) {
    const { role, stored } = attribute;
    const stride = codeBytes(attribute);
    if (role === 'position') places.position = { ...decodePositions(view, base, points), stored };
    else if (stride === colorCodeBytes && role === 'color') places.color = { ...decodeColors(view, base, points), stored };
    else if (role) places[role] = { view, base, stride, stored };
    base += points * stride;
  }
  return places;
}

/// Bits 0, 3, 6 … 21 of 24 as bits 0 … 7.
function everyThird(bits) {
  let x = bits & 0x249249;
  x = (x | (x >>> 2)) & 0x0c30c3;
  x = (x | (x >>> 4)) & 0x00f00f;
  return (x | (x >>> 8)) & 0xff;
}

/// One of the three 16-bit numbers that are interleaved in the 48 bits low, high.
const sixteen = (low, high, axis) =>
  everyThird((low & 0xffffff) >>> axis) | (everyThird((((low >>> 24) | (high << 8)) & 0xffffff) >>> axis) << 8);

function decodePositions(view, base, points) {
  const to = new Int32Array(3 * points);
  for (let i = 0, at = base; i < points; ++i, at += positionCodeBytes) {
    // The upper halves of the three numbers come first.
    const upperLow = view.getUint32(at, true);
    const upperHigh = view.getUint32(at + 4, true);
    const low = view.getUint32(at + 8, true);
    const high = view.getUint32(at + 12, true);
    for (let axis = 0; axis < 3; ++axis)
      to[3 * i + axis] = (sixteen(upperLow, upperHigh, axis) << 16) | sixteen(low, high, axis);
  }
  return { view: new DataView(to.buffer), base: 0, stride: 12 };
}

function decodeColors(view, base, points) {
  const to = new Uint16Array(3 * points);
  for (let i = 0, at = base; i < points; ++i, at += colorCodeBytes)
    for (let axis = 0; axis < 3; ++axis)
      to[3 * i + axis] = sixteen(view.getUint32(at, true), view.getUint32(at + 4, true), axis);
  return { view: new DataView(to.buffer), base: 0, stride: 6 };
}
