// Boxes that cut, without a browser: as the protocol means them, and what a hand does to them.

import assert from 'node:assert/strict';
import { describe, it } from 'node:test';

import { alongNormal, axesOf, edgesOf, facesOf, onLevel, outlineOf, placeIn, rounded, turnedTo, withFaceMoved, withPlaneMoved } from '../../../client/web/clip/box.js';
import { handlesOf } from '../../../client/web/clip/clip_marks.js';
import { add, dot, length, scale, subtract } from '../../../client/web/view/vectors.js';
import { random } from '../support/cameras.mjs';

const near = (found, wanted, tolerance = 1e-9) => found.forEach((value, i) => assert.ok(Math.abs(value - wanted[i]) <= tolerance, `${found} instead of ${wanted}`));
/** By the right-hand rule about an axis, as the protocol says turns. */
const turn = (v, axis, degrees) => {
  const a = (degrees * Math.PI) / 180;
  const cross = [axis[1] * v[2] - axis[2] * v[1], axis[2] * v[0] - axis[0] * v[2], axis[0] * v[1] - axis[1] * v[0]];
  return add(add(scale(v, Math.cos(a)), scale(cross, Math.sin(a))), scale(axis, dot(axis, v) * (1 - Math.cos(a))));
};

describe('a box', () => {
  const next = random(21);
  const some = Array.from({ length: 30 }, () => ({
    center: [4e5 + next(), 5e6, 30], size: [1 + 9 * next(), 1 + 9 * next(), 1 + 9 * next()], turn: [0, 1, 2].map(() => 720 * next() - 360),
  }));
  it('is turned by yaw about Z, then by pitch about its Y, then by roll about its X', () => {
    near(axesOf({ turn: [90, 0, 0] })[0], [0, 1, 0]); // yaw turns +X towards +Y
    for (const { turn: [yaw, pitch, roll] } of some) {
      let axes = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((axis) => turn(axis, [0, 0, 1], yaw));
      const [, y] = axes;
      axes = axes.map((axis) => turn(axis, y, pitch));
      const [x] = axes;
      axes = axes.map((axis) => turn(axis, x, roll));
      axesOf({ turn: [yaw, pitch, roll] }).forEach((axis, i) => near(axis, axes[i]));
    }
  });
  it('has twelve edges of its size, and six faces that look outwards', () => {
    for (const box of some) {
      const lengths = edgesOf(box).map(([a, b]) => length(subtract(b, a)));
      assert.equal(lengths.length, 12);
      box.size.forEach((size, axis) => near(lengths.slice(4 * axis, 4 * axis + 4), [size, size, size, size], 1e-6));
      for (const { at, normal, axis } of facesOf(box)) near([dot(subtract(at, box.center), normal)], [box.size[axis] / 2], 1e-6);
    }
  });
  it('grows by a face while the other stays, and never turns inside out', () => {
    for (const box of some) {
      for (const face of facesOf(box)) {
        const opposite = facesOf(box).find(({ axis, side }) => axis === face.axis && side === -face.side);
        for (const distance of [2, -0.5, -100]) {
          const moved = withFaceMoved(box, face, distance, 0.1);
          near(facesOf(moved).find(({ axis, side }) => axis === opposite.axis && side === opposite.side).at, opposite.at, 1e-6);
          near([moved.size[face.axis]], [Math.max(0.1, box.size[face.axis] + distance)]);
        }
      }
    }
  });
  it('turns to where the hand is, seen from above', () => {
    const [box] = some;
    const turned = turnedTo({ ...box, turn: [10, 0, 0] }, add(box.center, [3, 3, 50]));
    assert.deepEqual(turned.turn, [45, 0, 0]);
    assert.equal(turnedTo(box, add(box.center, [0, 0, 1])), box);
    const up = { ...box, turn: [0, 0, 0] };
    assert.deepEqual(handlesOf({ box: up }).map(({ kind }) => kind).filter((kind) => kind !== 'face'), ['move', 'turn']);
    near(placeIn(up, [1, 1, 1]), add(up.center, scale(up.size, 0.5)));
  });
  it('has the digits that a hand means, and keeps an inside', () => {
    assert.deepEqual(rounded({ center: [389500.123456, 1.00049, -2], size: [12.34567, 3, 1], turn: [0, 0, 0] }), { center: [389500.12, 1, -2], size: [12.35, 3, 1], turn: [0, 0, 0] });
    assert.deepEqual(rounded({ center: [0, 0, 0], size: [1e4, 1e-3, 1] }).size, [1e4, 1e-3, 1]);
  });
});

it('a half-space is drawn as a square of its plane, and moves along its normal', () => {
  const plane = { point: [4e5, 5e6, 30], normal: [1, 2, -2] };
  for (const [a, b] of outlineOf(plane, 6)) {
    near([dot(subtract(a, plane.point), plane.normal), length(subtract(b, a)), length(subtract(a, plane.point))], [0, 6, 3 * Math.SQRT2], 1e-6);
  }
  near(withPlaneMoved(plane, 3, 3).point, [4e5 + 1, 5e6 + 2, 28]);
  assert.deepEqual(handlesOf({ plane }, 5).map(({ kind }) => kind), ['face', 'side']);
  near([dot(subtract(handlesOf({ plane }, 5)[1].at, plane.point), plane.normal)], [3]);
});

it('a drag moves a face by as much as its normal is long on screen, and not where one looks along it', () => {
  assert.equal(alongNormal({ x: 30, y: 5 }, { x: 10, y: 0 }), 3);
  assert.equal(alongNormal({ x: 30, y: 5 }, { x: 0, y: 0 }), 0);
  near(onLevel([0, 0, 10], [1, 0, -2], 0), [5, 0, 0]);
  assert.equal(onLevel([0, 0, 10], [1, 0, 2], 0), undefined);
});
