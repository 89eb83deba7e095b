// While a newer picture is on its way, over a line of 125 ms each way, the last one is shown as it would look from where the
// camera is by now. SCANCAST_PROGRAM names the server's program; CTest sets it. The page is the working tree's.
//
// Oracle: a frame of the display is far shorter than the line, so what changes within two of them came from no server; and
// the picture at rest is that of a page that never shows anything but what came.

import assert from 'node:assert/strict';
import { after, before, describe, it } from 'node:test';

import { pixels, seriousComplaints, startBrowser, waitUntilSharp } from './support/browser.mjs';
import { PageProxy } from './support/page_proxy.mjs';
import { RealServer } from './support/real_server.mjs';
import { writeScans } from './support/scans.mjs';

const program = process.env.SCANCAST_PROGRAM;
if (!program) throw new Error('Set SCANCAST_PROGRAM, such as SCANCAST_PROGRAM=build/release/bin/scancast');

/** In the page: from here on, `answers` gets one entry for the first move of the mouse. */
function watch() {
  const picture = document.getElementById('picture');
  const small = () => Object.assign(document.createElement('canvas'), { width: 240, height: 150 }).getContext('2d', { willReadFrequently: true });
  const [base, over] = [small(), small()];
  window.answer = new Promise((answered) => {
    addEventListener('pointermove', () => {
      const { shown } = picture.dataset;
      let frames = 0;
      const look = () => {
        frames += 1;
        const canvas = document.querySelector('canvas.reprojection');
        if (canvas.style.visibility === 'visible') {
          base.drawImage(picture, 0, 0, 240, 150);
          over.drawImage(picture, 0, 0, 240, 150);
          over.drawImage(canvas, 0, 0, 240, 150);
          const [a, b] = [base, over].map((context) => context.getImageData(0, 0, 240, 150).data);
          const changed = a.filter((value, i) => Math.abs(value - b[i]) > 24).length / a.length;
          if (changed > 0.005) answered({ frames, changed, isOfLast: picture.dataset.shown === shown });
        }
        if (frames < 600) requestAnimationFrame(look);
        else answered({ frames });
      };
      requestAnimationFrame(look); // after the viewer's own, which it has asked for by now
    }, { once: true });
  });
}

describe('reprojection', { timeout: 150_000 }, () => {
  let scans, server, proxy, browser, url;

  before(async () => {
    scans = writeScans();
    server = new RealServer(program, scans.files);
    proxy = new PageProxy(await server.start(), 125);
    url = await proxy.start();
    browser = await startBrowser();
  });
  after(async () => {
    await browser?.close();
    await proxy?.stop();
    await server?.stop();
    scans?.remove();
  });

  /** A page with a sharp picture; `page.asked` are the sizes of pictures that it has asked for since. */
  async function withPage(use, { options, script, address = `${url}#cloud=ring` } = {}) {
    const context = await browser.newContext({ viewport: { width: 960, height: 600 }, ...options });
    if (script) await context.addInitScript(script);
    const page = await context.newPage();
    page.complaints = [];
    page.on('console', (message) => { if (['error', 'warning'].includes(message.type())) page.complaints.push(message.text()); });
    page.on('pageerror', (error) => page.complaints.push(String(error)));
    page.asked = [];
    page.on('websocket', (socket) => socket.on('framesent', ({ payload }) => {
      const message = JSON.parse(payload);
      if (message.type === 'view') page.asked.push([message.width, message.height]);
    }));
    try {
      await page.goto(address);
      await waitUntilSharp(page, 40_000);
      page.asked.length = 0;
      await use(page);
      assert.deepEqual(seriousComplaints(page), []);
    } finally {
      await context.close();
    }
  }

  const isOver = (page) => page.evaluate(() => document.querySelector('canvas.reprojection').style.visibility === 'visible');

  /** Drags and holds still; what the canvas has shown first. */
  async function firstAnswer(page) {
    await page.mouse.move(400, 300);
    await page.mouse.down();
    await page.evaluate(watch);
    await page.mouse.move(460, 320);
    return page.evaluate(() => window.answer);
  }

  async function atRest(page) {
    await page.mouse.up();
    await page.waitForFunction(() => document.querySelector('canvas.reprojection').style.visibility === 'hidden', undefined, { timeout: 20_000 });
    await page.waitForTimeout(500); // of margins, and of the address
    await waitUntilSharp(page, 40_000);
  }

  it('lies on the very rectangle of the picture, whatever is beside it', () => withPage(async (page) => {
    const rectangles = () => page.evaluate(() => ['#picture', 'canvas.reprojection'].map((name) => {
      const { left, top, width, height } = document.querySelector(name).getBoundingClientRect();
      return [left, top, width, height];
    }));
    const isOver = () => document.querySelector('canvas.reprojection').style.visibility === 'visible';
    for (const viewport of [{ width: 1280, height: 600 }, { width: 420, height: 800 }]) {
      await page.setViewportSize(viewport);
      // The layout opens or closes the panel by itself when the window's kind changes.
      await page.waitForFunction((wide) => innerWidth === wide, viewport.width);
      await page.evaluate(() => new Promise((done) => { requestAnimationFrame(() => requestAnimationFrame(done)); }));
      if (await page.evaluate(() => document.body.classList.contains('panel-closed'))) await page.keyboard.press('p');
      await page.waitForFunction(() => !document.body.classList.contains('panel-closed'));
      await waitUntilSharp(page);
      const [x, y] = [viewport.width / 4, viewport.height / 4];
      await page.mouse.move(x, y);
      await page.mouse.down();
      await page.mouse.move(x + 60, y + 20, { steps: 3 });
      await page.waitForFunction(isOver, undefined, { polling: 'raf', timeout: 10_000 });
      const [picture, over] = await rectangles();
      await page.mouse.up();
      assert.deepEqual(over, picture, `in a window of ${viewport.width} px`);
      assert.ok(picture[2] < viewport.width || picture[3] < viewport.height, 'the panel has no place of its own');
    }
  }));

  it('answers within two frames of the display, with a margin around what comes next, and leaves the picture at rest alone', () =>
    withPage(async (page) => {
      const { frames, isOfLast } = await firstAnswer(page);
      assert.ok(frames <= 2, `only after ${frames} frames`);
      assert.ok(isOfLast, 'it waited for the next picture');
      await atRest(page);
      assert.ok(!(await isOver(page)), 'something lies over the picture at rest');
      const sizes = page.asked.filter(([width]) => width !== undefined);
      const own = await page.evaluate(() => { const { width, height } = document.getElementById('picture'); return [width, height]; });
      assert.ok(sizes.some(([width, height]) => width > own[0] && height > own[1]), 'no margin was asked for');
      assert.deepEqual(sizes.at(-1), own, 'the last one has a margin');
      const moved = await pixels(page);
      await withPage(async (calm) => {
        assert.ok(moved.equals(await pixels(calm)), 'the picture at rest is another one');
      }, { address: page.url(), options: { reducedMotion: 'reduce' } });
    }));

  it('shows nothing but what came to who wants no motion', () => withPage(async (page) => {
    await page.mouse.move(400, 300);
    await page.mouse.down();
    await page.mouse.move(460, 320);
    await page.evaluate(() => new Promise((done) => { requestAnimationFrame(() => requestAnimationFrame(done)); }));
    assert.ok(!(await isOver(page)));
    await atRest(page);
    assert.ok(page.asked.every(([width]) => width === undefined), 'a margin for nothing');
  }, { options: { reducedMotion: 'reduce' } }));

  it('shifts and scales where there is no WebGL 2', () => withPage(async (page) => {
    await page.mouse.move(400, 300);
    await page.mouse.down({ button: 'right' });
    await page.evaluate(watch);
    await page.mouse.move(460, 320);
    const { frames, isOfLast } = await page.evaluate(() => window.answer);
    assert.ok(frames <= 2 && isOfLast, `only after ${frames} frames`);
    await page.mouse.up({ button: 'right' });
  }, {
    script: () => {
      const { getContext } = HTMLCanvasElement.prototype;
      HTMLCanvasElement.prototype.getContext = function (kind, ...rest) { return kind === 'webgl2' ? null : getContext.call(this, kind, ...rest); };
    },
  }));

  it('goes on without the graphics processor while that is lost, and with it again', () => withPage(async (page) => {
    await page.evaluate(() => {
      const gl = document.querySelector('canvas.reprojection').getContext('webgl2');
      window.loss = gl.getExtension('WEBGL_lose_context');
      window.loss.loseContext();
    });
    await page.mouse.move(400, 300);
    await page.mouse.down();
    await page.mouse.move(430, 310);
    await page.evaluate(() => new Promise((done) => { requestAnimationFrame(() => requestAnimationFrame(done)); }));
    assert.ok(!(await isOver(page)));
    await atRest(page);
    await page.evaluate(() => window.loss.restoreContext());
    await page.waitForTimeout(200);
    const { frames } = await firstAnswer(page);
    assert.ok(frames <= 2, `only after ${frames} frames`);
    await atRest(page);
  }));
});
