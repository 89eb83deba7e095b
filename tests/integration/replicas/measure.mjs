// How long people wait when replicas behind nginx are restarted one after the other, and when one is killed. Prints figures; judges only
// what is lost.
//
//     node tests/integration/replicas/measure.mjs PROGRAM CLOUD.scan [--sessions 50] [--replicas 3] [--seconds 10] [--drain 10]
//
// The sessions' pictures are 192 x 108 and get 10 views a second each; clients, nginx and replicas share this machine.

import { cpus } from 'node:os';

import { Cluster, sleep } from './cluster.mjs';
import { startViewers } from './viewer.mjs';

const [program, cloud, ...rest] = process.argv.slice(2);
const option = (name, usual) => (rest.includes(`--${name}`) ? Number(rest[rest.indexOf(`--${name}`) + 1]) : usual);
if (!program || !cloud) {
  console.error('measure.mjs PROGRAM CLOUD.scan [--sessions 50] [--replicas 3] [--seconds 10] [--drain 10]');
  process.exit(2);
}
const [sessions, count, seconds, drainSeconds] = [option('sessions', 50), option('replicas', 3), option('seconds', 10), option('drain', 10)];

const sorted = (values) => [...values].sort((a, b) => a - b);
const quantile = (values, q) => sorted(values)[Math.min(values.length - 1, Math.floor(q * values.length))];
const ms = (value) => `${value.toFixed(0)} ms`;

/** One line of the table: the longest pause of each session since `since`. */
function tell(what, viewers, since) {
  const gaps = viewers.map((viewer) => viewer.gap(since));
  const frames = viewers.map((viewer) => viewer.frames.filter((time) => time > since).length / ((performance.now() - since) / 1000));
  const faults = viewers.filter((viewer) => viewer.faults.length).length;
  console.log(`${what}: longest pause of a session: median ${ms(quantile(gaps, 0.5))}, 90 % ${ms(quantile(gaps, 0.9))}, worst ${ms(Math.max(...gaps))}; `
    + `${quantile(frames, 0.5).toFixed(1)} frames/s each; sessions lost: ${faults}`);
  return faults;
}

const cluster = new Cluster();
let viewers = [];
let lost = 0;
try {
  await cluster.start(program, [cloud], { count, drainSeconds, flags: ['--backend', 'cpu', '--threads', '1', '--memory-limit', '512M', '--max-sessions', String(4 * sessions)] });
  viewers = await startViewers(cluster.url, sessions);
  viewers.forEach((viewer) => viewer.move(10));
  console.log(`${count} replicas, ${sessions} sessions (${(await cluster.metric('scancast_sessions')).join(' + ')}), ${cpus().length} cores`);
  await sleep(2000);

  let since = performance.now();
  await sleep(seconds * 1000);
  lost += tell('left alone', viewers, since);

  since = performance.now();
  for (const replica of cluster.replicas) {
    const began = performance.now();
    const { code } = await replica.stop();
    const stopped = performance.now();
    await replica.start();
    console.log(`  a replica: ended with ${code} after ${ms(stopped - began)}, ready again ${ms(performance.now() - stopped)} later`);
  }
  await sleep(1000);
  lost += tell('rolling restart', viewers, since);
  console.log(`  told to go: ${viewers.reduce((sum, viewer) => sum + viewer.drained, 0)} times; connections refused on the way: ${viewers.reduce((sum, viewer) => sum + viewer.refused, 0)}`);

  const held = await cluster.metric('scancast_sessions');
  const fullest = held.indexOf(Math.max(...held));
  const connections = viewers.map((viewer) => viewer.connections);
  since = performance.now();
  await cluster.replicas[fullest].stop('SIGKILL');
  await sleep(3000);
  const moved = viewers.filter((viewer, i) => viewer.connections > connections[i]);
  lost += tell(`kill -9 of the one with ${held[fullest]}, its sessions`, moved.length ? moved : viewers, since);
  lost += tell('  the others', viewers.filter((viewer) => !moved.includes(viewer)), since);

  viewers.forEach((viewer) => viewer.rest());
  await Promise.all(viewers.map((viewer) => viewer.final()));
  console.log('all sessions have the final still of the view that they sent last');
} finally {
  viewers.forEach((viewer) => viewer.leave());
  await cluster.stop();
}
viewers.flatMap((viewer) => viewer.faults).slice(0, 5).forEach((fault) => console.log(fault));
process.exit(lost ? 1 : 0);
