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

const decoder = createChunkDecoder();
decoder.catch(() => {}); // said when the first job asks for it
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

/// { kind: 'decode', path, las, chunk, depth }: the points as CHNK records.
async function decode(job) {
  const overflows = mayOverflow(job.las);
  await (await decoder).decode(open(job.path), job.las, job.chunk, chunkPoints, async (heap, at, count) => {
    const kept = overflows ? keepFinite(heap, at, count, job.las) : count;
    const buffer = kept > 0 ? encodeRecords(heap, at, kept, job.las, job.depth) : null;
    parentPort.postMessage(
      { kind: 'part', buffer, points: kept, dropped: count - kept },
      buffer ? [buffer] : [],
    );
    ++waiting;
    while (waiting > mostWaiting) await new Promise((resolve) => (wake = resolve));
  });
}

/// { kind: 'look', path, las, chunk, most }: how the colours of the first `most` points are meant.
async function look(job) {
  let depth = colorDepth.unknown;
  const most = Math.min(job.most, job.chunk.points);
  const takeDepth = (heap, at, count) => {
    depth = Math.max(depth, depthOfColors(heap, at, count, job.las));
  };
  await (await decoder).decode(open(job.path), job.las, job.chunk, chunkPoints, takeDepth, most);
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
