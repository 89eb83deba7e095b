// The hand against the real server, in the page of the working tree: what it takes hold of stays under the cursor, nobody
// falls through the ground, and keys, fingers and wheels do what the help says.
//
// Oracle: the server's own pick says which point is under a pixel; where that is to be seen afterwards is arithmetic.

import assert from 'node:assert/strict';
import { after, before, describe, it } from 'node:test';

import { length, subtract } from '../../client/web/view/vectors.js';
import { eyeOf } from '../../client/web/view/camera.js';
import { seriousComplaints, startBrowser } from './support/browser.mjs';
import { HandPage, size } from './support/hand.mjs';
import { PageProxy } from './support/page_proxy.mjs';
import { RealServer } from './support/real_server.mjs';
import { writeYard } from './support/scans.mjs';

const program = process.env.SCANCAST_PROGRAM;
if (!program) throw new Error('Set SCANCAST_PROGRAM, such as SCANCAST_PROGRAM=build/release/bin/scancast');

const overview = { eye: [3, -24, 11], target: [0, 4, 2] };
const middle = { x: size.width / 2, y: size.height / 2 };

describe('the hand', { timeout: 240_000 }, () => {
  let yard, server, proxy, browser, address, hand;

  before(async () => {
    yard = writeYard();
    server = new RealServer(program, [yard.file]);
    address = await server.start();
    proxy = new PageProxy(address);
    browser = await startBrowser();
    hand = await HandPage.open(browser, await proxy.start(), address, '#cloud=yard');
  });
  after(async () => {
    const complaints = hand ? seriousComplaints(hand.page) : [];
    await browser?.close();
    await proxy?.stop();
    await server?.stop();
    yard?.remove();
    assert.deepEqual(complaints, []);
  });

  const eyeHeight = () => eyeOf(hand.camera)[2];
  const moved = (from, to) => length(subtract(eyeOf(from), eyeOf(to)));
  /** Pixels where ground, wall and tree are seen, found by picking. */
  const kinds = { ground: ([, , z]) => z < 0.05, wall: ([, y]) => Math.abs(y - 10) < 0.05, tree: ([x, y, z]) => Math.abs(Math.hypot(x + 9, y, z - 5) - 3) < 0.1 };

  it('what is dragged is 3 px off at most: on the ground, the wall and the tree', async () => {
    await hand.look(overview);
    const places = { ground: { x: 420, y: 450 }, wall: { x: 560, y: 250 }, tree: { x: 255, y: 245 } };
    for (const [kind, cursor] of Object.entries(places)) {
      await hand.look(overview);
      const point = await hand.truth(cursor);
      assert.ok(point && kinds[kind](point), `${kind} is not at ${cursor.x}, ${cursor.y}, but ${point}`);
      const errors = await hand.errors(cursor);
      for (const [act, error] of Object.entries(errors)) assert.ok(error <= 3, `${act} on the ${kind}: ${error} px`);
    }
  });

  it('fourteen notches end before the ground, the wall and the tree', async () => {
    for (const cursor of [{ x: 420, y: 450 }, { x: 560, y: 250 }, { x: 255, y: 245 }]) {
      await hand.look(overview);
      const point = await hand.truth(cursor);
      const far = length(subtract(eyeOf(hand.camera), point));
      await hand.notches(cursor, 14);
      assert.ok(await hand.wire.covered() > 0.5, 'in the void');
      assert.ok(eyeHeight() > 0, 'under the ground');
      const left = length(subtract(eyeOf(hand.camera), point));
      assert.ok(left < 0.12 * far && left > 0.2, `${left} of ${far} are left`);
      assert.ok(hand.offBy(point, cursor) <= 3);
    }
  });

  it('five seconds of W end before what is ahead', async () => {
    for (const view of [overview, { eye: [0, -10, 1.7], target: [0, 10, 1.7] }, { eye: [0, -10, 1.7], target: [0, -20, 1.7] }]) {
      await hand.look(view);
      await hand.hold('w', 5000);
      const [, y, z] = eyeOf(hand.camera);
      assert.ok(z > 0.2, `under the ground: ${z}`);
      assert.ok(y < 10, 'behind the wall');
      assert.ok(await hand.wire.covered() > 0.03, `${await hand.wire.covered()} covered`);
    }
  });

  it('C lets who wants to pass through', async () => {
    await hand.look({ eye: [0, 4, 3], target: [0, 10, 3] });
    await hand.page.keyboard.press('c');
    await hand.page.keyboard.down('w');
    for (let i = 0; i < 60 && eyeOf(hand.camera)[1] < 10; ++i) await hand.page.waitForTimeout(150);
    await hand.page.keyboard.up('w');
    assert.ok(eyeOf(hand.camera)[1] > 10, 'was stopped');
    await hand.page.keyboard.press('c');
  });

  it('a double-click centres the point and comes nearer, with Shift it goes away; Enter does so for the middle', async () => {
    await hand.look(overview);
    const cursor = { x: 400, y: 450 };
    const point = await hand.truth(cursor);
    const start = length(subtract(eyeOf(hand.camera), point));
    await hand.page.mouse.dblclick(cursor.x, cursor.y);
    await hand.settle();
    assert.ok(hand.offBy(point, middle) <= 3, `${hand.offBy(point, middle)} px from the middle`);
    const near = length(subtract(eyeOf(hand.camera), point));
    assert.ok(near < 0.5 * start && near > 1, `${near} of ${start}`);
    await hand.page.keyboard.down('Shift');
    await hand.page.mouse.dblclick(middle.x, middle.y);
    await hand.page.keyboard.up('Shift');
    await hand.settle();
    assert.ok(length(subtract(eyeOf(hand.camera), point)) > 2 * near);
    const before = hand.camera;
    await hand.page.keyboard.press('Enter');
    await hand.settle();
    assert.ok(hand.camera.distance < 0.5 * before.distance);
  });

  it('what is thrown glides on, until somebody takes hold of it; not for who wants no motion', async () => {
    await hand.look(overview);
    // In the page: how fast a real hand's events come here depends on what else the machine does.
    const fling = () => hand.page.evaluate(async () => {
      const canvas = document.getElementById('picture');
      canvas.setPointerCapture = () => {}; // only real pointers can be captured
      const send = (type, clientX) => canvas.dispatchEvent(new PointerEvent(type, { pointerId: 9, clientX, clientY: 420, bubbles: true, button: 2, buttons: 2 }));
      send('pointerdown', 300);
      for (let i = 1; i <= 8; ++i) {
        send('pointermove', 300 + 40 * i);
        for (const until = performance.now() + 6; performance.now() < until;);
      }
      send('pointerup', 620);
    });
    const point = await hand.truth({ x: 300, y: 420 });
    await fling();
    await hand.settle();
    assert.ok(hand.offBy(point, { x: 620, y: 420 }) > 30, 'it stood at once');
    await hand.page.emulateMedia({ reducedMotion: 'reduce' });
    await hand.look(overview);
    await fling();
    await hand.settle();
    assert.ok(hand.offBy(point, { x: 620, y: 420 }) <= 3, 'it went on');
    await hand.page.emulateMedia({ reducedMotion: null });
  });

  it('keys steer whatever has the focus, but for text fields', async () => {
    await hand.look(overview);
    const walked = async (key) => {
      const before = hand.camera;
      await hand.hold(key, 200);
      return moved(before, hand.camera) > 0.05;
    };
    if (await hand.page.getAttribute('#toggle-panel', 'aria-expanded') !== 'true') await hand.page.click('#toggle-panel');
    for (const selector of ['#cloud', '#shading', '#color input:checked', '#orthographic']) {
      await hand.page.focus(selector);
      assert.ok(await hand.page.evaluate((at) => document.activeElement === document.querySelector(at), selector), `no focus: ${selector}`);
      const value = await hand.page.evaluate((at) => document.querySelector(at).value, selector);
      assert.ok(await walked('s'), selector);
      assert.equal(await hand.page.evaluate((at) => document.querySelector(at).value, selector), value, selector);
    }
    await hand.page.focus('#shading');
    await hand.page.keyboard.press('1');
    await hand.settle();
    assert.ok(hand.camera.elevation > 1.5, 'not from the top');
    await hand.look(overview);
    await hand.page.evaluate(() => document.querySelector('#color input[value=elevation]').click());
    await hand.page.waitForSelector('#range-low', { state: 'attached' });
    await hand.page.evaluate(() => document.getElementById('range-low').focus());
    assert.equal(await hand.page.evaluate(() => document.activeElement.id), 'range-low');
    assert.ok(!(await walked('w')) && !(await walked('ArrowUp')), 'a text field keeps its keys');
    await hand.page.focus('#detail');
    const detail = await hand.page.inputValue('#detail');
    const before = hand.camera;
    await hand.page.keyboard.press('ArrowDown');
    assert.notEqual(await hand.page.inputValue('#detail'), detail, 'a menu keeps its arrows');
    assert.ok(moved(before, hand.camera) < 1e-3);
    await hand.page.click('#toggle-panel'); // beside it the picture is narrower
    await hand.settle();
  });

  it('arrows orbit, with Shift they pan; + and - zoom; Home is the first view', async () => {
    await hand.page.focus('#picture');
    await hand.look(overview);
    const point = await hand.truth(middle);
    const before = hand.camera;
    await hand.hold('ArrowLeft', 400);
    assert.ok(hand.offBy(point, middle) <= 3, `${hand.offBy(point, middle)} px`);
    assert.ok(Math.abs(hand.camera.azimuth - before.azimuth) > 0.1, `turned by ${hand.camera.azimuth - before.azimuth}`);
    await hand.look(overview);
    await hand.page.keyboard.down('Shift');
    await hand.hold('ArrowLeft', 300);
    await hand.page.keyboard.up('Shift');
    assert.ok(hand.offBy(point, middle) > 30);
    await hand.look(overview);
    await hand.hold('+', 300);
    assert.ok(hand.offBy(point, middle) <= 3);
    assert.ok(length(subtract(eyeOf(hand.camera), point)) < 0.9 * length(subtract(eyeOf(before), point)));
    const first = await (await fetch(`${address}api/v1/clouds`)).json();
    await hand.page.keyboard.press('Home');
    await hand.settle();
    const { eye, target } = first.clouds[0].view.camera;
    const [a, b] = [subtract(eye, target), subtract(eyeOf(hand.camera), hand.camera.target)];
    assert.ok(length(subtract(a.map((v) => v / length(a)), b.map((v) => v / length(b)))) < 1e-3);
  });

  it('a pinch on a touch pad zooms, a scroll to the side pans', async () => {
    await hand.look(overview);
    const cursor = { x: 560, y: 250 };
    const point = await hand.truth(cursor);
    await hand.page.mouse.move(cursor.x, cursor.y);
    const before = length(subtract(eyeOf(hand.camera), point));
    await hand.page.keyboard.down('Control');
    for (let i = 0; i < 10; ++i) await hand.page.mouse.wheel(0, -5);
    await hand.page.keyboard.up('Control');
    await hand.settle();
    const after = length(subtract(eyeOf(hand.camera), point));
    assert.ok(after < 0.7 * before && after > 0.4 * before, `${after} of ${before}`);
    assert.ok(hand.offBy(point, cursor) <= 3);
    await hand.page.mouse.wheel(40, 0);
    await hand.settle();
    assert.ok(hand.offBy(point, { x: cursor.x - 40, y: cursor.y }) <= 3, `${hand.offBy(point, { x: cursor.x - 40, y: cursor.y })}`);
  });
});

describe('fingers', { timeout: 120_000 }, () => {
  let yard, server, proxy, browser, hand, cdp;

  before(async () => {
    yard = writeYard();
    server = new RealServer(program, [yard.file]);
    const address = await server.start();
    proxy = new PageProxy(address);
    browser = await startBrowser();
    hand = await HandPage.open(browser, await proxy.start(), address, '#cloud=yard', { hasTouch: true });
    cdp = await hand.page.context().newCDPSession(hand.page);
  });
  after(async () => {
    await browser?.close();
    await proxy?.stop();
    await server?.stop();
    yard?.remove();
  });

  /** Moves fingers from where they are to where they go, at rest at last. */
  async function touch(paths) {
    const at = (t) => paths.map(([[x0, y0], [x1, y1]], id) => ({ id, x: x0 + (x1 - x0) * t, y: y0 + (y1 - y0) * t }));
    await cdp.send('Input.dispatchTouchEvent', { type: 'touchStart', touchPoints: at(0) });
    for (let i = 1; i <= 10; ++i) await cdp.send('Input.dispatchTouchEvent', { type: 'touchMove', touchPoints: at(i / 10) });
    await hand.page.waitForTimeout(90);
    await cdp.send('Input.dispatchTouchEvent', { type: 'touchEnd', touchPoints: [] });
    await hand.settle();
  }

  it('one orbits, two pan, pinch and twist, three look around', async () => {
    const cursor = { x: 400, y: 430 };
    await hand.look(overview);
    const point = await hand.truth(cursor);
    await touch([[[400, 430], [460, 400]]]);
    assert.ok(hand.offBy(point, cursor) <= 3, 'one');
    await hand.look(overview);
    const start = hand.camera;
    await touch([[[340, 430], [300, 460]], [[460, 430], [540, 460]]]);
    assert.ok(hand.offBy(point, { x: 420, y: 460 }) <= 5, `two: ${hand.offBy(point, { x: 420, y: 460 })} px`);
    const nearer = length(subtract(eyeOf(hand.camera), point)) / length(subtract(eyeOf(start), point));
    assert.ok(Math.abs(nearer - 0.5) < 0.05, `${nearer}`);
    await hand.look(overview);
    await touch([[[340, 430], [350, 390]], [[460, 430], [450, 470]]]);
    assert.ok(hand.camera.azimuth - start.azimuth > 0.3, `a twist: ${hand.camera.azimuth - start.azimuth}`);
    assert.ok(hand.offBy(point, cursor) <= 5);
    await hand.look(overview);
    await touch([[[340, 430], [400, 430]], [[400, 350], [460, 350]], [[460, 430], [520, 430]]]);
    assert.ok(length(subtract(eyeOf(hand.camera), eyeOf(start))) < 0.01, 'three: the eye stays');
    assert.ok(Math.abs(hand.camera.azimuth - start.azimuth) > 0.02, 'three: it looks around');
  });
});
