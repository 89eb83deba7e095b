// The viewer of photos, against a server that plays one: what is shown, how one gets through them by mouse, keys and fingers, and
// what is said when there is nothing to see.
//
// Oracle: each photo is one colour of its own, so a pixel of the screen says which one is there.

import assert from 'node:assert/strict';
import { after, afterEach, before, beforeEach, describe, it } from 'node:test';

import { blockJpeg } from './support/block_jpeg.mjs';
import { openPage, seriousComplaints, startBrowser, waitUntilSharp } from './support/browser.mjs';
import { clouds, FakeServer } from './support/fake_server.mjs';

const red = [200, 40, 30], green = [40, 170, 60], blue = [30, 60, 210];
const plain = (width, height, color) => blockJpeg(width, height, () => color);
const viewFrom = (eye, target, fov = 75) => ({ ...clouds[0].view, camera: { ...clouds[0].view.camera, eye, target, fov } });

describe('the viewer of photos', { timeout: 120_000 }, () => {
  let server, browser, page, url;

  before(async () => { browser = await startBrowser(); });
  after(async () => { await browser?.close(); });
  beforeEach(async () => {
    server = new FakeServer();
    server.clouds = [{ ...clouds[0], photos: 3, stations: 2 }, clouds[1]];
    server.stations = [
      { name: 'Tower', position: [0, 0, 2], points: 5000, photos: [], view: viewFrom([0, 0, 2], [0, 5, 2]) },
      { name: 'Gate', position: [3, 0, 2], points: 7000, photos: [1], view: viewFrom([3, 0, 2], [3, -5, 2]) },
    ];
    server.photos = [
      { name: 'North', projection: 'pinhole', width: 640, height: 480, file: plain(640, 480, red), view: viewFrom([1, 2, 3], [1, 9, 3], 40) },
      { name: 'All round', projection: 'spherical', width: 2000, height: 1000, station: { index: 1, name: 'Gate' }, file: plain(2000, 1000, green) },
      { name: 'Label', width: 64, height: 64, file: plain(64, 64, blue) },
    ];
    url = await server.start();
  });
  afterEach(async () => {
    const complaints = page ? seriousComplaints(page) : [];
    await page?.context().close();
    await server?.stop();
    page = undefined;
    assert.deepEqual(complaints, []);
  });

  async function open(options) {
    page = await openPage(browser, url, options);
    await waitUntilSharp(page);
  }
  const isOpen = () => page.evaluate(() => document.getElementById('photos').open);
  const shows = (name) => page.waitForFunction((title) => document.getElementById('photo-title').textContent === title
    && !document.getElementById('photo').hidden && document.getElementById('photo').naturalWidth > 0, name, { timeout: 5000 });
  const says = (text) => page.waitForFunction((wanted) => document.getElementById('photo-state').textContent.includes(wanted), text, { timeout: 5000 });
  const box = () => page.locator('#photo').boundingBox();
  /** What is on the screen there, as the browser draws it. */
  async function colorAt(x, y) {
    const png = await page.screenshot({ clip: { x, y, width: 1, height: 1 } });
    return page.evaluate(async (base64) => {
      const bitmap = await createImageBitmap(new Blob([Uint8Array.from(atob(base64), (c) => c.charCodeAt(0))], { type: 'image/png' }));
      const context = new OffscreenCanvas(1, 1).getContext('2d');
      context.drawImage(bitmap, 0, 0);
      return [...context.getImageData(0, 0, 1, 1).data].slice(0, 3);
    }, png.toString('base64'));
  }
  async function assertMiddleIs(color) {
    const { x, y, width, height } = await box();
    const seen = await colorAt(x + width / 2, y + height / 2);
    assert.ok(seen.every((value, i) => Math.abs(value - color[i]) < 12), `${seen} is not ${color}`);
  }
  const lastView = () => server.received.filter(({ type, camera }) => type === 'view' && camera).at(-1);

  it('shows all photos one after the other, by buttons and by keys', async () => {
    await open();
    assert.equal(await page.textContent('#show-photos'), 'Photos (3)');
    await page.click('#show-photos');
    await shows('North');
    await assertMiddleIs(red);
    assert.equal(await page.textContent('#photo-facts'), `Photo, 640 × 480, ${(server.photos[0].file.length / 1000).toPrecision(2)} kB`);
    assert.equal(await page.textContent('#photo-count'), '1 of 3');
    assert.equal(await page.getAttribute('#photo', 'alt'), 'The photo North');
    await page.click('#photo-next');
    await shows('All round');
    await assertMiddleIs(green);
    assert.match(await page.textContent('#photo-facts'), /^Panorama, 2,000 × 1,000, .*, taken at Gate$/);
    assert.equal(await page.getAttribute('#photo', 'alt'), 'The panorama All round, taken at Gate');
    await page.keyboard.press('ArrowRight');
    await shows('Label');
    await assertMiddleIs(blue);
    assert.equal((await box()).width, 128, 'a small one is shown twice as large');
    await page.keyboard.press('ArrowRight');
    await shows('North');
    await page.click('#photo-previous');
    await shows('Label');
    const views = server.received.filter(({ type }) => type === 'view').length;
    await page.keyboard.press('f');
    await page.keyboard.press('w');
    await page.waitForTimeout(200);
    assert.equal(server.received.filter(({ type }) => type === 'view').length, views, 'keys are the viewer\'s while it is open');
  });

  it('is closed by Escape, by its button and by a click beside the photo, and the focus is where it was', async () => {
    await open();
    const ways = [
      () => page.keyboard.press('Escape'),
      () => page.click('#photo-close'),
      () => page.mouse.click(4, 300), // beside the viewer
      async () => {
        const { x, y, height } = await box();
        await page.mouse.click(x - 15, y + height / 2); // beside the photo
      },
    ];
    for (const close of ways) {
      await page.focus('#show-photos');
      await page.keyboard.press('Enter');
      await shows('North');
      assert.equal(await page.evaluate(() => document.activeElement.id), 'photo-close');
      await close();
      await page.waitForFunction(() => !document.getElementById('photos').open, undefined, { timeout: 3000 });
      assert.equal(await page.evaluate(() => document.activeElement.id), 'show-photos');
    }
    await page.keyboard.press('Enter');
    await shows('North');
    const { x, y, width, height } = await box();
    await page.mouse.click(x + width / 2, y + height / 2);
    assert.ok(await isOpen(), 'a click on the photo closes nothing');
  });

  it('offers the photos of the scan position that one goes to', async () => {
    await open();
    await page.waitForSelector('#station', { state: 'visible' });
    const names = await page.$$eval('#station option', (options) => options.map((option) => option.textContent));
    assert.deepEqual(names.slice(1), ['Tower (5,000 points)', 'Gate (7,000 points, 1 photo)']);
    await page.selectOption('#station', { label: names[1] });
    assert.ok(!(await page.isVisible('#station-photos')), 'there is none of the tower');
    await page.selectOption('#station', { label: names[2] });
    assert.equal(await page.textContent('#station-photos'), 'Show 1 photo taken at Gate');
    await page.click('#station-photos');
    await shows('All round');
    assert.equal(await page.textContent('#photo-count'), '2 of 3', 'the others are beside it');
    await page.keyboard.press('Escape');
    await page.selectOption('#cloud', 'helix');
    await waitUntilSharp(page);
    for (const id of ['#station-photos', '#show-photos']) assert.ok(!(await page.isVisible(id)), id);
  });

  it('flies to where a photo was taken', async () => {
    await open();
    await page.click('#show-photos');
    await shows('North');
    server.received.length = 0;
    await page.click('#photo-go');
    assert.ok(!(await isOpen()));
    await page.waitForTimeout(500); // the flight
    await waitUntilSharp(page);
    const { camera } = lastView();
    camera.eye.forEach((value, i) => assert.ok(Math.abs(value - [1, 2, 3][i]) < 1e-6, camera.eye.join()));
    camera.target.forEach((value, i) => assert.ok(Math.abs(value - [1, 9, 3][i]) < 1e-6, camera.target.join()));
    assert.equal(camera.fov, 40);
    // Nobody knows it of the label; of the panorama, its scan position's does, once that was chosen.
    await page.click('#show-photos');
    await shows('North');
    await page.keyboard.press('ArrowLeft');
    await shows('Label');
    assert.ok(!(await page.isVisible('#photo-go')));
    await page.keyboard.press('Escape');
    await page.selectOption('#station', { index: 2 });
    await page.click('#station-photos');
    await shows('All round');
    assert.ok(await page.isVisible('#photo-go'));
    assert.deepEqual(server.received.find(({ type }) => type === 'photos') ?? {}, {}, 'the list is asked for once');
  });

  it('is zoomed by wheel, buttons, keys and double-click, and dragged', async () => {
    await open();
    await page.click('#show-photos');
    await shows('North');
    await page.keyboard.press('ArrowRight');
    await shows('All round');
    const fitted = await box();
    const stage = await page.locator('#photo-stage').boundingBox();
    assert.ok(fitted.width < stage.width + 1 && fitted.height < stage.height + 1, 'all of it');
    assert.ok(Math.min(stage.width - fitted.width, stage.height - fitted.height) < 3, 'as large as it fits');
    const cursor = [fitted.x + 0.25 * fitted.width, fitted.y + 0.5 * fitted.height];
    await page.mouse.move(...cursor);
    await page.mouse.wheel(0, -500);
    await page.waitForFunction((width) => document.getElementById('photo').width > 1.8 * width, fitted.width);
    const zoomed = await box();
    assert.ok(Math.abs(zoomed.x + 0.25 * zoomed.width - cursor[0]) < 3, 'what is under the cursor stays there');
    await page.mouse.down();
    await page.mouse.move(cursor[0] + 50, cursor[1], { steps: 4 });
    await page.mouse.up();
    assert.ok(Math.abs((await box()).x - zoomed.x - 50) < 3, 'dragged');
    await page.keyboard.press('ArrowRight');
    assert.ok((await box()).x < zoomed.x + 50, 'arrows move a part of it');
    assert.equal(await page.textContent('#photo-title'), 'All round');
    await page.keyboard.press('0');
    assert.equal((await box()).width, fitted.width);
    await page.click('#photo-larger');
    assert.ok((await box()).width > 1.4 * fitted.width);
    await page.click('#photo-smaller');
    assert.equal((await box()).width, fitted.width);
    await page.mouse.dblclick(...cursor);
    assert.ok((await box()).width > 1.9 * fitted.width);
    await page.mouse.dblclick(...cursor);
    assert.equal((await box()).width, fitted.width);
    assert.ok(await isOpen());
  });

  it('says in words what went wrong, and tries again', async () => {
    const { file } = server.photos[0];
    server.photos[0].file = '';
    server.photos[2].file = Buffer.from('no picture at all');
    await open();
    await page.click('#show-photos');
    await says('This photo cannot be read.');
    assert.ok(!(await page.isVisible('#photo-open')), 'there is nothing to open');
    server.photos[0].file = file;
    await page.click('#photo-retry');
    await shows('North');
    assert.ok(!(await page.isVisible('#photo-retry')));
    await page.keyboard.press('ArrowLeft');
    await says('The browser cannot read');
    await page.keyboard.press('ArrowRight');
    await shows('North');
    await page.keyboard.press('Escape');
    page.complaints = page.complaints.filter((text) => !text.includes('500'));
    await server.stop();
    await page.evaluate(() => document.getElementById('show-photos').click());
    await says('the server is not responding');
    await server.start(server.port);
  });

  it('asks a busy server again, but not for ever', async () => {
    server.busyFor = 2;
    await open();
    await page.click('#show-photos');
    await shows('North');
    server.busyFor = 9;
    await page.click('#photo-next');
    await says('Ask again later.');
    assert.equal(server.busyFor, 6);
    server.busyFor = 0;
    page.complaints = page.complaints.filter((text) => !text.includes('429'));
  });

  it('brings the token along, and keeps it out of addresses', async () => {
    server.token = 'a+token/with=signs?';
    page = await openPage(browser, url);
    await page.fill('#token', server.token);
    await page.keyboard.press('Enter');
    await waitUntilSharp(page);
    await page.click('#show-photos');
    await shows('North');
    await assertMiddleIs(red);
    const [tab] = await Promise.all([page.context().waitForEvent('page'), page.click('#photo-open')]);
    await tab.waitForLoadState();
    assert.match(tab.url(), /^blob:/);
    assert.equal(await tab.evaluate(() => document.images[0]?.naturalWidth), 640);
    assert.equal(await tab.evaluate(() => window.opener), null);
  });

  it('fits a phone', async () => {
    await open({ viewport: { width: 390, height: 760 }, deviceScaleFactor: 2, hasTouch: true, isMobile: true });
    await page.tap('#toggle-panel');
    await page.tap('#show-photos');
    await shows('North');
    const viewer = await page.locator('#photos').boundingBox();
    assert.deepEqual([viewer.x, viewer.y, viewer.width, viewer.height], [0, 0, 390, 760]);
    await page.tap('#photo-next');
    await shows('All round');
    for (const selector of ['#photo', '#photo-close', '#photo-next', '#photo-open', '#photo-larger']) {
      const at = await page.locator(selector).boundingBox();
      assert.ok(at && at.x >= 0 && at.y >= 0 && at.x + at.width <= 390 && at.y + at.height <= 760, selector);
    }
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
    await page.tap('#photo-close');
    assert.ok(!(await isOpen()));
  });

  it('has a label on every control', async () => {
    await open();
    await page.click('#show-photos');
    await shows('North');
    const nameless = await page.evaluate(() => [...document.querySelectorAll('#photos :is(button, a, img)')]
      .filter((node) => !(node.getAttribute('aria-label') || node.textContent.trim() || node.alt)).map((node) => node.outerHTML));
    assert.deepEqual(nameless, []);
  });
});
