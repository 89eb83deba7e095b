// Three replicas behind nginx, and people who move: each replica is stopped and started again, one is killed, and nobody loses a session
// or a view. Judged is what is lost, not how long it takes (measure.mjs tells that).

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { spawnSync } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

import { Cluster, nginxProgram, sleep } from './cluster.mjs';
import { startViewers } from './viewer.mjs';

const people = 8;
const skip = nginxProgram() ? false : 'nginx is missing: apt-get install nginx-light';
if (skip) console.log(`SKIPPED: rolling restarts: ${skip}`);
const program = process.env.SCANCAST_PROGRAM;
const cluster = new Cluster();
let folder;
let viewers = [];

before(async () => {
  if (skip) return;
  folder = mkdtempSync(join(tmpdir(), 'scancast-replicas-clouds-'));
  const [ply, scan] = [join(folder, 'statue.las'), join(folder, 'statue.scan')];
  for (const command of [['generate', 'statue', '--points', '20000', '-o', ply, '--quiet'], ['ingest', ply, '-o', scan]]) {
    const done = spawnSync(program, command, { encoding: 'utf8' });
    assert.equal(done.status, 0, done.stderr);
  }
  await cluster.start(program, [scan], { flags: ['--backend', 'cpu', '--threads', '1', '--memory-limit', '256M'], drainSeconds: 3 });
  viewers = await startViewers(cluster.url, people);
  viewers.forEach((viewer) => viewer.move(10));
  while (viewers.some((viewer) => viewer.seq < 3)) await sleep(20);
});

after(async () => {
  viewers.forEach((viewer) => viewer.leave());
  await cluster.stop();
  if (folder) rmSync(folder, { recursive: true, force: true });
});

/** Nobody lost anything, and everybody sees what was asked for last: the picture that any replica makes of that view. */
async function nobodyLost() {
  viewers.forEach((viewer) => viewer.rest());
  for (const viewer of viewers) {
    const seen = await viewer.final();
    assert.deepEqual(viewer.faults, [], cluster.logs());
    for (const replica of cluster.replicas) {
      const answer = await fetch(`${replica.url}api/v1/clouds/${viewer.cloud}/snapshot`, { method: 'POST',
        headers: { 'Content-Type': 'application/json', Accept: 'image/jpeg' }, body: JSON.stringify({ camera: viewer.camera, width: 192, height: 108 }) });
      assert.equal(answer.status, 200);
      assert.ok(Buffer.from(await answer.arrayBuffer()).equals(seen), 'the same bytes from every replica');
    }
  }
  viewers.forEach((viewer) => viewer.move(10));
}

test('people are spread over the replicas', { skip }, async () => {
  const sessions = await cluster.metric('scancast_sessions');
  assert.equal(sessions.reduce((sum, one) => sum + one), people);
  await nobodyLost();
});

test('each replica in turn is stopped and started again: nobody loses a session, a view or a frame number', { skip }, async () => {
  const ids = viewers.map((viewer) => viewer.session);
  for (const replica of cluster.replicas) {
    assert.deepEqual(await replica.stop(), { code: 0, signal: null }, cluster.logs());
    await replica.start();
  }
  await sleep(300);
  await nobodyLost();
  assert.deepEqual(viewers.map((viewer) => viewer.session), ids);
  assert.ok(viewers.every((viewer) => viewer.connections >= 2), 'all were moved');
  assert.ok(viewers.some((viewer) => viewer.drained > 0), 'they were told to go');
});

test('a replica is killed: its people go on elsewhere with the view that they had', { skip }, async () => {
  const sessions = await cluster.metric('scancast_sessions');
  const fullest = sessions.indexOf(Math.max(...sessions));
  await cluster.replicas[fullest].stop('SIGKILL');
  await sleep(500);
  const patience = Date.now() + 60_000;
  while ((await cluster.metric('scancast_sessions')).reduce((sum, one) => sum + one) < people) {
    assert.ok(Date.now() < patience, cluster.logs());
    await sleep(50);
  }
  await cluster.replicas[fullest].start();
  await nobodyLost();
});
