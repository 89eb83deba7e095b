// What keeps hold of a point. Oracle: the point's own projection before and after, of surfaces that are known exactly.

import assert from 'node:assert/strict';
import { describe, it } from 'node:test';

import { anchorUnder, farthestDepth, leastDistanceTo, mostDistanceTo, surfaceUnder } from '../../../client/web/view/anchor.js';
import * as cam from '../../../client/web/view/camera.js';
import { centerAhead, centerOn, dragTo, focusOn, orbitAbout, turnAbout, zoomTo } from '../../../client/web/view/moves.js';
import { coveredShare, hitAlong, isSeenFree, remembering } from '../../../client/web/view/seen.js';
import { dot, length, mix, subtract } from '../../../client/web/view/vectors.js';
import { manyCameras, random } from '../support/cameras.mjs';
import { plane, seenOf, town, truthUnder } from '../support/depth_scenes.mjs';

const size = { width: 1200, height: 800 };
const aspect = size.width / size.height;
const near = (actual, wanted, tolerance, what) =>
  assert.ok(Math.abs(actual - wanted) <= tolerance, `${what}: ${actual} instead of ${wanted}`);
const apart = (a, b) => Math.hypot(a.x - b.x, a.y - b.y);

/** A point ahead of each camera, and off its middle. */
const held = (camera) => cam.pointUnderCursor(camera, { x: 300, y: 610 }, size, camera.distance * 0.6);

describe('moves that hold a point', () => {
  it('orbiting leaves it at its pixel and at its depth, until the pole and beyond', () => {
    for (const camera of manyCameras()) {
      const point = held(camera);
      for (const [dx, dy] of [[137, -52], [3, 1e4], [-400, 77], [0, -1e4]]) {
        const next = orbitAbout(camera, point, dx, dy, size);
        const seen = cam.project(next, point, size);
        near(apart(seen, { x: 300, y: 610 }), 0, 1e-3, 'pixel');
        near(cam.depthOf(next, point) / (camera.distance * 0.6), 1, 1e-6, 'depth');
        assert.ok(dot(cam.axes(next).up, cam.upwards(next)) >= -1e-12, 'the picture stands on its head');
      }
      const [turned] = [turnAbout(camera, point, 0.3)];
      near(turned.elevation, camera.elevation, 1e-12, 'elevation');
    }
  });

  it('orbiting about the target is what orbiting always was', () => {
    for (const camera of manyCameras()) {
      const [a, b] = [orbitAbout(camera, camera.target, 40, -30, size), cam.orbit(camera, 40, -30, size)];
      near(length(subtract(cam.eyeOf(a), cam.eyeOf(b))), 0, 1e-6 * camera.distance + 1e-9 * length(camera.target), 'eye');
    }
  });

  it('dragging takes it along with the cursor', () => {
    for (const camera of manyCameras()) {
      const point = held(camera);
      const to = { x: 777, y: 123 };
      near(apart(cam.project(dragTo(camera, point, to, size), point, size), to), 0, 1e-3, 'pixel');
    }
  });

  it('zooming leaves it at its pixel; it is approached by shares, and never reached', () => {
    for (const camera of manyCameras()) {
      const point = held(camera);
      const far = length(subtract(cam.eyeOf(camera), point));
      let next = camera;
      for (let notch = 0; notch < 60; ++notch) {
        next = zoomTo(next, point, 0.8, { least: far * 0.01 });
        near(apart(cam.project(next, point, size), { x: 300, y: 610 }), 0, 0.01, 'pixel');
      }
      const left = camera.projection === 'orthographic' ? next.distance / camera.distance : length(subtract(cam.eyeOf(next), point)) / far;
      near(left, camera.projection === 'orthographic' ? Math.max(0.8 ** 60, (far * 0.01) / camera.distance) : 0.01, 1e-6, 'what is left of the way');
      const back = zoomTo(next, point, 1e9, { most: far * 3 });
      near(apart(cam.project(back, point, size), { x: 300, y: 610 }), 0, 0.01, 'pixel');
      assert.ok(length(subtract(cam.eyeOf(back), point)) < far * 12);
    }
  });

  it('limits never throw back: nearer than the least, one stays', () => {
    for (const camera of manyCameras()) {
      const point = held(camera);
      const same = zoomTo(camera, point, 0.5, { least: camera.distance * 9 });
      near(length(subtract(cam.eyeOf(same), cam.eyeOf(camera))), 0, camera.distance * 1e-9, 'eye');
      for (const factor of [0, -1, NaN, Infinity]) assert.equal(zoomTo(camera, point, factor), camera);
    }
  });

  it('setting the target to its depth changes nothing that is seen', () => {
    for (const camera of manyCameras()) {
      const point = held(camera);
      const next = focusOn(camera, point);
      near(cam.depthOf(next, point) / next.distance, 1, 1e-6, 'depth');
      for (const other of [point, camera.target, cam.pointUnderCursor(camera, { x: 900, y: 20 }, size, camera.distance * 2)]) {
        near(apart(cam.project(next, other, size), cam.project(camera, other, size)), 0, 1e-3, 'pixel');
      }
    }
  });

  it('centring has it in the middle, from that distance, keeping the direction or along the line of sight', () => {
    for (const camera of manyCameras()) {
      const point = held(camera);
      const middle = { x: 600, y: 400 };
      const kept = centerOn(camera, point, 3);
      near(apart(cam.project(kept, point, size), middle), 0, 1e-6, 'middle');
      near(dot(cam.axes(kept).back, cam.axes(camera).back), 1, 1e-12, 'direction');
      const along = centerAhead(camera, point, 3);
      near(apart(cam.project(along, point, size), middle), 0, 1e-4, 'middle');
      const [a, b] = [subtract(cam.eyeOf(along), point), subtract(cam.eyeOf(camera), point)];
      near(dot(a, b) / length(a) / length(b), 1, 1e-5, 'line of sight');
    }
  });
});

/** Views of the little town, each with what is to be held there. */
const views = [
  { what: 'flat ground', elevation: 0.7, azimuth: -1.2, distance: 60, target: [10, -20, 0] },
  { what: 'ground, very flat', elevation: 0.12, azimuth: -1.6, distance: 60, target: [10, -20, 0] },
  { what: 'steep wall', elevation: 0.1, azimuth: -1.5, distance: 40, target: [0, 20, 8] },
  { what: 'wall from the side', elevation: 0.2, azimuth: -0.25, distance: 30, target: [0, 20, 8] },
  { what: 'tree', elevation: 0.3, azimuth: 2.5, distance: 25, target: [-15, 0, 8] },
  { what: 'from above', elevation: Math.PI / 2, azimuth: -Math.PI / 2, distance: 150, target: [0, 0, 0] },
].flatMap((view) => ['perspective', 'orthographic'].map((projection) => ({ fov: 45, upAxis: 'z', ...view, projection })));

describe('the surface under the cursor', () => {
  it('is where it is; dragged by half the picture, it is 3 px off at most', () => {
    const next = random(5);
    for (const view of views) {
      const seen = seenOf(town.all, view, aspect, town.bounds);
      let worst = 0, found = 0;
      for (let i = 0; i < 60; ++i) {
        const cursor = { x: 150 + 900 * next(), y: 100 + 600 * next() };
        const truth = truthUnder(town.all, view, cursor, size, town.bounds);
        const anchor = anchorUnder(seen, view, cursor, size, town.bounds);
        near(apart(cam.project(view, anchor.point, size), cursor), 0, 1e-6, 'under the cursor');
        // At edges one of two surfaces is meant, and the depth's cells are 7.5 px wide.
        const edge = [-12, 0, 12].some((dx) => [-12, 0, 12].some((dy) => {
          const other = truthUnder(town.all, view, { x: cursor.x + dx, y: cursor.y + dy }, size, town.bounds);
          return !other !== !truth || (truth && Math.abs(cam.depthOf(view, other) / cam.depthOf(view, truth) - 1) > 0.3);
        }));
        if (!truth || edge) continue;
        ++found;
        assert.equal(anchor.of, 'surface', view.what);
        const to = { x: cursor.x + 400 * (next() - 0.5), y: cursor.y + 300 * (next() - 0.5) };
        worst = Math.max(worst, apart(cam.project(dragTo(view, anchor.point, to, size), truth, size), to));
        const turned = orbitAbout(view, anchor.point, 100, 20, size);
        worst = Math.max(worst, apart(cam.project(turned, truth, size), cursor) / 3);
      }
      assert.ok(found > 5, `${view.what}: only ${found} cursors`);
      assert.ok(worst <= 3, `${view.what}, ${view.projection}: ${worst} px`);
    }
  });

  it('is found in a picture that was drawn from elsewhere, too', () => {
    const next = random(6);
    for (const view of views.filter(({ what }) => what !== 'ground, very flat')) {
      const seen = seenOf(town.all, view, aspect, town.bounds);
      let good = 0, found = 0;
      for (let i = 0; i < 60; ++i) {
        const moved = cam.orbit({ ...view, distance: view.distance * (0.8 + 0.3 * next()) }, 60 * (next() - 0.5), 60 * (next() - 0.5), size);
        const cursor = { x: 300 + 600 * next(), y: 200 + 400 * next() };
        const truth = truthUnder(town.all, moved, cursor, size, town.bounds);
        if (!truth) continue;
        ++found;
        const surface = surfaceUnder(seen, moved, cursor, size, town.bounds);
        if (surface && length(subtract(surface.point, truth)) <= 0.03 * view.distance) ++good;
      }
      assert.ok(good >= 0.8 * found, `${view.what}, ${view.projection}: ${good} of ${found}`);
    }
  });

  it('beside the cursor counts within some pixels; elsewhere a plane does that is not past the cloud', () => {
    const view = { ...views.find(({ what, projection }) => what === 'tree' && projection === 'perspective'), elevation: 0, target: [-15, 0, 10] };
    const seen = seenOf(town.tree, view, aspect, town.bounds);
    const rim = Array.from({ length: 500 }, (_, i) => ({ x: 600 + i, y: 480 })).find((cursor) => !truthUnder(town.tree, view, cursor, size, town.bounds));
    const beside = anchorUnder(seen, view, { x: rim.x + 25, y: rim.y }, size, town.bounds);
    assert.equal(beside.of, 'beside');
    near(beside.depth, 25, 4, 'depth');
    const sky = anchorUnder(seen, view, { x: 50, y: 50 }, size, town.bounds, 1e6);
    assert.equal(sky.of, 'plane');
    assert.ok(sky.depth <= farthestDepth(view, town.bounds));
    near(apart(cam.project(view, sky.point, size), { x: 50, y: 50 }), 0, 1e-6, 'under the cursor');
    const blind = anchorUnder(undefined, view, { x: 50, y: 50 }, size, town.bounds, 12);
    assert.equal(blind.depth, 12);
  });

  it('fourteen notches anywhere on it end before it, and most of the picture is still covered', () => {
    const next = random(8);
    const { bounds } = town;
    const [least, most] = [leastDistanceTo(town), mostDistanceTo(town)];
    for (const view of views) {
      const seen = seenOf(town.all, view, aspect, bounds);
      for (let i = 0; i < 8; ++i) {
        const cursor = { x: 100 + 1000 * next(), y: 100 + 600 * next() };
        let camera = view;
        if (!truthUnder(town.all, view, cursor, size, bounds)) continue;
        const { point } = anchorUnder(seen, view, cursor, size, bounds);
        for (let notch = 0; notch < 14; ++notch) camera = zoomTo(camera, point, 0.8, { least, most });
        if (camera.projection === 'perspective') assert.ok(cam.eyeOf(camera)[2] > 0, `${view.what}: under the ground`);
        const after = seenOf(town.all, camera, aspect, bounds, 40, 24);
        assert.ok(coveredShare(after) > 0.2, `${view.what}: ${coveredShare(after)} covered`);
      }
    }
  });
});

describe('rays through what was seen', () => {
  const view = { target: [0, 20, 5], azimuth: -1.4, elevation: 0.4, distance: 60, fov: 45, projection: 'perspective', upAxis: 'z' };
  const seen = seenOf(town.all, view, aspect, town.bounds);

  it('meet the surface where it is', () => {
    const next = random(9);
    let found = 0;
    for (let i = 0; i < 300; ++i) {
      const origin = [next() * 30 - 15, next() * 30 - 15, 2 + next() * 10];
      const direction = [next() - 0.5, next() - 0.5, -next()];
      const hit = hitAlong(seen, origin, direction, 200);
      if (hit === undefined) continue;
      ++found;
      const truth = town.all(origin, direction);
      // What hides something else from the picture may be met from behind: later, never earlier.
      assert.ok(hit > truth * 0.9 - 1, `${hit} instead of ${truth}`);
    }
    assert.ok(found > 50, `only ${found}`);
  });

  it('see what is free', () => {
    const before = mix(cam.eyeOf(view), view.target, 0.05);
    assert.ok(isSeenFree(seen, [0, 0, 2], before));
    assert.ok(!isSeenFree(seen, [0, 40, 5], before), 'behind the wall');
    assert.ok(!isSeenFree(seen, [0, 0, -3], [0, 0, 10]), 'under the ground');
  });

  it('old pictures stay while they say something new', () => {
    let known = [];
    for (let step = 0; step < 200; ++step) {
      const camera = { ...view, target: [step * 0.5, 20, 5] };
      known = remembering(known, seenOf(plane([0, 0, 0], [0, 0, 1]), camera, aspect, town.bounds, 4, 3));
    }
    assert.ok(known.length >= 6 && known.length <= 8, `${known.length}`);
    const places = known.map((one) => one.camera.target[0]);
    assert.equal(places[0], 99.5);
    for (let i = 1; i < places.length; ++i) assert.ok(places[i] < places[i - 1]);
  });
});

describe('NaN', () => {
  it('never gets into a camera', () => {
    const isSound = (camera) => [...camera.target, camera.azimuth, camera.elevation, camera.distance].every(Number.isFinite);
    for (const camera of manyCameras().slice(0, 6)) {
      for (const bad of [NaN, Infinity, undefined]) {
        const point = [1, bad, 3];
        const cursor = { x: bad, y: 4 };
        const results = [orbitAbout(camera, point, 1, 1, size), orbitAbout(camera, camera.target, bad, 1, size), dragTo(camera, point, { x: 1, y: 1 }, size),
          dragTo(camera, camera.target, cursor, size), zoomTo(camera, point, 0.5), focusOn(camera, point), centerOn(camera, point, 1),
          centerAhead(camera, point, 1), cam.facing(camera, point)];
        for (const result of results) assert.ok(isSound(result), JSON.stringify(result));
      }
    }
  });
});
