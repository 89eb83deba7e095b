// A small film of somebody who measures, and draws a profile: the page driven by a mouse that one sees, a picture for every step, joined by ffmpeg.
//
//   scancast generate town --points 5M -o town.las && scancast ingest town.las -o town.scan && scancast serve town.scan &
//   node tests/browser/measure/measuring_film.mjs http://127.0.0.1:8080/ measuring.mp4 [CLOUD]
//
// Pictures are taken as fast as this machine can and shown at 12 a second, so the film's time is not the page's. Where is clicked is right for that town: the
// church's tower, a roof, a street.

import { spawnSync } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

import { startBrowser, waitUntilSharp } from '../support/browser.mjs';

const [, , url, film, cloud = 'town'] = process.argv;
if (!url || !film) {
  console.error('Usage: node tests/browser/measure/measuring_film.mjs URL FILM.mp4 [CLOUD]');
  process.exit(2);
}
const rate = 12;
const folder = mkdtempSync(join(tmpdir(), 'scancast-film-'));
const browser = await startBrowser();
const page = await (await browser.newContext({ viewport: { width: 1280, height: 720 }, colorScheme: 'dark' })).newPage();

let pictures = 0;
let at = { x: 640, y: 680 };
const take = async (count = 1) => {
  for (let i = 0; i < count; ++i) await page.screenshot({ path: join(folder, `${String(pictures++).padStart(5, '0')}.jpg`), type: 'jpeg', quality: 90, timeout: 120_000 });
};
/** The browser draws no cursor into screenshots. */
const showCursor = ({ x, y }) => page.evaluate(([left, top]) => {
  const id = 'film-cursor';
  const node = document.getElementById(id) ?? document.body.appendChild(Object.assign(document.createElement('div'), { id }));
  Object.assign(node.style, {
    position: 'fixed', left: `${left - 9}px`, top: `${top - 9}px`, width: '18px', height: '18px', border: '2px solid #fff', borderRadius: '50%', background: '#0006', zIndex: '99',
    pointerEvents: 'none',
  });
}, [x, y]);
const go = async (to, steps = 8) => {
  const from = at;
  for (let i = 1; i <= steps; ++i) {
    const t = i / steps;
    const smooth = t * t * (3 - 2 * t);
    at = { x: from.x + (to.x - from.x) * smooth, y: from.y + (to.y - from.y) * smooth };
    await page.mouse.move(at.x, at.y);
    await showCursor(at);
    await take();
  }
};
let picked = 0; // points that the server has found
page.on('response', (response) => { if (response.url().endsWith('/pick')) picked += 1; });
const press = async () => {
  await page.mouse.down();
  await page.mouse.up();
};
/** `finds`: the click is on the scan, and the server is to find the point. */
const click = async (to, { finds = false } = {}) => {
  await go(to);
  const before = picked;
  await press();
  for (let waited = 0; finds && picked === before; waited += 50) {
    if (waited > 30_000) throw new Error(`The server found no point for the click at ${to.x}, ${to.y}.`);
    await page.waitForTimeout(50);
  }
  await page.waitForTimeout(finds ? 150 : 300);
  await take(3);
};
const pick = (to) => click(to, { finds: true });
const drag = async (to, steps = 16) => {
  await page.mouse.down();
  await go(to, steps);
  await page.waitForTimeout(90);
  await page.mouse.up();
  await page.waitForTimeout(300);
  await take(4);
};
const middleOf = async (selector) => {
  const { x, y, width, height } = await page.locator(selector).first().boundingBox();
  return { x: x + width / 2, y: y + height / 2 };
};
const kind = async (name) => {
  await click(await middleOf(`#measure-kinds .choice:has(input[value=${name}])`));
  if (!await page.locator(`#measure-kinds input[value=${name}]`).isChecked()) throw new Error(`The click did not choose ${name}.`);
};

await page.goto(`${url}#cloud=${cloud}`);
await waitUntilSharp(page, 60_000);
await page.keyboard.press('p'); // the picture has the window to itself
await page.waitForTimeout(600);
await waitUntilSharp(page, 60_000);
await take(8);
await click(await middleOf('#tool-measure'));
await page.waitForSelector('#measuring', { state: 'visible' }); // it is loaded when it is first used
const near = 'eye=389500,5819655,100&target=389500,5819765,36&up=0,0,1&projection=perspective&fov=45';
const look = async () => {
  await page.evaluate((hash) => { location.hash = hash; }, `#cloud=${cloud}&${near}`);
  for (let i = 0; i < 4; ++i) {
    await page.waitForTimeout(60);
    await take();
  }
  await page.waitForTimeout(500);
  await waitUntilSharp(page, 60_000);
  await take(6);
};
await look();
/** How many have been measured; the newest one's words. */
const measured = async (count) => {
  await page.waitForFunction((wanted) => document.querySelectorAll('#measure-list .name').length === wanted, count);
  await take(8);
};
for (const place of [{ x: 891, y: 534 }, { x: 844, y: 387 }, { x: 799, y: 300 }]) await pick(place);
await page.keyboard.press('Enter');
await measured(1);
await go({ x: 800, y: 360 });
await drag({ x: 600, y: 330 }, 24);
await go({ x: 620, y: 250 });
await drag({ x: 820, y: 280 }, 24);
await look(); // as before
await kind('height');
for (const place of [{ x: 639, y: 211 }, { x: 640, y: 82 }]) await pick(place);
await measured(2);
await kind('area');
for (const place of [{ x: 603, y: 573 }, { x: 727, y: 568 }, { x: 733, y: 628 }, { x: 588, y: 633 }]) await pick(place);
await page.keyboard.press('Enter');
await measured(3);
await page.keyboard.press('Control+z');
await take(5);
await page.keyboard.press('Control+Shift+z');
await take(12);

// A profile: the line, what the server finds along it, a measurement there, nearer.
await click(await middleOf('#tool-profile'));
await page.waitForSelector('#profiling', { state: 'visible' });
for (const place of [{ x: 603, y: 372 }, { x: 776, y: 521 }, { x: 963, y: 410 }]) await pick(place);
await page.keyboard.press('Enter');
await page.waitForFunction(() => document.getElementById('profile-said').textContent !== '', undefined, { timeout: 30_000 });
await page.waitForTimeout(1500);
await take(8);
const plot = await page.locator('#profile-plot').boundingBox();
const inPlot = (u, v) => ({ x: plot.x + u * plot.width, y: plot.y + v * plot.height });
for (const [u, v] of [[0.32, 0.8], [0.45, 0.3]]) await click(inPlot(u, v));
await go(inPlot(0.4, 0.5));
for (let i = 0; i < 5; ++i) {
  await page.mouse.wheel(0, -140);
  await take(2);
}
await page.waitForTimeout(1000);
await take(8);
await go(inPlot(0.7, 0.4));
await take(6);
await browser.close();

const { status, stderr } = spawnSync('ffmpeg', ['-y', '-loglevel', 'error', '-framerate', String(rate), '-i', join(folder, '%05d.jpg'), '-pix_fmt', 'yuv420p', '-crf', '24', film], { encoding: 'utf8' });
rmSync(folder, { recursive: true, force: true });
if (status !== 0) {
  console.error(`ffmpeg could not join the pictures: ${stderr || 'it is not installed (apt-get install ffmpeg)'}`);
  process.exit(1);
}
console.log(`${film}: ${pictures} pictures, ${(pictures / rate).toFixed(0)} s`);
