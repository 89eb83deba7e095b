// The pictures of the page in docs/images/page: what a visitor sees, made by using it.
//
//   scancast generate town --points 5M -o town.las && scancast ingest town.las -o town.scan
//   scancast generate town --points 2M --seed 2 --origin 389700,5819800,34 -o east.las && scancast ingest east.las -o east.scan
//   node docs/page_pictures.mjs build/release/bin/scancast town.scan east.scan
//
// The second cloud, the tile to the east of the first one, is shown with it in one of them. They need tests/browser/node_modules and Chromium.

import { mkdirSync } from 'node:fs';
import { basename } from 'node:path';
import { fileURLToPath } from 'node:url';

import { startBrowser, waitUntilSharp } from '../tests/browser/support/browser.mjs';
import { PageProxy } from '../tests/browser/support/page_proxy.mjs';
import { RealServer } from '../tests/browser/support/real_server.mjs';

const [, , program, ...clouds] = process.argv;
const only = process.env.ONLY; // one picture's name, to make that one alone
if (!program || clouds.length !== 2) {
  console.error('Usage: node docs/page_pictures.mjs SCANCAST TOWN EAST   (an example is at the top of this file)');
  process.exit(2);
}
const folder = fileURLToPath(new URL('images/page/', import.meta.url));
mkdirSync(folder, { recursive: true });

const server = new RealServer(program, clouds);
const proxy = new PageProxy(await server.start());
const url = await proxy.start();
const browser = await startBrowser();
const [first, east] = clouds.map((file) => basename(file).replace(/\.[^.]*$/, ''));

const wide = { viewport: { width: 1440, height: 900 } };
const tablet = { viewport: { width: 1024, height: 768 }, hasTouch: true };
const phone = { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true, deviceScaleFactor: 2 };

/** Clicks points of the scan, each when the server has found the one before. */
async function picks(page, places) {
  for (const [x, y] of places) {
    const found = page.waitForResponse((response) => response.url().endsWith('/pick'), { timeout: 60_000 });
    await page.mouse.click(x, y);
    await found;
    await page.waitForTimeout(400); // two clicks are no double-click
  }
}

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
await take('tablet', { ...tablet, colorScheme: 'light' }, `cloud=${first}`);
await take('phone', phone, `cloud=${first}`);

// Somebody who measures; the card covers the left of the picture.
const near = 'eye=389500,5819655,100&target=389500,5819765,36&up=0,0,1&projection=perspective&fov=45'; // of the generated town
await take('measure', { viewport: { width: 1000, height: 580 } }, `cloud=${first}&${near}`, async (page) => {
  await page.keyboard.press('p');
  await page.waitForTimeout(500);
  await page.keyboard.press('m');
  await page.waitForSelector('#measuring', { state: 'visible' });
  for (const [kind, places] of [['height', [[499, 170], [500, 66]]], ['area', [[470, 462], [570, 458], [575, 506], [458, 510]]], ['distance', [[702, 430], [664, 312], [628, 242]]]]) {
    await page.check(`#measure-kinds input[value=${kind}]`);
    await picks(page, places);
    await page.keyboard.press('Enter');
    await page.waitForTimeout(300);
  }
  await page.keyboard.press('Escape'); // nothing is open: all three are in the list
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
  await picks(page, [[470, 300], [610, 420], [760, 330]]);
  await page.keyboard.press('Enter');
  await page.waitForFunction(() => document.getElementById('profile-said').textContent !== '', undefined, { timeout: 30_000 });
  await page.waitForTimeout(2500);
  const { x, y, width, height } = await page.locator('#profile-plot').boundingBox();
  for (const [u, v] of [[0.36, 0.82], [0.47, 0.3]]) await page.mouse.click(x + u * width, y + v * height);
}, 60);

// Houses by what the scanner measured of them: two handles over a histogram.
await take('filter', { viewport: { width: 1000, height: 620 } }, `cloud=${first}&${near}&color=intensity&colormap=viridis`, async (page) => {
  await page.keyboard.press('p');
  await page.keyboard.press('b');
  await page.waitForSelector('#filter-list svg');
  const low = page.locator('#filter-list input[type=range]').nth(2);
  await low.focus();
  for (let i = 0; i < 3; ++i) await page.keyboard.press('PageUp');
  await page.focus('#picture');
}, 56);

// Two tiles, each in a colour of its own.
await take('together', { viewport: { width: 1000, height: 580 } }, `cloud=${first}`, async (page) => {
  await page.keyboard.press('p');
  await page.keyboard.press('u');
  await page.waitForSelector('#together-others button');
  await page.click(`#together-others [data-key="add-${east}"]`);
  await page.click('#together-color');
  await page.click('#together-fit');
  await page.locator('#together-list .name').last().click();
  await page.waitForTimeout(600); // the flight
}, 56);

// Which points, in which format, and what else a GIS wants.
await take('export', { viewport: { width: 1000, height: 700 } }, `cloud=${first}&${near}`, async (page) => {
  await page.click('#tool-export');
  await page.waitForFunction(() => /points/.test(document.getElementById('export-count')?.textContent));
  await page.click('#rasters summary');
}, 52);

await browser.close();
await proxy.stop();
await server.stop();
