// One LAZ chunk after the other through laz-perf, checked on both sides of it: laz-perf itself believes everything.
// Used inside a worker, by one thread; its memory is WebAssembly's and grows to the largest chunk.
import { createRequire } from 'node:module';

import { ScanFailure, failureCode, grouped, malformed, tooLarge } from './failure.mjs';
import { recordLayout } from './las_header.mjs';
import { isLayered } from './laszip_record.mjs';
import { Version4Items } from './version4_items.mjs';

// Points between two looks at how far laz-perf has read.
const stride = 256;
const padding = 64;
// A layered chunk has these for the point itself, then one for each of colour and infrared, one for each extra byte.
const pointLayers = 9;
// The point format that has nothing but the point, which all layered ones begin with.
const bareFormat = 6;

export async function createChunkDecoder() {
  const { createLazPerf } = createRequire(import.meta.url)('laz-perf');
  return new ChunkDecoder(await createLazPerf());
}

class ChunkDecoder {
  #module;
  #input = { at: 0, bytes: 0 };
  #bare = { at: 0, bytes: 0 };
  #output = { at: 0, bytes: 0 };

  constructor(module) {
    this.#module = module;
  }

  /// Decodes a chunk in pieces. `consume(heap, at, count)` gets `count` records at `at` of the bytes `heap`, valid
  /// until it returns; it may return a promise. Stops after `most` points.
  async decode(file, las, chunk, piecePoints, consume, most = chunk.points) {
    const start = this.#reserve(this.#input, chunk.bytes + padding);
    const bare = las.itemVersion === 4 ? this.#reserve(this.#bare, chunk.bytes + padding) : 0;
    const records = this.#reserve(this.#output, Math.min(piecePoints, chunk.points) * las.recordBytes);
    const heap = this.#module.HEAPU8;
    const got = file.readInto(heap.subarray(start, start + chunk.bytes), chunk.at);
    if (got < chunk.bytes) throw malformed(`byte ${grouped(chunk.at + got)}: the file became shorter while it was read`);
    heap.fill(0, start + chunk.bytes, start + chunk.bytes + padding);
    const layers = isLayered(las.pointFormat) ? checkLayers(heap, start, las, chunk) : [];
    const input =
      las.itemVersion === 4
        ? splitChunk(heap, start, bare, las, layers)
        : { start, bytes: chunk.bytes, pointFormat: las.pointFormat, recordBytes: las.recordBytes };
    const decoder = new this.#module.ChunkDecoder();
    try {
      decoder.open(input.pointFormat, input.recordBytes, input.start);
      const place = this.#placeOfCursor(decoder, input.start);
      for (let done = 0; done < most; ) {
        const count = Math.min(piecePoints, most - done);
        this.#decodePiece(decoder, las, chunk, { input, place, records, count, done });
        done += count;
        if (done === chunk.points && chunk.isExact && this.#cursor(place) - input.start !== input.bytes)
          throw damaged(chunk, done, `its points end after ${grouped(this.#cursor(place) - input.start)} bytes`);
        await consume(this.#module.HEAPU8, records, count);
      }
    } finally {
      this.#release(decoder);
    }
  }

  #decodePiece(decoder, las, chunk, { input, place, records, count, done }) {
    for (let first = 0; first < count; first += stride) {
      const start = records + first * las.recordBytes;
      const end = records + Math.min(count, first + stride) * las.recordBytes;
      try {
        for (let at = start; at < end; at += las.recordBytes) decoder.getPoint(at);
      } catch {
        throw damaged(chunk, done + first, 'its bytes make no sense');
      }
      if (input.items) {
        const heap = this.#module.HEAPU8;
        for (let at = start; at < end; at += las.recordBytes) input.items.complete(heap, at);
      }
      if (this.#cursor(place) - input.start > input.bytes || input.items?.overran)
        throw damaged(chunk, done + first, 'its points go on beyond its end');
    }
  }

  #release(decoder) {
    try {
      decoder.delete();
    } catch {
      // It broke while decoding, which has been said already.
    }
  }

  #reserve(place, bytes) {
    if (place.bytes >= bytes) return place.at;
    if (place.bytes > 0) this.#module._free(place.at);
    place.bytes = 0;
    try {
      place.at = this.#module._malloc(bytes);
    } catch {
      place.at = 0;
    }
    if (place.at === 0) throw tooLarge(`a chunk that needs ${grouped(bytes)} bytes does not fit into memory`);
    place.bytes = bytes;
    return place.at;
  }

  /// laz-perf tells nobody how far it has read; its object's third word does: object → what it shares → its parts →
  /// the cursor. The release is pinned; should the word not be the cursor, that is found out here, on every chunk.
  #placeOfCursor(decoder, start) {
    const words = new Uint32Array(this.#module.HEAPU8.buffer);
    const parts = words[words[decoder.$$.ptr >> 2] >> 2];
    const place = (parts >> 2) + 2;
    if (words[place] !== start) throw new ScanFailure(failureCode.system, 'this release of laz-perf is not the one that Scancast knows');
    return place;
  }

  #cursor(place) {
    return new Uint32Array(this.#module.HEAPU8.buffer, 4 * place, 1)[0];
  }
}

const damaged = (chunk, point, reason) =>
  malformed(
    `the chunk of ${grouped(chunk.points)} points at byte ${grouped(chunk.at)} (${grouped(chunk.bytes)} bytes) is ` +
      `damaged near its point ${grouped(point)}: ${reason}`,
  );

/// A layered chunk: one whole record, the number of points, the bytes of every layer, the layers. Returns
/// [{ at, bytes }] of the layers, from the chunk's start.
function checkLayers(heap, start, las, chunk) {
  const layout = recordLayout(las.pointFormat);
  const layers = pointLayers + (layout.color >= 0 ? 1 : 0) + (las.pointFormat === 8 ? 1 : 0) + las.recordBytes - layout.bytes;
  const head = las.recordBytes + 4 + 4 * layers;
  if (chunk.bytes < head) throw damaged(chunk, 0, `it is shorter than the ${grouped(head)} bytes of its head`);
  const view = new DataView(heap.buffer, heap.byteOffset + start, head);
  const points = view.getUint32(las.recordBytes, true);
  if (points !== chunk.points) throw damaged(chunk, 0, `it says that it has ${grouped(points)} points`);
  const found = [];
  let sum = head;
  for (let at = las.recordBytes + 4; at < head; at += 4) {
    const bytes = view.getUint32(at, true);
    found.push({ at: sum, bytes });
    sum += bytes;
  }
  if (sum !== chunk.bytes) throw damaged(chunk, 0, `its layers would end after ${grouped(sum)} bytes`);
  return found;
}

/// The points of the chunk at `start` alone, as a chunk at `to` that laz-perf can decode, and their further items apart.
function splitChunk(heap, start, to, las, layers) {
  const { bytes: pointBytes } = recordLayout(bareFormat);
  const ofPoint = layers.slice(0, pointLayers);
  const copy = (from, bytes, at) => heap.copyWithin(to + at, start + from, start + from + bytes);
  const headBytes = pointBytes + 4 + 4 * pointLayers;
  const layerBytes = ofPoint.reduce((sum, { bytes }) => sum + bytes, 0);
  copy(0, pointBytes, 0);
  copy(las.recordBytes, 4 + 4 * pointLayers, pointBytes);
  copy(layers[0].at, layerBytes, headBytes);
  heap.fill(0, to + headBytes + layerBytes, to + headBytes + layerBytes + padding);
  const items = new Version4Items(
    { hasColor: recordLayout(las.pointFormat).color >= 0, hasInfrared: las.pointFormat === 8, pointBytes },
    heap.subarray(start + pointBytes, start + las.recordBytes),
    layers.slice(pointLayers).map(({ at, bytes }) => heap.slice(start + at, start + at + bytes)),
  );
  return { start: to, bytes: headBytes + layerBytes, pointFormat: bareFormat, recordBytes: pointBytes, items };
}
