// A worker thread: decodes one chunk after the other and posts the pieces, waiting when nobody takes them.
import { parentPort } from 'node:worker_threads';

import { createChunkDecoder } from './chunk_decoder.mjs';
import { asFailure } from './failure.mjs';
import { FileBytes } from './file_bytes.mjs';
import { mayOverflow } from './las_header.mjs';
import { colorDepth, depthOfColors, encodeRecords, keepFinite } from './las_columns.mjs';
import { chunkPoints } from './point_stream.mjs';

// Pieces that may wait to be written; more would only fill memory while another worker is behind.
const mostWaiting = 4;

let decoder; // made for the first chunk: plain records need none
let waiting = 0;
let wake = () => {};
let opened = { path: '', file: null };

function open(path) {
  if (opened.path !== path) {
    opened.file?.close();
    opened = { path: '', file: null };
    opened = { path, file: new FileBytes(path) };
  }
  return opened.file;
}

/// Hands a piece over; comes back when there is room for the next.
async function give(buffer, points, dropped) {
  parentPort.postMessage({ kind: 'part', buffer, points, dropped }, buffer ? [buffer] : []);
  ++waiting;
  while (waiting > mostWaiting) await new Promise((resolve) => (wake = resolve));
}

/// Records of LAS, decompressed where they are not plain, in pieces.
async function eachPiece({ path, las, chunk }, consume, most) {
  if (chunk.isPlain) await eachPlainPiece(open(path), las, chunk, consume, most);
  else await (await (decoder ??= createChunkDecoder())).decode(open(path), las, chunk, chunkPoints, consume, most);
}

async function eachPlainPiece(file, las, chunk, consume, most = chunk.points) {
  for (let done = 0; done < most; done += chunkPoints) {
    const count = Math.min(chunkPoints, most - done);
    const bytes = file.readAll(chunk.at + done * las.recordBytes, count * las.recordBytes, 'its points');
    await consume(bytes, 0, count);
  }
}

/// { kind: 'decode', path, las, chunk, depth, further?, most? }: the points as CHNK records.
async function decode(job) {
  const overflows = mayOverflow(job.las);
  await eachPiece(job, (heap, at, count) => {
    const kept = overflows ? keepFinite(heap, at, count, job.las) : count;
    const buffer = kept > 0 ? encodeRecords(heap, at, kept, job.las, job.depth, job.further) : null;
    return give(buffer, kept, count - kept);
  }, job.most);
}

/// { kind: 'look', most, … }: how the colours of the first `most` points are meant.
async function look(job) {
  let depth = colorDepth.unknown;
  await eachPiece(
    job,
    (heap, at, count) => {
      depth = Math.max(depth, depthOfColors(heap, at, count, job.las));
    },
    Math.min(job.most, job.chunk.points),
  );
  parentPort.postMessage({ kind: 'depth', depth });
}

parentPort.on('message', async (message) => {
  if (message.kind === 'taken') {
    --waiting;
    wake();
    return;
  }
  try {
    await (message.kind === 'look' ? look(message) : decode(message));
    parentPort.postMessage({ kind: 'end' });
  } catch (error) {
    const { code, message: sentence } = asFailure(error);
    parentPort.postMessage({ kind: 'failed', code, sentence });
  }
});
