// How long a cloud in object storage keeps people waiting, and what is fetched for it, through a line with latency: from the start of
// `scancast serve URL` to a stream's first frame and to its final one.
//
//   node tests/bench/remote/first_picture.mjs PROGRAM CLOUD.scan [ROUND_TRIP_MS [FLAGS OF SERVE...]]      (tests/foreign: npm ci)
//
// or SET/ept.json in the place of CLOUD.scan; or --ept SCAN.copc.laz, for a set of EPT that is made of that file's voxels.

import { createReadStream, mkdtempSync, rmSync, statSync } from 'node:fs';
import { createServer } from 'node:http';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { basename, dirname, join } from 'node:path';

import { RealServer } from '../../browser/support/real_server.mjs';
import { writeEptOfCopc } from '../../support/ept_of_copc.mjs';
import { Line } from '../../support/line.mjs';

const WebSocket = createRequire(new URL('../../foreign/package.json', import.meta.url))('ws');
const words = process.argv.slice(2);
const madeAt = words[1] === '--ept' ? mkdtempSync(join(tmpdir(), 'scancast-set-')) : null;
if (madeAt) {
  const [, copc] = words.splice(1, 2);
  writeEptOfCopc(copc, madeAt);
  words.splice(1, 0, join(madeAt, 'ept.json'));
}
const [program, cloud, roundTrip = '50', ...flags] = words;
let requests = 0;

const storage = createServer((request, response) => {
  ++requests;
  const file = join(dirname(cloud), decodeURIComponent(new URL(request.url, 'http://x').pathname).replace('/set/', ''));
  const { size, mtimeMs } = statSync(file);
  const [, first, last] = /^bytes=(\d+)-(\d+)$/.exec(request.headers.range)?.map(Number) ?? [0, 0, size - 1];
  const end = Math.min(last, size - 1);
  const range = request.headers.range ? { 'Content-Range': `bytes ${first}-${end}/${size}` } : {};
  response.writeHead(request.headers.range ? 206 : 200, { ETag: `"${mtimeMs}"`, 'Content-Length': end - first + 1, ...range });
  createReadStream(file, { start: first, end }).pipe(response);
});
await new Promise((done) => storage.listen(0, '127.0.0.1', done));
const line = new Line(storage.address().port, Number(roundTrip));
const port = await line.start();
const start = performance.now();
const server = new RealServer(program, [`http://127.0.0.1:${port}/set/${basename(cloud)}`], flags);
const url = await server.start();

const told = (what) => console.log(`${what}: ${((performance.now() - start) / 1000).toFixed(2)} s, ${(line.bytes / 1e6).toFixed(1)} MB, ${requests} requests, ${line.connections} connections`);
told('the server listens');
const ready = async () => (await fetch(new URL('readyz', url))).ok;
while (!await ready()) await new Promise((done) => setTimeout(done, 5));
told('the cloud is open');
await new Promise((done) => {
  const socket = new WebSocket(`${url.replace(/^http/, 'ws')}api/v1/stream`, ['scancast.v1']);
  let frames = 0;
  socket.on('open', () => socket.send(JSON.stringify({ type: 'hello', width: 1280, height: 720 })));
  socket.on('message', (data, binary) => {
    if (!binary) return;
    socket.send(JSON.stringify({ type: 'ack', frame: Number(data.readBigUInt64LE(16)) }));
    if (++frames === 1) told('first frame');
    if ((data[9] & 4) === 0) return;
    told(`final frame, the ${frames}th`);
    done();
    socket.terminate();
  });
});
await server.stop();
line.stop();
storage.close();
if (madeAt) rmSync(madeAt, { recursive: true, force: true });
process.exit(0);
