// Clouds in object storage, served by programs that are not ours: nginx for https:// and http://, s3rver for s3://, behind a check of
// signatures, and a line with latency that can be cut in front of them. What is right is what the same file gives on disk.

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { chmodSync, copyFileSync, existsSync, mkdirSync, mkdtempSync, readdirSync, readFileSync, renameSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';

import WebSocket from 'ws';

import { RealServer } from '../browser/support/real_server.mjs';
import { writeEptOfCopc } from '../support/ept_of_copc.mjs';
import { Line } from '../support/line.mjs';
import { comesTrue, hasNginx, run, startNginx, startS3 } from './support/object_storage.mjs';

const program = process.env.SCANCAST_PROGRAM;
const roundTripMs = 50;
const picture = ['--width', '320', '--height', '200', '--backend', 'cpu'];
const skip = hasNginx ? false : 'nginx is missing: apt-get install nginx-light';

let folder, nginx, s3, line;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'scancast-remote-'));
  chmodSync(folder, 0o755); // nginx that root starts reads as somebody else
  if (!hasNginx) return;
  mkdirSync(join(folder, 'web'));
  for (const [seed, name] of ['other', 'town'].entries()) {
    const [scan, cloud] = [join(folder, `${name}.las`), join(folder, `web/${name}.scan`)];
    execFileSync(program, ['generate', 'town', '--points', '600k', '--seed', String(seed + 1), '-o', scan], { stdio: 'ignore' });
    execFileSync(program, ['ingest', scan, '-o', cloud], { stdio: 'ignore' });
  }
  copyFileSync(join(folder, 'web/town.scan'), join(folder, 'town.scan'));
  nginx = await startNginx(folder, '/town.scan');
  s3 = await startS3(folder);
  await s3.put(join(folder, 'web/town.scan'), 'area/town.scan');
  line = new Line(nginx.port, roundTripMs);
  line.port = await line.start();
});

after(async () => {
  line?.stop();
  nginx?.child.kill();
  await s3?.stop();
  rmSync(folder, { recursive: true, force: true });
});

/** The picture of a cloud, as bytes. */
async function pictureOf(cloud, environment) {
  const file = join(folder, 'picture.png');
  const { code, said } = await run(['render', cloud, '-o', file, ...picture], environment);
  assert.equal(code, 0, said);
  return readFileSync(file);
}

test('the same picture from nginx, by http and by HTTP/2 under TLS, as from the file', { skip }, async () => {
  const expected = await pictureOf(join(folder, 'town.scan'));
  const trusted = { SSL_CERT_FILE: join(folder, 'certificate/cert.pem') };
  assert.ok((await pictureOf(`${nginx.plain}/town.scan`)).equals(expected));
  assert.ok((await pictureOf(`${nginx.secure}/town.scan`, trusted)).equals(expected));
  assert.ok((await pictureOf(`${nginx.plain}/moved/town.scan`)).equals(expected));
  assert.match(readFileSync(join(folder, 'logs/access.log'), 'utf8'), /GET \/town\.scan HTTP\/2\.0" 206/);
});

test('who answers GET alone, and has a secret in the URL, is read, and the secret is told nobody', { skip }, async () => {
  const signed = `${nginx.plain}/signed/town.scan?X-Amz-Signature=topsecret`;
  const told = await run(['info', '--json', signed]);
  assert.equal(told.code, 0, told.said);
  assert.equal(JSON.parse(told.said).files[0].points, 600_000);
  const wrong = await run(['info', '--json', signed.replace('town', 'nothing')]);
  assert.equal(wrong.code, 1);
  assert.match(wrong.said, /there is no such object/);
  for (const words of [['serve', signed, '--check-config'], ['serve', `${signed}#x`], ['label', signed], ['ingest', signed, '-o', 'x.scan'],
    ['look', signed, '--decide'], ['export', signed.replace('town', 'nothing'), '-o', join(folder, 'x.las')], ['render', signed, signed, '-o', join(folder, 'x.png')]])
    wrong.said += (await run(words)).said;
  assert.doesNotMatch(told.said + wrong.said, /topsecret/);
});

test('a certificate that nobody vouches for, https that leads to http, loops and servers without ranges are refused', { skip }, async () => {
  const trusted = { SSL_CERT_FILE: join(folder, 'certificate/cert.pem') };
  for (const [url, says, environment] of [
    [`${nginx.secure}/town.scan`, /certificate/], [`${nginx.secure}/down/town.scan`, /https leads to https only/, trusted],
    [`${nginx.plain}/loop/town.scan`, /redirects without an end/], [`${nginx.plain}/whole/town.scan`, /range requests/],
    ['http://user:topsecret@127.0.0.1/town.scan', /name and password/]]) {
    const { code, said } = await run(['info', url], environment);
    assert.equal(code, 1);
    assert.match(said, says);
    assert.doesNotMatch(said, /topsecret/);
  }
});

test('s3:// is signed, and a server that checks signatures lets nobody else in', { skip }, async () => {
  const expected = await pictureOf(join(folder, 'town.scan'));
  assert.ok((await pictureOf('s3://scans/area/town.scan', s3.environment)).equals(expected));
  const forged = await run(['info', 's3://scans/area/town.scan'], { ...s3.environment, AWS_SECRET_ACCESS_KEY: 'topsecret' });
  assert.equal(forged.code, 1);
  assert.match(forged.said, /403 SignatureDoesNotMatch/);
  const missing = await run(['info', 's3://scans/area/none.scan'], s3.environment);
  assert.match(missing.said, /404 NoSuchKey/);
  assert.doesNotMatch(forged.said + missing.said, /topsecret/);
});

test('all points come out again, with credentials in the environment alone', { skip }, async () => {
  const files = [join(folder, 'near.las'), join(folder, 'far.las')];
  assert.equal((await run(['export', join(folder, 'town.scan'), '-o', files[0]])).code, 0);
  const { code, said } = await run(['export', 's3://scans/area/town.scan', '-o', files[1]], s3.environment);
  assert.equal(code, 0, said);
  assert.ok(readFileSync(files[1]).equals(readFileSync(files[0])));
});

// ---- scans in COPC, where they lie

const copc = join(process.env.SCANCAST_TEST_DATA ?? '.', 'copc/lion_takanawa.copc.laz');
const skipCopc = skip || (existsSync(copc) ? false : `MISSING TEST DATA: ${copc}`);

test('COPC is shown from where it lies as a local one is that is not ingested either', { skip: skipCopc }, async () => {
  copyFileSync(copc, join(folder, 'web/lion.copc.laz'));
  const file = join(folder, 'lion.png');
  const local = await run(['render', copc, '--native', '-o', file, ...picture]);
  assert.equal(local.code, 0, local.said);
  assert.ok((await pictureOf(`${nginx.plain}/lion.copc.laz`)).equals(readFileSync(file)));
  const told = await run(['info', '--json', '--check', '--quiet', `${nginx.plain}/lion.copc.laz`]);
  assert.equal(told.code, 0, told.said);
  const [info] = JSON.parse(told.said).files;
  assert.equal(info.points, 341_989);
  assert.match(info.format, /COPC/);
  const out = await run(['export', `${nginx.plain}/lion.copc.laz`, '-o', join(folder, 'lion.las')]);
  assert.equal(out.code, 1);
  assert.match(out.said, /ingest it/);
});

test('COPC is served through a line that is cut and mended', { skip: skipCopc }, async () => {
  copyFileSync(copc, join(folder, 'web/lion.copc.laz'));
  const far = await served([`http://127.0.0.1:${line.port}/lion.copc.laz`]);
  let stream;
  try {
    await comesTrue(() => fetch(new URL('readyz', far.url)).then((got) => got.ok), 'the server is ready');
    line.cut();
    stream = new Stream(far.url, {});
    await comesTrue(() => stream.frames(0).length > 1, 'frames');
    line.mend();
    await stream.final(0);
    assert.ok(!stream.frames(0).some((frame) => frame.damaged));
    assert.deepEqual(stream.messages.filter(({ type }) => ['problem', 'failed', 'bye'].includes(type)), []);
  } finally {
    stream?.close();
    line.mend();
    await far.server.stop();
  }
});

// ---- sets of EPT, where they lie

/** In FOLDER/web/sets/NAME; how many points each tile has. */
const makeSet = (name) => writeEptOfCopc(copc, join(folder, 'web/sets', name));
const tilesOf = (name) => readdirSync(join(folder, 'web/sets', name, 'ept-data'));

test('EPT is shown from where it lies as COPC of the same voxels is, from nginx and from S3', { skip: skipCopc }, async () => {
  makeSet('lion');
  const file = join(folder, 'lion.png');
  const same = await run(['render', copc, '--native', '-o', file, ...picture]);
  assert.equal(same.code, 0, same.said);
  const expected = readFileSync(file);
  const local = await run(['render', join(folder, 'web/sets/lion'), '--native', '-o', file, ...picture]);
  assert.equal(local.code, 0, local.said);
  assert.ok(readFileSync(file).equals(expected), 'a local set');
  assert.ok((await pictureOf(`${nginx.plain}/sets/lion/ept.json`)).equals(expected), 'by http');
  const trusted = { SSL_CERT_FILE: join(folder, 'certificate/cert.pem') };
  assert.ok((await pictureOf(`${nginx.secure}/sets/lion/ept.json?of=all`, trusted)).equals(expected), 'by HTTP/2 under TLS');
  assert.match(readFileSync(join(folder, 'logs/access.log'), 'utf8'), /GET \/sets\/lion\/ept-data\/0-0-0-0\.laz\?of=all HTTP\/2\.0" 200/);
  for (const name of ['ept.json', 'ept-hierarchy/0-0-0-0.json', ...tilesOf('lion').map((tile) => `ept-data/${tile}`)])
    await s3.put(join(folder, 'web/sets/lion', name), `sets/lion/${name}`);
  assert.ok((await pictureOf('s3://scans/sets/lion/ept.json', s3.environment)).equals(expected), 'by s3');
  const told = await run(['info', '--json', '--check', '--quiet', `${nginx.plain}/sets/lion/ept.json`]);
  assert.equal(told.code, 0, told.said);
  const [info] = JSON.parse(told.said).files;
  assert.equal(info.points, 341_989);
  assert.match(info.format, /EPT 1\.1\.0, laszip/);
});

test('a tile of EPT that is missing, or another than it should be, is told and costs itself', { skip: skipCopc }, async () => {
  const points = makeSet('holes');
  const tiles = [...points.keys()].filter((key) => key.startsWith('1-'));
  const tileAt = (key) => join(folder, `web/sets/holes/ept-data/${key}.laz`);
  rmSync(tileAt(tiles[0]));
  copyFileSync(tileAt('0-0-0-0'), tileAt(tiles[1]));
  const told = await run(['info', '--json', '--check', '--quiet', `${nginx.plain}/sets/holes/ept.json`]);
  assert.equal(told.code, 1);
  assert.match(told.said, new RegExp(`its file ept-data/${tiles[0]}\\.laz is missing`));
  assert.match(told.said, new RegExp(`its file ept-data/${tiles[1]}\\.laz: it holds [0-9,]+ points; its hierarchy says`));
  const far = await served([`${nginx.plain}/sets/holes/ept.json`]);
  let stream;
  try {
    await comesTrue(() => fetch(new URL('readyz', far.url)).then((got) => got.ok), 'the server is ready');
    const clouds = await (await fetch(new URL('api/v1/clouds', far.url))).json();
    assert.equal(clouds.clouds[0].id, 'holes');
    stream = new Stream(far.url, { cloud: 'holes' });
    await stream.final(0);
    assert.ok(stream.frames(0).some((frame) => frame.damaged));
    assert.ok(!stream.frames(0).some((frame) => frame.away), 'missing is not away');
    assert.match(far.server.log, new RegExp(`ept-data/${tiles[0]}\\.laz is missing.*coarser points are shown`));
    assert.ok(metric(await far.metrics(), 'scancast_cloud_blocks_damaged_total') >= 2);
  } finally {
    stream?.close();
    await far.server.stop();
  }
});

test('EPT through a line that is cut is coarser and away, and whole when it is mended', { skip: skipCopc }, async () => {
  makeSet('far');
  const far = await served([`http://127.0.0.1:${line.port}/sets/far/ept.json`]);
  let stream;
  try {
    await comesTrue(() => fetch(new URL('readyz', far.url)).then((got) => got.ok), 'the server is ready');
    line.cut();
    stream = new Stream(far.url, {});
    await comesTrue(() => stream.frames(0).length > 1, 'frames');
    await comesTrue(() => stream.frames(0).at(-1).away, 'a frame that says why it is coarser');
    await comesTrue(async () => metric(await far.metrics(), 'scancast_remote_clouds_away') === 1, 'the cloud is away');
    assert.ok(!stream.frames(0).some((frame) => frame.final), 'coarser points are no final picture');
    line.mend();
    await stream.final(0);
    assert.ok(!stream.frames(0).some((frame) => frame.damaged));
    assert.deepEqual(stream.messages.filter(({ type }) => ['problem', 'failed', 'bye'].includes(type)), []);
  } finally {
    stream?.close();
    line.mend();
    await far.server.stop();
  }
});

test('sets of a list are called as their folders are', { skip: skipCopc }, async () => {
  for (const name of ['lion', 'town hall']) makeSet(name);
  writeFileSync(join(folder, 'web/sets/list.txt'), 'town hall/ept.json\nlion/ept.json\n');
  const far = await served([], ['--catalog', `${nginx.plain}/sets/list.txt`]);
  try {
    const ids = async () => (await (await fetch(new URL('api/v1/clouds', far.url))).json()).clouds.map(({ id }) => id).sort().join();
    await comesTrue(async () => await ids() === 'lion,town-hall', 'both sets');
  } finally {
    await far.server.stop();
  }
});

test('what was fetched of a set of EPT is on disk, until its description is another', { skip: skipCopc }, async () => {
  makeSet('kept');
  const cache = join(folder, 'cache-of-tiles');
  mkdirSync(cache);
  const shown = async () => {
    const { server, url, metrics } = await served([`${nginx.plain}/sets/kept/ept.json`], ['--cache-dir', cache, '--cache-size', '100M']);
    await comesTrue(() => fetch(new URL('readyz', url)).then((got) => got.ok), 'the server is ready');
    const stream = new Stream(url, { cloud: 'kept' });
    await stream.final(0);
    const fetched = metric(await metrics(), 'scancast_remote_bytes_total');
    const { revision } = await (await fetch(new URL('api/v1/clouds/kept', url))).json();
    stream.close();
    await server.stop();
    return { fetched, revision };
  };
  const cold = await shown();
  const warm = await shown();
  assert.ok(warm.fetched < cold.fetched / 5, `${warm.fetched} of ${cold.fetched}`);
  assert.equal(warm.revision, cold.revision);
  const description = join(folder, 'web/sets/kept/ept.json');
  writeFileSync(description, readFileSync(description, 'utf8').replace('"span":128', '"span":256 '));
  const other = await shown();
  assert.ok(other.fetched > cold.fetched * 0.8, `${other.fetched} of ${cold.fetched}`);
  assert.notEqual(other.revision, cold.revision);
});

// ---- served, through a line with latency

/** A stream's messages, acknowledged as they come. */
class Stream {
  messages = [];

  constructor(url, hello) {
    this.socket = new WebSocket(`${url.replace(/^http/, 'ws')}api/v1/stream`, ['scancast.v1']);
    this.socket.on('open', () => this.send({ type: 'hello', width: 320, height: 200, ...hello }));
    this.socket.on('error', (error) => this.messages.push({ type: 'failed', error }));
    this.socket.on('message', (data, binary) => {
      if (!binary) return this.messages.push(JSON.parse(data.toString()));
      const [id, seq] = [Number(data.readBigUInt64LE(16)), Number(data.readBigUInt64LE(24))];
      this.messages.push({ type: 'frame', id, seq, final: (data[9] & 4) !== 0, damaged: (data[9] & 8) !== 0, away: (data[9] & 16) !== 0 });
      this.send({ type: 'ack', frame: id });
    });
  }

  send(message) {
    this.socket.send(JSON.stringify(message));
  }

  frames(seq) {
    return this.messages.filter((message) => message.type === 'frame' && message.seq === seq);
  }

  final(seq) {
    return comesTrue(() => this.frames(seq).some((frame) => frame.final), `the final picture of view ${seq}`);
  }

  close() {
    this.socket.terminate();
  }
}

const closeBy = { camera: { type: 'perspective', eye: [389_480, 5_819_780, 55], target: [389_500, 5_819_800, 36], up: [0, 0, 1], fov: 40 } };
const serveFlags = ['--backend', 'cpu', '--memory-limit', '64M'];
const queryOf = ({ camera }) => `width=320&height=200&samples=1&eye=${camera.eye}&target=${camera.target}&up=${camera.up}&fov=${camera.fov}`;

async function served(files, flags = []) {
  const server = new RealServer(program, files, [...serveFlags, ...flags]);
  const url = await server.start();
  return { server, url, metrics: () => fetch(new URL('metrics', url)).then((got) => got.text()) };
}

function metric(text, name) {
  return Number(new RegExp(`^${name.replace(/[{}"]/g, '\\$&')} (\\S+)$`, 'm').exec(text)?.[1]);
}

test('a cut line shows coarser pictures and no error; the final one comes when it is mended', { skip }, async () => {
  const far = await served([`http://127.0.0.1:${line.port}/town.scan?X-Amz-Signature=topsecret`]);
  const near = await served([join(folder, 'town.scan')]);
  let stream;
  try {
    await comesTrue(() => fetch(new URL('readyz', far.url)).then((got) => got.ok), 'the server is ready');
    stream = new Stream(far.url, { cloud: 'town' });
    await stream.final(0);
    line.cut();
    stream.send({ type: 'view', seq: 1, ...closeBy });
    await comesTrue(() => stream.frames(1).length > 2, 'frames');
    await comesTrue(async () => metric(await far.metrics(), 'scancast_remote_clouds_away') === 1, 'the cloud is away');
    const snapshot = await fetch(new URL(`api/v1/clouds/town/snapshot.png?${queryOf(closeBy)}`, far.url));
    assert.equal(snapshot.status, 503);
    const problem = await snapshot.text();
    assert.match(problem, /unavailable/);
    assert.doesNotMatch(problem, /topsecret|127\.0\.0\.1/);
    assert.ok(!stream.frames(1).some((frame) => frame.final), 'coarser points are no final picture');
    await comesTrue(() => stream.frames(1).at(-1).away, 'a frame that says why it is coarser');
    await comesTrue(async () => metric(await far.metrics(), 'scancast_frames_away_total') > 0, 'it is counted');
    line.mend();
    await stream.final(1);
    assert.ok(!stream.frames(1).some((frame) => frame.damaged));
    assert.ok(!stream.frames(1).some((frame) => frame.final && frame.away), 'what is final lacks nothing');
    assert.deepEqual(stream.messages.filter(({ type }) => ['problem', 'failed', 'bye'].includes(type)), []);
    const [there, here] = await Promise.all([far, near].map(async ({ url }) => {
      const got = await fetch(new URL(`api/v1/clouds/town/snapshot.png?${queryOf(closeBy)}`, url));
      return [got.status, Buffer.from(await got.arrayBuffer()), await (await fetch(new URL('api/v1/clouds', url))).text()];
    }));
    assert.equal(there[0], 200);
    assert.ok(there[1].equals(here[1]), 'the same bytes as from the file');
    assert.doesNotMatch(there[2], /topsecret|127\.0\.0\.1/);
  } finally {
    stream?.close();
    line.mend();
    await Promise.all([far.server.stop(), near.server.stop()]);
  }
});

test('a server that is away at the start is waited for', { skip }, async () => {
  line.cut();
  const far = await served([`http://127.0.0.1:${line.port}/town.scan`]);
  try {
    assert.notEqual((await fetch(new URL('readyz', far.url))).status, 200);
    line.mend();
    await comesTrue(() => fetch(new URL('readyz', far.url)).then((got) => got.ok), 'the server is ready');
  } finally {
    line.mend();
    await far.server.stop();
  }
});

test('what was fetched is on disk; another object in its place is served instead', { skip }, async () => {
  const cache = join(folder, 'cache');
  mkdirSync(cache);
  const first = async () => {
    const { server, url, metrics } = await served([`${nginx.plain}/town.scan`], ['--cache-dir', cache, '--cache-size', '100M']);
    await comesTrue(() => fetch(new URL('readyz', url)).then((got) => got.ok), 'the server is ready');
    const stream = new Stream(url, { cloud: 'town' });
    await stream.final(0);
    return { server, url, metrics, stream };
  };
  const cold = await first();
  const fetched = metric(await cold.metrics(), 'scancast_remote_bytes_total');
  cold.stream.close();
  await cold.server.stop();
  const warm = await first();
  try {
    const text = await warm.metrics();
    assert.ok(metric(text, 'scancast_remote_bytes_total') < fetched / 5, `${metric(text, 'scancast_remote_bytes_total')} of ${fetched}`);
    assert.ok(metric(text, 'scancast_remote_pieces_total{found="disk"}') > 10);
    renameSync(join(folder, 'web/other.scan'), join(folder, 'web/town.scan'));
    const before = warm.stream.messages.length;
    warm.stream.send({ type: 'view', seq: 1, ...closeBy }); // needs what nobody has fetched
    const revision = async () => (await (await fetch(new URL('api/v1/clouds/town', warm.url))).json()).revision;
    const old = await revision();
    await comesTrue(async () => await revision() !== old, 'the other cloud');
    await comesTrue(() => warm.stream.messages.slice(before).some((message) => message.final), 'its picture');
    assert.deepEqual(warm.stream.messages.filter(({ type }) => ['problem', 'failed', 'bye'].includes(type)), []);
  } finally {
    warm.stream.close();
    await warm.server.stop();
  }
});
