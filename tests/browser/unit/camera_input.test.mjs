// What events of mouse, pen, fingers and wheel do, without a browser: the input is handed events as one sends them, and a
// surface that is known exactly. Oracle: where the held point is to be seen afterwards.

import assert from 'node:assert/strict';
import { describe, it } from 'node:test';

import { leastDistanceTo, mostDistanceTo } from '../../../client/web/view/anchor.js';
import { eyeOf, fromProtocol, project } from '../../../client/web/view/camera.js';
import { length, subtract } from '../../../client/web/view/vectors.js';
import { seenOf, town, truthUnder } from '../support/depth_scenes.mjs';

const windowHandlers = {};
globalThis.addEventListener = (name, handle) => { windowHandlers[name] = handle; };
const { CameraInput } = await import('../../../client/web/view/camera_input.js');

const size = { width: 1200, height: 800 };
const overview = fromProtocol({ type: 'perspective', eye: [5, -50, 30], target: [0, 0, 2], up: [0, 0, 1], fov: 45 });
const cursor = { x: 500, y: 560 };
const truth = truthUnder(town.all, overview, cursor, size, town.bounds);

/** An input with what a viewer gives it; `send` is an event, `run` lets time pass. */
function handOn(start = overview, more = {}) {
  const handlers = {};
  const element = {
    addEventListener: (name, handle) => { handlers[name] = handle; },
    getBoundingClientRect: () => ({ left: 0, top: 0 }),
    focus() {}, setPointerCapture() {}, classList: { add() {}, remove() {} },
  };
  const view = {
    camera: start, size, pictures: [seenOf(town.all, start, 1.5, town.bounds)], collides: true, calm: false, looksAround: false,
    limits: { bounds: town.bounds, hasGround: true, least: leastDistanceTo(town), most: mostDistanceTo(town) },
    changeCamera(next) { view.camera = next; },
    goTo(next) { view.camera = view.jumped = next; },
    wake() {},
    ...more,
  };
  const input = new CameraInput(element, view);
  let clock = 1000;
  const send = (name, fields) => {
    handlers[name]({ type: name, pointerId: 1, button: 0, buttons: 1, shiftKey: false, ctrlKey: false, deltaX: 0, deltaY: 0, deltaMode: 0,
      timeStamp: clock, preventDefault() {}, ...fields, clientX: fields.x, clientY: fields.y });
  };
  const wait = (milliseconds) => { clock += milliseconds; };
  const begin = performance.now();
  const run = (milliseconds) => {
    for (let t = 0; t < milliseconds; t += 16) view.camera = input.advance(view.camera, 0.016, begin + 20 + t);
    wait(milliseconds);
  };
  const drag = (steps, down = {}, step = [10, -4]) => {
    send('pointerdown', { ...cursor, ...down });
    for (let i = 1; i <= steps; ++i) {
      wait(10);
      send('pointermove', { x: cursor.x + step[0] * i, y: cursor.y + step[1] * i, ...(down.pointerId ? { pointerId: down.pointerId } : {}) });
    }
    return { x: cursor.x + step[0] * steps, y: cursor.y + step[1] * steps };
  };
  const offBy = (point, { x, y }) => {
    const at = project(view.camera, point, size);
    return Math.hypot(at.x - x, at.y - y);
  };
  return { view, input, send, wait, run, drag, offBy };
}

describe('a drag', () => {
  it('orbits about the point under the cursor; a click alone changes nothing', () => {
    const { view, send, drag, offBy } = handOn();
    send('pointerdown', cursor);
    send('pointerup', cursor);
    assert.equal(view.camera, overview);
    drag(20);
    assert.ok(offBy(truth, cursor) <= 3);
    assert.ok(Math.abs(view.camera.azimuth - overview.azimuth) > 0.3);
  });

  it('pans with the right or the middle button, with Shift, with the button of a pen: the point stays under the cursor', () => {
    for (const down of [{ button: 2, buttons: 2 }, { button: 1, buttons: 4 }, { shiftKey: true }, { pointerType: 'pen', buttons: 3 },
      { pointerType: 'pen', button: 2, buttons: 2 }]) {
      const { view, drag, offBy } = handOn();
      const to = drag(20, down);
      assert.ok(offBy(truth, to) <= 3, JSON.stringify(down));
      assert.ok(Math.abs(view.camera.azimuth - overview.azimuth) < 1e-9);
    }
    const pen = handOn();
    pen.drag(20, { pointerType: 'pen' });
    assert.ok(pen.offBy(truth, cursor) <= 3, 'a pen orbits as a mouse does');
  });

  it('turns the head where one looks around', () => {
    const { view, drag } = handOn(overview, { looksAround: true });
    drag(10);
    assert.ok(length(subtract(eyeOf(view.camera), eyeOf(overview))) < 1e-6);
  });

  it('over the sky turns about what is in the middle', () => {
    const level = fromProtocol({ type: 'perspective', eye: [0, -50, 5], target: [0, 0, 5], up: [0, 0, 1], fov: 45 });
    const { view, send, wait } = handOn(level);
    send('pointerdown', { x: 900, y: 50 });
    wait(10);
    send('pointermove', { x: 960, y: 50 });
    assert.deepEqual(view.camera.target.map(Math.round), [0, 0, 5]);
  });
});

describe('what is left of a drag', () => {
  it('glides on for 300 ms, in the direction of the hand', () => {
    const { view, input, send, drag, run, offBy } = handOn();
    const to = drag(20, { button: 2, buttons: 2 });
    send('pointerup', to);
    assert.ok(input.isMoving);
    run(400);
    assert.ok(!input.isMoving);
    const at = project(view.camera, truth, size);
    assert.ok(at.x > to.x + 30 && at.y < to.y - 10, `${at.x - to.x}, ${at.y - to.y}`);
    assert.ok(offBy(truth, to) < 200);
  });

  it('is nothing for who wants no motion, after a rest, when it is interrupted, or when somebody takes hold again', () => {
    const calm = handOn(overview, { calm: true });
    calm.send('pointerup', calm.drag(20));
    assert.ok(!calm.input.isMoving);
    const rested = handOn();
    const to = rested.drag(20);
    rested.wait(80);
    rested.send('pointerup', to);
    assert.ok(!rested.input.isMoving);
    const cancelled = handOn();
    cancelled.drag(20);
    cancelled.send('pointercancel', to);
    assert.ok(!cancelled.input.isMoving);
    const again = handOn();
    again.send('pointerup', again.drag(20));
    again.send('pointerdown', cursor);
    assert.ok(!again.input.isMoving);
    const program = handOn();
    program.send('pointerup', program.drag(20));
    program.input.rest();
    assert.ok(!program.input.isMoving);
  });
});

describe('the wheel', () => {
  const turn = (hand, count, fields = {}) => {
    for (let i = 0; i < count; ++i) {
      hand.send('wheel', { ...cursor, deltaY: -100, ...fields });
      hand.run(60);
    }
    hand.run(400);
  };
  const far = (hand) => length(subtract(eyeOf(hand.view.camera), truth));

  it('comes nearer to the point under the cursor, and stops before it', () => {
    const hand = handOn();
    const start = far(hand);
    turn(hand, 5);
    assert.ok(far(hand) < 0.5 * start && far(hand) > 0.25 * start);
    turn(hand, 60);
    assert.ok(Math.abs(far(hand) - leastDistanceTo(town)) < 0.1, `${far(hand)}`);
    assert.ok(hand.offBy(truth, cursor) <= 3);
    turn(hand, 300, { deltaY: 100 });
    assert.ok(far(hand) <= mostDistanceTo(town) * 1.01);
  });

  it('is smooth, but at once for who wants no motion', () => {
    const hand = handOn();
    hand.send('wheel', { ...cursor, deltaY: -100 });
    assert.equal(hand.view.camera, overview);
    hand.run(16);
    const first = far(hand);
    hand.run(300);
    assert.ok(far(hand) < first && first < far(handOn()));
    const calm = handOn(overview, { calm: true });
    calm.send('wheel', { ...cursor, deltaY: -100 });
    assert.ok(Math.abs(far(calm) - far(hand)) < 1e-6 * far(hand));
    assert.ok(!calm.input.isMoving);
  });

  it('lines and pages count, and many small steps are as much as a large one', () => {
    const [whole, small, lines] = [handOn(), handOn(), handOn()];
    turn(whole, 1, { deltaY: -99 });
    turn(small, 33, { deltaY: -3 });
    turn(lines, 1, { deltaY: -3, deltaMode: 1 });
    for (const hand of [small, lines]) assert.ok(Math.abs(far(hand) / far(whole) - 1) < 1e-3);
  });

  it('a pinch on a touch pad zooms faster; a scroll sideways, or with Shift, pans', () => {
    const pinch = handOn();
    turn(pinch, 10, { deltaY: -5, ctrlKey: true });
    assert.ok(far(pinch) < 0.6 * far(handOn()));
    const sideways = handOn();
    turn(sideways, 4, { deltaX: 15, deltaY: 2 });
    assert.ok(sideways.offBy(truth, { x: cursor.x - 60, y: cursor.y - 8 }) <= 3);
    const shifted = handOn();
    turn(shifted, 2, { deltaX: 30, deltaY: 0, shiftKey: true });
    assert.ok(shifted.offBy(truth, { x: cursor.x - 60, y: cursor.y }) <= 3);
  });

  it('changes the speed of who flies, and moves nothing by itself then', () => {
    const hand = handOn();
    windowHandlers.keydown({ key: 'w', code: 'KeyW', shiftKey: false, preventDefault() {} });
    hand.send('wheel', { ...cursor, deltaY: -300 });
    assert.equal(hand.view.camera, overview);
    assert.ok(hand.input.isMoving, 'the key is held');
    windowHandlers.keyup({ key: 'w', code: 'KeyW', shiftKey: false });
    hand.run(16);
    assert.ok(!hand.input.isMoving);
  });
});

describe('a double-click', () => {
  it('centres the point and comes nearer; with Shift it goes away', () => {
    const hand = handOn();
    hand.send('dblclick', cursor);
    assert.ok(hand.offBy(truth, { x: 600, y: 400 }) <= 3);
    assert.ok(Math.abs(hand.view.camera.distance / length(subtract(eyeOf(overview), truth)) - 0.4) < 0.05);
    const away = handOn();
    away.send('dblclick', { ...cursor, shiftKey: true });
    assert.ok(length(subtract(eyeOf(away.view.camera), truth)) > 2 * length(subtract(eyeOf(overview), truth)));
  });

  it('does nothing where there is nothing, and never ends under the ground', () => {
    const level = fromProtocol({ type: 'perspective', eye: [0, -50, 1.7], target: [0, 0, 12], up: [0, 0, 1], fov: 60 });
    const hand = handOn(level);
    hand.send('dblclick', { x: 1150, y: 20 });
    assert.equal(hand.view.camera, level);
    for (let y = 700; y < 800; y += 20) {
      const again = handOn(level);
      again.send('dblclick', { x: 100, y });
      assert.ok(!again.view.jumped || eyeOf(again.view.jumped)[2] > 0, `under the ground from ${y}`);
    }
  });
});

describe('fingers', () => {
  /** Two of them, 100 px apart around the cursor. */
  function two(hand) {
    hand.send('pointerdown', { x: cursor.x - 50, y: cursor.y, pointerType: 'touch' });
    hand.send('pointerdown', { x: cursor.x + 50, y: cursor.y, pointerId: 2, pointerType: 'touch' });
  }
  const move = (hand, id, x, y) => {
    hand.wait(10);
    hand.send('pointermove', { x, y, pointerId: id, pointerType: 'touch' });
  };

  it('two pinch about what is between them', () => {
    const hand = handOn();
    two(hand);
    for (let i = 1; i <= 10; ++i) {
      move(hand, 1, cursor.x - 50 - 5 * i, cursor.y);
      move(hand, 2, cursor.x + 50 + 5 * i, cursor.y);
    }
    assert.ok(hand.offBy(truth, cursor) <= 3);
    const ratio = length(subtract(eyeOf(hand.view.camera), truth)) / length(subtract(eyeOf(overview), truth));
    assert.ok(Math.abs(ratio - 0.5) < 0.02, `${ratio}`);
  });

  it('one that is left of two does not orbit; a third looks around', () => {
    const hand = handOn();
    two(hand);
    move(hand, 1, cursor.x - 60, cursor.y);
    hand.wait(100);
    hand.send('pointerup', { x: cursor.x - 60, y: cursor.y, pointerType: 'touch' });
    const before = hand.view.camera;
    move(hand, 2, cursor.x + 90, cursor.y + 30);
    assert.equal(hand.view.camera, before);
    hand.send('pointerup', { x: 0, y: 0, pointerId: 2 });
    const three = handOn();
    two(three);
    three.send('pointerdown', { x: cursor.x, y: cursor.y - 80, pointerId: 3, pointerType: 'touch' });
    for (const id of [1, 2, 3]) move(three, id, cursor.x + 40, cursor.y - 40);
    assert.ok(length(subtract(eyeOf(three.view.camera), eyeOf(overview))) < 1e-6);
    assert.notEqual(three.view.camera.azimuth, overview.azimuth);
  });
});
