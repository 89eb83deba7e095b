// Plans: round lengths, the scale bar, the grid, the view cube, the overview map, classes and the legend - all that is arithmetic.

import assert from 'node:assert/strict';
import { describe, it } from 'node:test';

import { classesWord, onlyOne, shownBy, toggled } from '../../../client/web/page/plan/class_list.js';
import { axisMark, gridOf, labelPlace, planAxis } from '../../../client/web/page/plan/grid.js';
import { classesOf, legendOf, rangeText } from '../../../client/web/page/plan/legend.js';
import { coordinateText, lengthText, roundAbove, roundBelow, unitName } from '../../../client/web/page/plan/lengths.js';
import { mapOf, movedTo, shownOnMap } from '../../../client/web/page/plan/minimap.js';
import { chosenOf, freeStretch, hasNorth } from '../../../client/web/page/plan/on_picture.js';
import { scaleBarOf, unitsPerPixel } from '../../../client/web/page/plan/scale_bar.js';
import { facesSeen, faceText, fromWhere, northMark, onCube, steppedTo, turnedTo } from '../../../client/web/page/plan/view_cube.js';
import { axes, eyeOf, fit, project, standardView } from '../../../client/web/view/camera.js';
import { poseOf } from '../../../client/web/view/pose.js';

const close = (a, b, by = 1e-9) => assert.ok(Math.abs(a - b) <= by * Math.max(1, Math.abs(b)), `${a} is not ${b}`);
const size = { width: 960, height: 600 };
const bounds = { min: [389400, 5819700, 30], max: [389600, 5819900, 70] };
const camera = { target: [389500, 5819800, 40], azimuth: -1.1, elevation: 0.6, distance: 300, fov: 60, projection: 'perspective', upAxis: 'z' };
const pose = (from, of = bounds) => poseOf(from, of, size.width / size.height);
const orthographic = { ...camera, projection: 'orthographic' };
const fromTop = standardView(orthographic, 'top', bounds, size);

describe('lengths', () => {
  it('are round: 1, 2 or 5', () => {
    assert.deepEqual([1, 1.9, 2, 4.99, 5, 9.99, 0.0019, 2e6, 49_999].map(roundBelow), [1, 1, 2, 2, 5, 5, 0.001, 2e6, 20_000]);
    assert.deepEqual([1, 1.01, 2, 2.1, 5, 5.1, 0.0021, 8e6].map(roundAbove), [1, 2, 2, 5, 5, 10, 0.005, 1e7]);
    // What arithmetic leaves of a power of ten is one all the same.
    for (let power = -9; power < 12; ++power) for (const digit of [1, 2, 5]) {
      const exact = Number(`${digit}e${power}`);
      close(roundBelow(exact * (1 + 1e-15)), exact);
      close(roundAbove(exact * (1 - 1e-15)), exact);
      close(roundBelow(0.1 * (exact / 0.1)), exact);
    }
  });
  it('are said in the unit of the coordinate system', () => {
    assert.deepEqual([0.002, 0.05, 1, 500, 2000].map((one) => lengthText(one, 'metre')), ['2 mm', '5 cm', '1 m', '500 m', '2 km']);
    assert.deepEqual([5, 1000].map((one) => lengthText(one, 'millimetre')), ['5 mm', '1 m']);
    assert.deepEqual([0.5, 2000].map((one) => lengthText(one, 'foot')), ['0.5 ft', '2,000 ft']);
    assert.equal(lengthText(100, 'US survey foot'), '100 ft (US)');
    assert.equal(lengthText(0.01, 'degree'), '0.01°');
    assert.deepEqual(['', undefined].map((unit) => lengthText(20, unit)), ['20 units', '20 units']);
    assert.equal(lengthText(1, ''), '1 unit');
    assert.deepEqual(['metre', 'US survey foot', 'chain', ''].map(unitName), ['m', 'ft (US)', 'chain', 'units']);
  });
  it('and coordinates have as many digits as tell them apart', () => {
    assert.deepEqual([coordinateText(389450, 50), coordinateText(-12.5, 0.5), coordinateText(-0.0000001, 0.02), coordinateText(0.3 - 0.1, 0.1)], ['389,450', '−12.5', '0.00', '0.2']);
  });
});

describe('the scale bar', () => {
  it('is the longest round length that fits', () => {
    for (let i = 0; i < 400; ++i) {
      const perPixel = 10 ** (i / 20 - 10);
      const { length, pixels } = scaleBarOf(perPixel, 'metre', 132);
      assert.ok(pixels <= 132 * (1 + 1e-9) && pixels >= 52.7, `${pixels} px`);
      close(pixels * perPixel, length);
    }
  });
  it('without perspective is exact, whatever the margin of a frame', () => {
    const perPixel = unitsPerPixel(pose(fromTop), size.height, 1);
    const [one, other] = [[389450, 5819750, 33], [389460, 5819750, 61]].map((point) => project(fromTop, point, size));
    close((other.x - one.x) * perPixel, 10);
    close(unitsPerPixel(poseOf(fromTop, bounds, 1.6, { x: 1.04, y: 1.04 }), size.height, 1), perPixel);
  });
  it('with it, holds at that depth', () => {
    const { right, back } = axes(camera);
    const at = (depth, aside) => eyeOf(camera).map((value, i) => value - back[i] * depth + right[i] * aside);
    for (const depth of [1, 50, 300]) {
      const width = project(camera, at(depth, 7), size).x - project(camera, at(depth, 0), size).x;
      close(width * unitsPerPixel(pose(camera), size.height, depth), 7, 1e-6);
    }
  });
});

describe('the grid', () => {
  it('is there in plans only', () => {
    assert.equal(planAxis(pose(fromTop)), 2);
    assert.deepEqual(['front', 'back', 'side', 'left', 'bottom'].map((name) => planAxis(pose(standardView(orthographic, name, bounds, size)))), [1, 1, 0, 0, 2]);
    assert.equal(planAxis(pose(camera)), undefined);
    assert.equal(planAxis(pose(orthographic)), undefined);
    assert.equal(planAxis(pose(standardView(camera, 'top', bounds, size))), undefined, 'in perspective');
    assert.equal(gridOf(pose(camera), size), undefined);
    assert.equal(planAxis(pose(standardView({ ...orthographic, upAxis: 'y' }, 'top', bounds, size))), 1, 'a model’s top');
  });
  for (const [name, of] of [['from the top', fromTop], ['from the front', standardView(orthographic, 'front', bounds, size)], ['turned', { ...fromTop, azimuth: 0.7 }],
    ['of a millimetre', { ...fromTop, distance: 0.004 }]]) {
    it(`has lines at round coordinates, where points of them appear: ${name}`, () => {
      const { step, lines } = gridOf(pose(of), size);
      close(step / roundBelow(step), 1);
      assert.ok(lines.length >= 5 && lines.length < 60, `${lines.length} lines`);
      for (const { axis, value, ends } of lines) {
        close(value / step, Math.round(value / step), 1e-9);
        // A point with that coordinate, wherever else, lies on the line.
        for (const shift of [-0.3, 0.2]) {
          const point = of.target.map((at) => at + shift * of.distance * 0.1);
          point[axis] = value;
          const { x, y } = project(of, point, size);
          const [[ax, ay], [bx, by]] = ends;
          const away = Math.abs((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / Math.hypot(bx - ax, by - ay);
          assert.ok(away < 0.02, `${away} px beside the line of ${value}`);
        }
        for (const [x, y] of ends) {
          const onBorder = Math.min(Math.abs(x), Math.abs(x - size.width), Math.abs(y), Math.abs(y - size.height));
          assert.ok(onBorder < 1e-3, 'a line that ends in the picture');
        }
      }
      const apart = (axis) => lines.filter((line) => line.axis === axis).length;
      assert.ok([0, 1, 2].filter((axis) => apart(axis) > 0).length === 2);
    });
  }
  it('writes coordinates where nothing else is', () => {
    const line = { ends: [[300, 0], [300, 600]] };
    const below = labelPlace(line, 'E 389,450', size, []);
    assert.ok(below.bottom > 580 && below.left > 300);
    const taken = [{ left: 250, right: 400, top: 540, bottom: 600 }];
    assert.ok(labelPlace(line, 'E 389,450', size, taken).bottom < 20, 'else at the other end');
    const everywhere = [{ left: 0, right: 960, top: 0, bottom: 600 }];
    assert.equal(labelPlace(line, 'E 389,450', size, everywhere), undefined);
  });
  it('says east and north on maps, axes elsewhere', () => {
    assert.deepEqual([0, 1, 2].map((axis) => axisMark(axis, 'z', true)), ['E', 'N', '']);
    assert.deepEqual([0, 1, 2].map((axis) => axisMark(axis, 'z', false)), ['X', 'Y', 'Z']);
    assert.equal(axisMark(1, 'y', true), 'Y');
    assert.deepEqual([hasNorth({ crsName: 'ETRS89 / UTM zone 33N' }), hasNorth({ crsEpsg: 25833 }), hasNorth({ crsName: '' }), hasNorth(undefined)], [true, true, false, false]);
  });
});

describe('the view cube', () => {
  const seen = (changes) => facesSeen(axes({ ...camera, ...changes }), changes.upAxis ?? 'z');
  it('shows the faces that are turned to the viewer', () => {
    assert.deepEqual(seen({ azimuth: -Math.PI / 2, elevation: 0 }), ['front']);
    assert.deepEqual(seen({ azimuth: -Math.PI / 2, elevation: Math.PI / 2 }), ['top']);
    assert.deepEqual(seen({ azimuth: -Math.PI / 4 - 0.1, elevation: 0.2 }), ['front', 'side', 'top']);
    assert.deepEqual(seen({ azimuth: -Math.PI / 4 - 0.1, elevation: 0.2, upAxis: 'y' }), ['front', 'side', 'top'], 'whatever the axis');
    assert.deepEqual(seen({ azimuth: 3, elevation: -1.4 }), ['bottom', 'left', 'back']);
  });
  it('lies as the picture shows the cloud', () => {
    for (const upAxis of ['z', 'y', '-y']) {
      const from = { ...camera, target: [0, 0, 0], upAxis, distance: 1e6, projection: 'orthographic' };
      const middle = project(from, [0, 0, 0], size);
      const place = [0.3, -0.7, 1];
      const [x, y] = onCube(place, axes(from), upAxis);
      const cloud = { z: place, y: [0.3, 1, 0.7], '-y': [0.3, -1, -0.7] }[upAxis];
      const there = project(from, cloud.map((value) => value * 1e5), size);
      close((there.x - middle.x) / x, (there.y - middle.y) / y, 1e-6);
    }
  });
  it('turns to faces, edges and corners: a plan has north above', () => {
    const from = (direction) => axes(turnedTo(camera, direction)).back;
    for (const direction of [[0, -1, 0], [1, 1, 0], [-1, 0, 1], [1, -1, -1], [0, 0, -1]]) {
      const length = Math.hypot(...direction);
      from(direction).forEach((value, i) => close(value, direction[i] / length, 1e-9));
    }
    const { up, back } = axes(turnedTo(camera, [0, 0, 1]));
    close(up[1], 1);
    close(back[2], 1);
    assert.deepEqual(turnedTo(camera, [1, 0, 0]).target, camera.target);
  });
  it('steps from one to the next by keys', () => {
    const degrees = ({ azimuth, elevation }) => [azimuth, elevation].map((angle) => Math.round((angle * 180) / Math.PI));
    const tilted = { ...camera, azimuth: (-100 * Math.PI) / 180, elevation: (30 * Math.PI) / 180 };
    assert.deepEqual(degrees(steppedTo(tilted, 1, 0)), [-90, 45]);
    assert.deepEqual(degrees(steppedTo(tilted, -1, 0)), [-135, 45]);
    assert.deepEqual(degrees(steppedTo(steppedTo(tilted, 1, 0), 1, 0)), [-45, 45]);
    assert.deepEqual(degrees(steppedTo(tilted, 0, 1)), [-90, 45]);
    assert.deepEqual(degrees(steppedTo({ ...camera, azimuth: 0, elevation: Math.PI / 2 }, 0, 1)), [0, 90]);
  });
  it('says from where in words', () => {
    const words = (azimuth, elevation, upAxis = 'z', north = true) => fromWhere(axes({ ...camera, azimuth: (azimuth * Math.PI) / 180, elevation: (elevation * Math.PI) / 180, upAxis }).back, upAxis, north);
    assert.equal(words(-90, 0), 'the south');
    assert.equal(words(-50, 30), 'the south-east, above');
    assert.equal(words(180, -40), 'the west, below');
    assert.equal(words(10, 85), 'above');
    assert.equal(words(-90, 5, 'y', false), 'the front');
  });
  it('marks north only where it is known; else the axis that lies there', () => {
    assert.deepEqual([northMark('z', true), northMark('z', false), northMark('y', true), northMark('-y', true)], ['N', 'Y', '−Z', 'Z']);
    assert.deepEqual([faceText('front', 'z', true), faceText('side', 'z', true), faceText('top', 'z', true), faceText('front', 'z', false), faceText('front', 'y', true)],
      ['S', 'E', 'Top', 'Front', 'Front']);
  });
});

describe('the overview map', () => {
  const map = mapOf(bounds, 'z');
  const on = (point) => project(map.camera, point, map.size);
  it('has all of the cloud, north above', () => {
    const [southWest, northEast] = [on(bounds.min), on(bounds.max)];
    assert.ok(southWest.x > 0 && northEast.y > 0 && northEast.x < map.size.width && southWest.y < map.size.height);
    assert.ok(southWest.x < northEast.x && southWest.y > northEast.y);
    assert.ok(northEast.x - southWest.x > 0.9 * map.size.width);
  });
  it('shows what a picture shows', () => {
    const near = { ...camera, distance: 60, elevation: 1.2 };
    const { eye, outline } = shownOnMap(map, pose(near), size.width / size.height);
    const there = on(eyeOf(near));
    close(eye[0], there.x, 1e-3);
    close(eye[1], there.y, 1e-3);
    // A corner of the picture is the place on the ground of the target that is seen there.
    outline.forEach(([x, y], i) => {
      const ground = [map.camera.target[0] + ((x - map.size.width / 2) * (bounds.max[0] - bounds.min[0])) / (on(bounds.max).x - on(bounds.min).x),
        map.camera.target[1] - ((y - map.size.height / 2) * (bounds.max[1] - bounds.min[1])) / (on(bounds.min).y - on(bounds.max).y), near.target[2]];
      const seen = project(near, ground, size);
      close(seen.x, [0, size.width, size.width, 0][i], 1e-2);
      close(seen.y, [0, 0, size.height, size.height][i], 1e-2);
    });
    const plan = shownOnMap(map, pose({ ...fromTop, distance: 20 }), size.width / size.height);
    assert.equal(plan.eye, undefined);
    close((plan.outline[1][0] - plan.outline[0][0]) / (plan.outline[3][1] - plan.outline[0][1]), size.width / size.height, 1e-6);
  });
  it('leads to a place, on the level where one is', () => {
    for (const upAxis of ['z', 'y', '-y']) {
      const [of, from] = [mapOf(bounds, upAxis), { ...camera, upAxis }];
      const moved = movedTo(from, of, { x: 40, y: 30 });
      const { x, y } = project(of.camera, moved.target, of.size);
      close(x, 40, 1e-6);
      close(y, 30, 1e-6);
      const level = upAxis === 'z' ? 2 : 1;
      close(moved.target[level], from.target[level]);
      assert.deepEqual([moved.azimuth, moved.elevation, moved.distance], [from.azimuth, from.elevation, from.distance]);
    }
  });
  it('is as large as fits, and never a thread', () => {
    const long = mapOf({ min: [0, 0, 0], max: [1e5, 10, 3] }, 'z').size;
    assert.ok(long.width / long.height <= 4.1 && long.width <= 176);
    const high = mapOf({ min: [0, 0, 0], max: [10, 1e5, 3] }, 'z').size;
    assert.ok(high.height / high.width <= 4.1 && high.height <= 132);
    assert.deepEqual(fit(map.camera, bounds, map.size, map.size, 1.02).target, map.camera.target);
  });
});

describe('classes', () => {
  const all = [1, 2, 6, 9];
  it('make the word of a view: nothing for all of them, a list for some', () => {
    assert.equal(classesWord([9, 6, 2, 1], all), null);
    assert.deepEqual(classesWord([6, 1], all), [1, 6]);
    assert.deepEqual(classesWord([], all), []);
    assert.deepEqual([shownBy(null, all), shownBy([6, 99], all), shownBy([], all)], [all, [6], []]);
  });
  it('are switched off and on again', () => {
    assert.deepEqual(toggled(null, all, 6), [1, 2, 9]);
    assert.equal(toggled([1, 2, 9], all, 6), null);
    assert.deepEqual(toggled([], all, 6), [6]);
    assert.deepEqual(toggled([6], all, 6), []);
  });
  it('are shown alone, and all again', () => {
    assert.deepEqual(onlyOne(null, all, 2), [2]);
    assert.equal(onlyOne([2], all, 2), null);
    assert.equal(onlyOne([2], [2], 2), null);
    const many = Array.from({ length: 256 }, (_, i) => i);
    assert.equal(toggled(null, many, 255).length, 255);
  });
});

describe('the legend', () => {
  const cloud = { classes: [2, 6, 65], classNames: { 2: 'ground', 6: 'building' }, classColors: { 2: '#a1794e', 6: '#cb5c4a' }, crsUnit: 'metre' };
  const ramps = { viridis: ['#440154', '#fde725'], turbo: ['#30123b', '#7a0403'], curvature: ['#2e48be', '#ba1e2a'], lod: ['#e65046', '#f0963c'] };
  const of = (view, stats) => legendOf({ view: { colormap: 'viridis', ...view }, cloud, ramps, stats });
  it('has classes that are shown', () => {
    assert.deepEqual(of({ color: 'classification' }).classes.map(({ name, color }) => [name, color]), [['Ground', '#a1794e'], ['Building', '#cb5c4a'], ['Class 65', '#808080']]);
    assert.deepEqual(of({ color: 'classification*intensity', classes: [6] }).classes.map(({ number }) => number), [6]);
    const many = { ...cloud, classes: Array.from({ length: 256 }, (_, i) => i) };
    const { classes, more } = legendOf({ view: { color: 'classification' }, cloud: many, ramps });
    assert.equal(classes.length + more, 256);
  });
  it('tells classes apart that share a name', () => {
    const reserved = { classes: [6, 26, 27], classNames: { 6: 'building', 26: 'reserved', 27: 'reserved' }, classCounts: { 6: 3 } };
    assert.deepEqual(classesOf(reserved).map(({ name, count }) => `${name}: ${count}`), ['Building: 3', 'Reserved (26): 0', 'Reserved (27): 0']);
  });
  it('has the ends that the server says, with their unit', () => {
    const stats = { color: 'elevation', colormap: 'turbo', range: [31.46, 58.2] };
    assert.deepEqual(of({ color: 'auto' }, stats), { title: 'Elevation', colors: ramps.turbo, ends: ['31.5', '58.2'], unit: 'm' });
    assert.deepEqual(of({ color: 'intensity', range: [0, 65535] }, stats), { title: 'Intensity', colors: ramps.viridis, ends: ['0', '65,535'], unit: '' });
    assert.equal(of({ color: 'intensity' }, stats), undefined, 'those of another picture are none');
    assert.equal(of({ color: 'curvature' }, { color: 'curvature', range: [-4, 4] }).unit, '1/m');
    assert.deepEqual(rangeText([-0.00012, 0.0003]), ['−0.00012', '0.0003']);
  });
  it('is silent where colours need no words', () => {
    for (const color of ['rgb', 'rgb*intensity', 'normal', '#ff0000', 'auto']) assert.equal(of({ color }), undefined, color);
    assert.equal(of({ color: 'auto' }, { color: 'rgb', range: null }), undefined);
    assert.equal(legendOf({}), undefined);
    assert.equal(of({ color: 'lod' }).isStepped, true);
  });
});

describe('what stands on the picture', () => {
  it('is chosen, and remembered as far as it can be read', () => {
    const usual = { cube: true, scaleBar: true, legend: true, grid: false, minimap: false };
    for (const kept of [null, '', '{', '7', 'null', '{"cube": 1}']) assert.deepEqual(chosenOf(kept), usual, String(kept));
    assert.deepEqual(chosenOf('{"grid": true, "cube": false, "other": 3}'), { ...usual, grid: true, cube: false });
  });
  it('keeps clear of what else floats there', () => {
    const within = { top: 0, bottom: 700 };
    const column = { left: 700, right: 900 };
    const boxes = [{ left: 600, right: 900, top: 10, bottom: 60 }, { left: 0, right: 300, top: 10, bottom: 200 }, { left: 650, right: 900, top: 640, bottom: 690 },
      { left: 0, right: 900, top: 760, bottom: 800 }];
    assert.deepEqual(freeStretch(boxes, column, within), [68, 632]);
    assert.deepEqual(freeStretch([], column, within), [8, 692]);
  });
});
