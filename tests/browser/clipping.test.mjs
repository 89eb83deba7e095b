// Cutting by boxes: what the page's handles and fields say to the server, against the test double; what a server makes of it is tested
// against the renderer. Accessibility is judged by axe.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { after, afterEach, before, beforeEach, describe, it } from 'node:test';

import { facesOf } from '../../client/web/clip/box.js';
import { project } from '../../client/web/view/camera.js';
import { closePage, openPage, startBrowser, waitUntilSharp } from './support/browser.mjs';
import { clouds, FakeServer } from './support/fake_server.mjs';

const axe = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');

describe('cutting', { timeout: 290_000 }, () => {
  let browser, server, page;

  before(async () => { browser = await startBrowser(); });
  after(() => browser?.close());
  beforeEach(async () => {
    server = new FakeServer();
    page = await openPage(browser, await server.start());
    await waitUntilSharp(page);
  });
  afterEach(async () => {
    const complaints = await closePage(page);
    await server.stop();
    assert.deepEqual(complaints, []);
  });

  const said = () => server.received.filter(({ type, clips }) => type === 'view' && clips !== undefined).at(-1)?.clips;
  /** The server has been told what the page wants now, not a step of a drag on the way there, and that holds. */
  const isSaid = async (holds, what) => {
    const isSo = async () => {
      const now = JSON.stringify(await page.evaluate(() => document.getElementById('view').viewer.view.clips));
      try { return JSON.stringify(said()) === now && holds(said()); } catch { return false; }
    };
    for (const end = Date.now() + 20_000; !(await isSo()); await page.waitForTimeout(20)) assert.ok(Date.now() < end, `${what}: ${JSON.stringify(said())}`);
    return said();
  };
  const close = (a, b, tolerance = 0.05) => a.every((value, i) => Math.abs(value - b[i]) <= tolerance * Math.max(1, Math.abs(b[i])));
  const placeOf = async (point) => project(await page.evaluate(() => document.getElementById('view').viewer.camera), point, { width: 960, height: 600 });
  const drag = async (from, to) => {
    await page.mouse.move(from.x, from.y);
    await page.mouse.down();
    await page.mouse.move((from.x + to.x) / 2, (from.y + to.y) / 2, { steps: 3 });
    await page.mouse.move(to.x, to.y, { steps: 3 });
    await page.mouse.up();
  };
  const withBox = async () => {
    await page.keyboard.press('x');
    await page.click('#clip-add');
    const [{ box }] = await isSaid((clips) => clips.length === 1, 'a box');
    return box;
  };

  it('a face follows the hand, its opposite stays; the middle moves all of it; the arm turns it', async () => {
    const box = await withBox();
    assert.ok(box.size.every((size) => size > 0));
    const camera = await page.evaluate(() => JSON.stringify(document.getElementById('view').viewer.camera));
    const face = facesOf(box).find(({ axis, side }) => axis === 0 && side === 1);
    const wanted = face.at.map((value, i) => value + 2 * face.normal[i]);
    await drag(await placeOf(face.at), await placeOf(wanted));
    const grown = (await isSaid((clips) => close([clips[0].box.size[0]], [box.size[0] + 2]), 'it grew by 2'))[0].box;
    assert.ok(close(grown.center, [box.center[0] + 1, box.center[1], box.center[2]]));
    assert.deepEqual(grown.size.slice(1), box.size.slice(1));
    const shifted = await placeOf(grown.center);
    await drag(shifted, { x: shifted.x + 60, y: shifted.y });
    const moved = (await isSaid((clips) => clips[0].box.center[0] > grown.center[0] + 0.5, 'it moved'))[0].box;
    assert.deepEqual(moved.size, grown.size);
    const arm = await page.locator('#clips .turn .dot').boundingBox();
    await drag({ x: arm.x + arm.width / 2, y: arm.y + arm.height / 2 }, await placeOf([moved.center[0], moved.center[1] + moved.size[0] * 0.65, moved.center[2] + moved.size[2] / 2]));
    await isSaid((clips) => close([clips[0].box.turn[0]], [90], 0.03), 'turned by a quarter');
    assert.equal(await page.evaluate(() => JSON.stringify(document.getElementById('view').viewer.camera)), camera, 'the camera has moved');
  });

  it('a half-space moves along its normal, and is turned over', async () => {
    await page.keyboard.press('x');
    await page.click('#clip-add-plane');
    const [{ plane }] = await isSaid((clips) => clips[0].plane.normal[2] === -1, 'what is below');
    await drag(await placeOf(plane.point), await placeOf([plane.point[0], plane.point[1], plane.point[2] - 2]));
    await isSaid((clips) => close([clips[0].plane.point[2]], [plane.point[2] - 2]) && clips[0].plane.point[0] === plane.point[0], 'it went down by 2');
    await page.click('#clip-list [data-key=flip-0]');
    await isSaid((clips) => clips[0].plane.normal[2] === 1, 'the other side');
    await page.fill('#clip-list input[aria-label="Normal X"]', '0.5');
    await page.keyboard.press('Enter');
    await isSaid((clips) => clips[0].plane.normal[0] === 0.5, 'a normal');
  });

  it('fields say all of it, for keys; eight are the most; and nothing again', async () => {
    await withBox();
    await page.selectOption('#clip-list select', 'outside');
    await isSaid(([shape]) => shape.keep === 'outside', 'outside');
    await page.fill('#clip-list input[aria-label="Size Z"]', '1.5');
    await page.keyboard.press('Enter');
    await isSaid(([{ box }]) => box.size[2] === 1.5, 'a size');
    assert.equal(await page.evaluate(() => document.activeElement.getAttribute('aria-label')), 'Size Z', 'the focus stays');
    await page.fill('#clip-list input[aria-label="Size Z"]', '-4');
    await page.keyboard.press('Enter');
    assert.equal(await page.inputValue('#clip-list input[aria-label="Size Z"]'), '1.5', 'no box without an inside');
    for (let i = 1; i < 8; ++i) await page.click('#clip-add');
    await isSaid((clips) => clips.length === 8, 'eight');
    assert.ok(await page.isDisabled('#clip-add'));
    await page.click('#clip-none');
    await isSaid((clips) => clips === null, 'nothing');
    assert.equal(await page.locator('#clip-list li').count(), 0);
    await page.keyboard.press('Escape');
    assert.ok(!(await page.isVisible('#clipping')));
  });

  for (const options of [{ colorScheme: 'light' }, { colorScheme: 'dark', viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true }]) {
    it(`axe finds nothing in the ${options.colorScheme} theme, ${options.isMobile ? 'on a phone' : 'on a desk'}; it and measuring take turns`, async () => {
      await closePage(page);
      page = await openPage(browser, `http://127.0.0.1:${server.port}/`, options);
      await waitUntilSharp(page);
      await page.click('#tool-clip');
      await page.click('#clip-add');
      await page.waitForSelector('#clip-list .details');
      await page.evaluate(axe);
      const findings = await page.evaluate(async () => (await globalThis.axe.run(document, { resultTypes: ['violations'] })).violations
        .flatMap(({ id, nodes }) => nodes.map((node) => `${id}: ${node.target.join(' ')} ${node.failureSummary}`)));
      assert.deepEqual(findings, []);
      await page.click('#tool-measure');
      await page.waitForSelector('#measuring', { state: 'visible' }); // it is loaded for this
      assert.deepEqual([await page.isVisible('#clipping'), await page.isVisible('#measuring')], [false, true]);
      await page.click('#tool-clip');
      assert.deepEqual([await page.isVisible('#clipping'), await page.isVisible('#measuring')], [true, false]);
    });
  }

  it('comes when it is first used; where it cannot, that is said, and the next press tries again', async () => {
    await closePage(page);
    page = await openPage(browser, `http://127.0.0.1:${server.port}/`);
    const asked = [];
    page.on('request', (request) => asked.push(new URL(request.url()).pathname));
    await waitUntilSharp(page);
    const toolsParts = () => asked.filter((path) => /\/(clip|measure)\/(clipping|measuring|card)\.js|(clip|measure|card)\.css/.test(path));
    assert.deepEqual(toolsParts(), []);
    await page.route('**/styles/clip.css', (route) => route.abort());
    await page.click('#tool-clip');
    await page.waitForFunction(() => /could not be loaded/.test(document.getElementById('toast-title').textContent));
    assert.equal(await page.locator('#clipping').count(), 0);
    assert.equal(await page.getAttribute('#tool-clip', 'aria-pressed'), 'false');
    await page.unroute('**/styles/clip.css');
    await page.click('#tool-clip');
    await page.waitForSelector('#clipping', { state: 'visible' });
    assert.equal(await page.getAttribute('#tool-clip', 'aria-pressed'), 'true');
    assert.ok(toolsParts().length >= 3);
    page.complaints = page.complaints.filter((text) => !/ERR_FAILED|could not be loaded/.test(text)); // which this test has made
  });

  it('has no button where the server does not cut', async () => {
    await closePage(page);
    const { clips, ...view } = clouds[0].view;
    server.clouds = [{ ...clouds[0], view }];
    page = await openPage(browser, `http://127.0.0.1:${server.port}/`);
    await waitUntilSharp(page);
    assert.equal(await page.locator('#tool-clip').count(), 0);
  });
});
