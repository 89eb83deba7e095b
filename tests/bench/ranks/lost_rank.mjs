// What somebody who looks at a cloud notices when a rank is killed: how long until the next frame, until one that is not coarser any
// more, until the final still of where he came to rest, until the ranks draw again. Frames that are not coarser before that are the front's own.
//
//     node tests/bench/ranks/lost_rank.mjs FOLDER_OF_THE_PROGRAMS CLOUD.scan [RANKS [KILLS [MEMORY_LIMIT]]]

import { join } from 'node:path';

import { Viewer } from '../../integration/replicas/viewer.mjs';
import { Front, sleep, until } from '../../ranks/front/front.mjs';

const [programs, cloud, ranks = '2', kills = '6', memory = '64M'] = process.argv.slice(2);
if (!cloud) {
  console.error('usage: lost_rank.mjs FOLDER_OF_THE_PROGRAMS CLOUD.scan [RANKS [KILLS [MEMORY_LIMIT]]]');
  process.exit(2);
}
const ms = (time) => `${Math.round(time)} ms`;
/** What came of it by then is known. */
const quiteMs = 500;
/** A job that has lived so long is started again at once. */
const livesMs = 11_000;

const front = await new Front().start(join(programs, 'scancast-ranks'), [cloud, '--threads', '1', '--memory-limit', memory], Number(ranks));
const viewer = new Viewer(front.url, { width: 1280, height: 720 });
try {
  await front.untilUp();
  await viewer.start();
  const rows = [];
  for (let kill = 0; kill < Number(kills); ++kill) {
    viewer.onFrame = () => {};
    viewer.move(20);
    await sleep(livesMs);
    const victims = { 'rank 1': front.ranks()[1], 'rank 0': front.ranks()[0], mpirun: front.mpirun() };
    const who = Object.keys(victims)[kill % 3];
    const shown = [];
    viewer.onFrame = (frame, at) => { shown.push({ ...frame, at }); };
    const killed = performance.now();
    process.kill(victims[who], 'SIGKILL');
    // Every other time he stands still at that moment, and waits for the final still.
    const stands = kill % 2 === 1;
    const next = await until('a frame', () => shown[0]);
    if (stands) viewer.rest();
    await sleep(quiteMs);
    // None, where the front has read all that moving frames need since it lost ranks before.
    const away = shown.find((frame) => frame.away);
    const whole = await until('a frame that is not', () => shown[shown.findLastIndex((frame) => frame.away) + 1]);
    viewer.rest();
    await viewer.final();
    const final = shown.at(-1);
    await front.untilUp(kill + 1);
    const up = performance.now();
    const times = [killed, ...shown.filter((frame) => frame.at <= whole.at).map((frame) => frame.at)];
    rows.push({ killed: who, stands, 'next frame': ms(next.at - killed), 'coarser frame': away ? ms(away.at - killed) : 'none',
      'longest gap': ms(Math.max(...times.slice(1).map((at, i) => at - times[i]))), 'coarser frames': shown.filter((frame) => frame.away).length,
      'whole frame': ms(whole.at - killed), 'final still': ms(final.at - killed), 'ranks are back': ms(up - killed) });
    console.table(rows.slice(-1));
    if (viewer.faults.length > 0) throw new Error(viewer.faults.join('; '));
  }
  console.table(rows);
  console.log(front.log().split('\n').filter((line) => /ranks/.test(line)).join('\n'));
} finally {
  viewer.leave();
  await front.stop();
}
