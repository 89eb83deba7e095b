// A front before ranks: its pictures are one process', whoever is killed; streams go on, say that pictures are coarser, and have their
// final still again by themselves; and nobody is left when it ends. Judged is what is shown, not how long it takes (lost_rank.mjs
// under tests/bench/ranks tells that).

import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';

import { Viewer } from '../../integration/replicas/viewer.mjs';
import { Front, Server, hasMpirun, isRunning, until } from './front.mjs';

const skip = hasMpirun() ? false : 'mpirun is missing: apt-get install openmpi-bin';
if (skip) console.log(`SKIPPED: a front before ranks: ${skip}`);
const [scancast, ranks] = [process.env.SCANCAST_PROGRAM, process.env.SCANCAST_RANKS_PROGRAM];
const size = 'width=160&height=90';
// Less than what a picture of the viewer shows, so that without ranks there is something coarser.
const frontFlags = ['--threads', '1', '--memory-limit', '64M'];
const [alone, front] = [new Server(), new Front()];
let folder, cloud;

before(async () => {
  if (skip) return;
  folder = mkdtempSync(join(tmpdir(), 'scancast-front-clouds-'));
  const scan = join(folder, 'room.las');
  cloud = join(folder, 'room.scan');
  for (const command of [['generate', 'room', '--points', '800k', '-o', scan], ['ingest', scan, '-o', cloud]])
    assert.equal(spawnSync(scancast, command).status, 0, command.join(' '));
  await Promise.all([
    alone.start([scancast, 'serve', cloud, '--backend', 'cpu', '--threads', '1', '--memory-limit', '256M']),
    front.start(ranks, [cloud, ...frontFlags], 2),
  ]);
  await front.untilUp();
});

after(async () => {
  await Promise.all([alone.stop(), front.stop('SIGKILL')]);
  if (folder) rmSync(folder, { recursive: true, force: true });
});

async function assertSame(path, options = {}, by = front) {
  const [one, other] = await Promise.all([alone.get(path, options), by.get(path, options)]);
  assert.equal(one.status, 200, `${path}: ${one.bytes}`);
  assert.equal(other.status, 200, `${path}: ${other.bytes}`);
  assert.ok(one.bytes.length > 0 && one.bytes.equals(other.bytes), `${path} has other bytes than one process\' server sends`);
}

const posted = (body, accept) => ({ method: 'POST', body: JSON.stringify(body),
  headers: { 'Content-Type': 'application/json', ...(accept ? { Accept: accept } : {}) } });

test('pictures, depths and picks are one process\'', { skip }, async () => {
  for (const query of ['method=ewa&samples=4', 'method=point&samples=1', 'method=voronoi', 'method=hqs&mirrors=true', 'method=pyramid'])
    await assertSame(`snapshot.png?${size}&${query}`);
  await assertSame(`snapshot.jpg?${size}`);
  await assertSame('snapshot', posted({ width: 160, height: 90, method: 'ewa' }, 'application/octet-stream'));
  await assertSame('pick', posted({ view: { width: 160, height: 90 }, x: 80, y: 60 }));
  assert.equal(await front.metric('scancast_ranks_up'), 1);
  assert.equal(await front.metric('scancast_ranks_restarts_total'), 0, front.log());
});

for (const [who, victim] of [['a rank', (front) => front.ranks()[1]], ['the first rank', (front) => front.ranks()[0]], ['mpirun', (front) => front.mpirun()]])
  test(`${who} is killed, and missed in a stream for a while, and no longer`, { skip }, async () => {
    // A new one each time: what the last one has read since it lost its ranks might be all that there is.
    const other = await new Front().start(ranks, [cloud, ...frontFlags], 2);
    await other.untilUp();
    const viewer = new Viewer(other.url, { width: 960, height: 540 });
    try {
      await viewer.start();
      viewer.wantSharpness();
      const first = viewer.last.picture;
      const before = [other.mpirun(), ...other.ranks()];
      let coarser = 0;
      viewer.onFrame = (frame) => { coarser += frame.away; };
      viewer.move(20);
      other.holdStarts(); // or a slow machine might show nothing between two jobs
      process.kill(victim(other), 'SIGKILL');
      await until('a coarser frame', () => coarser > 0); // so what was drawn before was the ranks'
      other.letStart();
      viewer.rest();
      viewer.lookAsAtFirst();
      assert.ok(first.equals(await viewer.final()), 'the final still is another than before');
      assert.equal(viewer.last.away, false);
      await other.untilUp(1);
      await assertSame(`snapshot.png?${size}&method=ewa`, {}, other);
      await until('the end of those before', () => !before.some(isRunning));
      assert.deepEqual(viewer.faults, []);
      assert.equal(viewer.connections, 1);
    } finally {
      viewer.leave();
      await other.stop('SIGKILL');
    }
  });

test('nobody is left when it ends, however', { skip }, async () => {
  for (const signal of ['SIGTERM', 'SIGKILL']) {
    const other = await new Front().start(ranks, [cloud, ...frontFlags], 2);
    await other.untilUp();
    const all = [other.mpirun(), ...other.ranks()];
    assert.equal(all.length, 3);
    const how = await other.stop(signal);
    assert.deepEqual(how, signal === 'SIGTERM' ? { code: 0, signal: null } : { code: null, signal });
    await until('the end of its ranks', () => !all.some(isRunning));
  }
});

test('where ranks cannot be started it says so, and serves', { skip }, async () => {
  const other = await new Server().start([ranks, 'front', cloud, '--threads', '1', '--memory-limit', '256M', '--start', 'no-such-mpirun -n 2']);
  const [one, same] = await Promise.all([alone.get(`snapshot.png?${size}`), other.get(`snapshot.png?${size}`)]);
  assert.equal(same.status, 200);
  assert.ok(one.bytes.equals(same.bytes));
  assert.equal(await other.metric('scancast_ranks_up'), 0);
  await until('two more starts', async () => await other.metric('scancast_ranks_restarts_total') >= 2);
  assert.equal(other.log().match(/no-such-mpirun cannot be started/g)?.length, 1, other.log()); // not at each of them
  assert.deepEqual(await other.stop(), { code: 0, signal: null });
});
