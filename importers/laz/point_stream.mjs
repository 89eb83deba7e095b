// The point stream (renderer/cloud/import/stream/POINT_STREAM.md), as bytes. Pure functions, and one writer.
import { writeSync } from 'node:fs';

export const chunkPoints = 65536;

const longestFormat = 256;
const longestWkt = 65536;
const longestFailure = 4096;
const longestNote = 1024;
const magic = [0x53, 0x43, 0x41, 0x4e, 0x50, 0x54, 0x53, 0x1a];
const version = 1;
const headerBytes = 136;

const columnBits = { color: 1, intensity: 2, classification: 4, normal: 8 };

/// Texts of the stream are ASCII; '?' stands for what is not. Ends at the first NUL, without blanks around.
export function printableText(text, longest) {
  const end = text.indexOf('\0');
  return text
    .slice(0, Math.min(longest, end < 0 ? text.length : end))
    .trim()
    .replace(/[^\x20-\x7e\n\t]/g, '?');
}

/// `scan`: { format, points?, bounds?: [[x,y,z],[x,y,z]], gridStep?, gridOrigin?, epsg?, wkt?, columns: {color,
/// intensity, classification, normal}, further?: [{ name, type, scale, offset, description }] }.
export function encodeHeader(scan) {
  const format = Buffer.from(printableText(scan.format, longestFormat), 'latin1');
  const wkt = Buffer.from(printableText(scan.wkt ?? '', longestWkt), 'latin1');
  const keys = ['name', 'type', 'scale', 'offset', 'description'];
  const further = Buffer.from(scan.further?.length ? JSON.stringify(scan.further, keys) : '', 'latin1');
  const bytes = Buffer.alloc(headerBytes + format.length + wkt.length + further.length);
  const vector = (at, v) => v.forEach((value, i) => bytes.writeDoubleLE(value, at + 8 * i));
  bytes.set(magic, 0);
  bytes.writeUInt16LE(version, 8);
  let columns = 0;
  for (const [name, bit] of Object.entries(columnBits)) if (scan.columns[name]) columns |= bit;
  bytes.writeUInt16LE(columns, 10);
  const known = [scan.points !== undefined, scan.bounds !== undefined, scan.epsg !== undefined];
  bytes.writeUInt32LE(known.reduce((bits, is, i) => bits | (is ? 1 << i : 0), 0), 12);
  bytes.writeBigUInt64LE(BigInt(scan.points ?? 0), 16);
  vector(24, scan.gridStep ?? [0, 0, 0]);
  vector(48, scan.gridOrigin ?? [0, 0, 0]);
  if (scan.bounds) scan.bounds.forEach((corner, i) => vector(72 + 24 * i, corner));
  bytes.writeInt32LE(scan.epsg ?? 0, 120);
  bytes.writeUInt32LE(format.length, 124);
  bytes.writeUInt32LE(wkt.length, 128);
  bytes.writeUInt32LE(further.length, 132);
  format.copy(bytes, headerBytes);
  wkt.copy(bytes, headerBytes + format.length);
  further.copy(bytes, headerBytes + format.length + wkt.length);
  return bytes;
}

/// A whole CHNK record to be filled: its buffer and where each column starts (-1 = not there). `rowBytes`: of the further
/// columns, 0 = none.
export function layOutChunk(points, columns, rowBytes = 0) {
  let at = 8;
  const place = (has, bytes) => {
    if (!has) return -1;
    const start = at;
    at += bytes * points;
    return start;
  };
  const position = place(true, 24);
  const color = place(columns.color, 3);
  const intensity = place(columns.intensity, 2);
  const classification = place(columns.classification, 1);
  const normal = place(columns.normal, 12);
  const rows = place(rowBytes > 0, rowBytes);
  const buffer = new ArrayBuffer(at);
  const view = new DataView(buffer);
  new Uint8Array(buffer).set([0x43, 0x48, 0x4e, 0x4b]); // CHNK
  view.setUint32(4, points, true);
  return { buffer, view, points, position, color, intensity, classification, normal, rows };
}

function encodeDone(sent, dropped) {
  const bytes = Buffer.alloc(24);
  bytes.write('DONE', 'latin1');
  bytes.writeBigUInt64LE(BigInt(sent), 8);
  bytes.writeBigUInt64LE(BigInt(dropped), 16);
  return bytes;
}

function encodeNote(sentence) {
  const text = Buffer.from(printableText(sentence, longestNote) || 'something was strange', 'latin1');
  const bytes = Buffer.alloc(8 + text.length);
  bytes.write('NOTE', 'latin1');
  bytes.writeUInt32LE(text.length, 4);
  text.copy(bytes, 8);
  return bytes;
}

function encodeFailure(code, sentence) {
  const text = Buffer.from(printableText(sentence, longestFailure) || 'it cannot be read', 'latin1');
  const bytes = Buffer.alloc(12 + text.length);
  bytes.write('FAIL', 'latin1');
  bytes.writeUInt32LE(text.length, 4);
  bytes.writeUInt32LE(code, 8);
  text.copy(bytes, 12);
  return bytes;
}

/// Writes the stream to a descriptor, in order, waiting for the reader: its pace is everybody's pace.
export class PointStreamWriter {
  #fd;
  #started = false;
  #sent = 0;
  #dropped = 0;

  constructor(fd) {
    this.#fd = fd;
  }

  header(scan) {
    this.#started = true;
    this.#write(encodeHeader(scan));
  }

  /// Something about the scan that its reader should hear: one plain sentence without an end.
  note(sentence) {
    this.#write(encodeNote(sentence));
  }

  /// `buffer`: a whole CHNK record of `points` points; null when all of them were dropped.
  chunk(buffer, points, dropped) {
    if (points > 0) this.#write(new Uint8Array(buffer));
    this.#sent += points;
    this.#dropped += dropped;
  }

  /// The same, of points from all over the scan that a reader may look at before all of them come; then endGlance().
  glance(buffer) {
    const bytes = new Uint8Array(buffer);
    bytes.set([0x4c, 0x4f, 0x4f, 0x4b]); // LOOK
    this.#write(bytes);
  }

  endGlance() {
    const bytes = Buffer.alloc(8);
    bytes.write('LOOK', 'latin1');
    this.#write(bytes);
  }

  done() {
    this.#write(encodeDone(this.#sent, this.#dropped));
  }

  fail(failure) {
    if (!this.#started) {
      const bare = Buffer.alloc(headerBytes);
      bare.set(magic, 0);
      bare.writeUInt16LE(version, 8);
      this.#write(bare);
    }
    this.#write(encodeFailure(failure.code, failure.message));
  }

  #write(bytes) {
    for (let at = 0; at < bytes.length; ) {
      try {
        at += writeSync(this.#fd, bytes, at, bytes.length - at);
      } catch (error) {
        // A pipe that somebody made non-blocking and that is full.
        if (error.code !== 'EAGAIN') throw error;
        Atomics.wait(new Int32Array(new SharedArrayBuffer(4)), 0, 0, 2);
      }
    }
  }
}
