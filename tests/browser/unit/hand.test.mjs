// What stops who walks, what fingers and wheels mean, what is left of a push, and whose a key is. Oracle of walking: scenes
// whose surface is known exactly; pictures of them are drawn as one goes, as the server would, a few steps late.

import assert from 'node:assert/strict';
import { describe, it } from 'node:test';

import { anchorUnder, leastDistanceTo, mostDistanceTo } from '../../../client/web/view/anchor.js';
import { eyeOf, fromProtocol, move, project } from '../../../client/web/view/camera.js';
import { Fingers } from '../../../client/web/view/fingers.js';
import { Grip, zoomed } from '../../../client/web/view/grip.js';
import { coveredFrom, liftOf, reachAhead, summaryOf } from '../../../client/web/view/ground.js';
import { HeldKeys } from '../../../client/web/view/held_keys.js';
import { glide, glideEnds, Momentum, noStep } from '../../../client/web/view/inertia.js';
import { heldKeys, isForView, keyTable } from '../../../client/web/view/keys.js';
import { coveredShare, remembering } from '../../../client/web/view/seen.js';
import { length, subtract } from '../../../client/web/view/vectors.js';
import { random } from '../support/cameras.mjs';
import { plane, seenOf, town } from '../support/depth_scenes.mjs';

const size = { width: 1200, height: 800 };
const aspect = 1.5;
const { bounds } = town;
const limits = { bounds, hasGround: true, least: leastDistanceTo(town), most: mostDistanceTo(town) };
const near = (actual, wanted, tolerance, what) =>
  assert.ok(Math.abs(actual - wanted) <= tolerance, `${what}: ${actual} instead of ${wanted}`);
const from = (eye, target) => fromProtocol({ type: 'perspective', eye, target, up: [0, 0, 1], fov: 45 });
const pictureOf = (camera, surface = town.all) => seenOf(surface, camera, aspect, bounds, 64, 36);

/** A key that is held for five seconds at 30 steps a second; pictures come `late` steps after they were asked for. */
function fly(start, places, { late = 4, surface = town.all, collides = true, seconds = 5 } = {}) {
  const keys = new HeldKeys();
  for (const code of places) keys.down({ code, key: code, shiftKey: false });
  let camera = start, known = [pictureOf(start, surface)], lowest = Infinity;
  const coming = [];
  for (let i = 0; i < 30 * seconds; ++i) {
    if (i % late === 0) coming.push(camera);
    if (i % late === 0 && coming.length > 2) known = remembering(known, pictureOf(coming.shift(), surface));
    camera = keys.advance(camera, 1 / 30, { size, limits, pictures: collides ? known : [], known, stops: collides, looksAround: false });
    lowest = Math.min(lowest, eyeOf(camera)[2]);
  }
  return { camera, lowest, covered: coveredShare(pictureOf(camera, surface)) };
}

describe('walking', () => {
  it('five seconds of W never end in the void or under the ground, wherever one begins', () => {
    const next = random(21);
    const starts = [
      from([0, -250, 180], [0, 0, 0]), from([-250, 0, 60], [0, 0, 10]), from([0, 0, 400], [0, 1, 0]), // from afar, from above
      from([0, -40, 1.7], [0, 0, 1.7]), from([0, -40, 1.7], [0, -80, 1.7]), from([60, 0, 1.7], [100, 0, 4]), // at eye level
      from([-30, 0, 8], [-15, 0, 8]), from([0, 0, 3], [0, 20, 9]), // at the tree, at the wall
      ...Array.from({ length: 5 }, () => {
        const eye = [next() * 120 - 60, next() * 120 - 80, 1.5 + next() * 30];
        const a = next() * 2 * Math.PI;
        return from(eye, [eye[0] + Math.cos(a), eye[1] + Math.sin(a), eye[2] - 0.6 * next()]);
      }),
    ];
    for (const [i, start] of starts.entries()) {
      const before = coveredShare(pictureOf(start));
      const { lowest, covered } = fly(start, ['KeyW']);
      assert.ok(lowest > 0, `start ${i}: fell through the ground, to ${lowest}`);
      assert.ok(covered >= Math.min(before, 0.05), `start ${i}: ${covered} covered, ${before} before`);
    }
  });

  it('stops before the wall, and does not pass the tree', () => {
    const wall = fly(from([5, -20, 5], [5, 20, 5]), ['KeyW']);
    const [, y] = eyeOf(wall.camera);
    assert.ok(y < 20 - 0.9 * limits.least && y > 10, `stands at y = ${y}`);
    const tree = fly(from([-40, 0, 8], [-15, 0, 8]), ['KeyW']);
    assert.ok(length(subtract(eyeOf(tree.camera), [-15, 0, 8])) > 4, 'inside the tree');
  });

  it('whoever wants to passes through', () => {
    const { camera } = fly(from([5, 0, 5], [5, 20, 5]), ['KeyW'], { collides: false });
    assert.ok(eyeOf(camera)[1] > 20 - limits.least, 'was stopped');
  });

  it('goes down to the ground and along it, not through it, also where the ground is out of sight', () => {
    for (const keys of [['KeyQ'], ['KeyW', 'KeyQ'], ['KeyQ', 'KeyD'], ['KeyQ', 'KeyS']]) {
      const { lowest } = fly(from([-50, -50, 3], [0, -48, 3]), keys);
      assert.ok(lowest > 0.5 * limits.least, `${keys}: down to ${lowest}`);
    }
    const along = fly(from([-50, -50, 6], [-20, -50, 0]), ['KeyW']);
    assert.ok(eyeOf(along.camera)[0] > -35, 'stuck on the ground');
  });

  it('knows what one picture says', () => {
    const seen = pictureOf(from([-50, -50, 3], [0, -48, 3]));
    const { covered, near: close, floor } = summaryOf(seen);
    near(floor, 0, 0.1, 'the ground');
    near(covered, 0.5, 0.1, 'covered');
    assert.ok(close > 6 && close < 12, `${close}`);
    assert.equal(summaryOf(pictureOf(from([0, 0, 50], [0, 1, 90]))).near, undefined, 'the sky');
    const sky = from([0, 0, 50], [0, 1, 90]);
    assert.ok(Number.isFinite(reachAhead([pictureOf(sky)], sky, limits)) && Number.isFinite(reachAhead([], sky, limits)));
  });

  it('does not take a wall close by for the ground', () => {
    // As high as the eye, a step aside, and only the wall is steeply below.
    const beside = from([0, 19, 5], [10, 19.3, 5]);
    const { floor } = summaryOf(pictureOf(beside, town.wall));
    assert.equal(floor, undefined);
    const { lowest } = fly(beside, ['KeyQ']);
    assert.ok(lowest < 2 && lowest > 0.5 * limits.least, `${lowest}`);
  });

  it('foresees what a picture from elsewhere will show', () => {
    const start = from([-50, -50, 3], [0, -48, 3]);
    const seen = pictureOf(start);
    near(coveredFrom(seen, start), coveredShare(seen), 0.03, 'from the same place');
    for (const steps of [{ ahead: 20 }, { right: 1 }, { ahead: 2 }]) {
      const later = move(start, steps);
      near(coveredFrom(seen, later), coveredShare(pictureOf(later)), 0.15, JSON.stringify(steps));
    }
    assert.equal(coveredFrom(seen, from([-50, -50, 3], [-90, -50, 3])), 0, 'behind');
  });

  it('the ground lifts only who sinks', () => {
    const start = from([0, -40, 10], [0, 0, 0]);
    const known = [pictureOf(start)];
    assert.equal(liftOf(known, start, move(start, { up: 5 }), limits), 0);
    assert.equal(liftOf(known, start, move(start, { ahead: 1 }), limits), 0);
    const under = move(from([0, -20, 4], [0, 0, 0]), { up: -8 });
    near(liftOf(known, from([0, -20, 4], [0, 0, 0]), under, limits, limits.least), 4 + limits.least, 0.3, 'lift');
    const beside = plane([0, 0, 0], [0, 0, 1], ([x]) => x > 0);
    const pit = from([-60, 0, 10], [20, 0, 0]);
    const thing = { ...limits, hasGround: false };
    assert.equal(liftOf([pictureOf(pit, beside)], pit, move(pit, { up: -15 }), thing), 0, 'there is no ground');
    near(liftOf([], pit, move(pit, { up: -15 }), limits, 1), 5 + 1, 1e-9, 'the cloud ends there');
  });
});

describe('a grip', () => {
  const start = from([0, -60, 30], [0, 0, 0]);
  const pictures = [pictureOf(start)];
  const cursor = { x: 500, y: 500 };
  const anchor = anchorUnder(pictures[0], start, cursor, size, bounds);
  const world = { size, limits, pictures };
  const at = (camera, point = anchor.point) => project(camera, point, size);

  it('holds through many small steps', () => {
    for (const [kind, moves] of [['orbit', 0], ['pan', 1], ['pinch', 1]]) {
      const grip = new Grip(kind, anchor, cursor);
      let camera = start;
      for (let i = 0; i < 40; ++i) camera = grip.move(camera, { ...noStep(), x: 3, y: -2 }, world);
      near(at(camera).x, cursor.x + 120 * moves, 0.01, kind);
      near(at(camera).y, cursor.y - 80 * moves, 0.01, kind);
    }
  });

  it('what fingers twist turns with them, from above and from below; what they spread grows', () => {
    for (const eye of [[0, -60, 30], [0, -60, -30]]) {
      const camera = from(eye, [0, 0, 0]);
      const point = [0, 0, 0];
      const middle = { x: 600, y: 400 };
      const grip = new Grip('pinch', { point }, middle);
      const aside = [5, 0, 0];
      const next = grip.move(camera, { ...noStep(), zoom: Math.log(1.5), twist: 0.3 }, { ...world, limits: { ...limits, hasGround: false }, pictures: [] });
      near(Math.hypot(at(next, point).x - 600, at(next, point).y - 400), 0, 0.01, 'middle');
      const [before, after] = [at(camera, aside), at(next, aside)];
      assert.ok(after.y > before.y, 'clockwise is down on the right');
      assert.ok(after.x - 600 > 1.3 * (before.x - 600), 'larger');
      near(next.distance / camera.distance, 1 / 1.5, 1e-6, 'distance');
    }
  });

  it('orbiting does not lead through the ground, but goes on sideways', () => {
    const grip = new Grip('orbit', anchor, cursor);
    let camera = start;
    for (let i = 0; i < 200; ++i) camera = grip.move(camera, { ...noStep(), x: 5, y: -5 }, world);
    assert.ok(eyeOf(camera)[2] > 0, 'under the ground');
    assert.ok(Math.abs(camera.azimuth - start.azimuth) > 0.5, 'stands');
    near(at(camera).x, cursor.x, 0.01, 'held');
    const free = new Grip('orbit', anchor, cursor);
    const through = { size, pictures: [], limits: { ...limits, hasGround: false } };
    for (let i = 0; i < 200; ++i) camera = free.move(camera, { ...noStep(), y: -5 }, through);
    assert.ok(eyeOf(camera)[2] < 0, 'who wants to look from below may');
  });

  it('going backwards does not sink into the ground', () => {
    let camera = from([0, -40, 2], [0, 20, 12]);
    const known = [pictureOf(camera)];
    for (let i = 0; i < 20; ++i) camera = zoomed(camera, { point: [0, 20, 12], of: 'surface' }, 1.2, { ...world, pictures: known });
    assert.ok(eyeOf(camera)[2] > 0, `${eyeOf(camera)}`);
    assert.ok(length(subtract(eyeOf(camera), [0, 20, 12])) <= limits.most * 1.01);
  });
});

describe('zooming towards nothing', () => {
  it('ends before the void, and comes to a cloud that is far away', () => {
    for (const [eye, target, cursor] of [[[0, -40, 1.7], [0, 20, 15], { x: 900, y: 60 }], [[-60, 0, 8], [-15, 0, 8], { x: 300, y: 60 }],
      [[0, -900, 500], [0, 0, 0], { x: 60, y: 60 }]]) {
      let camera = from(eye, target);
      let known = [pictureOf(camera)];
      const before = coveredShare(known[0]);
      const anchor = anchorUnder(known[0], camera, cursor, size, bounds);
      assert.equal(anchor.of, 'plane');
      for (let notch = 0; notch < 14; ++notch) {
        camera = zoomed(camera, anchor, 0.82, { size, limits, pictures: known });
        if (notch % 3 === 2) known = remembering(known, pictureOf(camera));
      }
      const covered = coveredShare(pictureOf(camera));
      assert.ok(covered >= Math.min(before, 0.1) / 2, `${covered} covered, ${before} before`);
    }
  });
});

describe('fingers', () => {
  it('one moves, two also pinch and, past a dead zone, twist; a fourth is left out', () => {
    const fingers = new Fingers();
    fingers.down(1, { x: 100, y: 100 });
    assert.deepEqual(fingers.move(1, { x: 110, y: 95 }), { x: 10, y: -5, zoom: 0, twist: 0 });
    fingers.down(2, { x: 210, y: 95 });
    const spread = fingers.move(2, { x: 310, y: 95 });
    near(spread.zoom, Math.log(2), 1e-12, 'zoom');
    assert.equal(spread.x, 50);
    assert.equal(fingers.move(2, { x: 310, y: 105 }).twist, 0, 'a little');
    const steps = [1, 2, 3, 4, 5].map((i) => fingers.move(2, { x: 310, y: 105 + 20 * i }).twist);
    assert.ok(steps.at(-1) > 0 && steps.every((twist) => twist >= 0), 'clockwise');
    assert.ok(fingers.down(3, { x: 0, y: 0 }));
    assert.equal(fingers.move(3, { x: 30, y: 0 }).x, 10, 'a third of the way');
    assert.ok(!fingers.down(4, { x: 1, y: 1 }));
    assert.equal(fingers.move(4, { x: 2, y: 2 }), undefined);
    assert.ok(fingers.up(3) && !fingers.up(3));
    assert.equal(fingers.count, 2);
  });

  it('too near to each other they say nothing wild', () => {
    const fingers = new Fingers();
    fingers.down(1, { x: 100, y: 100 });
    fingers.down(2, { x: 100, y: 100 });
    assert.ok(Math.abs(fingers.move(2, { x: 104, y: 100 }).zoom) < 1e-9);
  });
});

describe('inertia', () => {
  const push = (rest) => {
    const momentum = new Momentum();
    for (let t = 0; t <= 100; t += 10) momentum.add({ ...noStep(), x: 8 }, t);
    return momentum.speed(100 + rest);
  };

  it('goes on as fast as the hand was, and stands within 300 ms', () => {
    const speed = push(0);
    near(speed.x, 0.9, 0.15, 'px a millisecond');
    const whole = glide(speed, 0, 1000).x;
    assert.ok(whole > 30 && whole < 120, `${whole} px`);
    assert.equal(glide(speed, 300, 1000).x, 0);
    assert.ok(glideEnds(300) && !glideEnds(200));
    let sum = 0;
    for (let t = 0; t < 300; t += 16) sum += glide(speed, t, t + 16).x;
    near(sum, whole, 1e-9, 'in pieces');
  });

  it('is nothing after a rest, or of a hand that hardly moved', () => {
    assert.equal(push(60), undefined);
    assert.equal(new Momentum().speed(5), undefined);
    const slow = new Momentum();
    for (let t = 0; t < 100; t += 10) slow.add({ ...noStep(), x: 0.1 }, t);
    assert.equal(slow.speed(95), undefined);
  });
});

describe('whose a key is', () => {
  /** As much of an element as is asked: `closest` finds what `kinds` names. */
  const element = (localName, type, ...kinds) => ({
    localName, type,
    closest: (selector) => ([localName, ...kinds].some((kind) => selector.split(', ').includes(kind)) ? {} : null),
    matches: () => false,
  });
  const asks = (target, key, more = {}) => isForView({ target, key, code: key, ...more });

  it("text fields keep all of theirs; menus, sliders and buttons only what works them", () => {
    for (const type of ['text', 'number', 'password', 'search']) assert.ok(!asks(element('input', type), 'w'), type);
    assert.ok(!asks(element('textarea'), 'w'));
    for (const target of [element('select'), element('input', 'range'), element('input', 'checkbox'), element('button', 'button')]) {
      for (const key of ['w', '1', 'f', '+', '?']) assert.ok(asks(target, key), `${key} on ${target.localName}`);
    }
    assert.ok(!asks(element('select'), 'ArrowDown') && !asks(element('input', 'range'), 'ArrowLeft') && !asks(element('select'), 'Home'));
    const radio = element('button', 'button', '[role="radio"]');
    assert.ok(!asks(radio, 'ArrowLeft') && asks(radio, 'w'));
    assert.ok(!asks(element('canvas'), 'w', { defaultPrevented: true }), 'somebody else has used it');
    assert.ok(asks(element('button', 'submit'), 'ArrowLeft') && !asks(element('button', 'submit'), 'Enter'));
    assert.ok(asks(element('canvas'), 'ArrowLeft') && asks(element('body'), 'Enter') && asks(undefined, 'w'));
    assert.ok(!asks(element('div', '', 'dialog'), 'w'), 'a dialog');
    for (const held of ['ctrlKey', 'altKey', 'metaKey']) assert.ok(!asks(element('canvas'), 'w', { [held]: true }));
  });

  it('a menu that is open has them all', () => {
    assert.ok(!asks({ ...element('select'), matches: (selector) => selector === 'select:open' }, 'w'));
    assert.ok(asks({ ...element('select'), matches: () => { throw new SyntaxError('no such selector'); } }, 'w'));
  });

  it('the help names every key that is held', () => {
    const named = keyTable.map(([keys]) => keys).join(' ');
    for (const code of Object.keys(heldKeys)) {
      const sign = { ArrowLeft: '←', ArrowRight: '→', ArrowUp: '↑', ArrowDown: '↓', Plus: '+', Minus: '−', PageUp: 'E', PageDown: 'Q' }[code] ?? code.replace('Key', '');
      assert.ok(named.includes(sign), code);
    }
  });
});

describe('held keys', () => {
  const start = from([0, -60, 30], [0, 0, 0]);
  const world = { size, limits, pictures: [], known: [pictureOf(start)], stops: false, looksAround: false };
  const pressed = (code, more = {}) => {
    const keys = new HeldKeys();
    assert.ok(keys.down({ code, key: code, shiftKey: false, ...more }));
    return keys;
  };
  const middle = anchorUnder(world.known[0], start, { x: 600, y: 400 }, size, bounds).point;

  it('arrows orbit about the middle, with Shift they pan, + comes nearer to it', () => {
    const keys = pressed('ArrowLeft');
    let camera = start;
    for (let i = 0; i < 20; ++i) camera = keys.advance(camera, 1 / 30, world);
    near(project(camera, middle, size).x, 600, 0.01, 'orbit');
    assert.ok(Math.abs(camera.azimuth - start.azimuth) > 0.2);
    const panned = pressed('ArrowLeft', { shiftKey: true }).advance(start, 0.1, world);
    assert.ok(project(panned, middle, size).x > 620, 'what is seen moves to the right');
    near(panned.azimuth, start.azimuth, 1e-12, 'direction');
    const nearer = pressed('Equal', { key: '+' }).advance(start, 0.1, world);
    assert.ok(length(subtract(eyeOf(nearer), middle)) < 0.9 * length(subtract(eyeOf(start), middle)));
    near(project(nearer, middle, size).x, 600, 0.01, 'zoom');
  });

  it('the wheel changes the speed of who walks, of nobody else', () => {
    const way = (pixels) => {
      const keys = pressed('KeyW');
      assert.ok(keys.changePace(pixels));
      return length(subtract(eyeOf(keys.advance(start, 0.1, world)), eyeOf(start)));
    };
    assert.ok(way(400) > 2 * way(0) && way(-400) < 0.5 * way(0));
    assert.ok(!pressed('ArrowLeft').changePace(100) && !new HeldKeys().changePace(100));
    assert.ok(way(1e9) <= 16.1 * way(0), 'bounded');
  });

  it('without perspective, W makes larger what is in the middle', () => {
    const flat = { ...start, projection: 'orthographic' };
    const next = pressed('KeyW').advance(flat, 0.1, { ...world, known: [pictureOf(flat)] });
    assert.ok(next.distance < 0.95 * flat.distance);
  });

  it('are let go', () => {
    const keys = pressed('KeyW');
    keys.up({ code: 'KeyW', key: 'w', shiftKey: false });
    assert.ok(keys.areHeld, 'however short, it moves something');
    assert.notDeepEqual(keys.advance(start, 0.02, world).target, start.target);
    assert.ok(!keys.areHeld);
    keys.down({ code: 'KeyW', key: 'w', shiftKey: false });
    keys.advance(start, 0.02, world);
    keys.up({ code: 'KeyW', key: 'w', shiftKey: false });
    assert.ok(!keys.areHeld);
    assert.ok(!keys.down({ code: 'KeyX', key: 'x', shiftKey: false }));
    assert.ok(!keys.down({ code: 'KeyW', key: 'w', shiftKey: false, ctrlKey: true }));
  });

  it('no step leads to NaN', () => {
    for (const code of Object.keys(heldKeys).map((place) => ({ Plus: 'Equal', Minus: 'Minus' })[place] ?? place)) {
      const keys = pressed(code, code === 'Equal' ? { key: '+' } : code === 'Minus' ? { key: '-' } : {});
      for (const known of [[], world.known]) {
        const camera = keys.advance(start, 0.05, { ...world, known, pictures: known, stops: true });
        assert.ok([...camera.target, camera.azimuth, camera.elevation, camera.distance].every(Number.isFinite), code);
      }
    }
  });
});
