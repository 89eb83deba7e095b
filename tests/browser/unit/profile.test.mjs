// Profiles and exports without a browser: the line and its corridor, the plot's view, what the server is asked.

import assert from 'node:assert/strict';
import { describe, it } from 'node:test';

import { axesOf } from '../../../client/web/clip/box.js';
import { coloursOf, countIn, fileName, limitsOf, regionOf } from '../../../client/web/export/region.js';
import { save } from '../../../client/web/export/saving.js';
import { partQuestion, pointsQuestion, wholeQuestion } from '../../../client/web/profile/asking.js';
import { boxesAround, lengthOf, lineOf, movedBy, nearestStation, outlineOf, partOf, placeAt, stationsOf } from '../../../client/web/profile/line.js';
import { apart, edgesOf, exaggerated, fitted, fromPixel, nearestDrawn, panned, ticks, toPixel, usualExaggeration, zoomed } from '../../../client/web/profile/plot_view.js';
import { dot, subtract } from '../../../client/web/view/vectors.js';
import { random } from '../support/cameras.mjs';

const near = (found, wanted, tolerance = 1e-9) => {
  assert.equal(found.length, wanted.length);
  found.forEach((value, i) => assert.ok(Math.abs(value - wanted[i]) <= tolerance, `${found} instead of ${wanted}`));
};
const size = { width: 800, height: 200 };

describe('the line of a profile', () => {
  const line = [[400_000, 100], [400_030, 140], [400_030, 190]];

  it('moves with its scan, and is where it was when that is moved back', () => {
    const points = [[389_527.196, 5_819_788.23, 34.02], [0.1, 0.2, 0.3]];
    const by = [0.1, -0.3, 1e-3];
    near(movedBy(points, by)[1], [0.2, -0.1, 0.301]);
    assert.deepEqual(movedBy(movedBy(points, by), by.map((value) => -value)), points);
    assert.deepEqual(movedBy(points, [0, 0, 0]), points);
  });

  it('has stations, and places at them', () => {
    assert.deepEqual(stationsOf(line), [0, 50, 100]);
    near(placeAt(line, 25), [400_015, 120]);
    near(placeAt(line, 60), [400_030, 150]);
    near(placeAt(line, -5), line[0]);
    near(placeAt(line, 500), line[2]);
    for (const station of [0, 12.5, 50, 77, 100]) near([nearestStation(line, placeAt(line, station))], [station], 1e-6);
    assert.deepEqual(lineOf([[1, 2, 3], [1, 2, 9], [4, 6, 0]]), [[1, 2], [4, 6]], 'two points above each other are one corner');
  });

  it('has parts, whose stations go on from where they begin', () => {
    near(partOf(line, 25, 60).flat(), [400_015, 120, 400_030, 140, 400_030, 150]);
    near([lengthOf(partOf(line, -10, 1000))], [100]);
    assert.equal(partOf(line, 100, 120), undefined);
    assert.equal(partOf(line, -20, 0), undefined);
  });

  // Right by the definition of the corridor: within half its width of the line, and not beyond its ends.
  it('is cut free by boxes, one for each part', () => {
    const boxes = boxesAround(line, 4, { min: [400_000, 0, 10], max: [400_100, 200, 30] });
    assert.equal(boxes.length, 2);
    const next = random(7);
    const isIn = ({ box }, point) => axesOf(box).every((axis, i) => Math.abs(dot(subtract(point, box.center), axis)) <= box.size[i] / 2 + 1e-6);
    for (let i = 0; i < 2000; ++i) {
      const point = [400_000 + next() * 40 - 5, 90 + next() * 110, 10 + next() * 20];
      const distances = line.slice(1).map((to, k) => {
        const from = line[k];
        const along = [to[0] - from[0], to[1] - from[1]];
        const long = Math.hypot(...along);
        const t = ((point[0] - from[0]) * along[0] + (point[1] - from[1]) * along[1]) / long;
        const off = ((point[0] - from[0]) * along[1] - (point[1] - from[1]) * along[0]) / long;
        return t >= 0 && t <= long ? Math.abs(off) : Infinity;
      });
      if (Math.abs(Math.min(...distances) - 2) > 1e-3) assert.equal(boxes.some((one) => isIn(one, point)), Math.min(...distances) < 2, String(point));
    }
    assert.equal(boxesAround(Array.from({ length: 10 }, (_, i) => [i, i % 2]), 1, { min: [0, 0, 0], max: [9, 1, 1] }), undefined, 'more than a view has');
  });

  it('is drawn with its corridor', () => {
    const [first] = outlineOf([[0, 0, 5], [10, 0, 7], [10, 0, 9]], 2);
    assert.deepEqual(first.map((point) => point.map((value) => value + 0)), [[0, -1, 5], [10, -1, 7], [10, 1, 7], [0, 1, 5], [0, -1, 5]]);
    assert.equal(outlineOf([[0, 0, 5], [0, 0, 7]], 2).length, 0);
  });
});

describe('the plot', () => {
  const view = { left: 20, bottom: 30, scale: 8, exaggeration: 5 };

  it('goes from places to pixels and back', () => {
    const place = { station: 45, height: 33 };
    assert.deepEqual(toPixel(view, size, place), { x: 200, y: 200 - 3 * 40 });
    assert.deepEqual(fromPixel(view, size, toPixel(view, size, place)), place);
    assert.deepEqual(edgesOf(view, size), { left: 20, right: 120, bottom: 30, top: 35 });
  });

  it('is zoomed about the cursor, moved with the hand, and exaggerated about its middle', () => {
    const cursor = { x: 300, y: 50 };
    const before = fromPixel(view, size, cursor);
    const closer = zoomed(view, size, cursor, 3, 200);
    near(Object.values(fromPixel(closer, size, cursor)), Object.values(before));
    assert.equal(closer.scale, 24);
    near(Object.values(fromPixel(panned(view, { x: 10, y: -20 }), size, { x: 310, y: 30 })), Object.values(before));
    const middle = { x: 400, y: 100 };
    near(Object.values(fromPixel(exaggerated(view, size, 20), size, middle)), Object.values(fromPixel(view, size, middle)));
    assert.ok(zoomed(view, size, cursor, 1e9, 200).scale <= 1_000_000);
    assert.ok(zoomed(view, size, cursor, 1e-9, 200).scale >= 1);
  });

  it('shows all of a profile, heights as much larger as there is room', () => {
    assert.equal(usualExaggeration(100, [0, 20], size), 1);
    assert.equal(usualExaggeration(1000, [0, 20], size), 10);
    assert.equal(usualExaggeration(10, [0, 90], size), 1, 'a tower');
    for (const [length, heights, times] of [[100, [0, 20], 1], [1000, [5, 25], 10], [10, [0, 90], 1], [50, [3, 3], 1]]) {
      const { left, right, bottom, top } = edgesOf(fitted(length, heights, size, times), size);
      assert.ok(left <= 1e-9 && right >= length - 1e-9 && bottom < heights[0] && top > heights[1], JSON.stringify({ left, right, bottom, top }));
    }
  });

  it('has round numbers at its axes', () => {
    assert.deepEqual(ticks(3, 27, 6), { step: 5, decimals: 0, values: [5, 10, 15, 20, 25] });
    assert.deepEqual(ticks(-0.11, 0.21, 4), { step: 0.1, decimals: 1, values: [-0.1, 0, 0.1, 0.2] });
    for (let i = 0; i < 200; ++i) {
      const [low, range, most] = [i * 17.3 - 900, 10 ** ((i % 11) - 4), 1 + (i % 9)];
      const { values, step } = ticks(low, low + range, most);
      assert.ok(values.length <= most + 1 && values.every((value) => value >= low - 1e-6 * step && value <= low + range + 1e-6 * step));
    }
  });

  it('tells what two places are apart', () => {
    const found = apart({ station: 2, height: 10 }, { station: 5, height: 14 });
    assert.deepEqual([found.distance, found.along, found.rise], [5, 3, 4]);
    near([found.slope, found.percent], [(Math.atan2(4, 3) * 180) / Math.PI, 400 / 3]);
    assert.equal(apart({ station: 2, height: 10 }, { station: 2, height: 14 }).percent, undefined);
    near([apart({ station: 0, height: 0 }, { station: 0, height: 1 }, 3.28).distance], [3.28]);
  });

  it('takes the drawn pixel that is nearest', () => {
    const data = new Uint8ClampedArray(4 * 20 * 10);
    for (const [x, y] of [[3, 4], [12, 4]]) data[4 * (y * 20 + x) + 3] = 255;
    const image = { data, width: 20, height: 10 };
    assert.deepEqual(nearestDrawn(image, 6, 4, 5), { x: 3, y: 4 });
    assert.deepEqual(nearestDrawn(image, 9, 5, 5), { x: 12, y: 4 });
    assert.equal(nearestDrawn(image, 7.5, 9, 4), undefined);
    assert.deepEqual(nearestDrawn(image, -2, 4, 6), { x: 3, y: 4 });
  });
});

describe('what the server is asked', () => {
  const shapes = [{ box: { center: [0, 0, 0], size: [1, 1, 1] }, keep: 'inside' }];
  const view = { classes: '2,6', clips: shapes, clip: null, color: 'elevation*intensity', colormap: 'turbo', range: null };

  it('for points: what the view shows, or parts of that', () => {
    assert.deepEqual(regionOf(view), { clips: shapes, classes: '2,6' });
    assert.deepEqual(regionOf(view, { classes: true }), { classes: '2,6' });
    assert.deepEqual(regionOf(view, { polygon: [[1, 2, 9], [3, 4, 9], [5, 0, 9]] }), { polygon: [[1, 2], [3, 4], [5, 0]] });
    assert.equal(regionOf({ classes: null, clips: null }), undefined);
    const filter = [{ column: 'gps_time', low: 5 }];
    assert.deepEqual(regionOf({ ...view, filter }), { clips: shapes, classes: '2,6', filter });
    assert.deepEqual(regionOf({ ...view, filter }, { classes: true }), { classes: '2,6' });
    assert.deepEqual(limitsOf(view), { classes: true, shapes: true, filter: false });
    assert.deepEqual(limitsOf({ filter }), { classes: false, shapes: false, filter: true });
  });

  it('for a profile: as it is coloured in the view, where that has a meaning', () => {
    assert.deepEqual(coloursOf(view), { color: 'elevation*intensity', colormap: 'turbo' });
    assert.deepEqual(coloursOf({ color: 'depth', colormap: 'turbo' }), {});
    assert.deepEqual(coloursOf({ color: '#ff0000' }), { color: '#ff0000' });
    assert.deepEqual(coloursOf({ color: 'column:gps_time', range: [0, 1] }), { color: 'column:gps_time', range: [0, 1] });
    const line = [[0, 0], [100, 0]];
    assert.deepEqual(pointsQuestion({ line, width: 2 }, {}, 'las'), { line, width: 2, format: 'las' });
    assert.deepEqual(wholeQuestion({ line, width: 2 }, view, size).picture, { width: 800, height: 200, pointSize: 1, background: 'transparent', color: 'elevation*intensity', colormap: 'turbo' });
    const { question, from } = partQuestion({ line, width: 2 }, view, { left: 40, right: 60, bottom: 5, top: 9 }, { scale: 10, exaggeration: 5 });
    assert.equal(from, 38);
    near(question.line.flat(), [38, 0, 62, 0]);
    assert.deepEqual(question.region, { clips: shapes, classes: '2,6', z: [5, 9] });
    assert.deepEqual([question.picture.width, question.picture.exaggeration], [240, 5]);
    assert.equal(partQuestion({ line, width: 2 }, view, { left: 140, right: 160, bottom: 5, top: 9 }, { scale: 10, exaggeration: 5 }), undefined);
  });

  it('and what the beginning of the file says of its size', () => {
    const las = new Uint8Array(375);
    las.set(new TextEncoder().encode('LASF'));
    const fields = new DataView(las.buffer);
    fields.setUint32(96, 2000, true);
    fields.setUint16(105, 36, true);
    fields.setBigUint64(247, 1_000_000n, true);
    assert.deepEqual(countIn(las), { points: 1_000_000, bytes: 36_002_000 });
    const head = 'ply\nformat binary_little_endian 1.0\nelement vertex 10\nproperty double x\nproperty double y\nproperty double z\nproperty uchar red\nend_header\n';
    assert.deepEqual(countIn(new TextEncoder().encode(`${head}xyz`)), { points: 10, bytes: head.length + 250 });
    assert.equal(countIn(new TextEncoder().encode('x,y,z\n1,2,3\n')), undefined);
    assert.equal(fileName('attachment; filename="town-part.las"', 'town', '', 'las'), 'town-part.las');
    assert.equal(fileName(null, 'town', 'cut', 'ply'), 'town-cut.ply');
  });
});

describe('a file that is saved while it comes', () => {
  /** { target, log }: what happened to it. */
  const target = () => {
    const log = /** @type {any[]} */ ([]);
    return { log, target: { name: 'x', begin: async () => ({ write: async (chunk) => log.push([...chunk]), close: async () => log.push('closed'), abort: async () => log.push('aborted') }) } };
  };
  const answer = (chunks, end) => new Response(new ReadableStream({
    async pull(controller) {
      if (chunks.length > 0) controller.enqueue(Uint8Array.from(chunks.shift()));
      else end(controller);
    },
  }));

  it('is all there, or not there', async () => {
    const whole = target();
    const told = /** @type {number[]} */ ([]);
    assert.equal(await save(answer([[1, 2], [3]], (controller) => controller.close()), whole.target, (bytes) => told.push(bytes)), 3);
    assert.deepEqual([whole.log, told], [[[1, 2], [3], 'closed'], [2, 3]]);
    const broken = target();
    await assert.rejects(save(answer([[1, 2]], (controller) => controller.error(new TypeError('terminated'))), broken.target, () => {}), TypeError);
    assert.deepEqual(broken.log, [[1, 2], 'aborted']);
    const stopped = target();
    const stop = new AbortController();
    await assert.rejects(save(answer([[1], [2], [3]], () => {}), stopped.target, () => stop.abort(), stop.signal), { name: 'AbortError' });
    assert.deepEqual(stopped.log, [[1], 'aborted']);
  });
});
