// A profile, as a user draws it, against the real server: what is asked, what is seen and read in the panel, what is saved. SCANCAST_PROGRAM names the
// server's program; CTest sets it.
//
// Oracle: the scan is a grid that this test has written, with a wall of known place and height: the profile across it is known, and so is every point
// of its corridor.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, describe, it } from 'node:test';

import { project } from '../../client/web/view/camera.js';
import { isTrue, newPage, openPage, seriousComplaints, startBrowser, waitUntilSharp } from './support/browser.mjs';
import { clouds, FakeServer } from './support/fake_server.mjs';
import { RealServer } from './support/real_server.mjs';
import { courtOrigin, courtSpacing, writeCourt } from './support/scans.mjs';

const program = process.env.SCANCAST_PROGRAM;
if (!program) throw new Error('Set SCANCAST_PROGRAM, such as SCANCAST_PROGRAM=build/release/bin/scancast');
const axe = readFileSync(new URL('node_modules/axe-core/axe.min.js', import.meta.url), 'utf8');

const at = (x, y, z = 0) => [x, y, z].map((value, axis) => value + courtOrigin[axis]);
/** The wall hides nothing then; from higher up, where there is less room. */
const fromAbove = (height) => `eye=${at(10, 9, height)}&target=${at(10, 9.5, 0)}&up=0,0,1&projection=perspective&fov=45`;

describe('a profile', { timeout: 250_000 }, () => {
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

  async function withPage(use, options = {}) {
    const page = await newPage(browser, { viewport: { width: 1440, height: 900 }, ...options });
    page.setDefaultTimeout(20_000);
    page.asked = [];
    page.picks = 0;
    page.on('request', (request) => { if (request.url().endsWith('/profile')) page.asked.push(request.postDataJSON()); });
    page.on('response', (response) => { if (response.url().endsWith('/pick')) page.picks += 1; });
    await page.addInitScript(() => { globalThis.showSaveFilePicker = undefined; }); // a dialog that no test can answer
    try {
      await page.goto(`${url}#cloud=court&${fromAbove(options.isMobile ? 85 : 26)}`);
      await waitUntilSharp(page, 40_000);
      await use(page);
      // The server may still be busy with a picture that the page has given up; then the page asks again.
      assert.deepEqual(seriousComplaints(page).filter((text) => !/status of (429|503)/.test(text)), []);
    } finally {
      await page.context().close();
    }
  }

  const placeOf = async (page, point) => project(await page.evaluate(() => document.getElementById('view').viewer.camera), point, await page.evaluate(() => {
    const { clientWidth, clientHeight } = document.getElementById('picture');
    return { width: clientWidth, height: clientHeight };
  }));

  /** Across the wall, which stands along y = 12: from y = 2 to y = 18. */
  async function drawAcross(page) {
    await page.click('#tool-profile');
    await page.waitForSelector('#profiling', { state: 'visible' });
    await page.fill('#profile-width', '0.5');
    await page.keyboard.press('Enter');
    await page.focus('#picture');
    for (const point of [at(10, 2), at(10, 18)]) {
      const { x, y } = await placeOf(page, point);
      const before = page.picks;
      await page.mouse.click(x, y);
      await isTrue(() => page.picks > before, 'a pick');
    }
    await page.waitForFunction(() => document.querySelectorAll('#profile-marks .drawn .point:not(.pending)').length >= 2);
    await page.keyboard.press('Enter');
    await page.waitForFunction(() => document.getElementById('profile-said').textContent !== '');
    await isTrue(() => page.asked.some(({ region }) => region?.z), 'the picture as the panel shows it');
    await page.waitForTimeout(500);
  }

  /** CSS pixels, on the page, of the plot's pixels that have the wall's colour: { left, right, top, bottom }. */
  const wallIn = (page) => page.evaluate(() => {
    const canvas = document.getElementById('profile-plot');
    const { data, width, height } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    const box = { left: Infinity, right: -Infinity, top: Infinity, bottom: -Infinity, count: 0 };
    for (let y = 0; y < height; ++y) {
      for (let x = 0; x < width; ++x) {
        const [r, g, b] = data.subarray(4 * (y * width + x));
        if (Math.abs(r - 200) > 6 || Math.abs(g - 190) > 6 || Math.abs(b - 170) > 6) continue;
        box.left = Math.min(box.left, x);
        box.right = Math.max(box.right, x);
        box.top = Math.min(box.top, y);
        box.bottom = Math.max(box.bottom, y);
        box.count += 1;
      }
    }
    const { left, top } = canvas.getBoundingClientRect();
    const scale = canvas.clientWidth / width;
    return { left: left + box.left * scale, right: left + box.right * scale, top: top + box.top * scale, bottom: top + box.bottom * scale, count: box.count };
  });

  const reading = async (page) => {
    const [, station, height] = /^Station ([\d.,−]+).* height ([\d.,−]+)/.exec(await page.textContent('#profile-at')) ?? [];
    return [station, height].map((text) => Number(text?.replaceAll(',', '').replace('−', '-')));
  };

  it('shows the wall where it stands; what is read, measured and saved there is the scan\'s', () => withPage(async (page) => {
    await drawAcross(page);
    const [{ line, width }] = page.asked;
    assert.equal(width, 0.5);
    assert.ok(line.flat().every((value, i) => Math.abs(value - at(10, i < 2 ? 2 : 18)[i % 2]) < 1.5 * courtSpacing), JSON.stringify(line));
    let wall = await wallIn(page);
    await isTrue(async () => { wall = await wallIn(page); return wall.count > 100; }, 'the wall');
    const middle = (wall.left + wall.right) / 2;
    await page.mouse.move(middle, (wall.top + wall.bottom) / 2);
    const station = at(0, 12)[1] - line[0][1];
    let read = await reading(page);
    assert.ok(Math.abs(read[0] - station) <= 0.1 && Math.abs(read[1] - at(0, 0, 3)[2]) <= 0.3, `${read} instead of ${station}, 43`);
    assert.ok(await page.evaluate(() => document.querySelector('#profile-marks .over-all').style.display === ''), 'the place in the picture');
    // Its foot and its top: 6 apart.
    await page.mouse.click(middle, wall.top + 1);
    await page.mouse.click(middle, wall.bottom - 1);
    const [, rise] = /height (−?[\d.]+)/.exec(await page.textContent('#profile-measured'));
    assert.ok(Math.abs(Number(rise.replace('−', '-')) + 6) <= 0.15, rise);
    // Nearer, about the wall's top: it stays under the cursor.
    await page.mouse.move(middle, wall.top + 1);
    const before = page.asked.length;
    for (let i = 0; i < 3; ++i) await page.mouse.wheel(0, -150);
    await isTrue(() => page.asked.length > before, 'a sharper picture');
    await page.waitForTimeout(500);
    await page.mouse.move(middle + 1, wall.top + 1);
    read = await reading(page);
    assert.ok(Math.abs(read[0] - station) <= 0.1 && Math.abs(read[1] - at(0, 0, 6)[2]) <= 0.15, `${read} instead of ${station}, 46`);
    // All points of the corridor: counted here.
    const [from, to] = [line[0], line[1]];
    const long = Math.hypot(to[0] - from[0], to[1] - from[1]);
    const isIn = (x, y) => {
      const [dx, dy] = [x - from[0], y - from[1]];
      const along = (dx * (to[0] - from[0]) + dy * (to[1] - from[1])) / long;
      return along >= -1e-9 && along <= long + 1e-9 && Math.abs((dx * (to[1] - from[1]) - dy * (to[0] - from[0])) / long) <= 0.25 + 1e-9;
    };
    let count = 0;
    for (let j = 0; j <= 200; ++j) {
      for (let i = 0; i <= 200; ++i) {
        const [x, y] = at(i * courtSpacing, j * courtSpacing);
        if (isIn(x, y)) count += 1;
        if (j <= 60 && i >= 40 && i <= 160 && isIn(x, at(0, 12)[1])) count += 1;
      }
    }
    const saved = async (format) => {
      await page.click('#profile-save');
      const [file] = await Promise.all([page.waitForEvent('download'), page.click(`#profile-files [data-format=${format}]`)]);
      return { name: file.suggestedFilename(), bytes: readFileSync(await file.path()) };
    };
    const csv = await saved('csv');
    assert.equal(csv.name, 'court-profile.csv');
    const rows = csv.bytes.toString().trim().split('\n');
    assert.match(rows[0], /station.*offset/);
    assert.ok(Math.abs(rows.length - 1 - count) <= 2, `${rows.length - 1} points instead of ${count}`); // two of them on the edge, to a rounding
    const las = await saved('las');
    assert.equal(Number(las.bytes.readBigUInt64LE(247)), rows.length - 1);
    const png = await saved('png');
    assert.deepEqual([...png.bytes.subarray(1, 4)], [...Buffer.from('PNG')]);
    assert.ok(png.bytes.readUInt32BE(16) >= 2000, 'twice as fine as the panel');
  }));

  it('is worked by keys alone; heights are drawn larger; the panel has the height that one gives it; only the corridor is shown', () => withPage(async (page) => {
    await drawAcross(page);
    // Wider: how many points there are is told anew, and one goes on looking where one does.
    const told = await page.textContent('#profile-said');
    await page.fill('#profile-width', '1.5');
    await page.keyboard.press('Enter');
    await page.waitForFunction((before) => /in the corridor/.test(document.getElementById('profile-said').textContent) && document.getElementById('profile-said').textContent !== before, told);
    await page.selectOption('#profile-exaggeration', '5');
    await isTrue(() => page.asked.at(-1).picture.exaggeration === 5, 'heights five times as large');
    await page.focus('#profile-plot');
    await page.keyboard.press('Home');
    for (let i = 0; i < 5; ++i) await page.keyboard.press('ArrowRight');
    await page.keyboard.press('Enter');
    for (let i = 0; i < 4; ++i) await page.keyboard.press('ArrowLeft');
    await page.keyboard.press('Enter');
    assert.match(await page.textContent('#profile-measured'), /along/);
    await page.keyboard.press('Escape');
    assert.equal(await page.textContent('#profile-measured'), '');
    assert.ok(await page.isVisible('#profile-panel'), 'Escape was the plot\'s');
    const high = () => page.evaluate(() => [document.getElementById('profile-panel').offsetHeight, document.getElementById('picture').clientHeight]);
    const [panel, picture] = await high();
    assert.equal(panel + picture, 900);
    await page.focus('#profile-resize');
    await page.keyboard.press('ArrowUp');
    assert.deepEqual(await high(), [panel + 24, picture - 24]);
    const background = () => page.evaluate(() => {
      const canvas = document.getElementById('picture');
      const { data } = canvas.getContext('2d').getImageData(0, Math.floor(canvas.height * 0.75), canvas.width, 1);
      let green = 0;
      for (let i = 0; i < data.length; i += 4) if (data[i + 1] > data[i] + 12 && data[i + 1] > data[i + 2] + 12) green += 1;
      return green / (data.length / 4);
    });
    await waitUntilSharp(page);
    assert.ok(await background() > 0.4, 'the court');
    await page.click('#profile-only');
    await page.waitForTimeout(300);
    await waitUntilSharp(page);
    assert.ok(await background() < 0.2, 'the corridor alone');
    assert.equal(await page.evaluate(() => document.getElementById('view').viewer.view.clips.length), 1);
    await isTrue(() => page.asked.at(-1).region.clips?.length === 1, 'the profile is of what is shown');
    await page.click('#profile-again');
    assert.ok(!(await page.isVisible('#profile-panel')));
    await page.focus('#picture');
    await page.keyboard.press('Escape');
    assert.ok(!(await page.isVisible('#profiling')));
  }));

  it('the line goes with a scan that is shifted, and the profile is of the same points', () => withPage(async (page) => {
    await drawAcross(page);
    const first = page.asked.find(({ picture }) => picture && picture.width > 64);
    const handles = () => page.$$eval('#profile-marks .handle.point', (nodes) => nodes.map((node) => node.getAttribute('transform').match(/[\d.]+/g).map(Number)));
    const shift = [3, 0, 1];
    const seen = (point) => point.map((value, axis) => value + shift[axis]);
    const said = await page.textContent('#profile-said');
    await page.evaluate((by) => { document.getElementById('view').viewer.changeStyle({ with: [{ cloud: '.', shift: by }] }); }, shift);
    await waitUntilSharp(page);
    for (const [i, point] of [at(10, 2), at(10, 18)].entries()) {
      const { x, y } = await placeOf(page, seen(point));
      const [[u, v]] = (await handles()).splice(i, 1);
      assert.ok(Math.hypot(x - u, y - v) < 6, `${u}, ${v} instead of ${x}, ${y}`); // the pick may be a grid's step beside it
    }
    assert.match(await page.textContent('#profile-how'), /where the scan’s file has them/);
    await page.waitForTimeout(600); // another picture would be asked for by then
    assert.deepEqual(page.asked.at(-1).line, first.line, 'where the file has it');
    assert.equal(await page.textContent('#profile-said'), said);
    // A corner that is drawn elsewhere is where it is seen, less the shift.
    const [from, to] = [await placeOf(page, seen(at(10, 2))), await placeOf(page, seen(at(6, 4)))];
    await page.mouse.move(from.x, from.y);
    await page.mouse.down();
    await page.mouse.move(to.x, to.y, { steps: 4 });
    await page.mouse.up();
    await isTrue(() => page.asked.at(-1).line[0][0] < at(8)[0], 'another line');
    const [x, y] = page.asked.at(-1).line[0];
    assert.ok(Math.abs(x - at(6)[0]) < 1.5 * courtSpacing && Math.abs(y - at(0, 4)[1]) < 1.5 * courtSpacing, `${x}, ${y}`);
  }));

  it('is not offered where another axis is up: the server\'s profiles stand on x and y', async () => {
    const fake = new FakeServer();
    fake.clouds = [{ ...clouds[0], look: undefined, view: { ...clouds[0].view, camera: { ...clouds[0].view.camera, up: [0, 1, 0] } } }];
    await fake.start();
    const page = await openPage(browser, `http://127.0.0.1:${fake.port}/`);
    try {
      await waitUntilSharp(page);
      await page.click('#tool-profile');
      await page.waitForFunction(() => /another axis is up/.test(document.getElementById('profile-how')?.textContent ?? ''));
      await page.mouse.click(500, 300);
      await page.waitForTimeout(200);
      assert.equal(await page.locator('#profile-marks .point').count(), 0);
    } finally {
      await page.context().close();
      await fake.stop();
    }
  });

  for (const options of [{ colorScheme: 'light' }, { colorScheme: 'dark', viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true }]) {
    it(`axe finds nothing in the ${options.colorScheme} theme, ${options.isMobile ? 'on a phone' : 'on a desk'}`, () => withPage(async (page) => {
      await drawAcross(page);
      await page.evaluate(axe);
      const findings = await page.evaluate(async () => (await globalThis.axe.run(document, { resultTypes: ['violations'] })).violations
        .flatMap(({ id, nodes }) => nodes.map((node) => `${id}: ${node.target.join(' ')} ${node.failureSummary}`)));
      assert.deepEqual(findings, []);
      await page.click('#tool-measure');
      await page.waitForSelector('#measuring', { state: 'visible' });
      assert.ok(!(await page.isVisible('#profile-panel')), 'they take turns');
    }, options));
  }
});
