// Points of a Potree node, as bytes with a layout, to the columns of CHNK records. Pure functions on bytes.
import { colorDepth } from '../las_columns.mjs';
import { columnsOf } from './attributes.mjs';
import { layOutChunk } from '../point_stream.mjs';

/// Where an attribute of every point is: base + stride × point. In records of points one behind the other.
export function inRecords(layout, bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
  const places = {};
  for (const { role, stored, at } of layout.attributes)
    if (role) places[role] = { view, base: at, stride: layout.bytes, stored };
  return places;
}

/// sixteenBits as soon as one colour number is above 255, eightBits if one is above 0 or they are stored as bytes.
export function depthOfColumns(places, points) {
  const color = places.color;
  if (!color || color.stored === 'uint8') return colorDepth.eightBits;
  let all = 0;
  for (let i = 0, at = color.base; i < points; ++i, at += color.stride)
    all |= color.view.getUint16(at, true) | color.view.getUint16(at + 2, true) | color.view.getUint16(at + 4, true);
  if (all > 255) return colorDepth.sixteenBits;
  return all > 0 ? colorDepth.eightBits : colorDepth.unknown;
}

/// A whole CHNK record of the points first … first + count - 1. `grid`: { scale, offset }, three numbers each.
export function encodeColumns(places, layout, grid, depth, first, count) {
  const chunk = layOutChunk(count, columnsOf(layout));
  fillPositions(places.position, grid, first, count, chunk);
  if (chunk.color >= 0) fillColors(places.color, depth, first, count, chunk);
  if (chunk.intensity >= 0)
    eachPoint(places.intensity, first, count, (view, at, i) =>
      chunk.view.setUint16(chunk.intensity + 2 * i, view.getUint16(at, true), true),
    );
  if (chunk.classification >= 0)
    eachPoint(places.classification, first, count, (view, at, i) =>
      chunk.view.setUint8(chunk.classification + i, view.getUint8(at)),
    );
  if (chunk.normal >= 0) fillNormals(places, first, count, chunk);
  return chunk.buffer;
}

function eachPoint({ view, base, stride }, first, count, act) {
  for (let i = 0, at = base + first * stride; i < count; ++i, at += stride) act(view, at, i);
}

const readNumber = {
  int32: (view, at) => view.getInt32(at, true),
  float: (view, at) => view.getFloat32(at, true),
};

function fillPositions(place, { scale, offset }, first, count, chunk) {
  const to = new Float64Array(chunk.buffer, chunk.position, 3 * count);
  const read = readNumber[place.stored];
  eachPoint(place, first, count, (view, at, i) => {
    to[3 * i] = offset[0] + read(view, at) * scale[0];
    to[3 * i + 1] = offset[1] + read(view, at + 4) * scale[1];
    to[3 * i + 2] = offset[2] + read(view, at + 8) * scale[2];
  });
}

/// 16-bit colours keep their high byte, as in LAS.
function fillColors(place, depth, first, count, chunk) {
  const to = new Uint8Array(chunk.buffer, chunk.color, 3 * count);
  const step = place.stored === 'uint8' ? 1 : 2;
  const byte = step === 2 && depth === colorDepth.sixteenBits ? 1 : 0;
  eachPoint(place, first, count, (view, at, i) => {
    to[3 * i] = view.getUint8(at + byte);
    to[3 * i + 1] = view.getUint8(at + byte + step);
    to[3 * i + 2] = view.getUint8(at + byte + 2 * step);
  });
}

function fillNormals(places, first, count, chunk) {
  const put = (i, x, y, z) => {
    // Of unit length, or 0 for what is none; three roundings to 32 bits harm neither.
    const length = Math.hypot(x, y, z);
    const factor = length > 1e-6 && Number.isFinite(length) ? 1 / length : 0;
    const at = chunk.normal + 12 * i;
    chunk.view.setFloat32(at, factor && x * factor, true);
    chunk.view.setFloat32(at + 4, factor && y * factor, true);
    chunk.view.setFloat32(at + 8, factor && z * factor, true);
  };
  if (!places.normal) {
    const value = ({ view, base, stride }, i) => view.getFloat32(base + (first + i) * stride, true);
    for (let i = 0; i < count; ++i)
      put(i, value(places.normalX, i), value(places.normalY, i), value(places.normalZ, i));
    return;
  }
  const unpack = { sphere: fromSphereMap, octahedron: fromOctahedron, float: fromFloats }[places.normal.stored];
  eachPoint(places.normal, first, count, (view, at, i) => put(i, ...unpack(view, at)));
}

const signed = (byte) => (byte / 255) * 2 - 1;
const fromFloats = (view, at) => [0, 4, 8].map((i) => view.getFloat32(at + i, true));

/// The picture of a sphere in a mirror ball: the middle is +z, the rim -z.
function fromSphereMap(view, at) {
  const x = signed(view.getUint8(at));
  const y = signed(view.getUint8(at + 1));
  const l = Math.max(0, 1 - x * x - y * y);
  const s = 2 * Math.sqrt(l);
  return [x * s, y * s, 2 * l - 1];
}

/// The faces of an octahedron unfolded to a square.
function fromOctahedron(view, at) {
  const u = signed(view.getUint8(at));
  const v = signed(view.getUint8(at + 1));
  const z = 1 - Math.abs(u) - Math.abs(v);
  if (z >= 0) return [u, v, z];
  return [(1 - Math.abs(v)) * Math.sign(u), (1 - Math.abs(u)) * Math.sign(v), z];
}
