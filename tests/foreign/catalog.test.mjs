// --catalog behind a URL: a list at nginx, behind a line that can be cut, and a prefix in S3. Clouds appear and vanish without a restart,
// and an outage takes nothing away.

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { chmodSync, copyFileSync, mkdirSync, mkdtempSync, renameSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';

import { RealServer } from '../browser/support/real_server.mjs';
import { Line } from '../support/line.mjs';
import { comesTrue, hasNginx, startNginx, startS3 } from './support/object_storage.mjs';

const program = process.env.SCANCAST_PROGRAM;
const skip = hasNginx ? false : 'nginx is missing: apt-get install nginx-light';
const flags = ['--backend', 'cpu', '--memory-limit', '64M', '--request-log', 'off'];

let folder, nginx, s3, line;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'scancast-catalog-'));
  chmodSync(folder, 0o755); // nginx that root starts reads as somebody else
  if (!hasNginx) return;
  mkdirSync(join(folder, 'web'));
  const scan = join(folder, 'town.las');
  execFileSync(program, ['generate', 'town', '--points', '50k', '-o', scan], { stdio: 'ignore' });
  execFileSync(program, ['ingest', scan, '-o', join(folder, 'web/town.scan')], { stdio: 'ignore' });
  nginx = await startNginx(folder, '/town.scan');
  s3 = await startS3(folder);
  line = new Line(nginx.port, 10);
  line.port = await line.start();
});

after(async () => {
  line?.stop();
  nginx?.child.kill();
  await s3?.stop();
  rmSync(folder, { recursive: true, force: true });
});

/** A list as whoever makes it should put it there: at once. */
function writeList(text) {
  writeFileSync(join(folder, 'list.part'), text);
  renameSync(join(folder, 'list.part'), join(folder, 'web/list.txt'));
}

async function served(catalog, environment) {
  const server = new RealServer(program, [], [...flags, '--catalog', catalog], environment);
  const url = await server.start();
  const clouds = () => fetch(new URL('api/v1/clouds', url)).then((got) => got.json());
  return {
    server,
    clouds,
    has: (...ids) => comesTrue(async () => (await clouds()).clouds.map(({ id }) => id).sort().join() === ids.join(), `clouds ${ids}`),
    failed: async () => (await clouds()).pending.filter(({ state }) => state === 'failed').map(({ id }) => id),
  };
}

test('clouds of a list come and go with it, and an outage takes none away', { skip }, async () => {
  writeFileSync(join(folder, 'web/broken.scan'), 'no cloud file');
  writeList('# clouds\ntown.scan\nbroken.scan\ns3://scans/area/town.scan\n');
  const far = await served(`http://127.0.0.1:${line.port}/list.txt?key=topsecret`);
  try {
    await far.has('town');
    await comesTrue(async () => (await far.failed()).join() === 'broken', 'the broken one is told of');
    copyFileSync(join(folder, 'web/town.scan'), join(folder, 'web/broken.scan'));
    copyFileSync(join(folder, 'web/town.scan'), join(folder, 'web/a church.scan'));
    writeList('town.scan\nbroken.scan\na church.scan\n');
    await far.has('a-church', 'broken', 'town');
    line.cut();
    await comesTrue(() => far.server.log.includes('The clouds stay as they are'), 'the outage is told');
    await far.has('a-church', 'broken', 'town');
    writeList('["town.scan"]');
    line.mend();
    await far.has('town');
    writeList('');
    await comesTrue(() => far.server.log.includes('nothing stands in it'), 'an empty file is told');
    await far.has('town');
    assert.equal(far.server.log.split('\n').filter((said) => said.includes('broken.scan')).length, 1, 'once');
    assert.match(far.server.log, /only a list that is in S3 itself/);
    assert.doesNotMatch(far.server.log, /topsecret/);
    line.cut();
    const begun = Date.now();
    await far.server.stop();
    assert.ok(Date.now() - begun < 10_000, 'nobody waits for the list when the server ends');
  } finally {
    line.mend();
    await far.server.stop();
  }
});

test('objects beneath a prefix are clouds, with credentials from the environment', { skip }, async () => {
  const cloud = join(folder, 'web/town.scan');
  const put = (key) => s3.put(cloud, key);
  await put('area/town.scan');
  for (const other of ['area/.hidden.scan', 'area/notes.txt', 'area/old/tower.scan', 'elsewhere.scan']) await put(other);
  const near = await served('s3://scans/area/', s3.environment);
  const forged = await served('s3://scans/area/', { ...s3.environment, AWS_SECRET_ACCESS_KEY: 'topsecret' });
  try {
    await near.has('town');
    await put('area/a & b.scan');
    await near.has('a-b', 'town');
    await s3.remove('area/town.scan');
    await near.has('a-b');
    await comesTrue(() => forged.server.log.includes('403 SignatureDoesNotMatch'), 'who may not look is told');
    assert.deepEqual((await forged.clouds()).clouds, []);
    assert.doesNotMatch(forged.server.log + near.server.log, /topsecret/);
  } finally {
    await Promise.all([near.server.stop(), forged.server.stop()]);
  }
});
