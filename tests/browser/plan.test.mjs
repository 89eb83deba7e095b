// Classes and the furniture of plans, on the page against the real server: by the pixels that it shows and the messages that it sends.
// The scan is a plot of known measures (support/scans.mjs): a red roof of 10 × 10 with a corner at the origin, on brown ground of 40 × 40.

import assert from 'node:assert/strict';
import { after, before, describe, it } from 'node:test';

import { mapOf, movedTo } from '../../client/web/page/plan/minimap.js';
import { choose, isTrue, openPage, pixels, seriousComplaints, startBrowser, waitUntilSharp } from './support/browser.mjs';
import { clouds, FakeServer } from './support/fake_server.mjs';
import { RealServer } from './support/real_server.mjs';
import { writePlot } from './support/scans.mjs';

const program = process.env.SCANCAST_PROGRAM;
if (!program) throw new Error('Set SCANCAST_PROGRAM, such as SCANCAST_PROGRAM=build/release/bin/scancast');

const phone = { viewport: { width: 360, height: 740 }, hasTouch: true, isMobile: true };
const isRed = (r, g, b) => r > 120 && g < 90 && b < 90;
const isBrown = (r, g, b) => r > 70 && r < 180 && Math.abs(r - g) < 60 && g > b + 15;

describe('plans and classes', { timeout: 290_000 }, () => {
  let plot, server, browser, url;

  before(async () => {
    plot = writePlot();
    server = new RealServer(program, [plot.file]);
    url = await server.start();
    browser = await startBrowser();
  });
  after(async () => {
    await browser?.close();
    await server?.stop();
    plot?.remove();
  });

  /** A page with a sharp picture; `page.views` are the view messages that it has sent, `page.maps` the small pictures that it asked for. */
  async function withPage(use, options = {}, hash = '') {
    const page = await openPage(browser, 'about:blank', options);
    page.views = [];
    page.maps = [];
    page.on('websocket', (socket) => socket.on('framesent', ({ payload }) => {
      const message = typeof payload === 'string' ? JSON.parse(payload) : {};
      if (message.type === 'view') page.views.push(message);
    }));
    page.on('request', (request) => request.url().includes('snapshot.jpg') && page.maps.push(request.url()));
    try {
      await page.goto(url + hash);
      await waitUntilSharp(page);
      await use(page);
      assert.deepEqual(seriousComplaints(page), []);
    } finally {
      await page.context().close();
    }
  }

  const share = async (page, is) => {
    const bytes = await pixels(page);
    let count = 0;
    for (let i = 0; i < bytes.length; i += 3) if (is(bytes[i], bytes[i + 1], bytes[i + 2])) ++count;
    return count / (bytes.length / 3);
  };
  const camera = (page) => page.evaluate(() => document.getElementById('view').viewer.camera);
  /** After a flight. */
  const atRest = async (page) => {
    await page.waitForTimeout(350);
    await waitUntilSharp(page);
  };
  /** Where the red roof begins and ends in the canvas, in CSS pixels: { left, right, top, bottom }. */
  const roof = (page) => page.evaluate(() => {
    const canvas = document.getElementById('picture');
    const { width, height } = canvas;
    const { data } = canvas.getContext('2d').getImageData(0, 0, width, height);
    const box = { left: width, right: 0, top: height, bottom: 0 };
    for (let i = 0; i < width * height; ++i) {
      if (!(data[4 * i] > 130 && data[4 * i + 1] < 80 && data[4 * i + 2] < 80)) continue;
      const [x, y] = [i % width, Math.floor(i / width)];
      Object.assign(box, { left: Math.min(box.left, x), right: Math.max(box.right, x + 1), top: Math.min(box.top, y), bottom: Math.max(box.bottom, y + 1) });
    }
    const ratio = width / canvas.clientWidth;
    return Object.fromEntries(Object.entries(box).map(([side, value]) => [side, value / ratio]));
  });
  const lastWord = (page) => page.views.findLast((view) => 'classes' in view)?.classes;

  it('a class that is switched off is not in the picture any more, and comes back', () => withPage(async (page) => {
    assert.deepEqual(await page.$$eval('#class-list .name', (names) => names.map((name) => name.textContent)), ['Ground', 'Building']);
    assert.deepEqual(await page.$$eval('#class-list .count', (counts) => counts.map((count) => count.textContent)), ['80,000', '40,000']);
    const [red, brown] = [await share(page, isRed), await share(page, isBrown)];
    assert.ok(red > 0.01 && brown > 0.05, `${red} red, ${brown} brown`);
    const act = async (what, word) => {
      await what();
      await isTrue(() => JSON.stringify(lastWord(page)) === JSON.stringify(word), `the word ${JSON.stringify(word)}`);
      await waitUntilSharp(page);
    };
    await act(() => page.uncheck('#class-list input[value="6"]'), [2]);
    assert.equal(await share(page, isRed), 0);
    assert.match(await page.textContent('#classes [role=status]'), /1 of 2/);
    await page.waitForFunction(() => /classes=2(&|$)/.test(location.hash)); // the address says it
    await act(() => page.click('#class-list .only[value="6"]'), [6]);
    assert.ok((await share(page, isBrown)) < 0.01 && (await share(page, isRed)) > 0.9 * red, 'only the roof');
    await act(() => page.click('#classes .heading button:nth-of-type(2)'), []);
    assert.ok((await share(page, isRed)) + (await share(page, isBrown)) < 0.001, 'none');
    await page.focus('#class-list input[value="2"]');
    await act(() => page.keyboard.press(' '), [2]);
    await act(() => page.click('#classes .heading button:nth-of-type(1)'), null);
    assert.ok(Math.abs((await share(page, isRed)) - red) < 0.001, 'all');
  }));

  it('the legend says what colours mean: classes that are shown, and the ends of a ramp', () => withPage(async (page) => {
    assert.ok(!(await page.isVisible('#plan-legend')), 'colours as scanned need none');
    await choose(page, '#color', 'classification');
    await page.waitForFunction(() => document.querySelectorAll('#plan-legend li').length === 2);
    await waitUntilSharp(page);
    const colours = await page.$$eval('#plan-legend .swatch', (swatches) => swatches.map((swatch) => getComputedStyle(swatch).backgroundColor));
    const [r, g, b] = /(\d+), (\d+), (\d+)/.exec(colours[1]).slice(1).map(Number);
    assert.ok((await share(page, (...rgb) => [r, g, b].every((value, i) => Math.abs(value - rgb[i]) < 12))) > 0.01, 'the swatch is another colour than the picture’s');
    await page.uncheck('#class-list input[value="6"]');
    await page.waitForFunction(() => document.querySelector('#plan-legend ul').textContent === 'Ground');
    await page.check('#class-list input[value="6"]');
    await choose(page, '#color', 'elevation');
    await page.waitForFunction(() => document.querySelector('#plan-legend .ends')?.textContent === '06');
    assert.match(await page.textContent('#plan-legend h2'), /Elevation \(units\)/);
    await page.uncheck('#on-picture-legend');
    assert.ok(!(await page.isVisible('#plan-legend')));
  }));

  it('scale bar and grid of a plan are as long and lie as the scan says', () => withPage(async (page) => {
    assert.match(await page.getAttribute('#scale-bar', 'aria-label'), /units at the centre/, 'with perspective it says where');
    await page.keyboard.press('7');
    await page.keyboard.press('g');
    await atRest(page);
    assert.equal((await camera(page)).projection, 'orthographic');
    assert.ok((await camera(page)).elevation > 1.57);
    const seen = await roof(page);
    const bar = await page.locator('#scale-bar i').evaluate((node) => node.getBoundingClientRect().width);
    const length = Number(await page.getAttribute('#scale-bar', 'data-length'));
    assert.equal(await page.getAttribute('#scale-bar', 'aria-label'), `Scale: ${length} units`);
    const perPixel = length / bar;
    for (const pixelsOfRoof of [seen.right - seen.left, seen.bottom - seen.top]) {
      assert.ok(Math.abs(pixelsOfRoof * perPixel - 10) < 3 * perPixel + 0.1, `the roof is ${pixelsOfRoof * perPixel} units`);
    }
    // The roof's corner is the origin: the lines of 0 run along its left and lower edges.
    const ends = (await page.getAttribute('#plan-grid .line', 'd')).split('M').slice(1).map((line) => line.split('L').map((end) => end.split(' ').map(Number)));
    const upright = ends.filter(([[x], [u]]) => Math.abs(x - u) < 0.5).map(([[x]]) => x);
    const flat = ends.filter(([[, y], [, v]]) => Math.abs(y - v) < 0.5).map(([[, y]]) => y);
    assert.ok(upright.some((x) => Math.abs(x - seen.left) < 3), `${upright} beside ${seen.left}`);
    assert.ok(flat.some((y) => Math.abs(y - seen.bottom) < 3), `${flat} beside ${seen.bottom}`);
    assert.ok((await page.$$eval('#plan-grid text', (texts) => texts.map((text) => text.textContent))).includes('X 0'));
    await page.keyboard.press('7');
    await atRest(page);
    assert.equal((await camera(page)).projection, 'perspective', 'back to where one was');
    assert.ok(!(await page.isVisible('#plan-grid')), 'in perspective there is none');
  }));

  it('the cube turns the view by a click, a drag and by keys, and turns with it', () => withPage(async (page) => {
    /** The camera looks from there, in degrees, once its flight is over. */
    const looksFrom = (azimuth, elevation, within = 0.5) => page.waitForFunction(([wanted, tolerance]) => {
      const { camera } = document.getElementById('view').viewer;
      return [camera.azimuth, camera.elevation].every((angle, i) => Math.abs((angle * 180) / Math.PI - wanted[i]) < tolerance);
    }, [[azimuth, elevation], within], { timeout: 20_000 });
    /** The cube follows what is on the canvas. */
    const facesAre = (...names) => page.waitForFunction((wanted) => [...document.querySelectorAll('#cube text.face:not([hidden])')]
      .map((label) => label.textContent).sort().join() === wanted, names.join(), { timeout: 20_000 });
    const click = (direction) => page.locator(`#cube .cell[data-direction="${direction}"]:not([hidden])`).first().click();
    const before = await pixels(page);
    await click('0 0 1');
    await looksFrom(-90, 90);
    await facesAre('Top');
    assert.equal(await page.textContent('#cube text.north'), 'Y', 'nobody says that it is north');
    await waitUntilSharp(page);
    assert.ok(!before.equals(await pixels(page)));
    await click('1 -1 1');
    await looksFrom(-45, 35.26);
    await facesAre('Front', 'Right', 'Top');
    await click('1 0 0');
    await looksFrom(0, 0);
    await page.waitForFunction(() => /the right/.test(document.getElementById('cube').getAttribute('aria-label')), undefined, { timeout: 20_000 });
    const { x, y } = await page.locator('#cube').boundingBox();
    await page.mouse.move(x + 56, y + 60);
    await page.mouse.down();
    await page.mouse.move(x + 36, y + 80, { steps: 4 });
    await page.mouse.up();
    await looksFrom(32, 32, 8);
    await page.focus('#cube');
    await page.keyboard.press('ArrowUp');
    await looksFrom(45, 45);
    await page.keyboard.press('ArrowRight');
    await looksFrom(90, 45);
  }));

  it('the overview map is drawn once for each look, shows where one is, and leads to another place', () => withPage(async (page) => {
    assert.equal(page.maps.length, 0, 'only on demand');
    await page.keyboard.press('n');
    const isLoaded = () => page.waitForFunction(() => document.querySelector('#minimap img').naturalWidth > 0 && document.querySelector('#minimap .outline').getAttribute('d'));
    await isLoaded();
    const outline = await page.getAttribute('#minimap .outline', 'd');
    const { bounds, look } = (await (await fetch(new URL('api/v1/clouds', url))).json()).clouds[0];
    const [map, from] = [mapOf(look?.bounds ?? bounds, 'z'), await camera(page)];
    const looksAt = (pixel) => page.waitForFunction((wanted) => document.getElementById('view').viewer.camera.target
      .every((value, i) => Math.abs(value - wanted[i]) < 0.5), movedTo(from, map, pixel).target, { timeout: 20_000 });
    await page.locator('#minimap img').click({ position: { x: 30, y: 40 } });
    await looksAt({ x: 30, y: 40 });
    await page.waitForFunction((old) => document.querySelector('#minimap .outline').getAttribute('d') !== old, outline, { timeout: 20_000 });
    const { x, y } = await page.locator('#minimap img').boundingBox();
    await page.mouse.move(x + 30, y + 40);
    await page.mouse.down();
    await page.mouse.move(x + 80, y + 60, { steps: 5 });
    await page.mouse.up();
    await looksAt({ x: 80, y: 60 });
    assert.equal(page.maps.length, 1, 'moving asks for no other picture');
    await page.uncheck('#class-list input[value="6"]');
    await isTrue(() => page.maps.length === 2, 'a map of the classes that are shown');
    assert.match(page.maps[1], /classes=2&/);
  }));

  it('a scan may have all 256 classes: the list scrolls, and keys go through it', async () => {
    const fake = new FakeServer();
    const numbers = Array.from({ length: 256 }, (_, i) => i);
    const each = (value) => Object.fromEntries(numbers.map((number) => [number, value]));
    fake.clouds = [{ ...clouds[0], classes: numbers, classNames: { ...each('user defined'), 2: 'ground' }, classCounts: each(7), classColors: each('#5080a0'), attributes: [{ name: 'classification' }] }];
    const page = await openPage(browser, await fake.start());
    try {
      await waitUntilSharp(page);
      assert.equal(await page.locator('#class-list input:checked').count(), 256);
      const [height, all] = await page.locator('#class-list').evaluate((list) => [list.clientHeight, list.scrollHeight]);
      assert.ok(height <= 340 && all > 5000, `${height} of ${all} px`);
      await page.focus('#class-list li:nth-child(255) .only');
      await page.keyboard.press('Tab');
      await page.keyboard.press(' ');
      await isTrue(() => fake.received.findLast(({ type, classes }) => type === 'view' && classes)?.classes.length === 255, 'all but the last');
      assert.ok(await page.evaluate(() => document.activeElement.value === '255' && document.activeElement.getBoundingClientRect().bottom < innerHeight));
      assert.equal(await page.getByRole('checkbox', { name: /^User defined \(77\) 7$/ }).count(), 1);
      await choose(page, '#color', 'classification');
      await page.waitForFunction(() => /and 231 more/.test(document.querySelector('#plan-legend')?.textContent));
      assert.deepEqual(seriousComplaints(page), []);
    } finally {
      await page.context().close();
      await fake.stop();
    }
  });

  it('what is switched on is remembered; presentations and phones keep what they have room for', async () => {
    await withPage(async (page) => {
      await page.keyboard.press('n');
      await page.uncheck('#on-picture-scaleBar');
      await page.reload();
      await waitUntilSharp(page);
      assert.deepEqual(await Promise.all(['#cube', '#scale-bar', '#minimap'].map((selector) => page.isVisible(selector))), [true, false, true]);
      await page.check('#on-picture-scaleBar');
      await page.keyboard.press('h');
      assert.deepEqual(await Promise.all(['#cube', '#plan-view', '#minimap', '#scale-bar'].map((selector) => page.isVisible(selector))), [false, false, false, true]);
    });
    for (const scheme of [phone, { viewport: { width: 640, height: 360 }, hasTouch: true, isMobile: true }]) await withPage(async (page) => {
      await page.keyboard.press('n');
      for (const opensPanel of [false, true]) {
        if (opensPanel) await page.tap('#toggle-panel');
        await page.waitForTimeout(200);
        await page.waitForFunction(() => {
          const map = document.querySelector('#minimap img');
          return !map?.checkVisibility({ visibilityProperty: true }) || map.naturalWidth > 0;
        }, undefined, { timeout: 20_000 });
        const look = () => page.evaluate(() => {
          const box = (node) => node.getBoundingClientRect();
          const seen = (node) => node.checkVisibility({ visibilityProperty: true }) && box(node).width > 0;
          const ours = [...document.querySelectorAll('#cube, #plan-view, #plan-legend, #minimap, #scale-bar')].filter(seen);
          const theirs = [...document.querySelectorAll('.title, .actions, .views, #hud, #rail, #credit, #hint, #panel')].filter(seen);
          const upon = (one, other) => box(one).left < box(other).right && box(other).left < box(one).right && box(one).top < box(other).bottom && box(other).top < box(one).bottom;
          const name = (node) => node.id || node.className;
          const found = ours.flatMap((one) => [...ours.filter((other) => other !== one), ...theirs].filter((other) => upon(one, other)).map((other) => `${name(one)} on ${name(other)}`));
          return { found, count: ours.length, outside: ours.filter((one) => box(one).left < 0 || box(one).right > innerWidth || box(one).bottom > innerHeight).map(name) };
        });
        // All of it is placed a frame after its sizes are known, and moves there.
        let lying = await look();
        for (const end = Date.now() + 20_000; lying.found.length + lying.outside.length > 0 && Date.now() < end; lying = await look()) await page.waitForTimeout(50);
        assert.deepEqual([lying.found, lying.outside], [[], []], `${scheme.viewport.width} px, panel ${opensPanel}`);
        assert.ok(lying.count >= 1, 'nothing is left');
      }
    }, scheme);
  });
});
