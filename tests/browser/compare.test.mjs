// Comparing two sides, against the test double: what each session is asked for, what is on which side of the divider, and that nothing is left
// behind. Accessibility is judged by axe.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { after, afterEach, before, beforeEach, describe, it } from 'node:test';

import { closePage, isTrue, openPage, startBrowser, waitUntilSharp } from './support/browser.mjs';
import { FakeServer } from './support/fake_server.mjs';

const axe = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');

describe('comparing', { timeout: 290_000 }, () => {
  let browser, server, page, url;

  before(async () => { browser = await startBrowser(); });
  after(() => browser?.close());
  beforeEach(async () => {
    server = new FakeServer();
    url = await server.start();
    page = await openPage(browser, url);
    await waitUntilSharp(page);
  });
  afterEach(async () => {
    const complaints = await closePage(page);
    await server.stop();
    assert.deepEqual(complaints, []);
  });

  const views = () => [...server.sessions].map(({ view }) => view);
  const begin = async () => {
    await page.keyboard.press('k');
    await page.waitForSelector('#comparing:not([hidden])');
    await isTrue(() => server.sessions.size === 2, 'a session of its own');
    await page.waitForSelector('#other-side.drawn');
  };
  /** Of a screenshot, the share of red dots left and right of an x of the picture. */
  const redAt = async (x) => {
    const png = (await page.screenshot({ clip: { x: 440, y: 80, width: 500, height: 420 } })).toString('base64');
    return page.evaluate(async ([bytes, at]) => {
      const bitmap = await createImageBitmap(new Blob([Uint8Array.from(atob(bytes), (letter) => letter.charCodeAt(0))]));
      const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
      const context = canvas.getContext('2d');
      context.drawImage(bitmap, 0, 0);
      const { data } = context.getImageData(0, 0, bitmap.width, bitmap.height);
      const count = [0, 0];
      for (let i = 0; i < data.length; i += 4) if (data[i] > 180 && data[i + 1] < 70 && data[i + 2] < 70) count[(i / 4) % bitmap.width < at - 440 ? 0 : 1] += 1;
      return count;
    }, [png, x]);
  };

  it('the right side is another picture from the same camera, cut off at the divider, which hand and keys move', async () => {
    await begin();
    await page.selectOption('#compare-method', 'point');
    await page.selectOption('#compare-color', 'elevation');
    await isTrue(() => views().some(({ method, color }) => method === 'point' && color === 'elevation') && views().some(({ method, color }) => method === 'paraboloid' && color === 'auto'), 'each side has its own');
    await page.waitForTimeout(500);
    await page.focus('#divider');
    assert.equal(await page.getAttribute('#divider', 'aria-valuenow'), '50');
    const camera = JSON.stringify(views()[0].camera);
    await page.keyboard.press('ArrowRight');
    assert.equal(await page.getAttribute('#divider', 'aria-valuenow'), '52');
    await page.keyboard.press('Shift+ArrowLeft');
    assert.equal(await page.getAttribute('#divider', 'aria-valuenow'), '42');
    await page.keyboard.press('End');
    assert.equal(await page.getAttribute('#divider', 'aria-valuenow'), '100');
    assert.equal(JSON.stringify(views()[0].camera), camera, 'the arrows were the divider’s');
    await page.mouse.move(958, 480);
    await page.mouse.down();
    await page.mouse.move(600, 470, { steps: 4 });
    await page.mouse.up();
    assert.equal(await page.getAttribute('#divider', 'aria-valuenow'), '63');
    const divider = await page.locator('#divider').boundingBox();
    assert.ok(Math.abs(divider.x + divider.width / 2 - 600) < 2, 'it is where the hand let it go');
    await page.waitForFunction(() => /compare=method:point;color:elevation;at:62\.5/.test(location.hash));
    assert.equal(await page.evaluate(() => getComputedStyle(document.getElementById('other-side')).clipPath), 'inset(0px 0px 0px 62.5%)');
    // The hand goes through the right side, and both sides turn.
    await page.mouse.move(760, 300);
    await page.mouse.down();
    await page.mouse.move(820, 320, { steps: 5 });
    await page.waitForTimeout(100);
    await page.mouse.up();
    await isTrue(() => JSON.stringify(views()[0].camera) !== camera && JSON.stringify(views()[0].camera) === JSON.stringify(views()[1].camera), 'both look from the same place');
    assert.match(await page.textContent('.side.left'), /Paraboloids/);
    assert.match(await page.textContent('.side.right'), /Points · Elevation/);
  });

  it('what stands on each side are the colours of that side', async () => {
    await begin();
    await page.evaluate(() => document.getElementById('view').viewer.changeStyle({ color: '#ff0000' }));
    await page.selectOption('#compare-color', 'elevation');
    await isTrue(() => views().some(({ color }) => color === '#ff0000') && views().some(({ color }) => color === 'elevation'), 'red, and heights');
    await waitUntilSharp(page);
    await page.waitForTimeout(400);
    await page.focus('#divider');
    for (let i = 0; i < 2; ++i) await page.keyboard.press('PageUp');
    await page.waitForTimeout(100);
    const [left, right] = await redAt(0.7 * 960);
    assert.ok(left > 300 && right === 0, `${left} red ones on the left, ${right} on the right`);
  });

  it('begins with two sides that differ, and says so until something else is chosen', async () => {
    await begin();
    await isTrue(() => views().some(({ color }) => color === 'elevation') && views().some(({ color }) => color === 'auto'), 'the right side by elevation');
    assert.match(await page.textContent('#compare-begins'), /begins coloured by elevation/);
    assert.equal(await page.inputValue('#compare-color'), 'elevation');
    await page.selectOption('#compare-color', '');
    await isTrue(() => views().every(({ color }) => color === 'auto'), 'both as the left one');
    assert.equal(await page.textContent('#compare-begins'), '');
  });

  it('another cloud, an address that says so, and an end that leaves nothing', async () => {
    await begin();
    await page.selectOption('#compare-cloud', 'helix');
    await isTrue(() => [...server.sessions].some(({ cloud }) => cloud.id === 'helix') && [...server.sessions].some(({ cloud }) => cloud.id === 'ring'), 'both clouds');
    await page.waitForFunction(() => /compare=cloud:helix/.test(location.hash));
    const [one, other] = views();
    assert.deepEqual(one.camera, other.camera);
    await page.reload();
    await waitUntilSharp(page);
    await page.waitForSelector('#other-side.drawn');
    assert.ok([...server.sessions].some(({ cloud }) => cloud.id === 'helix'), 'the link brings it back');
    await page.click('#tool-compare');
    await page.click('#tool-measure'); // one card at a time; both sides stay
    await page.waitForSelector('#measuring:not([hidden])');
    assert.deepEqual([await page.isVisible('#comparing'), await page.isVisible('#divider')], [false, true]);
    await page.click('#tool-compare');
    await page.click('#close-comparing');
    await isTrue(() => server.sessions.size === 1, 'its session has ended');
    assert.equal(await page.locator('#other-side, #divider, .side').count(), 0);
    await page.waitForFunction(() => !location.hash.includes('compare'));
    await begin(); // and again
    await page.selectOption('#compare-method', 'point');
    await isTrue(() => views().some(({ method }) => method === 'point'), 'from its beginning');
    assert.ok([...server.sessions].every(({ cloud }) => cloud.id === 'ring'));
  });

  it('a cloud that goes away is told on its side, and by nothing that comes again and again', async () => {
    await begin();
    await page.selectOption('#compare-cloud', 'helix');
    await isTrue(() => [...server.sessions].some(({ cloud }) => cloud.id === 'helix'), 'it is shown');
    server.remove('helix');
    await page.waitForFunction(() => document.querySelector('.side.right').textContent.includes('no scan named helix'));
    assert.ok(!(await page.locator('#other-side.drawn').count()), 'nothing else stands there in its place');
    await page.selectOption('#compare-cloud', '');
    await page.waitForSelector('#other-side.drawn');
    page.complaints = page.complaints.filter((text) => !text.includes('404'));
  });

  for (const options of [{ colorScheme: 'light' }, { colorScheme: 'dark', viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true }]) {
    it(`axe finds nothing in the ${options.colorScheme} theme, ${options.isMobile ? 'on a phone' : 'on a desk'}`, async () => {
      await closePage(page);
      page = await openPage(browser, url, options);
      await waitUntilSharp(page);
      await page.click('#tool-compare');
      await page.waitForSelector('#other-side.drawn');
      await page.selectOption('#compare-method', 'point');
      await page.waitForTimeout(300);
      await page.evaluate(axe);
      assert.deepEqual(await page.evaluate(async () => (await globalThis.axe.run(document, { resultTypes: ['violations'] })).violations
        .flatMap(({ id, nodes }) => nodes.map((node) => `${id}: ${node.target.join(' ')} ${node.failureSummary}`))), []);
    });
  }
});
