// The binary header in front of every picture (PROTOCOL.md, "Frames"): 48 bytes, little-endian, and behind them the
// frame's depth where `hello` asked for it (frame_depth.js unpacks that). Pure.

const magic = 0x52464353; // "SCFR"
const leastHeaderLength = 48;
const codecs = { 1: 'jpeg', 2: 'h264' };
const largestSide = 16384;
const depthStart = 64;
const largestDepthSide = 160;

/** Thrown for bytes that are no frame; its message says what is wrong with them. */
export class FrameError extends Error {}

/**
 * A frame's depth as it came: cells in each direction, the least and greatest depth among them (cloud units; 0 where all is
 * background), and the packed bytes, inside the message.
 * @typedef {{ width: number, height: number, near: number, far: number, bytes: Uint8Array }} PackedDepth
 */

/** @returns {PackedDepth | undefined} */
function packedDepthOf(data, headerLength) {
  if (headerLength < depthStart) return undefined;
  const length = data.getUint32(52, true);
  if (length === 0) return undefined;
  if (length > headerLength - depthStart) {
    throw new FrameError(`a header of ${headerLength} bytes has no room for ${length} bytes of depth`);
  }
  const [width, height] = [data.getUint16(48, true), data.getUint16(50, true)];
  if (!(width >= 1 && width <= largestDepthSide && height >= 1 && height <= largestDepthSide)) {
    throw new FrameError(`a frame's depth has no ${width} × ${height} cells; at most ${largestDepthSide} in each direction`);
  }
  const [near, far] = [data.getFloat32(56, true), data.getFloat32(60, true)];
  if (!((near > 0 && near <= far && far < Infinity) || (near === 0 && far === 0))) {
    throw new FrameError(`a frame's depth does not reach from ${near} to ${far}`);
  }
  return { width, height, near, far, bytes: new Uint8Array(data.buffer, depthStart, length) };
}

/**
 * One received message, taken apart: the header's fields, `picture`, a view of the bytes of its `codec`, 'jpeg' or 'h264', and `packedDepth`, where
 * the frame has it.
 */
export function parseFrame(buffer) {
  if (buffer.byteLength < leastHeaderLength) {
    throw new FrameError(`a frame has at least ${leastHeaderLength} bytes, this one has ${buffer.byteLength}`);
  }
  const data = new DataView(buffer);
  if (data.getUint32(0, true) !== magic) throw new FrameError('a frame starts with SCFR; this one does not');
  const version = data.getUint16(4, true);
  if (version !== 1) throw new FrameError(`frames of version ${version} need a newer page: reload it`);
  const headerLength = data.getUint16(6, true);
  const pictureLength = data.getUint32(12, true);
  if (headerLength < leastHeaderLength || headerLength + pictureLength !== buffer.byteLength) {
    throw new FrameError(
      `a header of ${headerLength} and a picture of ${pictureLength} bytes do not make a frame of ${buffer.byteLength}`,
    );
  }
  const codec = data.getUint8(8);
  if (!codecs[codec]) throw new FrameError(`codec ${codec} is unknown; 1 is JPEG, 2 is H.264`);
  const width = data.getUint32(32, true);
  const height = data.getUint32(36, true);
  if (!(width >= 1 && width <= largestSide && height >= 1 && height <= largestSide)) {
    throw new FrameError(`a picture of ${width} × ${height} pixels is impossible`);
  }
  const flags = data.getUint8(9);
  return {
    moving: (flags & 1) !== 0,
    still: (flags & 2) !== 0,
    final: (flags & 4) !== 0,
    damaged: (flags & 8) !== 0,
    away: (flags & 16) !== 0,
    key: (flags & 32) !== 0,
    codec: codecs[codec],
    frameId: Number(data.getBigUint64(16, true)),
    seq: Number(data.getBigUint64(24, true)),
    width,
    height,
    renderMicroseconds: data.getUint32(40, true),
    encodeMicroseconds: data.getUint32(44, true),
    packedDepth: packedDepthOf(data, headerLength),
    picture: new Uint8Array(buffer, headerLength, pictureLength),
  };
}
