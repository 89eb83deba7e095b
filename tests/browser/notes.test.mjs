// Notes, saved views and tours as a user makes them, against the real server: by what is drawn, where it is, what is kept and what comes back.
//
// Oracle: the scan is a grid that this test has written (support/scans.mjs), so every place is known; views are what the viewer says it shows.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { after, before, describe, it } from 'node:test';

import { project } from '../../client/web/view/camera.js';
import { newPage, seriousComplaints, startBrowser, waitUntilSharp } from './support/browser.mjs';
import { RealServer } from './support/real_server.mjs';
import { courtOrigin, writeCourt } from './support/scans.mjs';

const program = process.env.SCANCAST_PROGRAM;
if (!program) throw new Error('Set SCANCAST_PROGRAM, such as SCANCAST_PROGRAM=build/release/bin/scancast');

const axe = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
const at = (x, y, z = 0) => [x, y, z].map((value, axis) => value + courtOrigin[axis]);
const fromSouth = `eye=${at(10, -14, 14)}&target=${at(10, 8, 0)}&up=0,0,1&projection=perspective&fov=45`;
const fromNorth = `eye=${at(10, 30, 3)}&target=${at(10, 8, 1)}&up=0,0,1&projection=perspective&fov=45`;
const phone = { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true };

describe('notes, saved views and tours', { timeout: 290_000 }, () => {
  let scan, server, browser, url;

  before(async () => {
    scan = writeCourt();
    server = new RealServer(program, [scan.file]);
    url = await server.start();
    browser = await startBrowser();
  });
  after(async () => {
    await browser?.close();
    await server?.stop();
    scan?.remove();
  });

  async function withPage(use, { options = {}, hash = fromSouth } = {}) {
    const page = await newPage(browser, { viewport: { width: 1440, height: 600 }, ...options });
    page.setDefaultTimeout(20_000);
    try {
      await page.goto(`${url}#cloud=court&${hash}`);
      await waitUntilSharp(page, 40_000);
      await use(page);
      assert.deepEqual(seriousComplaints(page), []);
    } finally {
      await page.context().close();
    }
  }

  const viewerSays = (page, what) => page.evaluate((name) => document.getElementById('view').viewer[name], what);
  const placeOf = async (page, point) => project(await viewerSays(page, 'camera'), point, await viewerSays(page, 'cssSize'));
  const kept = (page) => page.evaluate(() => JSON.parse(localStorage.getItem(Object.keys(localStorage).find((key) => key.startsWith('scancast.project.'))) ?? '{}'));
  const isNear = (found, wanted, tolerance = 0.2) => found.every((value, i) => Math.abs(value - wanted[i]) <= tolerance);
  const look = async (page, words) => {
    await page.evaluate((hash) => { location.hash = hash; }, `#cloud=court&${words}`);
    await page.waitForTimeout(450);
    await waitUntilSharp(page);
  };
  async function placeNote(page, point, title) {
    const count = await page.locator('#note-list li').count();
    const { x, y } = await placeOf(page, point);
    await page.mouse.click(x, y);
    await page.waitForFunction((before) => document.querySelectorAll('#note-list li').length > before, count);
    await page.keyboard.type(title); // its field has the focus, all of it selected
    await page.keyboard.press('Tab');
  }
  const accessible = async (page) => {
    await page.evaluate(axe);
    assert.deepEqual(await page.evaluate(async () => (await globalThis.axe.run(document, { resultTypes: ['violations'] })).violations
      .flatMap(({ id, nodes }) => nodes.map((node) => `${id}: ${node.target.join(' ')} ${node.failureSummary}`))), []);
  };

  it('a note stands at a point of the scan, keeps what is written, is moved, taken back, and hides behind the wall', () => withPage(async (page) => {
    await page.keyboard.press('i');
    await page.waitForSelector('#annotating:not([hidden])');
    await placeNote(page, at(6, 6), 'Drain');
    await page.keyboard.type('Blocked.');
    await page.keyboard.press('Tab');
    await page.keyboard.type('javascript:alert(1)');
    await page.keyboard.press('Tab');
    assert.ok(await page.isVisible('#note-list .warning'), 'that is no link');
    await page.fill('#note-list [data-key^=link]', 'https://example.org/drain');
    await page.keyboard.press('Tab');
    let [note] = (await kept(page)).annotations;
    assert.deepEqual([note.title, note.text, note.link], ['Drain', 'Blocked.', 'https://example.org/drain']);
    assert.ok(isNear(note.point, at(6, 6)), JSON.stringify(note.point));
    // Escape leaves a field, which keeps what was written; the note stays open, and its row has the focus.
    await page.focus('#note-list textarea');
    await page.keyboard.press('End');
    await page.keyboard.type(' Since May.');
    await page.keyboard.press('Escape');
    assert.match(await page.evaluate(() => document.activeElement.dataset.key), /^row-/);
    assert.ok(await page.isVisible('#note-list textarea'));
    assert.equal((await kept(page)).annotations[0].text, 'Blocked. Since May.');
    await page.fill('#note-list textarea', 'Blocked.');
    await page.click('#note-list-title'); // away from the fields
    assert.equal(await page.getAttribute('#note-list a', 'href'), 'https://example.org/drain');
    assert.equal(await page.textContent('#notes .label'), 'Drain');
    const mark = await page.locator('#notes .point .dot').boundingBox();
    const place = await placeOf(page, note.point);
    assert.ok(Math.hypot(mark.x + mark.width / 2 - place.x, mark.y + mark.height / 2 - place.y) < 2, 'the marker is where the point is');
    // Drawn to another place, and back.
    const to = await placeOf(page, at(14, 4));
    await page.mouse.move(place.x, place.y);
    await page.mouse.down();
    await page.mouse.move(to.x, to.y, { steps: 4 });
    await page.mouse.up();
    await page.waitForFunction((before) => !localStorage.getItem(Object.keys(localStorage).find((key) => key.startsWith('scancast.project.'))).includes(before), String(note.point[1]));
    assert.ok(isNear((await kept(page)).annotations[0].point, at(14, 4)));
    await page.click('#note-undo');
    [note] = (await kept(page)).annotations;
    assert.ok(isNear(note.point, at(6, 6)));
    await page.click('#close-annotating');
    await look(page, fromNorth);
    await page.waitForFunction(() => document.querySelector('#notes .label').classList.contains('hidden'));
    await look(page, fromSouth);
    await page.waitForFunction(() => !document.querySelector('#notes .label').classList.contains('hidden'));
    // Who reloads sees it again, and a click on it opens it.
    await page.reload();
    await waitUntilSharp(page);
    await page.waitForSelector('#notes .label');
    await page.click('#notes .label');
    assert.equal(await page.inputValue('#note-list [data-key^=text]'), 'Blocked.');
    await page.click('#note-list [data-key^=remove]');
    assert.equal(await page.locator('#notes .label').count(), 0);
    await page.keyboard.press('Control+z');
    assert.equal(await page.textContent('#notes .label'), 'Drain');
  }));

  it('views are kept, named, gone to, ordered and renewed; a project file brings all of it to somebody else', () => withPage(async (page) => {
    await page.keyboard.press('v');
    await page.click('#save-view');
    await page.keyboard.type('South');
    await page.keyboard.press('Enter');
    await page.keyboard.press('Escape');
    await look(page, `${fromNorth}&color=elevation`);
    const north = await viewerSays(page, 'camera');
    await page.keyboard.press('v');
    await page.click('#save-view');
    await page.keyboard.type('South'); // there is one already
    await page.keyboard.press('Enter');
    assert.deepEqual((await kept(page)).views.map(({ name }) => name), ['South', 'South 1']);
    await page.waitForFunction(() => document.querySelectorAll('#saved-list img').length === 2);
    await page.click('#saved-list li:first-child .go');
    await page.waitForFunction(() => document.getElementById('view').viewer.view.color !== 'elevation');
    await waitUntilSharp(page);
    assert.ok(isNear((await viewerSays(page, 'view')).camera.eye, at(10, -14, 14), 1e-6));
    await page.click('#saved-list li:last-child .go');
    await page.waitForFunction(() => document.getElementById('view').viewer.view.color === 'elevation');
    await waitUntilSharp(page);
    assert.ok(isNear((await viewerSays(page, 'camera')).target, north.target, 1e-6));
    await page.click('#saved-list li:last-child [data-key^=earlier]');
    assert.deepEqual((await kept(page)).views.map(({ name }) => name), ['South 1', 'South']);
    await page.click('#saved-list li:last-child [data-key^=update]');
    assert.match((await kept(page)).views[1].view, /color=elevation/);
    await page.click('#saved-undo');
    assert.doesNotMatch((await kept(page)).views[1].view, /color=elevation/);
    await page.fill('#tour-seconds', '0.5');
    await page.fill('#tour-pause', '0.4');
    await page.press('#tour-pause', 'Tab');
    assert.deepEqual((await kept(page)).tours, [{ name: 'Tour', seconds: 0.5, pause: 0.4 }]);
    await page.keyboard.press('Escape');
    await page.keyboard.press('i');
    await page.waitForSelector('#annotating:not([hidden])');
    await placeNote(page, at(10, 12.0, 4), 'Sent along');
    await page.click('#annotating summary');
    const [saved] = await Promise.all([page.waitForEvent('download'), page.click('#note-save-project')]);
    assert.equal(saved.suggestedFilename(), 'court.project.json');
    const file = JSON.parse(readFileSync(await saved.path(), 'utf8'));
    assert.deepEqual([file.annotations.length, file.views.length, file.tours.length], [1, 2, 1]);
    await page.keyboard.press('m');
    await page.waitForSelector('#measure-files summary');
    await page.click('#measure-files summary');
    const [table] = await Promise.all([page.waitForEvent('download'), page.click('#export-csv')]);
    assert.match(readFileSync(await table.path(), 'utf8'), /\r\nSent along,Note,/);
    await withPage(async (other) => {
      await other.keyboard.press('i');
      await other.waitForSelector('#annotating:not([hidden])');
      await other.setInputFiles('#project-file', await saved.path());
      await other.waitForSelector('#notes .label');
      assert.match(await other.textContent('#toast'), /1 note, 2 saved views/);
      assert.deepEqual((await kept(other)).views, file.views);
    });
  }));

  it('a tour flies from view to view, puts styles on as it arrives, and Escape stops it; without motion it goes in steps', () => withPage(async (page) => {
    const [south, north] = [`cloud=court&${fromSouth}&color=rgb`, `cloud=court&${fromNorth}&color=elevation`];
    const file = { format: 'scancast-project', version: 1, cloud: { id: 'court' }, views: [{ name: 'S', view: south }, { name: 'N', view: north }], tours: [{ name: 'Walk', seconds: 3, pause: 1, loop: true }] };
    const open = async () => {
      await page.keyboard.press('m');
      await page.waitForSelector('#measuring:not([hidden])');
      await page.setInputFiles('#project-file', { name: 'a.json', mimeType: 'application/json', buffer: Buffer.from(JSON.stringify(file)) });
      await page.waitForSelector('#toast:not([hidden])');
      await page.keyboard.press('Escape');
    };
    await open();
    await page.evaluate(() => {
      globalThis.seen = [];
      const { viewer } = document.getElementById('view');
      viewer.addEventListener('camera', () => globalThis.seen.push([...viewer.view.camera.eye, viewer.view.color]));
    });
    await page.keyboard.press('h'); // in a presentation, too
    await page.keyboard.press('j');
    await page.waitForFunction(() => document.getElementById('view').viewer.view.color === 'elevation');
    assert.match(await page.textContent('#touring'), /2 of 2: N/);
    await page.waitForTimeout(500);
    await page.keyboard.press('Escape');
    assert.ok(!(await page.isVisible('#touring')));
    assert.ok(await page.evaluate(() => document.body.classList.contains('presenting')), 'the presentation goes on');
    await page.keyboard.press('Escape');
    const seen = await page.evaluate(() => globalThis.seen);
    const flight = seen.slice(seen.findLastIndex(([x, y, z]) => isNear([x, y, z], at(10, -14, 14), 1e-6)));
    assert.ok(flight.length > 3, 'it flew');
    const aside = flight.map(([x]) => Math.abs(x - at(10, 0)[0]));
    assert.ok(Math.max(...aside) > 5, 'round what it looks at, and not through it');
    const onTheWay = flight.filter(([x, y, z]) => !isNear([x, y, z], at(10, -14, 14), 0.5) && !isNear([x, y, z], at(10, 30, 3), 0.5));
    assert.equal(onTheWay[0]?.[3], 'rgb', 'the style stays until it has arrived');
    await page.keyboard.press('j');
    await page.waitForSelector('#touring', { state: 'visible' });
    await page.keyboard.press('1'); // whoever wants to be elsewhere gets there
    await page.waitForSelector('#touring', { state: 'hidden' });
    await page.waitForTimeout(600); // its flight
    await page.emulateMedia({ reducedMotion: 'reduce' });
    await page.evaluate(() => { globalThis.seen = []; });
    await page.keyboard.press('j');
    await page.waitForFunction(() => globalThis.seen.length >= 2);
    assert.ok((await page.evaluate(() => globalThis.seen)).every(([x, y, z]) => isNear([x, y, z], at(10, -14, 14), 1e-6) || isNear([x, y, z], at(10, 30, 3), 1e-6)));
    await page.mouse.move(700, 300); // a hand on the picture stops it
    await page.mouse.down();
    await page.mouse.move(760, 300, { steps: 3 });
    await page.mouse.up();
    await page.waitForSelector('#touring', { state: 'hidden' });
  }));

  for (const options of [{ colorScheme: 'light' }, { colorScheme: 'dark', ...phone }]) {
    it(`axe finds nothing, ${options.isMobile ? 'on a phone, dark' : 'on a desk, light'}`, () => withPage(async (page) => {
      await page.click('#tool-annotate');
      await page.waitForSelector('#annotating:not([hidden])');
      const { x, y } = await placeOf(page, at(10, 8));
      await (options.isMobile ? page.touchscreen.tap(x, y) : page.mouse.click(x, y));
      await page.waitForSelector('#note-list .details');
      await page.waitForTimeout(300);
      await accessible(page);
      await page.click('#close-annotating');
      await page.click('#tool-views');
      await page.click('#save-view');
      await page.click('#save-view');
      await page.waitForSelector('#saved-list li:nth-child(2)');
      await page.waitForTimeout(400);
      await accessible(page);
    }, { options }));
  }
});
