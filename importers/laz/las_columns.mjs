// LAS records to the columns of a CHNK record: the inner loop of every LAZ import. Pure functions on bytes, with the
// rules of renderer/cloud/import/las/las_decode.cpp.
import { fillRows } from './las_extra.mjs';
import { recordLayout } from './las_header.mjs';
import { layOutChunk } from './point_stream.mjs';

export const colorDepth = Object.freeze({ unknown: 0, eightBits: 1, sixteenBits: 2 });

const atIntensity = 12;

export const lasColumns = (las) => ({
  color: recordLayout(las.pointFormat).color >= 0,
  intensity: true,
  classification: true,
  normal: false,
});

/// sixteenBits as soon as one colour number is above 255, eightBits if one is above 0.
export function depthOfColors(heap, at, count, las) {
  const color = recordLayout(las.pointFormat).color;
  const end = at + color + count * las.recordBytes;
  let high = 0;
  let low = 0;
  for (let p = at + color; p < end; p += las.recordBytes) {
    high |= heap[p + 1] | heap[p + 3] | heap[p + 5];
    low |= heap[p] | heap[p + 2] | heap[p + 4];
  }
  if (high !== 0) return colorDepth.sixteenBits;
  return low !== 0 ? colorDepth.eightBits : colorDepth.unknown;
}

/// Takes records whose position overflows to infinity out. Returns how many remain.
export function keepFinite(heap, at, count, las) {
  const view = new DataView(heap.buffer, heap.byteOffset);
  let to = at;
  for (let from = at; from < at + count * las.recordBytes; from += las.recordBytes) {
    const finite = [0, 1, 2].every((i) =>
      Number.isFinite(las.offset[i] + view.getInt32(from + 4 * i, true) * las.scale[i]),
    );
    if (!finite) continue;
    heap.copyWithin(to, from, from + las.recordBytes);
    to += las.recordBytes;
  }
  return (to - at) / las.recordBytes;
}

/// A whole CHNK record of `count` records at `at`. `further`: furtherColumns() of las_extra.mjs, if they are wanted.
export function encodeRecords(heap, at, count, las, depth, further) {
  const chunk = layOutChunk(count, lasColumns(las), further?.bytes);
  if (further) fillRows(heap, at, count, las, further, new Uint8Array(chunk.buffer), chunk.rows);
  fillPositions(heap, at, count, las, chunk);
  fillAttributes(heap, at, count, las, chunk);
  if (chunk.color >= 0) fillColors(heap, at, count, las, chunk, depth === colorDepth.sixteenBits ? 1 : 0);
  return chunk.buffer;
}

function fillPositions(heap, at, count, las, chunk) {
  const from = new DataView(heap.buffer, heap.byteOffset);
  const to = new Float64Array(chunk.buffer, chunk.position, 3 * count);
  const [sx, sy, sz] = las.scale;
  const [ox, oy, oz] = las.offset;
  for (let i = 0, p = at; i < 3 * count; i += 3, p += las.recordBytes) {
    to[i] = ox + from.getInt32(p, true) * sx;
    to[i + 1] = oy + from.getInt32(p + 4, true) * sy;
    to[i + 2] = oz + from.getInt32(p + 8, true) * sz;
  }
}

function fillAttributes(heap, at, count, las, chunk) {
  const to = new Uint8Array(chunk.buffer);
  const { classification, classMask } = recordLayout(las.pointFormat);
  let intensity = chunk.intensity;
  let classes = chunk.classification;
  for (let i = 0, p = at; i < count; ++i, p += las.recordBytes) {
    to[intensity++] = heap[p + atIntensity];
    to[intensity++] = heap[p + atIntensity + 1];
    to[classes++] = heap[p + classification] & classMask;
  }
}

/// `byte`: 1 keeps the high byte of 16-bit colours, which undoes both usual ways of making 16 bits of 8 (× 256 and
/// × 257).
function fillColors(heap, at, count, las, chunk, byte) {
  const to = new Uint8Array(chunk.buffer);
  let color = chunk.color;
  const first = at + recordLayout(las.pointFormat).color + byte;
  for (let i = 0, p = first; i < count; ++i, p += las.recordBytes) {
    to[color++] = heap[p];
    to[color++] = heap[p + 2];
    to[color++] = heap[p + 4];
  }
}
