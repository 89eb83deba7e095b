// How the page looks and where everything is: against the test double, in the sizes and themes that people have. Accessibility is
// judged by axe (axe-core), whose rules include the contrast of every text that is to be seen.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { after, afterEach, before, beforeEach, describe, it } from 'node:test';

import { choose, chosen, closePage, drag, isTrue, openPage, startBrowser, waitUntilSharp } from './support/browser.mjs';
import { clouds, FakeServer } from './support/fake_server.mjs';

const axe = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
const phone = { viewport: { width: 390, height: 844 }, deviceScaleFactor: 2, hasTouch: true, isMobile: true };
const tablet = { viewport: { width: 820, height: 1180 }, hasTouch: true, isMobile: true };
const lying = { viewport: { width: 844, height: 390 }, hasTouch: true, isMobile: true };

const named = [{
  ...clouds[0], title: 'A ring of stones', attribution: 'Society of Ring Walkers, CC BY 4.0', recorded: '2024-05-13', classes: [2, 6],
  classNames: { 2: 'ground', 6: 'building' }, classCounts: { 2: 1_000_000, 6: 234_567 }, classColors: { 2: '#a1794e', 6: '#cb5c4a' }, attributes: [{ name: 'rgb' }, { name: 'classification' }, { name: 'intensity', range: [0, 255] }],
  look: { up: [0, 0, 1], views: [{ name: 'from the south', inside: false, camera: clouds[0].view.camera }, { name: 'top', inside: false, camera: { ...clouds[0].view.camera, eye: [0, -1, 40] } }] },
}, clouds[1]];

describe('the looks of the page', { timeout: 290_000 }, () => {
  let browser, server, page;

  before(async () => { browser = await startBrowser(); });
  after(() => browser?.close());
  beforeEach(() => {
    server = new FakeServer();
    server.clouds = named;
    server.snapshotMs = 5;
  });
  afterEach(async () => {
    const complaints = await closePage(page);
    page = undefined;
    await server.stop();
    assert.deepEqual(complaints, []);
  });

  const open = async (options = {}, hash = '') => {
    page = await openPage(browser, (await server.start()) + hash, options);
    await waitUntilSharp(page);
  };

  /** What axe finds, in words; rules of the whole of WCAG 2.2 AA and its own best practice. */
  const findings = async () => {
    await page.evaluate(axe); // not by a <script>, which the page's policy forbids
    return page.evaluate(async () => {
      const { violations } = await globalThis.axe.run(document, { resultTypes: ['violations'] });
      return violations.flatMap(({ id, nodes }) => nodes.map((node) => `${id}: ${node.target.join(' ')} ${node.failureSummary}`));
    });
  };
  const box = (selector) => page.locator(selector).boundingBox();
  /** A place of the picture, at that share of its width. */
  const press = async (on, hasTouch, share) => {
    const { x, y, width, height } = await box('#picture');
    const before = server.received.filter(({ type }) => type === 'pick').length;
    const place = [x + width * (0.3 + 0.6 * share), y + height / 2];
    await (hasTouch ? on.touchscreen.tap(...place) : on.mouse.click(...place));
    await isTrue(() => server.received.filter(({ type }) => type === 'pick').length > before, 'a pick is asked for');
  };
  const views = () => server.received.filter(({ type }) => type === 'view');

  for (const colorScheme of ['light', 'dark']) {
    it(`axe finds nothing in the ${colorScheme} theme: panel, methods, legend, figures, gallery, help, presentation`, async () => {
      await open({ colorScheme });
      await choose(page, '#color', 'classification');
      await page.evaluate(() => { for (const id of ['all-methods', 'tuning', 'hud']) document.getElementById(id).open = true; });
      await page.click('#about summary');
      assert.deepEqual(await findings(), [], 'the panel');
      for (const key of ['7', 'g', 'n']) await page.keyboard.press(key);
      await page.waitForFunction(() => document.querySelector('#minimap img').naturalWidth > 0 && document.querySelector('#plan-grid text'));
      assert.deepEqual(await findings(), [], 'a plan');
      await choose(page, '#color', 'elevation');
      await page.click('#tool-views');
      assert.deepEqual(await findings(), [], 'the gallery');
      await page.keyboard.press('Escape');
      await page.keyboard.press('?');
      assert.deepEqual(await findings(), [], 'the help');
      await page.keyboard.press('Escape');
      await page.keyboard.press('h');
      assert.deepEqual(await findings(), [], 'the presentation');
    });

    it(`axe finds nothing in the ${colorScheme} theme while one measures, on a phone either`, async () => {
      for (const options of [{}, phone]) {
        await open({ ...options, colorScheme });
        await page.click('#tool-measure');
        await page.waitForSelector('#measuring', { state: 'visible' });
        await waitUntilSharp(page);
        await choose(page, '#measure-kinds', 'height');
        for (const share of [0.4, 0.6]) await press(page, options.hasTouch, share);
        await page.waitForSelector('#measure-list .details');
        await page.evaluate(() => { document.getElementById('measure-files').open = true; });
        assert.deepEqual(await findings(), [], 'the card');
        if (options !== phone) {
          await page.context().close();
          await server.stop();
          continue;
        }
        const low = await page.$$eval('#measuring button, #measuring label.choice', (nodes) => nodes.map((node) => [node.textContent, node.getBoundingClientRect()])
          .filter(([, { width: w, height: h }]) => w > 0 && (w < 43.5 || h < 43.5)).map(([name]) => name));
        assert.deepEqual(low, [], 'too small for fingers');
        const [card, picture, rail] = [await box('#measuring'), await box('#picture'), await box('#rail')];
        assert.ok(picture.y + picture.height <= card.y + 0.5 && card.y + card.height <= rail.y + 0.5, 'the picture, the card, the rail');
      }
    });

    it(`axe finds nothing on a phone in the ${colorScheme} theme, nor at the entrance`, async () => {
      await open({ ...phone, colorScheme });
      assert.deepEqual(await findings(), [], 'the picture');
      await page.tap('#toggle-panel');
      assert.deepEqual(await findings(), [], 'the sheet');
      server.token = 'secret';
      await page.reload();
      await page.waitForSelector('#token', { state: 'visible' });
      assert.deepEqual(await findings(), [], 'the entrance');
    });
  }

  it('what is pressed by fingers is 44 pixels high and wide, and nothing lies outside or upon something else', async () => {
    for (const options of [phone, tablet, lying]) {
      await open(options);
      const { width, height } = options.viewport;
      const small = await page.evaluate(() => [...document.querySelectorAll('button, summary')]
        .filter((node) => node.checkVisibility({ visibilityProperty: true }))
        .map((node) => [node.id || node.textContent.trim(), node.getBoundingClientRect()])
        .filter(([, { width: w, height: h }]) => w < 43.5 || h < 43.5).map(([name, { width: w, height: h }]) => `${name} ${w} × ${h}`));
      assert.deepEqual(small, []);
      const boxes = await Promise.all(['#rail', '.actions', '.views', '#hud', '.title', '#credit'].map(async (selector) => [selector, await box(selector)]));
      for (const [i, [name, one]] of boxes.entries()) {
        assert.ok(one && one.x >= 0 && one.y >= 0 && one.x + one.width <= width + 0.5 && one.y + one.height <= height + 0.5, `${name} ${JSON.stringify(one)} in ${width} × ${height}`);
        for (const [other, two] of boxes.slice(i + 1)) {
          const apart = one.x + one.width <= two.x || two.x + two.width <= one.x || one.y + one.height <= two.y || two.y + two.height <= one.y;
          assert.ok(apart, `${name} lies upon ${other} in ${width} × ${height}`);
        }
      }
      await page.tap('#toggle-panel');
      const [panel, picture] = [await box('#panel'), await box('#picture')];
      assert.ok(picture.x + picture.width <= panel.x + 0.5 || picture.y + picture.height <= panel.y + 0.5, 'the picture is under the panel');
      await page.context().close();
      await server.stop();
    }
    page = undefined;
    await server.start();
  });

  it('the sheet of a phone has three heights, and is drawn down to close', async () => {
    await open(phone);
    await page.tap('#toggle-panel');
    const height = async () => (await box('#panel')).height / 844;
    assert.ok(Math.abs((await height()) - 0.5) < 0.01);
    await page.focus('#sheet-handle');
    await page.keyboard.press('ArrowUp');
    assert.ok((await height()) > 0.9);
    await page.keyboard.press('ArrowDown');
    await page.keyboard.press('ArrowDown');
    assert.ok((await height()) < 0.3);
    assert.ok((await box('#picture')).height > 0.7 * 844);
    const { y } = await box('#panel');
    await drag(page, [120, y + 20], [120, y - 180]);
    assert.ok(Math.abs((await height()) - 0.5) < 0.01, 'drawn to half');
    await drag(page, [120, 844 * 0.5 + 20], [120, 830]);
    assert.ok(!(await page.isVisible('#panel')), 'drawn down');
  });

  it('themes: as the system has it, or chosen and remembered', async () => {
    const background = () => page.evaluate(() => getComputedStyle(document.getElementById('panel')).backgroundColor);
    const light = 'rgb(255, 255, 255)';
    await open({ colorScheme: 'light' });
    assert.equal(await background(), light);
    await choose(page, '#theme', 'dark');
    assert.notEqual(await background(), light);
    await page.reload();
    await waitUntilSharp(page);
    assert.notEqual(await background(), light);
    assert.equal(await chosen(page, '#theme'), 'dark');
    await choose(page, '#theme', 'system');
    assert.equal(await background(), light);
    await page.emulateMedia({ colorScheme: 'dark' });
    assert.notEqual(await background(), light);
  });

  it('Sharp and Raw choose methods; what cannot be chosen says why', async () => {
    await open();
    assert.equal(await chosen(page, '#appearance'), 'sharp');
    assert.ok(await page.isDisabled('#appearance input[value=smooth]'));
    assert.match(await page.textContent('#method-summary'), /Smooth: /);
    await choose(page, '#appearance', 'raw');
    await isTrue(() => views().at(-1).method === 'point', 'Raw chooses point');
    assert.equal(await chosen(page, '#method'), 'point');
    await choose(page, '#method', 'paraboloid');
    assert.equal(await chosen(page, '#appearance'), 'sharp');
  });

  it('has no button for what cannot be done yet, and a place for it', async () => {
    await open();
    const tools = await page.$$eval('#rail button', (buttons) => buttons.map((button) => button.textContent));
    assert.deepEqual(tools, ['Orbit', 'Look', 'Measure', 'Cut', 'Filter', 'Profile', 'Notes', 'Views', 'Together', 'Compare', 'Picture', 'Export', 'Present']);
    await page.click('#look-around');
    assert.deepEqual(await page.$$eval('#rail [aria-pressed=true]', (buttons) => buttons.map((button) => button.textContent)), ['Look']);
    assert.match(await page.textContent('#hint'), /to look around/);
    await page.keyboard.press('l');
    assert.match(await page.textContent('#hint'), /to orbit/);
  });

  it('names the scan, its day and whose it is, in presentations, too', async () => {
    await open();
    assert.match(await page.textContent('#cloud-facts'), /13 May 2024/);
    assert.equal(await page.textContent('#credit-text'), 'Society of Ring Walkers, CC BY 4.0');
    assert.ok(await page.isVisible('#credit'));
    await page.keyboard.press('h');
    for (const selector of ['#panel', '#rail', '.actions', '.views', '#hud', '.title']) assert.ok(!(await page.isVisible(selector)), selector);
    for (const selector of ['#credit-title', '#credit-date', '#credit-text']) assert.ok(await page.isVisible(selector), selector);
    assert.equal((await box('#picture')).width, 1280);
    await page.waitForFunction(() => location.hash.endsWith('&present'));
    await page.keyboard.press('Escape');
    await page.waitForSelector('#panel', { state: 'visible' });
    await page.waitForFunction(() => !location.hash.includes('present'));
  });

  it('#present begins with the presentation, and a button leads out', async () => {
    await open({}, '#present');
    assert.ok(!(await page.isVisible('#panel')));
    await page.mouse.move(300, 300);
    await page.click('#leave-presentation');
    assert.ok(await page.isVisible('#panel'));
  });

  it('thumbnails come one at a time, once, and are given up while the camera moves', async () => {
    server.snapshotMs = 120;
    await open();
    const asked = () => server.received.filter(({ type }) => type === 'snapshot');
    await page.click('#tool-views');
    await page.waitForFunction(() => document.querySelectorAll('#views-list img').length === 2);
    assert.equal(server.mostSnapshots, 1, 'side by side');
    assert.equal(asked().length, 2);
    assert.deepEqual(await page.$$eval('#views-list .name', (names) => names.map((name) => name.textContent)), ['From the south', 'Top']);
    await page.keyboard.press('Escape');
    await page.click('#tool-views');
    await page.waitForFunction(() => [...document.querySelectorAll('#views-list .thumbnail img')].filter((image) => image.naturalWidth > 0).length === 2, undefined, { timeout: 20_000 });
    await page.keyboard.press('Escape');
    assert.equal(asked().length, 2);
    // Of the methods that this cloud can be drawn with; the camera moves before the first is there.
    server.snapshotMs = 60_000;
    await page.click('#all-methods summary');
    await isTrue(() => asked().length >= 3, 'a third is asked for');
    server.snapshotMs = 20;
    await drag(page, [400, 300], [460, 320]);
    await page.waitForFunction(() => document.querySelectorAll('#method img').length === 2, undefined, { timeout: 20_000 });
    await isTrue(() => server.snapshotsGivenUp === 1, 'one is given up');
    assert.ok(asked().slice(2).every(({ words }) => words.width === '216' && Number(words.fov) < 20));
  });

  it('a server that is busy leaves a gallery with names', async () => {
    server.snapshotMs = undefined; // answers 503
    await open();
    await page.click('#tool-views');
    const asked = () => server.received.filter(({ type }) => type === 'snapshot').length;
    await isTrue(() => asked() === 1, 'one is asked for');
    await page.waitForTimeout(300);
    assert.equal(asked(), 1, 'asked again at once');
    assert.equal(await page.$$eval('#views-list img', (images) => images.length), 0);
    page.complaints = page.complaints.filter((text) => !text.includes('503'));
    const before = views().length;
    await page.click('#views-list button:nth-child(2)');
    await isTrue(() => views().length > before, 'its views can be gone to');
  });
});
