// The handles of what cuts, drawn by a mouse, against the real server: each kind changes the view's word as the hand meant it, and the picture
// with it. SCANCAST_PROGRAM names the server's program; CTest sets it.
//
// Oracle: the scan is a level court of green ground, so whether a place of it is drawn is the colour of the pixel there.

import assert from 'node:assert/strict';
import { after, before, beforeEach, afterEach, describe, it } from 'node:test';

import { facesOf, placeIn } from '../../client/web/clip/box.js';
import { project } from '../../client/web/view/camera.js';
import { closePage, openPage, startBrowser, waitUntilSharp } from './support/browser.mjs';
import { RealServer } from './support/real_server.mjs';
import { courtOrigin, writeCourt } from './support/scans.mjs';

const program = process.env.SCANCAST_PROGRAM;
if (!program) throw new Error('Set SCANCAST_PROGRAM, such as SCANCAST_PROGRAM=build/release/bin/scancast');

const at = (x, y, z = 0) => [x, y, z].map((value, axis) => value + courtOrigin[axis]);
/** Beside the court's red spot. */
const fromAbove = `eye=${at(11, 4.9, 30)}&target=${at(11, 5, 0)}&up=0,0,1&projection=perspective&fov=45`;

describe('handles', { timeout: 120_000 }, () => {
  let scan, server, browser, url, page;

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
  beforeEach(async () => {
    page = await openPage(browser, `${url}#cloud=court&${fromAbove}`, { viewport: { width: 1440, height: 800 } });
    await waitUntilSharp(page, 40_000);
  });
  afterEach(async () => assert.deepEqual(await closePage(page), []));

  const placeOf = async (point) => project(await page.evaluate(() => document.getElementById('view').viewer.camera), point, await page.evaluate(() => {
    const { clientWidth, clientHeight } = document.getElementById('picture');
    return { width: clientWidth, height: clientHeight };
  }));
  const shapes = () => page.evaluate(() => document.getElementById('view').viewer.view.clips);

  /** Whether the court's ground is drawn there. */
  const isDrawn = async (point) => {
    const place = await placeOf(point);
    return page.evaluate(({ x, y }) => {
      const canvas = document.getElementById('picture');
      const scale = canvas.width / canvas.clientWidth;
      const [r, g, b] = canvas.getContext('2d').getImageData(Math.round(x * scale), Math.round(y * scale), 1, 1).data;
      return g > r + 10 && g > b + 10;
    }, place);
  };
  /** Ground that is to be seen and ground that is not, in the court's own coordinates. */
  async function shows(seen, unseen, when) {
    await waitUntilSharp(page);
    for (const [x, y] of seen) assert.ok(await isDrawn([x, y, courtOrigin[2]]), `${when}: nothing is drawn at ${x - courtOrigin[0]}, ${y - courtOrigin[1]}`);
    for (const [x, y] of unseen) assert.ok(!(await isDrawn([x, y, courtOrigin[2]])), `${when}: ${x - courtOrigin[0]}, ${y - courtOrigin[1]} is drawn`);
  }

  async function drag(from, to) {
    await page.mouse.move(from.x, from.y);
    await page.mouse.down();
    await page.mouse.move((from.x + to.x) / 2, (from.y + to.y) / 2, { steps: 3 });
    await page.mouse.move(to.x, to.y, { steps: 3 });
    await page.mouse.up();
    await page.waitForTimeout(100);
  }
  const near = (found, wanted, tolerance) => assert.ok(Math.abs(found - wanted) <= tolerance, `${found} instead of ${wanted}`);
  const open = async () => {
    await page.keyboard.press('x');
    await page.waitForSelector('#clipping', { state: 'visible' });
  };

  it('of a box: every face, the middle, the arm', async () => {
    await open();
    await page.click('#clip-add');
    // Low, so that all of its handles are near the ground that they stand on in the picture.
    for (const [axis, value] of [['X', 6], ['Y', 4], ['Z', 1]]) {
      await page.fill(`#clip-list input[aria-label="Size ${axis}"]`, String(value));
      await page.keyboard.press('Enter');
    }
    let [{ box }] = await shapes();
    const on = (a, b) => placeIn(box, [a, b, 0]);
    const all = [[0.9, 0], [-0.9, 0], [0, 0.85], [0, -0.85]].map(([a, b]) => on(a, b));
    await shows(all, [[1.15, 0], [-1.15, 0], [0, 1.25], [0, -1.25]].map(([a, b]) => on(a, b)), 'a box');
    for (const [axis, side] of [[0, 1], [0, -1], [1, 1], [1, -1]]) {
      const before = box;
      const face = facesOf(box).find((one) => one.axis === axis && one.side === side);
      const beyond = face.at.map((value, i) => value + face.normal[i] * 0.5);
      await shows([], [beyond], 'before');
      await drag(await placeOf(face.at), await placeOf(face.at.map((value, i) => value + face.normal[i])));
      [{ box }] = await shapes();
      near(box.size[axis], before.size[axis] + 1, 0.06);
      assert.deepEqual(box.size.toSpliced(axis, 1), before.size.toSpliced(axis, 1), 'the other sizes');
      const opposite = facesOf(box).find((one) => one.axis === axis && one.side === -side).at;
      opposite.forEach((value, i) => near(value, facesOf(before).find((one) => one.axis === axis && one.side === -side).at[i], 0.01));
      await shows([beyond], [], `face ${axis}, ${side}`);
    }
    // The middle: 2 to the west and 1 to the south.
    let before = box;
    const gone = on(0.9, 0);
    await drag(await placeOf(box.center), await placeOf(box.center.map((value, axis) => value + [-2, -1, 0][axis])));
    [{ box }] = await shapes();
    assert.deepEqual(box.size, before.size);
    [-2, -1, 0].forEach((way, axis) => near(box.center[axis] - before.center[axis], way, 0.08));
    await shows([on(0.9, 0), on(-0.9, 0), on(0, -0.85)], [gone], 'moved');
    // The arm, by a quarter.
    before = box;
    const arm = await page.locator('#clips .turn .dot').boundingBox();
    const reach = 1.3 * (box.size[0] / 2);
    const across = [on(0.9, 0), placeIn(box, [0, 1.2, 0])];
    await drag({ x: arm.x + arm.width / 2, y: arm.y + arm.height / 2 }, await placeOf([box.center[0], box.center[1] + reach, box.center[2] + box.size[2] / 2]));
    [{ box }] = await shapes();
    near(box.turn[0], 90, 2);
    assert.deepEqual([box.center, box.size], [before.center, before.size]);
    await shows([on(0.9, 0), on(-0.9, 0), across[1]], [across[0]], 'turned');
    // What is outside.
    await page.selectOption('#clip-list select', 'outside');
    await page.waitForTimeout(100);
    await shows([across[0]], [on(0.8, 0), on(0, 0)], 'outside');
  });

  it('of a half-space: along its normal', async () => {
    await open();
    await page.click('#clip-add-plane');
    for (const [axis, value] of [['X', 1], ['Z', 0]]) {
      await page.fill(`#clip-list input[aria-label="Normal ${axis}"]`, String(value));
      await page.keyboard.press('Enter');
    }
    const [{ plane }] = await shapes();
    assert.deepEqual(plane.normal, [1, 0, 0]);
    const [x, y] = plane.point;
    await shows([[x + 1, y], [x + 5, y]], [[x - 1, y]], 'the east');
    const { point } = plane;
    await drag(await placeOf(point), await placeOf([x + 3, y, point[2]]));
    let [{ plane: moved }] = await shapes();
    near(moved.point[0], x + 3, 0.06);
    assert.deepEqual(moved.point.slice(1), point.slice(1));
    await shows([[x + 4, y]], [[x + 2, y]], 'farther east');
    await page.click('#clip-list [data-key=flip-0]');
    await page.waitForTimeout(100);
    await shows([[x + 2, y], [x - 1, y]], [[x + 4, y]], 'turned over');
    await drag(await placeOf(moved.point), await placeOf([x - 2, y, point[2]]));
    [{ plane: moved }] = await shapes();
    near(moved.point[0], x - 2, 0.06);
    await shows([[x - 3, y]], [[x - 1, y]], 'the west');
  });
});
