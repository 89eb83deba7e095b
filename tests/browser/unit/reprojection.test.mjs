// Oracle of the poses: project() of camera.js, which knows neither matrices nor the protocol. Of the meshes: planes, whose
// 1 / depth is linear in the picture, so that every corner's is known.

import assert from 'node:assert/strict';
import { describe, it } from 'node:test';

import { fromProtocol, pointUnderCursor, project, toProtocol } from '../../../client/web/view/camera.js';
import { cameraOf as cameraOfWords } from '../../../client/web/view/camera_words.js';
import { depthMesh } from '../../../client/web/view/depth_mesh.js';
import { withMargin } from '../../../client/web/view/margin.js';
import { gridOf } from '../../../client/web/view/mesh_triangles.js';
import { backdropScale, placeToClip, poseOf, seesTheSame, similarityOf } from '../../../client/web/view/pose.js';
import { random } from '../support/cameras.mjs';

const size = { width: 960, height: 600 };
const aspect = size.width / size.height;
const middle = [389500, 5819800, 40]; // as surveys have them
const bounds = { min: middle.map((value) => value - 100), max: middle.map((value) => value + 100) };

const next = random(21);
const cameraOf = (projection) => ({
  target: middle.map((value) => value + 20 * next() - 10), azimuth: 6 * next() - 3, elevation: 2 * next() - 1,
  distance: 150 + 100 * next(), fov: 40 + 30 * next(), projection, upAxis: 'z',
});
const nearby = (camera, projection) => ({
  ...camera, projection, azimuth: camera.azimuth + 0.2, elevation: camera.elevation - 0.1, distance: camera.distance * 0.9,
});

/** A point's place in the picture of `camera`, as placeToClip() takes it, and in pixels. */
function seen(camera, point) {
  const at = project(camera, point, size);
  // An orthographic camera's eye is outside of the cloud; depth counts from there.
  const { eye } = toProtocol(camera, bounds);
  const depth = at.depth + Math.hypot(...eye.map((value, i) => value - camera.target[i])) - camera.distance;
  const [x, y] = [(2 * at.x) / size.width - 1, 1 - (2 * at.y) / size.height];
  return { at, depth, place: camera.projection === 'orthographic' ? [x, y, depth, 1] : [x, y, 1, 1 / depth] };
}

function applied(matrix, place) {
  const [x, y, z, w] = [0, 1, 2, 3].map((row) => place.reduce((sum, value, column) => sum + matrix[4 * column + row] * Math.fround(value), 0));
  return { x: ((1 + x / w) / 2) * size.width, y: ((1 - y / w) / 2) * size.height, z: z / w, w };
}

const kinds = ['perspective', 'orthographic'];
const depths = { least: 20, greatest: 600 };

describe('where a place of one picture is in another', () => {
  for (const from of kinds) {
    for (const to of kinds) {
      it(`${from} to ${to}: where project() has the point, to a hundredth of a pixel`, () => {
        for (let i = 0; i < 200; ++i) {
          const before = cameraOf(from);
          const after = nearby(before, to);
          const matrix = placeToClip(poseOf(before, bounds, aspect), poseOf(after, bounds, aspect), depths);
          const points = [0, 1].map(() => middle.map((value) => value + 60 * next() - 30));
          const [a, b] = points.map((point) => ({ got: applied(matrix, seen(before, point).place), wanted: seen(after, point) }));
          for (const { got, wanted } of [a, b]) {
            assert.ok(Math.hypot(got.x - wanted.at.x, got.y - wanted.at.y) < 0.01, `${got.x}, ${got.y} instead of ${wanted.at.x}, ${wanted.at.y}`);
            assert.ok(Math.abs(got.z) < 1, 'it would be cut off');
          }
          if (Math.abs(a.wanted.depth - b.wanted.depth) > 1) {
            assert.equal(a.got.z < b.got.z, a.wanted.depth < b.wanted.depth, 'the farther one hides the nearer one');
          }
        }
      });
    }
  }

  it('is where it was, in the same picture and in that with a margin around it', () => {
    for (const kind of kinds) {
      const camera = cameraOf(kind);
      const stretch = { x: 1.1, y: 1.2 };
      const [plain, wide] = [poseOf(camera, bounds, aspect), poseOf(camera, bounds, aspect, stretch)];
      const same = applied(placeToClip(plain, plain, depths), kind === 'orthographic' ? [0.3, -0.4, 200, 1] : [0.3, -0.4, 1, 1 / 200]);
      assert.ok(Math.hypot(same.x - 624, same.y - 420) < 0.01);
      const inner = applied(placeToClip(wide, plain, depths), kind === 'orthographic' ? [0.3, -0.4, 200, 1] : [0.3, -0.4, 1, 1 / 200]);
      assert.ok(Math.hypot(inner.x - (480 + 0.33 * 480), inner.y - (300 + 0.48 * 300)) < 0.01);
      assert.deepEqual(backdropScale(wide, plain).map((value) => value.toFixed(9)), ['1.100000000', '1.200000000']);
      assert.ok(seesTheSame(plain, wide));
      assert.ok(!seesTheSame(plain, poseOf(nearby(camera, kind), bounds, aspect)));
    }
  });

  it('rolled cameras are seen as the server draws them', () => {
    const [c, r] = [Math.cos(0.5), Math.sin(0.5)];
    // Looks north from (0, -10, 0), its head turned by half a radian: right (c, 0, r), up (-r, 0, c), back (0, -1, 0).
    const viewMatrix = [c, -r, 0, 0, 0, 0, -1, 0, r, c, 0, 0, 0, 0, -10, 1];
    const rolled = poseOf(cameraOfWords({ type: 'perspective', viewMatrix, fov: 90 }, { eye: [0, -10, 0], target: [0, 0, 0] }), bounds, aspect);
    const upright = poseOf(fromProtocol({ eye: [0, -10, 0], target: [0, 0, 0], fov: 90 }), bounds, aspect);
    const { x, y } = applied(placeToClip(rolled, upright, depths), [0, 0.5, 1, 0.1]); // 5 above in the rolled picture
    assert.ok(Math.hypot(x - (480 - 0.5 * r * 300), y - (300 - 0.5 * c * 300)) < 0.01, `${x}, ${y}`);
  });

  it('without depth, what is looked at shifts and grows as pan and zoom have it', () => {
    for (const kind of kinds) {
      const before = cameraOf(kind);
      const [held, there] = [{ x: 400, y: 300 }, { x: 460, y: 270 }].map((cursor) => pointUnderCursor(before, cursor, size));
      const moved = { ...before, target: before.target.map((value, i) => value + held[i] - there[i]), distance: before.distance * 0.8 };
      const fit = similarityOf(poseOf(before, bounds, aspect), poseOf(moved, bounds, aspect));
      const at = project(moved, before.target, size);
      assert.ok(Math.abs((1 + fit.x) * 480 - at.x) < 0.1 && Math.abs((1 - fit.y) * 300 - at.y) < 0.1);
      assert.ok(Math.abs(fit.scale - 1 / 0.8) < 1e-3, `${fit.scale}`);
    }
  });
});

describe('the margin', () => {
  it('is so many pixels around the same picture', () => {
    for (const kind of kinds) {
      const camera = cameraOf(kind);
      const view = { ...size, method: 'cone', camera: toProtocol(camera, bounds) };
      const larger = withMargin(view);
      assert.deepEqual([larger.view.width, larger.view.height, larger.view.method], [960 + 2 * 38, 600 + 2 * 24, 'cone']);
      const there = fromProtocol(larger.view.camera);
      for (let i = 0; i < 20; ++i) {
        const point = middle.map((value) => value + 60 * next() - 30);
        const [a, b] = [project(camera, point, size), project(there, point, larger.view)];
        assert.ok(Math.hypot(b.x - 38 - a.x, b.y - 24 - a.y) < 1e-3, 'a pixel is somewhere else');
      }
    }
  });

  it('is none where the picture may not be larger', () => {
    const view = { ...size, camera: toProtocol(cameraOf('perspective'), bounds) };
    assert.equal(withMargin(view, 960 * 600), undefined);
    assert.equal(withMargin({ ...view, camera: { ...view.camera, fov: 170 } }), undefined);
  });
});

const [width, height] = [40, 24];
const cells = (inverseAt) => ({
  width, height, inverse: Float32Array.from({ length: width * height }, (_, i) => inverseAt((i % width) + 0.5, Math.floor(i / width) + 0.5)),
});

/** Corners of a mesh as { x, y } in cells from the picture's top left, and nearness. */
function cornersOf(mesh) {
  const grid = gridOf(mesh.columns, mesh.rows);
  return (corner) => ({ x: grid[4 * corner + 2] * width, y: grid[4 * corner + 3] * height, nearness: mesh.nearness[corner] });
}

const trianglesOf = (mesh) => {
  const at = cornersOf(mesh);
  return Array.from({ length: mesh.triangles.length / 3 }, (_, i) => [0, 1, 2].map((k) => at(mesh.triangles[3 * i + k])));
};
const areaOf = ([a, b, c]) => Math.abs((b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y)) / 2;

describe('the mesh of a depth', () => {
  it('of a plane is that plane, in few triangles, without holes and without anything made up', () => {
    const plane = (x, y) => 0.01 + 0.0001 * x + 0.0003 * y;
    const mesh = depthMesh(cells(plane), false);
    const triangles = trianglesOf(mesh);
    for (const corner of triangles.flat()) {
      const isInside = corner.x >= 1 && corner.x <= width - 1 && corner.y >= 1 && corner.y <= height - 1;
      if (isInside) assert.ok(Math.abs(corner.nearness - plane(corner.x, corner.y)) < 1e-6, `${corner.x}, ${corner.y}`);
    }
    const area = triangles.reduce((sum, one) => sum + areaOf(one), 0);
    // And a quarter of the picture more at each side.
    assert.ok(Math.abs(area - width * 1.5 * height * 1.5) < 0.01, `${area}`);
    assert.ok(triangles.length < width * height, `${triangles.length} triangles`);
    assert.equal(mesh.filling.squares.length, 0);
  });

  it('has no cracks where small triangles meet large ones', () => {
    const bump = (x, y) => 0.01 + 0.0001 * x + 0.002 * Math.exp(-((x - 21) ** 2 + (y - 10) ** 2) / 16);
    const edges = new Map();
    for (const [a, b, c] of trianglesOf(depthMesh(cells(bump), false))) {
      for (const ends of [[a, b], [b, c], [c, a]]) {
        const key = ends.map(({ x, y, nearness }) => `${x.toFixed(3)} ${y.toFixed(3)} ${nearness}`).sort().join(' - ');
        edges.set(key, { count: (edges.get(key)?.count ?? 0) + 1, ends });
      }
    }
    const isOutside = ({ x, y }) => x < -1 || x > width + 1 || y < -1 || y > height + 1;
    const open = [...edges.values()].filter(({ count, ends }) => count === 1 && !ends.every(isOutside));
    assert.deepEqual(open, []);
  });

  it('parts at edges; behind them the farther side goes on, and bridges lead there', () => {
    // A post before a wall, both seen flat: 1 / 10 and 1 / 100.
    const post = (x) => (x > 12 && x < 15 ? 0.1 : 0.01);
    const mesh = depthMesh(cells(post), false);
    for (const triangle of trianglesOf(mesh)) {
      assert.ok(new Set(triangle.map(({ nearness }) => nearness.toFixed(4))).size === 1, 'a triangle from post to wall');
    }
    const behind = new Set();
    const { squares, ...counts } = mesh.filling;
    assert.deepEqual(counts, { behind: 3 * height, across: 2 * height, backdrop: 0 });
    for (let i = 0; i < squares.length; i += 20) {
      for (let corner = 0; corner < 4; ++corner) {
        const u = squares[i + 5 * corner + 3] * width;
        assert.ok(u <= 12.001 || u >= 14.999, 'the post is seen behind the post');
      }
      if (i >= 20 * counts.behind) {
        const nearness = [0, 1, 2, 3].map((corner) => squares[i + 5 * corner + 2]);
        assert.ok(Math.abs(Math.max(...nearness) - 0.1) < 1e-6 && Math.abs(Math.min(...nearness) - 0.01) < 1e-6, 'no bridge');
        continue;
      }
      assert.ok(Math.abs(squares[i + 2] - 0.01) < 1e-6, 'not of the wall');
      behind.add(Math.round(((squares[i] + 1) / 2) * width));
    }
    assert.deepEqual([...behind].sort((a, b) => a - b), [12, 13, 14]);
  });

  it('leaves the backdrop where it is: rows of it, from side to side', () => {
    const house = (x, y) => (x > 10 && x < 30 && y > 8 ? 0.02 : 0);
    const mesh = depthMesh(cells(house), false);
    const { squares, backdrop, across } = mesh.filling;
    assert.deepEqual([squares.length, backdrop, across], [20 * height, height, 0]);
    for (let row = 0; row < height; ++row) {
      assert.deepEqual([squares[20 * row + 2], squares[20 * row]], [0, -1.5]);
      assert.ok(squares[20 * row + 3] * width < 10, 'the house is no backdrop');
    }
    const area = trianglesOf(mesh).reduce((sum, one) => sum + areaOf(one), 0);
    assert.ok(area >= 20 * 16 && area < 20 * 16 * 1.5, `${area}`);
  });

  it('of an orthographic picture is linear in depth', () => {
    const depth = (x, y) => 100 + 2 * x + 3 * y;
    const mesh = depthMesh(cells((x, y) => 1 / depth(x, y)), true);
    for (const corner of trianglesOf(mesh).flat()) {
      const isInside = corner.x >= 1 && corner.x <= width - 1 && corner.y >= 1 && corner.y <= height - 1;
      if (isInside) assert.ok(Math.abs(mesh.deepest - corner.nearness - depth(corner.x, corner.y)) < 1e-3);
    }
    assert.ok(mesh.deepest > depth(width, height) - 3 && mesh.depths.least > 100);
  });

  it('of nothing at all is nothing', () => {
    const mesh = depthMesh(cells(() => 0), false);
    assert.equal(mesh.triangles.length, 0);
    assert.equal(mesh.filling.squares.length, 20 * height);
  });
});
