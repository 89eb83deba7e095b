// How firmly the hand holds, of any server whose frames bring depth:
//
//   node tests/browser/measure/hand.mjs http://127.0.0.1:8080/ [CLOUD…]
//
// For every cloud: by how many pixels what was taken is off after a pan, an orbit and five notches, at nine places of the
// first view and of one from close by; and how much of the picture is covered after 14 notches and after 5 s of W.

import { startBrowser } from '../support/browser.mjs';
import { HandPage, size } from '../support/hand.mjs';
import { PageProxy } from '../support/page_proxy.mjs';

const [, , server = 'http://127.0.0.1:8080/', ...wanted] = process.argv;
const { clouds } = await (await fetch(`${server}api/v1/clouds`)).json();
const proxy = new PageProxy(server);
const url = await proxy.start();
const browser = await startBrowser();
const places = [0.3, 0.5, 0.65].flatMap((x) => [0.35, 0.55, 0.75].map((y) => ({ x: Math.round(x * size.width), y: Math.round(y * size.height) })));
const round = (value) => Number(value.toFixed(2));
const percent = (share) => `${Math.round(100 * share)} %`;

/** Views to start from: those that the cloud itself offers, and one at eye level in its middle. */
async function startsOf(cloud, hand) {
  const starts = (cloud.look?.views ?? []).slice(0, 3).map(({ name, camera }) => ({ name, camera }));
  const { min, max } = cloud.bounds;
  const [x, y] = [(min[0] + max[0]) / 2, (min[1] + max[1]) / 2];
  const reach = Math.max(max[0] - min[0], max[1] - min[1]);
  await hand.look({ eye: [x, y - 1e-3 * reach, max[2] + reach], target: [x, y, min[2]] });
  const ground = await hand.truth({ x: size.width / 2, y: size.height / 2 });
  if (ground) {
    const eye = [ground[0], ground[1], ground[2] + Math.max(2, 0.01 * reach)];
    for (const [name, dx, dy] of [['eye level, north', 0, 1], ['eye level, east', 1, 0]]) {
      starts.push({ name, camera: { eye, target: [eye[0] + dx * 0.1 * reach, eye[1] + dy * 0.1 * reach, eye[2]] } });
    }
  }
  return starts;
}

try {
  for (const cloud of clouds.filter(({ id }) => wanted.length === 0 || wanted.includes(id))) {
    const hand = await HandPage.open(browser, url, server, `#cloud=${cloud.id}`);
    const starts = await startsOf(cloud, hand);
    const worst = { pan: [], orbit: [], zoom: [] };
    for (const [i, place] of places.entries()) {
      await hand.look(starts[i % Math.min(3, starts.length)].camera);
      if (i % 2 === 1) await hand.notches(place, 8);
      const errors = await hand.errors(place);
      for (const key of Object.keys(worst)) if (errors) worst[key].push(errors[key]);
    }
    const said = Object.entries(worst).map(([key, values]) => {
      values.sort((a, b) => a - b);
      return `${key} ${round(values[values.length >> 1] ?? NaN)} (most ${round(values.at(-1) ?? NaN)})`;
    });
    console.log(`${cloud.id}: px off, median of ${worst.pan.length}: ${said.join(', ')}`);
    for (const { name, camera } of starts) {
      const after = [];
      for (const place of [places[4], places[0], places[8]]) {
        await hand.look(camera);
        await hand.notches(place, 14);
        after.push(percent(await hand.wire.covered()));
      }
      await hand.look(camera);
      const before = await hand.wire.covered();
      await hand.hold('w', 5000);
      console.log(`  ${name}: ${percent(before)} covered; after 14 notches at three places ${after.join(', ')}; after 5 s of W ${percent(await hand.wire.covered())}`);
    }
    await hand.close();
  }
} finally {
  await browser.close();
  await proxy.stop();
}
