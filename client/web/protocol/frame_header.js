// The binary header in front of every picture (PROTOCOL.md, "Frames"): 48 bytes, little-endian. Pure.

const magic = 0x52464353; // "SCFR"
const leastHeaderLength = 48;
const jpeg = 1;
const largestSide = 16384;

/** Thrown for bytes that are no frame; its message says what is wrong with them. */
export class FrameError extends Error {}

/** One received message, taken apart: the header's fields and `picture`, a view of the JPEG's bytes. */
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
  if (codec !== jpeg) throw new FrameError(`codec ${codec} is unknown; 1 is JPEG`);
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
    frameId: Number(data.getBigUint64(16, true)),
    seq: Number(data.getBigUint64(24, true)),
    width,
    height,
    renderMicroseconds: data.getUint32(40, true),
    encodeMicroseconds: data.getUint32(44, true),
    picture: new Uint8Array(buffer, headerLength, pictureLength),
  };
}
