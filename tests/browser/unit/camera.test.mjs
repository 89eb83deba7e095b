// Oracles: geometry that holds for every camera - a rotation keeps lengths, a point that is held stays where it is -
// tried on many seeded random cameras.

import assert from 'node:assert/strict';
import { describe, it } from 'node:test';

import * as cam from '../../../client/web/view/camera.js';
import { dot, length, subtract } from '../../../client/web/view/vectors.js';
import { manyCameras, random } from '../support/cameras.mjs';

const size = { width: 1200, height: 800 };
const near = (actual, wanted, tolerance, what) =>
  assert.ok(Math.abs(actual - wanted) <= tolerance, `${what}: ${actual} instead of ${wanted}`);
const sameVector = (a, b, tolerance, what) => near(length(subtract(a, b)), 0, tolerance, what);

/** Which way is up, by what the axis is called. */
const upOf = (camera) => ({ z: [0, 0, 1], y: [0, 1, 0], '-y': [0, -1, 0] })[camera.upAxis];

describe('orbit', () => {
  it('keeps the distance from eye to target, and the target', () => {
    for (const camera of manyCameras()) {
      const next = cam.orbit(camera, 137, -52, size);
      assert.deepEqual(next.target, camera.target);
      near(length(subtract(cam.eyeOf(next), next.target)), camera.distance, camera.distance * 1e-9, 'distance');
    }
  });

  it('never turns over at the pole: up stays up, however far one drags', () => {
    for (const camera of manyCameras()) {
      for (const dy of [1e5, -1e5]) {
        const next = cam.orbit(camera, 0, dy, size);
        assert.ok(dot(cam.axes(next).up, upOf(camera)) >= -1e-12, 'the picture stands on its head');
        assert.equal(Math.abs(next.elevation), Math.PI / 2);
        // And back again: no dead way at the pole.
        assert.ok(Math.abs(cam.orbit(next, 0, -Math.sign(dy) * 10, size).elevation) < Math.PI / 2);
      }
    }
  });

  it('takes the near side along with the hand', () => {
    // A point between eye and target moves to the right when the hand drags to the right.
    for (const camera of manyCameras()) {
      if (Math.abs(camera.elevation) > 1.2) continue;
      const eye = cam.eyeOf(camera);
      const point = camera.target.map((value, i) => value + (eye[i] - value) * 0.3);
      const before = cam.project(camera, point, size);
      assert.ok(cam.project(cam.orbit(camera, 20, 0, size), point, size).x > before.x);
      assert.ok(cam.project(cam.orbit(camera, 0, 20, size), point, size).y > before.y);
    }
  });
});

describe('axes', () => {
  it('are orthonormal and right-handed', () => {
    for (const camera of manyCameras()) {
      const { right, up, back } = cam.axes(camera);
      for (const axis of [right, up, back]) near(length(axis), 1, 1e-12, 'length');
      near(dot(right, up), 0, 1e-12, 'right · up');
      near(dot(up, back), 0, 1e-12, 'up · back');
      const cross = [right[1] * up[2] - right[2] * up[1], right[2] * up[0] - right[0] * up[2], right[0] * up[1] - right[1] * up[0]];
      sameVector(cross, back, 1e-12, 'right × up');
    }
  });
});

describe('look', () => {
  it('keeps the eye where it is', () => {
    for (const camera of manyCameras()) {
      const eye = cam.eyeOf(camera);
      sameVector(cam.eyeOf(cam.look(camera, 91, -37, size)), eye, camera.distance * 1e-9 + length(eye) * 1e-9, 'eye');
    }
  });
});

describe('move', () => {
  it('walks where one looks: what lay ahead is reached', () => {
    for (const camera of manyCameras()) {
      const next = cam.move(camera, { ahead: camera.distance });
      sameVector(cam.eyeOf(next), camera.target, camera.distance * 1e-8 + length(camera.target) * 1e-9, 'eye');
    }
  });
});

describe('fit', () => {
  it('shows every corner, and at least one of them near the border', () => {
    const next = random(7);
    for (const camera of manyCameras()) {
      const min = [0, 1, 2].map(() => next() * 100 - 50);
      const bounds = { min, max: min.map((value) => value + 0.1 + next() * 80) };
      const fitted = cam.fit(camera, bounds, size);
      let farthest = 0;
      for (let i = 0; i < 8; ++i) {
        const corner = [0, 1, 2].map((axis) => bounds[i & (1 << axis) ? 'max' : 'min'][axis]);
        const seen = cam.project(fitted, corner, size);
        assert.ok(seen && seen.x >= 0 && seen.x <= size.width && seen.y >= 0 && seen.y <= size.height, 'a corner is cut off');
        farthest = Math.max(farthest, Math.abs(seen.x - 600) / 600, Math.abs(seen.y - 400) / 400);
      }
      assert.ok(farthest > 0.8, `the cloud is lost in the picture: ${farthest}`);
    }
  });

  it('keeps out of what lies over the picture', () => {
    const bounds = { min: [0, 0, 0], max: [3, 2, 1] };
    const free = { width: 600, height: 500 };
    for (const camera of manyCameras()) {
      const fitted = cam.fit(camera, bounds, size, free);
      for (let i = 0; i < 8; ++i) {
        const corner = [0, 1, 2].map((axis) => bounds[i & (1 << axis) ? 'max' : 'min'][axis]);
        const seen = cam.project(fitted, corner, size);
        assert.ok(Math.abs(seen.x - 600) <= 300 && Math.abs(seen.y - 400) <= 250, 'a corner is covered');
      }
    }
  });

  it('standard views look along the axes, north up', () => {
    const bounds = { min: [0, 0, 0], max: [4, 6, 2] };
    const [camera] = manyCameras();
    sameVector(cam.axes(cam.standardView(camera, 'top', bounds, size)).back, [0, 0, 1], 1e-12, 'top');
    sameVector(cam.axes(cam.standardView(camera, 'top', bounds, size)).up, [0, 1, 0], 1e-12, 'north');
    sameVector(cam.axes(cam.standardView(camera, 'front', bounds, size)).right, [1, 0, 0], 1e-12, 'front');
    sameVector(cam.axes(cam.standardView(camera, 'side', bounds, size)).right, [0, 1, 0], 1e-12, 'side');
    // Where Y is up, the front is the side that one sees looking along -Z: the way modellers turn their things.
    const modelled = cam.axes(cam.standardView({ ...camera, upAxis: 'y' }, 'front', bounds, size));
    sameVector(modelled.back, [0, 0, 1], 1e-12, 'front, Y up');
    sameVector(modelled.up, [0, 1, 0], 1e-12, 'front, Y up');
  });
});

describe('fittedInto', () => {
  const wide = { width: 1600, height: 900 };

  it('into all of a picture of 16:9 changes nothing', () => {
    for (const camera of manyCameras()) near(cam.fittedInto(camera, wide, wide).distance / camera.distance, 1, 1e-12, 'distance');
  });

  it('what was seen of the plane looked at, and nearer, is seen in the part that is free', () => {
    const next = random(11);
    for (const camera of manyCameras()) {
      const window = { width: 400 + next() * 1600, height: 300 + next() * 900 };
      const free = { width: window.width * (0.3 + 0.7 * next()), height: window.height * (0.3 + 0.7 * next()) };
      const into = cam.fittedInto(camera, window, free);
      assert.deepEqual(into.target, camera.target);
      for (const cursor of [{ x: 0, y: 0 }, { x: 1600, y: 900 }, { x: 0, y: 900 }, { x: 800, y: 450 }, { x: next() * 1600, y: next() * 900 }]) {
        const onPlane = cam.pointUnderCursor(camera, cursor, wide);
        const eye = cam.eyeOf(camera);
        for (const point of [onPlane, onPlane.map((value, i) => value + (eye[i] - value) * 0.4)]) {
          const seen = cam.project(into, point, window);
          const slack = 1e-6 * window.width;
          assert.ok(Math.abs(seen.x - window.width / 2) <= free.width / 2 + slack, 'covered at a side');
          assert.ok(Math.abs(seen.y - window.height / 2) <= free.height / 2 + slack, 'covered above or below');
        }
      }
    }
  });

  it('fills that part: one pair of its sides is reached', () => {
    const window = { width: 1000, height: 1000 };
    for (const free of [window, { width: 500, height: 900 }, { width: 900, height: 300 }]) {
      for (const camera of manyCameras()) {
        const seen = cam.project(cam.fittedInto(camera, window, free), cam.pointUnderCursor(camera, { x: 0, y: 0 }, wide), window);
        const reached = Math.max((500 - seen.x) / (free.width / 2), (500 - seen.y) / (free.height / 2));
        near(reached, 1, 1e-6, 'reached');
      }
    }
  });
});

describe('where -Y is up', () => {
  it('up, front and the way one moves are turned, and stay right-handed', () => {
    const bounds = { min: [0, 0, 0], max: [4, 6, 2] };
    const camera = { ...manyCameras()[0], upAxis: '-y' };
    const front = cam.axes(cam.standardView(camera, 'front', bounds, size));
    sameVector(front.up, [0, -1, 0], 1e-12, 'front');
    sameVector(front.back, [0, 0, -1], 1e-12, 'a depth camera looks along +z');
    sameVector(front.right, [1, 0, 0], 1e-12, 'and has x to the right');
    sameVector(cam.axes(cam.standardView(camera, 'top', bounds, size)).back, [0, -1, 0], 1e-12, 'top');
    const moved = cam.move(camera, { up: 3 });
    sameVector(subtract(moved.target, camera.target), [0, -3, 0], 1e-9, 'upwards');
  });

  it("reads a depth camera's own view", () => {
    const read = cam.fromProtocol({ type: 'perspective', eye: [0, 0, 0], target: [0, 0, 3], up: [0, -1, 0], fov: 50 }, '-y');
    near(read.elevation, 0, 1e-12, 'level');
    sameVector(cam.axes(read).up, [0, -1, 0], 1e-12, 'up');
    sameVector(cam.eyeOf(read), [0, 0, 0], 1e-12, 'eye');
  });
});

describe('between', () => {
  it('starts and ends where it should and turns by the shorter way', () => {
    const [a] = manyCameras();
    const from = { ...a, azimuth: 3 }, to = { ...a, azimuth: -3, distance: a.distance * 4 };
    near(cam.between(from, to, 0).azimuth, 3, 1e-12, 'start');
    near(cam.between(from, to, 1).azimuth, -3, 1e-12, 'end');
    assert.ok(Math.abs(cam.between(from, to, 0.5).azimuth) > 3);
    near(cam.between(from, to, 0.5).distance, a.distance * 2, a.distance * 1e-9, 'half-way in the logarithm');
  });
});

describe('protocol', () => {
  it('round trip: what is written is read back', () => {
    for (const camera of manyCameras()) {
      const back = cam.fromProtocol(cam.toProtocol(camera), camera.upAxis);
      sameVector(back.target, camera.target, 0, 'target');
      // An orthographic camera has no field of view on the wire; what it shows is told by the height.
      near(cam.heightAtTarget(back) / cam.heightAtTarget(camera), 1, 1e-6, 'height at the target');
      if (camera.projection === 'perspective') near(back.distance / camera.distance, 1, 1e-6, 'distance');
      near(back.elevation, camera.elevation, 1e-6, 'elevation');
      near(Math.cos(back.azimuth - camera.azimuth), 1, 1e-9, 'azimuth');
      assert.equal(back.projection, camera.projection);
    }
  });

  it('at the poles too, where only the up direction tells the azimuth', () => {
    for (const elevation of [Math.PI / 2, -Math.PI / 2]) {
      for (const azimuth of [-3, -1.5, 0, 0.4, 2.9]) {
        const camera = { target: [1, 2, 3], azimuth, elevation, distance: 5, fov: 60, projection: 'perspective' };
        const wire = cam.toProtocol(camera);
        assert.ok(Math.abs(dot(wire.up, [0, 0, 1])) < 1e-9, 'up is parallel to the view');
        near(cam.fromProtocol(wire).azimuth, azimuth, 1e-6, 'azimuth');
      }
    }
  });

  it('an orthographic eye stands outside the cloud, so that nothing of it is cut off', () => {
    const bounds = { min: [-50, -50, -50], max: [50, 50, 50] };
    for (const camera of manyCameras().map((one) => ({ ...one, projection: 'orthographic', distance: 0.01 }))) {
      const { eye, target } = cam.toProtocol(camera, bounds);
      const ahead = subtract(target, eye);
      for (let i = 0; i < 8; ++i) {
        const corner = [0, 1, 2].map((axis) => (i & (1 << axis) ? 50 : -50));
        assert.ok(dot(subtract(corner, eye), ahead) > 0, 'a corner lies behind the eye');
      }
    }
  });

  it('reads no nonsense', () => {
    const good = { eye: [1, 2, 3], target: [0, 0, 0] };
    assert.ok(cam.fromProtocol(good));
    for (const bad of [undefined, null, {}, { eye: [1, 2], target: [0, 0, 0] }, { eye: [0, 0, 0], target: [0, 0, 0] },
      { eye: [NaN, 0, 0], target: [0, 0, 0] }, { eye: ['1', '2', '3'], target: [0, 0, 0] }, { eye: [1e300, 0, 0], target: [1e299, 0, 0] }]) {
      assert.equal(cam.fromProtocol(bad), undefined);
    }
  });
});

describe('NaN', () => {
  it('never gets in, whatever a broken event carries', () => {
    const isSound = (camera) => [...camera.target, camera.azimuth, camera.elevation, camera.distance].every(Number.isFinite);
    const bounds = { min: [0, 0, 0], max: [NaN, 1, 1] };
    for (const camera of manyCameras().slice(0, 5)) {
      for (const bad of [NaN, Infinity, -Infinity, undefined]) {
        const cursor = { x: bad, y: 5 };
        const results = [
          cam.orbit(camera, bad, 1, size), cam.look(camera, 1, bad, size), cam.move(camera, { ahead: bad }),
          cam.fit(camera, bounds, size), cam.orbit(camera, 1, 1, { width: 0, height: 0 }), cam.between(camera, camera, bad),
        ];
        for (const result of results) assert.ok(isSound(result), JSON.stringify(result));
      }
    }
  });
});
