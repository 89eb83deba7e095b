// Measuring, as a user does it, against the real server: known lengths, what sticks to the scan while the camera moves, what hides,
// keys, links, project files. SCANCAST_PROGRAM names the server's program; CTest sets it.
//
// Oracle: the scan is a grid that this test has written, so every point and every length is known; and a red spot in the picture
// itself tells where a point is on screen.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, describe, it } from 'node:test';

import { project } from '../../client/web/view/camera.js';
import { isTrue, seriousComplaints, startBrowser, waitUntilSharp } from './support/browser.mjs';
import { PageProxy } from './support/page_proxy.mjs';
import { RealServer } from './support/real_server.mjs';
import { courtOrigin, courtSpacing, writeCourt } from './support/scans.mjs';

const program = process.env.SCANCAST_PROGRAM;
if (!program) throw new Error('Set SCANCAST_PROGRAM, such as SCANCAST_PROGRAM=build/release/bin/scancast');

const at = (x, y, z = 0) => [x, y, z].map((value, axis) => value + courtOrigin[axis]);
const fromSouth = `eye=${at(10, -14, 14)}&target=${at(10, 8, 0)}&up=0,0,1&projection=perspective&fov=45`;
const fromNorth = `eye=${at(10, 30, 3)}&target=${at(10, 8, 1)}&up=0,0,1&projection=perspective&fov=45`;

describe('measuring', { timeout: 290_000 }, () => {
  let scan, server, proxy, browser, url;

  before(async () => {
    scan = writeCourt();
    server = new RealServer(program, [scan.file]);
    proxy = new PageProxy(await server.start(), 60); // over a line, so that what is seen between frames is seen
    url = await proxy.start();
    browser = await startBrowser();
  });
  after(async () => {
    await browser?.close();
    await proxy?.stop();
    await server?.stop();
    scan?.remove();
  });

  async function withPage(use, { options = {}, address = `${url}#cloud=court&${fromSouth}` } = {}) {
    const context = await browser.newContext({ viewport: { width: 1440, height: 600 }, ...options });
    const page = await context.newPage();
    page.setDefaultTimeout(30_000);
    page.complaints = [];
    page.on('console', (message) => { if (['error', 'warning'].includes(message.type())) page.complaints.push(message.text()); });
    page.on('pageerror', (error) => page.complaints.push(String(error)));
    page.picks = [];
    page.on('request', (request) => { if (request.url().endsWith('/pick')) page.picks.push(request.postDataJSON()); });
    try {
      await page.goto(address);
      await waitUntilSharp(page, 40_000);
      await use(page);
      assert.deepEqual(seriousComplaints(page), []);
    } finally {
      await context.close();
    }
  }

  const camera = (page) => page.evaluate(() => document.getElementById('view').viewer.camera);
  /** Where a point of the court is on screen; what is used lies beside the card. */
  const placeOf = async (page, point) => project(await camera(page), point, await page.evaluate(() => {
    const { clientWidth, clientHeight } = document.getElementById('picture');
    return { width: clientWidth, height: clientHeight };
  }));
  const click = async (page, point) => {
    const { x, y } = await placeOf(page, point);
    await page.mouse.click(x, y);
  };
  const measures = (page) => page.evaluate(() => JSON.parse(localStorage.getItem(Object.keys(localStorage).find((key) => key.startsWith('scancast.project.'))) ?? '{"measures": []}').measures);
  const rows = (page) => page.$$eval('#measure-list .name', (names) => names.map((name) => [...name.children].map((part) => part.textContent)));
  const look = async (page, words) => {
    await page.evaluate((hash) => { location.hash = hash; }, `#cloud=court&${words}`);
    await page.waitForTimeout(450);
    await waitUntilSharp(page);
  };
  const chooseKind = (page, kind) => page.check(`#measure-kinds input[value=${kind}]`);

  /** The tool is loaded when it is first used. */
  async function startMeasuring(page) {
    await page.keyboard.press('m');
    await page.waitForSelector('#measuring', { state: 'visible' });
  }

  /** The distance of 8 between two points of the ground. */
  async function measureEight(page) {
    await startMeasuring(page);
    await click(page, at(6, 6));
    await click(page, at(14, 6));
    await page.waitForFunction(() => document.querySelectorAll('#marks .drawn .point:not(.pending)').length >= 2);
    await page.keyboard.press('Enter');
    await page.waitForSelector('#measure-list .name');
  }

  const isOfGrid = (point) => point.every((value, axis) => {
    const steps = (value - courtOrigin[axis]) / courtSpacing;
    return Math.abs(steps - Math.round(steps)) < 1e-5;
  });

  it('lengths, heights, areas and angles are those of the scan, between points of the file', () => withPage(async (page) => {
    const tolerance = 0.001 + courtSpacing / 2;
    await measureEight(page);
    assert.equal(page.picks.length, 2);
    const [eight] = await measures(page);
    assert.ok(eight.points.every(isOfGrid), JSON.stringify(eight.points));
    const [[name, text]] = await rows(page);
    assert.equal(name, 'Distance 1');
    assert.ok(Math.abs(Number(text) - 8) <= tolerance, text);
    assert.equal(await page.textContent('#marks .label.value'), text);
    assert.match(await page.textContent('#measure-said'), /^Distance 1: /);
    const cases = {
      height: [[at(10, 12, 1), at(10, 12, 5)], 4], area: [[at(7, 2), at(16, 2), at(16, 9), at(7, 9)], 63], angle: [[at(7, 3), at(10, 3), at(10, 8)], 90],
      horizontal: [[at(8, 4), at(8, 12, 4)], 8], circle: [[at(15, 10), at(12, 7), at(9, 10)], 3],
    };
    for (const [kind, [points, wanted]] of Object.entries(cases)) {
      await chooseKind(page, kind);
      for (const point of points) {
        const count = page.picks.length;
        await click(page, point);
        await isTrue(() => page.picks.length > count, 'a pick');
      }
      if (['area', 'horizontal'].includes(kind)) await page.keyboard.press('Enter');
      await page.waitForFunction((count) => document.querySelectorAll('#measure-list .name').length === count, 2 + Object.keys(cases).indexOf(kind));
      const value = Number((await rows(page)).at(-1)[1].replace(/[^\d.−]/g, ''));
      const allowed = { area: 0.01 * 63, angle: 1.2 }[kind] ?? tolerance;
      assert.ok(Math.abs(value - wanted) <= allowed, `${kind}: ${value} instead of ${wanted}`);
    }
  }));

  it('the kinds stay where they are, however many measures there are and whichever is open', () => withPage(async (page) => {
    await startMeasuring(page);
    const many = Array.from({ length: 30 }, (_, i) => ({ name: `Distance ${i + 1}`, kind: 'distance', step: 0.001, points: [at(6, 4 + i / 5), at(14, 4 + i / 5)] }));
    const project = { format: 'scancast-project', version: 1, cloud: { id: 'court' }, measures: many };
    await page.setInputFiles('#project-file', { name: 'court.project.json', mimeType: 'application/json', buffer: Buffer.from(JSON.stringify(project)) });
    await page.waitForFunction(() => document.querySelectorAll('#measure-list .name').length === 30);
    const kinds = () => page.locator('#measure-kinds').boundingBox();
    const before = await kinds();
    for (const row of [29, 0, 15]) {
      await page.locator('#measure-list .name').nth(row).click();
      await page.waitForSelector('#measure-list [aria-expanded=true]');
      assert.deepEqual(await kinds(), before);
      const [list, opened] = [await page.locator('#measuring .rest').boundingBox(), await page.locator('#measure-list li:has([aria-expanded=true]) .head').boundingBox()];
      assert.ok(opened.y >= list.y - 1 && opened.y + opened.height <= list.y + list.height + 1, 'what was opened is to be seen');
      assert.ok(list.y >= before.y + before.height, 'below the kinds');
      await page.keyboard.press('Enter'); // closes it
    }
    await page.click('#measure-kinds .choice:has(input[value=area])');
    assert.ok(await page.isChecked('#measure-kinds input[value=area]'));
  }));

  it('a volume over a base is the server\'s, of the points that are there', () => withPage(async (page) => {
    await startMeasuring(page);
    await chooseKind(page, 'volume');
    for (const point of [at(8, 2), at(16, 2), at(16, 9), at(8, 9)]) {
      const count = page.picks.length;
      await click(page, point);
      await isTrue(() => page.picks.length > count, 'a pick');
    }
    await page.keyboard.press('Enter');
    const value = () => page.waitForFunction(() => {
      const text = document.querySelector('#measure-list .name b')?.textContent;
      return text ? { text } : undefined;
    }).then((found) => found.jsonValue()).then(({ text }) => Number(text));
    assert.ok(Math.abs(await value()) < 0.01, 'the ground itself');
    await page.selectOption('#measure-list select', 'height');
    await page.fill('#measure-list input[type=number]', String(courtOrigin[2] - 2));
    await page.keyboard.press('Enter');
    await page.waitForFunction(() => Number(document.querySelector('#measure-list .name b')?.textContent) > 100);
    const found = await value();
    assert.ok(Math.abs(found - 8 * 7 * 2) <= 0.01 * 8 * 7 * 2, `${found} instead of 112`);
    assert.ok((await measures(page))[0].option === courtOrigin[2] - 2);
  }));

  it('a plane is fitted to the points around a place, and drawn there', () => withPage(async (page) => {
    await startMeasuring(page);
    await chooseKind(page, 'plane');
    for (const [count, [point, wanted]] of [[at(11, 12, 3), 90], [at(12, 5), 0]].entries()) {
      await click(page, point);
      await page.waitForFunction(() => document.querySelectorAll('#marks .drawn .point:not(.pending)').length >= 2 || document.querySelector('#marks .drawn .point:not(.pending)'));
      await page.keyboard.press('Enter');
      await page.waitForFunction((wait) => document.querySelectorAll('#measure-list .name b:not(:empty)').length > wait, count);
      const slope = Number((await rows(page)).at(-1)[1].replace('°', ''));
      assert.ok(Math.abs(slope - wanted) <= 0.1, `${slope} instead of ${wanted}`);
      assert.ok(await page.evaluate(() => document.querySelector('#marks .measure.selected .line').getAttribute('d').length > 40), 'its square');
    }
    assert.match(await page.textContent('#measure-list dl'), /Points that count/);
  }));

  it('sticks to the scan while the camera moves, between frames as well; the cursor\'s coordinates are told', () => withPage(async (page) => {
    const spot = await placeOf(page, at(6, 6));
    await page.mouse.move(spot.x, spot.y);
    await page.waitForFunction(() => /^≈ x 400,00\d/.test(document.getElementById('coordinates').textContent));
    await measureEight(page);
    await page.keyboard.press('Escape'); // so that nothing of it is in another colour
    // Whenever something has been drawn: where the red spot is in it, and where the mark is.
    await page.evaluate(() => {
      const canvas = document.getElementById('picture');
      const over = document.querySelector('canvas.reprojection');
      const { viewer } = document.getElementById('view');
      const half = 70;
      const flat = Object.assign(document.createElement('canvas'), { width: 2 * half, height: 2 * half }).getContext('2d', { willReadFrequently: true });
      let drawn = viewer.shownPose;
      window.seen = [];
      viewer.addEventListener('shown', () => {
        if (viewer.shownPose === drawn) return;
        drawn = viewer.shownPose;
        const isBetween = over.style.visibility === 'visible';
        const { e, f } = document.querySelector('#marks .handle.point').transform.baseVal[0].matrix;
        flat.setTransform(1, 0, 0, 1, half - Math.round(e), half - Math.round(f));
        flat.drawImage(canvas, 0, 0, canvas.clientWidth, canvas.clientHeight);
        if (isBetween) flat.drawImage(over, 0, 0, canvas.clientWidth, canvas.clientHeight);
        const { data } = flat.getImageData(0, 0, 2 * half, 2 * half);
        let [x, y, count] = [0, 0, 0];
        for (let i = 0; i < data.length; i += 4) {
          if (data[i] < 140 || data[i + 1] > 90 || data[i + 2] > 90) continue;
          [x, y, count] = [x + ((i / 4) % (2 * half)) + 0.5, y + Math.floor(i / 8 / half) + 0.5, count + 1];
        }
        if (count > 30) window.seen.push({ isBetween, off: Math.hypot(x / count - half + Math.round(e) - e, y / count - half + Math.round(f) - f) });
      });
    });
    await page.mouse.move(700, 300);
    await page.mouse.down();
    for (let i = 1; i <= 24; ++i) {
      await page.mouse.move(700 - 8 * i, 300 + 2 * i);
      await page.waitForTimeout(16);
    }
    await page.mouse.up();
    await page.waitForTimeout(450);
    await waitUntilSharp(page);
    const seen = await page.evaluate(() => window.seen);
    const between = seen.filter(({ isBetween }) => isBetween).map(({ off }) => off).sort((a, b) => a - b);
    assert.ok(between.length >= 5, `${between.length} pictures between frames`);
    console.log(`# off the spot, px: median ${between[between.length >> 1].toFixed(2)}, worst ${between.at(-1).toFixed(2)} of ${between.length} between frames; at rest ${seen.at(-1).off.toFixed(2)}`);
    assert.ok(between[between.length >> 1] < 2.5 && between.at(-1) < 8, `off by ${between.map((off) => off.toFixed(1))} px`);
    assert.ok(seen.at(-1).off < 1.5, `at rest off by ${seen.at(-1).off} px`);
  }));

  it('hides behind what is in the way, and comes back', () => withPage(async (page) => {
    await measureEight(page);
    await page.keyboard.press('Escape');
    const opacityIs = (wanted) => page.waitForFunction((value) => Number(getComputedStyle(document.querySelector('#marks .label.value')).opacity) === value,
      wanted, { timeout: 20_000 });
    const lines = () => page.$eval('#marks .line', (line) => line.getAttribute('d').length);
    await opacityIs(1);
    assert.ok((await lines()) > 10);
    await look(page, fromNorth);
    await opacityIs(0);
    assert.equal(await lines(), 0, 'no line before the wall');
    assert.ok((await page.$eval('#marks .behind', (line) => line.getAttribute('d').length)) > 10, 'but a faint one');
    await look(page, fromSouth);
    await opacityIs(1);
  }));

  it('points are drawn to other places, added, removed; every step is taken back', () => withPage(async (page) => {
    await measureEight(page);
    const drag = async (from, to) => {
      const [a, b] = [await placeOf(page, from), Array.isArray(to) ? await placeOf(page, to) : to];
      const count = page.picks.length;
      await page.mouse.move(a.x, a.y);
      await page.mouse.down();
      await page.mouse.move(b.x, b.y, { steps: 4 });
      await page.mouse.up();
      await isTrue(() => page.picks.length > count, 'a pick at the new place');
    };
    const pointsNow = async () => (await measures(page))[0].points.map((point) => point.map((value, axis) => Math.round(value - courtOrigin[axis])));
    /** Once the server has found the point, they are these. */
    const become = async (wanted) => {
      for (const end = Date.now() + 20_000; JSON.stringify(await pointsNow()) !== JSON.stringify(wanted) && Date.now() < end;) await page.waitForTimeout(40);
      assert.deepEqual(await pointsNow(), wanted);
    };
    const before = await camera(page);
    await drag(at(14, 6), at(14, 3));
    await become([[6, 6, 0], [14, 3, 0]]);
    await drag(at(10, 4.5), at(10, 9)); // the middle of the line
    await become([[6, 6, 0], [10, 9, 0], [14, 3, 0]]);
    assert.deepEqual(await camera(page), before, 'the camera has moved');
    await click(page, at(10, 9));
    await page.keyboard.press('Delete');
    await become([[6, 6, 0], [14, 3, 0]]);
    await page.keyboard.press('Control+z');
    await page.keyboard.press('Control+z');
    await page.keyboard.press('Control+z');
    await become([[6, 6, 0], [14, 6, 0]]);
    await page.keyboard.press('Control+Shift+z');
    await become([[6, 6, 0], [14, 3, 0]]);
    await drag(at(14, 3), { x: 900, y: 12 }); // the background
    await page.waitForFunction(() => /no point/.test(document.getElementById('toast-title').textContent));
    await become([[6, 6, 0], [14, 3, 0]]);
  }));

  it('with keys alone: aim, place, take back, end, name, delete', () => withPage(async (page) => {
    await page.focus('#picture');
    await startMeasuring(page);
    const placed = (count) => page.waitForFunction((wanted) => document.querySelectorAll('#marks .drawn .point:not(.pending)').length === wanted, count);
    const said = (count) => page.waitForFunction((start) => document.getElementById('measure-said').textContent.startsWith(start), `Point ${count}: `);
    /** Some steps along an axis, by short presses; how far one leads depends on the machine, and far is taken back: the court is to stay in the middle. */
    const aim = async ({ there, back, axis, sign }) => {
      const from = (await camera(page)).target[axis];
      const gone = async () => sign * ((await camera(page)).target[axis] - from);
      const isFine = (way) => Math.abs(way) > 0.1 && Math.abs(way) <= 3;
      let way = 0;
      for (let i = 0; i < 20 && !isFine(way); ++i) {
        await page.keyboard.press(way > 3 ? back : there);
        await page.waitForTimeout(300);
        await waitUntilSharp(page);
        way = await gone();
      }
      assert.ok(isFine(way), `${there} led ${way} away`);
    };
    await page.mouse.move(5, 300); // off the picture's middle
    await page.keyboard.press(' ');
    await said(1);
    await aim({ there: 'd', back: 'a', axis: 0, sign: 1 });
    await page.keyboard.press(' ');
    await said(2);
    await aim({ there: 's', back: 'w', axis: 1, sign: -1 });
    await page.keyboard.press(' ');
    await said(3);
    await page.keyboard.press('Backspace');
    await page.keyboard.press('Enter');
    await page.waitForSelector('#measure-list .name');
    assert.equal((await measures(page))[0].points.length, 2);
    await page.focus('#measure-list .details input');
    await page.keyboard.press('Control+a');
    await page.keyboard.type('kerb');
    await page.keyboard.press('Enter');
    assert.equal((await rows(page))[0][0], 'kerb');
    await page.focus('#measure-list .eye');
    await page.keyboard.press(' ');
    assert.equal(await page.getAttribute('#measure-list .eye', 'aria-pressed'), 'false');
    assert.equal(await page.evaluate(() => document.activeElement.className), 'eye', 'the focus stays');
    await page.keyboard.press('Delete');
    assert.equal((await rows(page)).length, 0);
    await page.keyboard.press('Control+z');
    assert.equal((await rows(page)).length, 1);
    for (let i = 0; i < 2; ++i) await page.keyboard.press('Escape');
    assert.ok(!(await page.isVisible('#measuring')));
  }));

  it('is kept: by the address, by this browser, by a project file; a bad file changes nothing', () => withPage(async (page) => {
    await measureEight(page);
    const before = await measures(page);
    await page.waitForFunction(() => location.hash.includes('&measures='));
    const address = page.url();
    // Somebody else, with the link.
    await withPage(async (other) => {
      assert.deepEqual((await measures(other)).map(({ kind, points }) => ({ kind, points })), before.map(({ kind, points }) => ({ kind, points })));
    }, { address });
    await page.reload();
    await waitUntilSharp(page);
    await startMeasuring(page);
    assert.equal((await rows(page)).length, 1, 'once, though address and browser have it');
    // Files.
    await page.click('#measure-files summary');
    const saved = async (button) => {
      const [file] = await Promise.all([page.waitForEvent('download'), page.click(button)]);
      return { name: file.suggestedFilename(), text: readFileSync(await file.path(), 'utf8') };
    };
    const project = await saved('#save-project');
    assert.equal(project.name, 'court.project.json');
    assert.deepEqual(JSON.parse(project.text).measures, before);
    const csv = await saved('#export-csv');
    assert.ok(csv.text.includes(`Distance 1,Distance,8,,1,${before[0].points[0].join()}`), csv.text);
    assert.match((await saved('#export-dxf')).text, /POLYLINE[\s\S]*EOF/);
    assert.ok(!(await page.isVisible('#export-geojson')));
    await page.click('#measure-list .name');
    await page.click('#measure-list [data-key^=remove]');
    assert.equal((await rows(page)).length, 0);
    const open = (text) => page.setInputFiles('#project-file', { name: 'file.json', mimeType: 'application/json', buffer: Buffer.from(text) });
    await look(page, fromNorth);
    await open(project.text);
    await page.waitForSelector('#measure-list .name');
    assert.deepEqual(await measures(page), before);
    await page.waitForFunction((eye) => location.hash.includes(eye), `eye=${at(10, -14, 14)}`);
    for (const [text, why] of [['{', /no JSON/], [project.text.replace('"distance"', '"spline"'), /measures\[0\]\.kind/], [project.text.replace('"court"', '"elsewhere"'), /“elsewhere”/]]) {
      await open(text);
      await page.waitForFunction((pattern) => new RegExp(pattern).test(document.getElementById('toast-detail').textContent), why.source);
      assert.deepEqual(await measures(page), before);
    }
  }));
});
