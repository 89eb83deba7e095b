// The page against the real server, used as a person uses it. SCANCAST_PROGRAM names the server's program; CTest sets it.
//
// Oracle of most of these: pictures are deterministic, so the same view is the same pixels, and another view is not.

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, join } from 'node:path';
import { after, before, describe, it } from 'node:test';

import { choose, chosen, differing, drag, openPage, pixels, seriousComplaints, startBrowser, waitUntilSharp } from './support/browser.mjs';
import { RealServer } from './support/real_server.mjs';
import { e57WithPhotos, ptxOfTwoScanners, writeScans } from './support/scans.mjs';

const program = process.env.SCANCAST_PROGRAM;
if (!program) throw new Error('Set SCANCAST_PROGRAM, such as SCANCAST_PROGRAM=build/release/bin/scancast');

const changedAtLeast = 0.004; // of the pixels; a view that moved changes far more
const sameAtMost = 0.0005;

describe('the page', { timeout: 240_000 }, () => {
  let scans, server, browser, url;

  before(async () => {
    scans = writeScans();
    server = new RealServer(program, scans.files);
    url = await server.start();
    browser = await startBrowser();
  });
  after(async () => {
    await browser?.close();
    await server?.stop();
    scans?.remove();
  });

  /** A page with a sharp picture, closed again after `use`; nothing serious may stand in its console. */
  async function withPage(use, options, address = url) {
    const page = await openPage(browser, address, options);
    try {
      await waitUntilSharp(page);
      await use(page);
      assert.deepEqual(seriousComplaints(page), []);
    } finally {
      await page.context().close();
    }
  }

  /** Runs `act`, waits for the final still, and returns how much of the picture changed. */
  async function changeBy(page, act) {
    const earlier = await pixels(page);
    const asked = await page.getAttribute('#picture', 'data-asked');
    await act();
    await page.waitForFunction((before) => document.getElementById('picture').dataset.asked !== before, asked, { timeout: 5000 });
    await waitUntilSharp(page);
    return differing(earlier, await pixels(page));
  }

  it('shows the cloud, its name and how to get around', () => withPage(async (page) => {
    const picture = await pixels(page);
    const orange = picture.filter((_, i) => i % 3 === 0 && picture[i] > 150 && picture[i + 2] < 110).length;
    assert.ok(orange > 0.02 * (picture.length / 3), 'the ring is not to be seen');
    assert.match(await page.textContent('h1'), /ring/);
    assert.match(await page.textContent('#cloud-facts'), /60,000 points/);
    assert.ok(await page.isVisible('#hint'));
    assert.ok(!(await page.isVisible('#cover')));
    assert.match(await page.title(), /ring/);
  }));

  it('dragging turns it, and then it becomes sharp', () => withPage(async (page) => {
    assert.ok(await changeBy(page, () => drag(page, [300, 300], [420, 260])) > changedAtLeast);
    assert.equal(await page.textContent('#hud-state'), 'Sharp');
  }));

  it('right-dragging pans, the wheel zooms, a double-click goes there, F shows everything again', () => withPage(async (page) => {
    const whole = await pixels(page);
    assert.ok(await changeBy(page, () => drag(page, [300, 300], [380, 330], 'right')) > changedAtLeast);
    assert.ok(await changeBy(page, () => page.mouse.wheel(0, -300)) > changedAtLeast);
    assert.ok(await changeBy(page, () => page.mouse.dblclick(350, 320)) > changedAtLeast);
    await changeBy(page, () => page.keyboard.press('f'));
    await page.waitForTimeout(400); // the flight
    await waitUntilSharp(page);
    assert.ok(differing(whole, await pixels(page)) <= sameAtMost, 'F is not where it was');
  }));

  it('goes to where the scanner stood, in clouds that know it', async () => {
    const file = join(scans.folder, 'room.ptx');
    writeFileSync(file, ptxOfTwoScanners(8000));
    const other = new RealServer(program, [...scans.files, file]);
    try {
      const address = await other.start();
      await withPage(async (page) => {
        assert.ok(!(await page.isVisible('#station')), 'nobody knows it of the ring');
        await page.selectOption('#cloud', 'room');
        await page.waitForSelector('#station', { state: 'visible' });
        await waitUntilSharp(page);
        const names = await page.$$eval('#station option', (options) => options.map((option) => option.textContent));
        assert.deepEqual(names, ['Go to a scan position…', 'Scan 1 (8,000 points)', 'Scan 2 (8,000 points)']);
        assert.ok(await changeBy(page, () => page.selectOption('#station', { label: names[1] })) > changedAtLeast);
        assert.equal(await page.inputValue('#station'), '', 'a menu of places, not a state');
        await page.waitForTimeout(400); // the flight
        await waitUntilSharp(page);
        const first = await pixels(page);
        assert.ok(await changeBy(page, () => page.selectOption('#station', { label: names[2] })) > changedAtLeast);
        await changeBy(page, () => page.selectOption('#station', { label: names[1] }));
        await page.waitForTimeout(400); // the flight
        await waitUntilSharp(page);
        assert.ok(differing(first, await pixels(page)) <= sameAtMost, 'the same place looks another way');
        await page.selectOption('#cloud', 'corner');
        await page.waitForSelector('#station', { state: 'hidden' });
      }, {}, `${address}#cloud=ring`);
    } finally {
      await other.stop();
    }
  });

  it('shows the photos that a scan brought along, and the points from where they were taken', async () => {
    const file = join(scans.folder, 'hall.e57');
    const { bytes, jpegs } = e57WithPhotos(9000);
    writeFileSync(file, bytes);
    const other = new RealServer(program, [file]);
    try {
      const address = await other.start();
      await withPage(async (page) => {
        await page.waitForSelector('#station', { state: 'visible' }); // of the whole cloud
        const list = (await (await fetch(`${address}api/v1/clouds/hall/photos`)).json()).photos;
        assert.deepEqual(list.map(({ name, projection, station }) => [name, projection, station?.name]), [['All round', 'spherical', 'Hall'], ['North wall', 'pinhole', 'Hall']]);
        for (const [i, jpeg] of jpegs.entries()) {
          const sent = Buffer.from(await (await fetch(new URL(list[i].href, address))).arrayBuffer());
          assert.ok(sent.equals(jpeg), 'another photo than the file has');
        }
        const shows = (name) => page.waitForFunction((title) => document.getElementById('photo-title').textContent === title
          && document.getElementById('photo').naturalWidth > 0, name, { timeout: 5000 });
        await changeBy(page, () => page.selectOption('#station', { label: 'Hall (9,000 points, 2 photos)' }));
        await page.click('#station-photos');
        await shows('All round');
        assert.match(await page.textContent('#photo-facts'), /^Panorama, 640 × 320, .*, taken at Hall$/);
        await page.click('#photo-next');
        await shows('North wall');
        // Half its height is as long as its camera: 90° show all of it, for the window is wider.
        const asked = await page.getAttribute('#picture', 'data-asked');
        await page.click('#photo-go');
        await page.waitForFunction((before) => document.getElementById('picture').dataset.asked !== before, asked);
        await page.waitForTimeout(400); // the flight
        await waitUntilSharp(page);
        await page.click('#copy-link');
        const words = new URLSearchParams(new URL(page.url()).hash.slice(1));
        const [eye, target] = ['eye', 'target'].map((word) => words.get(word).split(',').map(Number));
        [11, 20, 1.5].forEach((value, axis) => assert.ok(Math.abs(eye[axis] - value) < 1e-6, eye.join()));
        assert.ok(Math.abs(target[0] - 11) < 1e-6 && target[1] > 21 && Math.abs(target[2] - 1.5) < 1e-6, target.join());
        assert.ok(Math.abs(Number(words.get('fov')) - 90) < 1e-6, words.get('fov'));
      }, {}, address);
    } finally {
      await other.stop();
    }
  });

  it('is used by keys alone: walking, turning, standard views, orthographic projection', () => withPage(async (page) => {
    for (const key of ['ArrowLeft', 'w', '+', '1', '2', '3', 'o']) {
      assert.ok(await changeBy(page, () => page.keyboard.press(key, { delay: 150 })) > changedAtLeast, key);
      await page.waitForTimeout(350);
      await waitUntilSharp(page);
    }
    assert.equal(await page.getAttribute('#orthographic', 'aria-pressed'), 'true');
  }));

  it('method, its parameters, colour, light and background all change the picture', () => withPage(async (page) => {
    const methods = await page.$$eval('#method input', (inputs) => inputs.map((input) => input.value));
    assert.ok(methods.includes('point') && methods.includes('paraboloid'), methods.join());
    assert.ok(await changeBy(page, () => choose(page, '#color', 'elevation')) > changedAtLeast, 'elevation');
    assert.ok(await changeBy(page, () => choose(page, '#colormap', 'turbo')) > changedAtLeast, 'turbo');
    assert.ok(await changeBy(page, async () => {
      await page.fill('#range-high', '0');
      await page.press('#range-high', 'Enter');
    }) > changedAtLeast, 'range');
    assert.ok(await changeBy(page, () => choose(page, '#color', 'flat')) > changedAtLeast, 'one colour');
    assert.ok(await changeBy(page, () => page.selectOption('#shading', 'unlit')) > changedAtLeast, 'no light'); // the look has some
    assert.ok(await changeBy(page, () => page.selectOption('#shading', 'eyedome')) > changedAtLeast, 'edges');
    assert.ok(await changeBy(page, () => choose(page, '#background', 'white')) > changedAtLeast, 'white');
    await choose(page, '#method', 'paraboloid'); // the automatic one has no parameters of its own
    await waitUntilSharp(page);
    await page.click('#tuning summary');
    assert.ok(await changeBy(page, async () => {
      await page.fill('#parameter-sizePx', '14');
      await page.press('#parameter-sizePx', 'Enter');
    }) > changedAtLeast, 'size');
    assert.ok(await changeBy(page, () => choose(page, '#method', 'point')) > changedAtLeast, 'point');
    await changeBy(page, () => page.click('#reset-style'));
    assert.equal(await chosen(page, '#method'), 'auto');
    assert.equal(await chosen(page, '#color'), 'auto');
  }));

  it('another cloud comes with its name and its own view', () => withPage(async (page) => {
    await page.waitForFunction(() => ![...document.querySelectorAll('#cloud option')].some((option) => option.disabled));
    assert.ok(await changeBy(page, () => page.selectOption('#cloud', 'corner')) > changedAtLeast);
    assert.match(await page.textContent('h1'), /corner/);
  }));

  it('a copied link shows the very same picture after a reload, to the pixel', () => withPage(async (page) => {
    await page.waitForFunction(() => ![...document.querySelectorAll('#cloud option')].some((option) => option.disabled));
    await changeBy(page, () => page.selectOption('#cloud', 'corner'));
    await changeBy(page, () => drag(page, [300, 300], [350, 340]));
    await changeBy(page, () => choose(page, '#method', 'cone'));
    await changeBy(page, () => choose(page, '#color', 'elevation'));
    const sent = await pixels(page);
    await page.click('#copy-link');
    await page.waitForSelector('#toast:not([hidden])');
    assert.match(page.url(), /#cloud=corner&eye=.*method=cone/);
    await page.reload();
    await waitUntilSharp(page);
    assert.equal(differing(sent, await pixels(page), 0), 0, 'the words of the link are those that were sent');
    assert.equal(await chosen(page, '#method'), 'cone');
  }));

  it('saves the picture in full quality and full size', () => withPage(async (page) => {
    await page.click('#save-picture');
    const [download] = await Promise.all([page.waitForEvent('download'), page.click('#picture-save')]);
    assert.match(download.suggestedFilename(), /^ring-\d{4}-\d\d-\d\d-[a-z]+-960x600\.png$/);
    const png = readFileSync(await download.path());
    assert.equal(png.toString('latin1', 1, 4), 'PNG');
    assert.deepEqual([png.readUInt32BE(16), png.readUInt32BE(20)], [960, 600]);
  }));

  it('a scan whose Y axis is up is stood upright, and a link remembers it', () => withPage(async (page) => {
    assert.ok(await changeBy(page, () => page.selectOption('#up-axis', 'y')) > changedAtLeast);
    const upright = await pixels(page);
    await page.click('#copy-link');
    await page.reload();
    await waitUntilSharp(page);
    assert.ok(differing(upright, await pixels(page)) <= sameAtMost);
    assert.equal(await page.inputValue('#up-axis'), 'y');
  }));

  it('a method that does not exist is explained in words, and the picture comes all the same', async () => {
    const address = `${url}#cloud=ring&method=parabloid`;
    await withPage(async (page) => {
      await page.waitForSelector('#toast:not([hidden])');
      assert.match(await page.textContent('#toast'), /parabloid/);
      assert.ok(await page.isVisible('#toast'));
      assert.equal(await chosen(page, '#method'), 'auto');
    }, {}, address);
  });

  it('follows the size of its window', () => withPage(async (page) => {
    await page.setViewportSize({ width: 700, height: 500 });
    await page.waitForFunction(() => document.getElementById('picture').width === 700, undefined, { timeout: 5000 });
    await page.waitForTimeout(300);
    await waitUntilSharp(page);
    const figures = await page.evaluate(() => {
      document.getElementById('hud').open = true;
      return new Promise((done) => { setTimeout(() => done(document.getElementById('hud-figures').textContent), 700); });
    });
    assert.match(figures, /700 × 500/);
  }));

  it('shows its help on ?, and Escape closes it', () => withPage(async (page) => {
    await page.keyboard.press('?');
    assert.ok(await page.isVisible('#help'));
    await page.keyboard.press('Escape');
    assert.ok(!(await page.isVisible('#help')));
  }));

  it('fits a phone: fingers orbit, pan and pinch, nothing runs out of the screen', () => withPage(async (page) => {
    assert.equal(await page.evaluate(() => document.getElementById('picture').width), 780, 'two pixels for each CSS pixel');
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
    for (const selector of ['.views', '.actions', '#hud', '#hint', '#rail']) {
      const box = await page.locator(selector).boundingBox();
      assert.ok(box && box.x >= 0 && box.x + box.width <= 390 && box.y + box.height <= 844, selector);
    }
    const cdp = await page.context().newCDPSession(page);
    const touch = (type, ...touchPoints) => cdp.send('Input.dispatchTouchEvent', { type, touchPoints });
    assert.ok(await changeBy(page, async () => {
      await touch('touchStart', { x: 150, y: 400, id: 1 });
      for (let i = 1; i <= 5; ++i) await touch('touchMove', { x: 150 + 16 * i, y: 400 + 6 * i, id: 1 });
      await touch('touchEnd');
    }) > changedAtLeast, 'one finger');
    assert.ok(await changeBy(page, async () => {
      await touch('touchStart', { x: 170, y: 400, id: 1 }, { x: 230, y: 420, id: 2 });
      for (let i = 1; i <= 5; ++i) await touch('touchMove', { x: 170 - 12 * i, y: 400, id: 1 }, { x: 230 + 12 * i, y: 420, id: 2 });
      await touch('touchEnd');
    }) > changedAtLeast, 'two fingers');
    await page.tap('#toggle-panel');
    assert.ok(await page.isVisible('#appearance'));
    // The picture ends where the sheet begins.
    const [sheet, picture] = [await page.locator('#panel').boundingBox(), await page.locator('#picture').boundingBox()];
    assert.ok(picture.y + picture.height <= sheet.y + 1, 'the picture is under the panel');
  }, { viewport: { width: 390, height: 844 }, deviceScaleFactor: 3, hasTouch: true, isMobile: true }));

  it('says when the connection is lost, and comes back to the same view by itself', () => withPage(async (page) => {
    await changeBy(page, () => drag(page, [300, 300], [420, 260]));
    const seen = await pixels(page);
    await server.stop('SIGKILL');
    await page.waitForFunction(() => document.getElementById('cover-title').textContent === 'Connection lost');
    assert.ok(await page.isVisible('#cover-retry'));
    assert.ok(differing(seen, await pixels(page)) <= sameAtMost, 'the last picture is gone');
    await server.start();
    await page.waitForSelector('#cover', { state: 'hidden', timeout: 20_000 });
    // A server that has just started may show a part of the cloud first, marked as such.
    await page.waitForSelector('#loading', { state: 'hidden' });
    const end = Date.now() + 10_000;
    while (differing(seen, await pixels(page)) > sameAtMost && Date.now() < end) await page.waitForTimeout(100);
    await waitUntilSharp(page);
    assert.ok(differing(seen, await pixels(page)) <= sameAtMost, 'another view came back');
  }));

  it("shows a guest the cloud of his link, and no other", async () => {
    const folder = mkdtempSync(join(tmpdir(), 'scancast-guest-'));
    const run = (...words) => execFileSync(program, words, { encoding: 'utf8', stdio: ['ignore', 'pipe', 'ignore'] }).trim();
    const file = (name, text) => {
      writeFileSync(join(folder, name), text, { mode: 0o600 });
      return join(folder, name);
    };
    const keys = file('keys', run('token', 'guests'));
    const closed = new RealServer(program, scans.files, ['--auth-token-file', file('tokens', run('token', 'alice')), '--guest-key-file', keys]);
    try {
      const address = await closed.start();
      const id = scans.files.map((path) => basename(path).replace(/\.[^.]*$/, '')).at(-1);
      const link = run('guest-link', '--key-file', keys, '--cloud', id, '--expires', '60m', '--url', address);
      await withPage(async (page) => {
        assert.ok(!page.url().includes('guest='), 'the token has left the address');
        assert.deepEqual(await page.$$eval('#cloud option', (options) => options.map((option) => option.value)), [id]);
        await page.reload();
        await waitUntilSharp(page);
      }, undefined, link);
    } finally {
      await closed.stop();
      rmSync(folder, { recursive: true });
    }
  });
});
