// The pictures of the page in docs/images/page: what a visitor sees, made by using it.
//
//   scancast generate town --points 5M -o town.las && scancast ingest town.las -o town.scan
//   node docs/page_pictures.mjs build/release/bin/scancast town.scan
//
// The first cloud is shown wide, by night and by day, the last one on a phone. They need tests/browser/node_modules and Chromium.

import { mkdirSync } from 'node:fs';
import { fileURLToPath } from 'node:url';

import { startBrowser, waitUntilSharp } from '../tests/browser/support/browser.mjs';
import { PageProxy } from '../tests/browser/support/page_proxy.mjs';
import { RealServer } from '../tests/browser/support/real_server.mjs';

const [, , program, ...clouds] = process.argv;
const only = process.env.ONLY; // one picture's name, to make that one alone
if (!program || clouds.length === 0) {
  console.error('Usage: node docs/page_pictures.mjs SCANCAST CLOUD…   (an example is at the top of this file)');
  process.exit(2);
}
const folder = fileURLToPath(new URL('images/page/', import.meta.url));
mkdirSync(folder, { recursive: true });

const server = new RealServer(program, clouds);
const proxy = new PageProxy(await server.start());
const url = await proxy.start();
const browser = await startBrowser();
const { clouds: list } = await (await fetch(new URL('/api/v1/clouds', url))).json();
const [first, last] = [list[0].id, list.at(-1).id];

const wide = { viewport: { width: 1440, height: 900 } };
const tablet = { viewport: { width: 1024, height: 768 }, hasTouch: true };
const phone = { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true, deviceScaleFactor: 2 };

/** One picture: `use(page)` brings the page to what is to be seen. */
async function take(name, options, hash, use = async () => {}, quality = 82) {
  if (only && only !== name) return;
  const context = await browser.newContext({ colorScheme: 'dark', ...options });
  const page = await context.newPage();
  await page.goto(`${url}#${hash}`);
  await waitUntilSharp(page, 60_000);
  await use(page);
  await waitUntilSharp(page, 60_000);
  await page.waitForTimeout(600); // messages and flights
  await page.screenshot({ path: `${folder}${name}.jpg`, type: 'jpeg', quality });
  console.log(`docs/images/page/${name}.jpg`);
  await context.close();
}

await take('page', wide, `cloud=${first}`);
await take('light', { ...wide, colorScheme: 'light' }, `cloud=${first}`, async (page) => {
  await page.keyboard.press('v');
  await page.waitForFunction(() => document.querySelectorAll('#views-list img').length >= 4, undefined, { timeout: 30_000 });
});
await take('presentation', wide, `cloud=${first}`, async (page) => {
  await page.mouse.move(700, 450);
  for (let notch = 0; notch < 4; ++notch) {
    await page.mouse.wheel(0, -200);
    await page.waitForTimeout(250);
  }
  await page.keyboard.press('h');
});
await take('plan', { viewport: { width: 960, height: 660 } }, `cloud=${first}&color=classification`, async (page) => {
  for (const key of ['7', 'g', 'n']) await page.keyboard.press(key);
  await page.waitForFunction(() => document.querySelector('#minimap img').naturalWidth > 0, undefined, { timeout: 30_000 });
  await page.waitForTimeout(600); // the flight
  await page.mouse.move(430, 250);
  await page.mouse.wheel(0, -320);
}, 66);
await take('tablet', { ...tablet, colorScheme: 'light' }, `cloud=${last}`);
await take('phone', phone, `cloud=${last}`);

// Somebody who measures; the card covers the left of the picture.
const near = 'eye=389500,5819655,100&target=389500,5819765,36&up=0,0,1&projection=perspective&fov=45'; // of the generated town
await take('measure', { viewport: { width: 1000, height: 580 } }, `cloud=${first}&${near}`, async (page) => {
  await page.keyboard.press('p');
  await page.waitForTimeout(500);
  await page.keyboard.press('m');
  await page.waitForSelector('#measuring', { state: 'visible' });
  for (const [kind, places] of [['height', [[499, 170], [500, 66]]], ['area', [[470, 462], [570, 458], [575, 506], [458, 510]]], ['distance', [[702, 430], [664, 312], [628, 242]]]]) {
    await page.check(`#measure-kinds input[value=${kind}]`);
    for (const [x, y] of places) {
      await page.mouse.click(x, y);
      await page.waitForTimeout(900);
    }
    await page.keyboard.press('Enter');
    await page.waitForTimeout(300);
  }
}, 46);

// Two sides under a divider, and a note.
await take('compare', { viewport: { width: 1000, height: 560 } }, `cloud=${first}&${near}&compare=method:point;color:classification;at:56`, async (page) => {
  await page.keyboard.press('p');
  await page.waitForSelector('#other-side.drawn');
  await page.waitForTimeout(500);
  await page.keyboard.press('i');
  await page.waitForSelector('#annotating:not([hidden])');
  await page.mouse.click(500, 66);
  await page.waitForSelector('#note-list input');
  await page.keyboard.type('Scan it again from the north');
  await page.keyboard.press('Tab');
  await page.click('#close-annotating');
  await page.waitForTimeout(2500); // the second picture, too
}, 60);

// A profile along three points, and a measurement in it.
await take('profile', { viewport: { width: 1000, height: 660 } }, `cloud=${first}&${near}`, async (page) => {
  await page.keyboard.press('p');
  await page.waitForTimeout(500);
  await page.keyboard.press('t');
  await page.waitForSelector('#profiling', { state: 'visible' });
  for (const [x, y] of [[470, 300], [610, 420], [760, 330]]) {
    await page.mouse.click(x, y);
    await page.waitForTimeout(900);
  }
  await page.keyboard.press('Enter');
  await page.waitForFunction(() => document.getElementById('profile-said').textContent !== '', undefined, { timeout: 30_000 });
  await page.waitForTimeout(2500);
  const { x, y, width, height } = await page.locator('#profile-plot').boundingBox();
  for (const [u, v] of [[0.36, 0.82], [0.47, 0.3]]) await page.mouse.click(x + u * width, y + v * height);
}, 60);

await browser.close();
await proxy.stop();
await server.stop();
