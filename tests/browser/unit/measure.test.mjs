// Measuring, without a browser: what points come to, digits and units, links, project files and exports.

import assert from 'node:assert/strict';
import { describe, it } from 'node:test';

import { Answers, questionOf } from '../../../client/web/measure/answers.js';
import { systemText } from '../../../client/web/measure/coordinates.js';
import { Draft } from '../../../client/web/measure/draft.js';
import { stepOf } from '../../../client/web/measure/hand.js';
import { csvOf, dxfOf, geoJsonOf, isWgs84 } from '../../../client/web/measure/export.js';
import { parseMeasures, printMeasures } from '../../../client/web/measure/link.js';
import { Measures, mostMeasures, unknownOf } from '../../../client/web/measure/measures.js';
import { isCovered, nearestTo, Places } from '../../../client/web/measure/places.js';
import { parseProject, printProject, ProjectError } from '../../../client/web/measure/project.js';
import { decimalsFor, exactText, heightFactor, measuresLengths, placeText, unitOf, unitsFor, valueText } from '../../../client/web/measure/units.js';
import { boundsOf, circleThrough, crossesItself, figureOf, kinds, valuesOf } from '../../../client/web/measure/values.js';
import { measure as words } from '../../../client/web/page/strings/measure.js';
import { project as projected } from '../../../client/web/view/camera.js';
import { poseOf } from '../../../client/web/view/pose.js';
import { random } from '../support/cameras.mjs';
import { seenOf, town } from '../support/depth_scenes.mjs';

/** A survey's coordinates are large; values must not suffer from it. */
const far = [389459.271, 5819743.97, 45.426];
const at = (...points) => points.map((point) => point.map((value, axis) => value + far[axis]));
const made = (kind, points, more = {}) => ({ id: 1, kind, name: '', points, step: 0.001, up: 'z', visible: true, ...more });
const values = (kind, points, more) => Object.fromEntries(valuesOf(made(kind, points, more)).map(({ name, value }) => [name, value]));
const near = (found, wanted, tolerance = 1e-6) => assert.ok(Math.abs(found - wanted) <= tolerance, `${found} instead of ${wanted}`);

describe('what points come to', () => {
  it('a line: its length, flat, and how much it rises', () => {
    const found = values('distance', at([0, 0, 0], [3, 4, 0], [3, 4, 12]));
    near(found.length, 17);
    near(found.horizontal, 5);
    near(found.rise, 12);
    assert.deepEqual(valuesOf(made('distance', at([0, 0, 0], [3, 4, 0]))).map(({ name }) => name)[0], 'length');
    near(values('horizontal', at([0, 0, 7], [3, 4, 9])).horizontal, 5);
  });
  it('a height is along what is up: Z, Y or -Y', () => {
    near(values('height', at([0, 0, 0], [1, 2, -3])).rise, -3);
    near(values('height', at([0, 0, 0], [1, 2, -3]), { up: 'y' }).rise, 2);
    near(values('height', at([0, 0, 0], [1, 2, -3]), { up: '-y' }).rise, -2);
    near(values('height', at([0, 0, 0], [1, 2, -3]), { up: 'y' }).horizontal, Math.hypot(1, 3));
  });
  it('an angle at the second point', () => {
    near(values('angle', at([1, 0, 0], [0, 0, 0], [0, 0, 5])).angle, 90);
    near(values('angle', at([1, 0, 0], [0, 0, 0], [-1, 1e-9, 0])).angle, 180, 1e-4);
    assert.deepEqual(valuesOf(made('angle', at([1, 0, 0], [1, 0, 0], [2, 0, 0]))), []);
  });
  it('an area in whatever plane, and on the map', () => {
    // A square of 10 × 10 that leans by 60°, turned about the vertical.
    const [c, s] = [Math.cos(Math.PI / 3), Math.sin(Math.PI / 3)];
    const leaning = [[0, 0], [10, 0], [10, 10], [0, 10]].map(([x, y]) => [0.6 * x - 0.8 * c * y, 0.8 * x + 0.6 * c * y, s * y]);
    const found = values('area', at(...leaning));
    near(found.area, 100, 1e-5);
    near(found.flatArea, 50, 1e-5);
    near(found.outline, 40);
    near(values('area', at(...leaning.toReversed())).area, 100, 1e-5);
    near(values('area', at([0, 0, 0], [4, 0, 0], [4, 4, 0], [2, 1, 0], [0, 4, 0])).area, 10); // not convex
  });
  it('an outline that crosses itself is known', () => {
    assert.equal(crossesItself(at([0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0])), false);
    assert.equal(crossesItself(at([0, 0, 0], [5, 3, 0], [4, 0, 0], [0, 4, 0])), true);
    assert.equal(crossesItself(at([0, 0, 0], [4, 0, 0], [4, 4, 0])), false);
  });
  it('a circle through any three of its points, wherever it lies', () => {
    const next = random(3);
    for (let i = 0; i < 50; ++i) {
      const [radius, tilt] = [0.1 + 20 * next(), next() * 3];
      const on = [0, 1, 2].map((k) => (2 * Math.PI * (k + 0.8 * next())) / 3).map((a) => [
        radius * Math.cos(a), radius * Math.sin(a) * Math.cos(tilt), radius * Math.sin(a) * Math.sin(tilt),
      ]);
      const points = at(...on);
      near(values('circle', points).radius, radius, 1e-5);
      const { center } = circleThrough(points);
      center.forEach((value, axis) => near(value, far[axis], 1e-4));
      assert.ok(figureOf(made('circle', points)).lines[0].every((point) => Math.abs(Math.hypot(...point.map((value, axis) => value - far[axis])) - radius) < 1e-4));
    }
    assert.deepEqual(valuesOf(made('circle', at([0, 0, 0], [1, 1, 1], [2, 2, 2]))), []);
  });
  it('too few points come to nothing, and are drawn all the same', () => {
    for (const [kind, { least }] of Object.entries(kinds)) {
      for (let count = 1; count <= 4; ++count) {
        const points = at(...[[0, 0, 0], [1, 0, 0], [1, 2, 0], [0, 3, 1]].slice(0, count));
        const { lines, helpers, label } = figureOf(made(kind, points));
        assert.ok([...lines, ...helpers].flat().concat([label]).every((point) => point.every(Number.isFinite)), `${kind} ${count}`);
        if (count < least) assert.deepEqual(valuesOf(made(kind, points)), []);
      }
    }
  });
});

describe('what the server computes', () => {
  const corners = at([0, 0, 0], [10, 0, 1], [10, 5, 2], [0, 5, 1]);
  const answer = { above: 120, below: 20, net: 100, area: 50, uncovered: 0.5, base: { at: [far[0], far[1], far[2] - 2], slope: [0.1, 0] } };
  it('is asked with what decides which points count, and nothing else of the view', () => {
    const view = { classes: [2], outliers: null, clip: null, method: 'point', camera: {} };
    assert.deepEqual(questionOf(made('volume', corners), view), { measure: 'volume', points: corners, base: 'lowest', view: { classes: [2] } });
    assert.deepEqual(questionOf(made('cylinder', [far], { option: 0.3 }), {}), { measure: 'cylinder', points: [far], within: 0.3 });
  });
  it('is asked one at a time, once each, be it that it fails without a word', async () => {
    const measures = new Measures();
    const asked = [];
    let [open, most] = [0, 0];
    const measure = async (cloud, question) => {
      asked.push(question.base);
      most = Math.max(most, ++open);
      await new Promise((done) => { setTimeout(done); });
      --open;
      if (question.base === 'lowest') throw new TypeError('Failed to fetch');
      return question.base === 'plane' ? null : answer;
    };
    new Answers(/** @type {any} */ ({ cloud: { id: 'town' }, view: {}, server: { measure } }), measures);
    measures.begin(['lowest', 'plane', 40, 'lowest'].map((option) => made('volume', corners, { option })));
    const first = measures.list[0].id;
    for (let i = 0; i < 20; ++i) {
      if (i === 3) measures.change(first, { name: 'pit' });
      await new Promise((done) => { setTimeout(done, 1); });
    }
    assert.deepEqual([asked, most], [['lowest', 'plane', 40, 'lowest'], 1]);
    assert.deepEqual(measures.list.map(({ trouble, answer: said }) => said ?? trouble), ['', '', answer, '']);
    measures.change(first, { option: 41 });
    await new Promise((done) => { setTimeout(done, 10); });
    assert.deepEqual([asked.length, measures.list[0].answer], [5, answer]);
  });
  it('comes to nothing before the answer, and to that then', () => {
    assert.deepEqual(valuesOf(made('volume', corners)), []);
    assert.deepEqual(valuesOf(made('volume', corners, { answer })).map(({ name, value }) => [name, value]), [['net', 100], ['above', 120], ['below', 20], ['flatArea', 50], ['uncovered', 0.5]]);
    assert.equal(valueText(valuesOf(made('volume', corners, { answer }))[0], unitOf('metre', 'm')), '100.0 m³');
    const pipe = { center: far, axis: [0, 0, 2], radius: 0.25, length: 4, rms: 0.002 };
    assert.deepEqual(valuesOf(made('cylinder', [far], { answer: pipe })).map(({ value }) => value), [0.25, 0.5, 4, 0.002]);
    assert.deepEqual(valuesOf(made('cylinder', [far], { answer: {} })), []);
  });
  it('is drawn down to its base, and as a cylinder', () => {
    const { helpers } = figureOf(made('volume', corners, { answer }));
    assert.equal(helpers.length, 5);
    near(helpers[2][1][2], far[2] - 2 + 0.1 * 10);
    const { lines } = figureOf(made('cylinder', [far], { answer: { center: far, axis: [1, 1, 0], radius: 0.25, length: 4 } }));
    const ends = [-1, 1].map((side) => far.map((value, axis) => value + (axis < 2 ? side * Math.SQRT2 : 0)));
    lines.forEach((line, i) => line.forEach((point) => near(Math.hypot(...point.map((value, axis) => value - ends[i][axis])), 0.25)));
    assert.equal(figureOf(made('cylinder', [far], { answer: { center: null } })).lines[0].length, 1);
  });
  it('fits circles, planes and spheres, which are values and are drawn', () => {
    assert.deepEqual(questionOf(made('fitCircle', [far], { option: 0.3 }), {}), { measure: 'circle', points: [far], within: 0.3 });
    const valueOf = (kind, said, name) => valuesOf(made(kind, [far], { option: 1, answer: said })).find((one) => one.name === name)?.value;
    const ring = { center: far, axis: [0, 1, 1], radius: 0.4, diameter: 0.8, arc: 210, rms: 0.003, used: 400 };
    assert.deepEqual(['radius', 'diameter', 'arc', 'spread', 'used'].map((name) => valueOf('fitCircle', ring, name)), [0.4, 0.8, 210, 0.003, 400]);
    const circle = figureOf(made('fitCircle', [far], { answer: ring })).lines[0];
    for (const point of circle) {
      const way = point.map((value, axis) => value - far[axis]);
      near(Math.hypot(...way), 0.4);
      near(way[1] + way[2], 0); // at right angles to the axis
    }
    near(Math.hypot(...circle[0].map((value, axis) => value - circle.at(-1)[axis])), 0);
    // A roof that falls to the east by 45 degrees: it strikes north.
    const roof = { center: far, normal: [Math.SQRT1_2, 0, Math.SQRT1_2], slope: 45, falls: 90, rms: 0.01, used: 900 };
    assert.deepEqual(['slope', 'falls', 'strike'].map((name) => valueOf('plane', roof, name)), [45, 90, 0]);
    assert.deepEqual(valuesOf(made('plane', [far], { answer: { ...roof, falls: null } })).map(({ name }) => name), ['slope', 'spread', 'used'], 'a level one falls nowhere');
    const { lines: [square], helpers: [down] } = figureOf(made('plane', [far], { option: 2, answer: roof }));
    for (const point of square) near(point.reduce((sum, value, axis) => sum + (value - far[axis]) * roof.normal[axis], 0), 0);
    assert.ok(down[1][0] > far[0] && down[1][2] < far[2], 'the arrow goes down');
    const ball = figureOf(made('sphere', [far], { answer: { center: far, radius: 3 } }));
    for (const line of [...ball.lines, ...ball.helpers]) for (const point of line) near(Math.hypot(...point.map((value, axis) => value - far[axis])), 3);
    const project = (option) => JSON.stringify({ format: 'scancast-project', version: 1, cloud: { id: 'town' }, measures: [{ kind: 'sphere', points: [far], ...option }] });
    assert.equal(parseProject(project({ option: 0.5 })).measures[0].option, 0.5);
    assert.throws(() => parseProject(project({})), /option is missing/);
    assert.deepEqual(parseMeasures(printMeasures([made('plane', corners, { option: 0.5 })], words.kinds).word)[0].points, corners);
  });
  it('is not known of other points any more, and telling it is no step', () => {
    const list = new Measures();
    const id = list.add(made('volume', corners, { name: 'heap' }));
    list.tell(list.find(id), { answer });
    list.change(id, { name: 'pit' });
    assert.equal(list.find(id).answer, answer);
    list.change(id, { option: 'fit' });
    assert.equal(list.find(id).answer, undefined);
    list.undo();
    list.undo();
    assert.equal(list.find(id).name, 'heap');
    list.tell(made('volume', corners), { answer });
    list.undo();
    assert.equal(list.list.length, 0);
  });
  it('how it is computed stands in links and files', () => {
    const some = [made('volume', corners, { option: 'fit', name: 'heap!' }), made('volume', corners, { option: -1.5 }), made('cylinder', [far], { option: 0.25 })];
    const read = parseMeasures(printMeasures(some, words.kinds).word);
    assert.deepEqual(read.map(({ option, name }) => [option, name]), [['fit', 'heap!'], [-1.5, ''], [0.25, '']]);
    assert.deepEqual(parseMeasures('#measures=t0.1.2.3!-1~t0.1.2.3!fit~d0.1.2.3.4.5.6!fit~v0.1.2.3.4.5.6!mean'), []);
    const file = printProject({ cloud: { id: 'a' }, view: '', unit: 'm', measures: some });
    assert.deepEqual(parseProject(file).measures.map(({ option }) => option), ['fit', -1.5, 0.25]);
    assert.throws(() => parseProject(file.replace('"fit"', '"top"')), /option is none/);
    assert.throws(() => parseProject(file.replace(/,\s*"option": 0.25/, '')), /option is missing/);
    assert.ok(!file.includes('answer'));
  });
});

describe('digits and units', () => {
  it('say as much as the coordinates are good for', () => {
    assert.deepEqual([0.0001, 0.001, 0.01, 0.1, 1, 10, 0].map(decimalsFor), [4, 3, 2, 1, 0, 0, 4]);
    const metre = unitOf('metre', 'm');
    assert.equal(valueText(valuesOf(made('distance', at([0, 0, 0], [1234.5678, 0, 0])))[0], metre), '1,234.568 m');
    assert.equal(valueText(valuesOf(made('height', at([0, 0, 0], [0, 0, -1.5])))[0], metre), '−1.500 m');
    assert.equal(valueText(valuesOf(made('area', at([0, 0, 0], [10, 0, 0], [10, 10, 0], [0, 10, 0])))[0], metre), '100.00 m²');
    assert.equal(valueText(valuesOf(made('angle', at([1, 0, 0], [0, 0, 0], [0, 1, 0])))[0], metre), '90.0°');
    assert.equal(valueText({ quantity: 'length', value: -1e-9, error: 0.001 }, metre), '0.000 m');
    assert.equal(placeText(far, 0.001), '389,459.271  5,819,743.970  45.426');
    assert.equal(exactText(0.1 + 0.2), '0.3');
  });
  it('metres and feet, the survey foot its own; none where none is known', () => {
    assert.deepEqual([unitsFor('metre'), unitsFor('US survey foot'), unitsFor('foot'), unitsFor(''), unitsFor('degree')], [['m', 'ft'], ['ft', 'm'], ['ft', 'm'], [], []]);
    const length = { quantity: 'length', value: 10, error: 0.001 };
    assert.equal(valueText(length, unitOf('metre', 'ft')), '32.808 ft');
    assert.equal(valueText(length, unitOf('foot', 'm')), '3.0480 m');
    assert.equal(valueText(length, unitOf('US survey foot', 'ft')), '10.000 ft (US)');
    assert.equal(valueText({ ...length, value: 3937 }, unitOf('US survey foot', 'm')), '1,200.0000 m');
    assert.equal(valueText(length, unitOf('', 'm')), '10.000');
    // Where z is in another unit than x and y, it counts as that.
    const mixed = { crsUnit: 'foot', crs: { verticalUnit: 'metre' } };
    near(heightFactor(mixed), 1 / 0.3048);
    assert.equal(heightFactor({ crsUnit: 'foot' }), 1);
    near(valuesOf(made('distance', at([0, 0, 0], [3, 0, 4 * 0.3048])), heightFactor(mixed))[0].value, 5);
    near(figureOf(made('distance', at([0, 0, 0], [3, 0, 4 * 0.3048], [9, 9, 9])), heightFactor(mixed)).legs[0].length, 5);
    assert.equal(systemText({ ...mixed, crsName: 'NAD83' }), 'ft, z m · NAD83');
    assert.ok(!measuresLengths('degree') && measuresLengths('') && measuresLengths('metre'));
  });
});

describe('a draft', () => {
  const found = (...position) => ({ position, precision: [0.001, 0.001, 0.01], depth: 3, distance: 0, rgb: [1, 2, 3], crs: null, attributes: { gps_time: 7 } });
  it('is a measure once all its points are found', () => {
    const draft = new Draft('height', 'z');
    const first = draft.add([0, 0, 0]);
    assert.equal(draft.lacks, 1);
    const second = draft.add(undefined);
    assert.ok(draft.closing && !draft.takesMore && draft.measure === undefined);
    draft.settle(second, found(1, 2, 3));
    draft.settle(first, found(0, 0, 1));
    assert.deepEqual(draft.measure, { kind: 'height', up: 'z', visible: true, points: [[0, 0, 1], [1, 2, 3]], step: 0.01 });
  });
  it('goes on where a point was not found, or clicked twice', () => {
    const draft = new Draft('height', 'z');
    draft.settle(draft.add([0, 0, 0]), found(0, 0, 0));
    draft.settle(draft.add([1, 0, 0]), null);
    assert.ok(draft.takesMore && draft.points.length === 1);
    draft.settle(draft.add([0, 0, 0]), found(0, 0, 0));
    assert.equal(draft.measure, undefined);
    draft.removeLast();
    assert.ok(draft.takesMore);
  });
  it('a point keeps what the scan says of it, and nothing of the picture', () => {
    const draft = new Draft('point', 'z');
    draft.settle(draft.add(undefined), found(1, 2, 3));
    assert.deepEqual(draft.measure.more, { rgb: [1, 2, 3], gps_time: 7 });
    assert.equal(stepOf({}), 0);
  });
});

describe('the list', () => {
  it('takes every change back, and does it again', () => {
    const list = new Measures();
    const id = list.add(made('distance', at([0, 0, 0], [1, 0, 0], [2, 0, 0]), { name: 'one' }));
    list.change(id, { name: 'two' });
    list.removePoint(id, 1);
    assert.equal(list.find(id).points.length, 2);
    list.removePoint(id, 0);
    assert.equal(list.list.length, 0, 'one point is no distance');
    list.undo();
    list.undo();
    assert.deepEqual([list.find(id).points.length, list.find(id).name], [3, 'two']);
    list.undo();
    assert.equal(list.find(id).name, 'one');
    list.redo();
    assert.equal(list.find(id).name, 'two');
    list.remove(77);
    assert.ok(list.canRedo, 'nothing was done');
    assert.equal(list.nameFor('Distance'), 'Distance 1');
  });
  it('ends somewhere, and knows what it has', () => {
    const list = new Measures();
    list.replace(Array.from({ length: mostMeasures }, (_, i) => made('point', [[i, 0, 0]])));
    assert.equal(list.add(made('point', [[0, 1, 0]])), undefined);
    assert.equal(unknownOf(list.list, [made('point', [[3, 0, 0]]), made('point', [[3, 1, 0]])]).length, 1);
  });
});

describe('a link', () => {
  const some = [
    made('distance', [[389459.271, 5819743.97, 45.426], [389459.272, 5819740, -0.001]], { name: 'Distance 1' }),
    made('area', [[0, 0, 0], [1.5, 0, 0], [1.5, -2.25, 0]], { name: 'Café · roof *~.', up: 'y', visible: false }),
    made('point', [[2.5992379, -0.0013804187774344977, 1e-7]], { name: 'Point 3' }),
  ];
  it('holds measures exactly, with names of their own', () => {
    const { word, left } = printMeasures(some, words.kinds);
    assert.equal(left, 0);
    const read = parseMeasures(`#cloud=a&${word}&present`);
    assert.deepEqual(read.map(({ kind }) => kind), ['distance', 'area', 'point']);
    assert.deepEqual(read[0].points, some[0].points);
    assert.deepEqual(read[1].points, some[1].points);
    assert.deepEqual([read[0].name, read[1].name, read[1].up, read[1].visible, read[0].visible], ['', 'Café · roof *~.', 'y', false, true]);
    read[2].points[0].forEach((value, axis) => near(value, some[2].points[0][axis], 1e-9));
  });
  it('is exact for any grid', () => {
    const next = random(5);
    for (let i = 0; i < 200; ++i) {
      const decimals = Math.floor(next() * 5);
      const points = Array.from({ length: 4 }, () => [6e5, 6e6, 500].map((size) => Number((size * (2 * next() - 1)).toFixed(decimals))));
      const [read] = parseMeasures(printMeasures([made('distance', points)], words.kinds).word);
      assert.deepEqual(read.points, points);
    }
  });
  it('has an end: what has no room is counted', () => {
    const many = Array.from({ length: 200 }, (_, i) => ({ ...some[0], points: at([i, 0, 0], [0, i, 1]) }));
    const { word, left } = printMeasures(many, words.kinds, 600);
    assert.ok(word.length < 1600 && left > 100);
    assert.equal(parseMeasures(word).length, 200 - left);
    assert.deepEqual(printMeasures(many, words.kinds, 4096), { word: '', left: 200 });
  });
  it('from anywhere is never more than measures', () => {
    for (const hash of [undefined, '', '#measures=', '#measures=%', '#measures=d3.1.2', '#measures=d3.1.2.3', '#measures=x3.1.2.3.4.5.6', '#measures=d3.1.2.3.4.5.zzzzzzzzzzzzz',
      '#measures=p9.zzzzzzzzzzz.1.1', `#measures=${'d3.1.2.3.4.5.6~'.repeat(400)}`, '#measures=h3.1.2.3.4.5.6.7.8.9', '#measures=__proto__', '#measures=d3..1.2.3.4.5.6']) {
      assert.deepEqual(parseMeasures(hash), [], hash);
    }
    assert.equal(parseMeasures('#measures=nonsense~p0.1.2.3~d').length, 1);
  });
});

describe('a project file', () => {
  const cloud = { id: 'town', title: 'Old town', revision: 'r1', crsName: 'ETRS89 / UTM zone 33N', crsUnit: 'metre', crsEpsg: 25833 };
  const measures = [
    made('distance', at([0, 0, 0], [1, 0, 0]), { name: 'kerb' }), made('point', at([0, 0, 0]), { name: 'nail', more: { rgb: [1, 2, 3], className: 'road' }, visible: false, up: 'y' }),
  ];
  const whole = () => JSON.parse(printProject({ cloud, view: 'cloud=town&method=auto', unit: 'ft', measures }));
  it('comes back as it was, with what a later version added', () => {
    const text = printProject({ cloud, view: 'cloud=town&method=auto', unit: 'ft', measures, kept: { sections: [{ text: 'here' }] } });
    const read = parseProject(text);
    assert.deepEqual(read.measures.map((one) => ({ id: 1, ...one })), measures);
    assert.deepEqual([read.cloud, read.view, read.unit, read.kept], [{ id: 'town', revision: 'r1' }, 'cloud=town&method=auto', 'ft', { sections: [{ text: 'here' }] }]);
    assert.equal(printProject({ cloud, view: read.view, unit: read.unit, measures: read.measures, kept: read.kept }), text);
  });
  it('that is none is refused with a sentence that names what is wrong', () => {
    const change = (act) => {
      const file = whole();
      act(file);
      return JSON.stringify(file);
    };
    const cases = [
      ['', /no JSON/], ['null', /no project file/], ['[]', /no project file/], ['{"format": "other"}', /no project file/],
      [`"${'x'.repeat(5 << 20)}"`, /larger than 4 MiB/],
      [JSON.stringify(whole()).replace('{', `{"later": ${'['.repeat(1 << 20)}${']'.repeat(1 << 20)},`), /64 levels/],
      [change((file) => { delete file.version; }), /which version/], [change((file) => { file.version = 9; }), /version 9/],
      [change((file) => { file.cloud = 7; }), /cloud\.id/], [change((file) => { file.cloud.id = '../../etc'; }), /cloud\.id/],
      [change((file) => { file.view = {}; }), /view is no text/], [change((file) => { file.unit = 'mile'; }), /unit is neither/],
      [change((file) => { file.measures = {}; }), /measures is no list/],
      [change((file) => { file.measures = Array(mostMeasures + 1).fill(file.measures[0]); }), /There are 501 measures/],
      [change((file) => { file.measures[1] = null; }), /measures\[1\] is no measure/],
      [change((file) => { file.measures[0].kind = 'constructor'; }), /measures\[0\]\.kind: there is no kind "constructor"/],
      [change((file) => { file.measures[0].points[1][2] = null; }), /measures\[0\]\.points\[1\] is no point/],
      [change((file) => { file.measures[0].points[1] = [1, 2]; }), /points\[1\] is no point/],
      [change((file) => { file.measures[0].points.pop(); }), /has 1; a measure of the kind distance has 2 to 500/],
      [change((file) => { file.measures[1].points.push([0, 0, 0]); }), /kind point has 1\./],
      [change((file) => { file.measures[0].name = 'n'.repeat(999); }), /name is no text/], [change((file) => { file.measures[0].visible = 'yes'; }), /visible/],
      [change((file) => { file.measures[0].up = 'x'; }), /up is none/], [change((file) => { file.measures[0].step = -1; }), /step is no length/],
      [change((file) => { file.measures[1].more = { text: 'x'.repeat(9000) }; }), /more/],
      [JSON.stringify(whole()).replace('389459.271', '1e999'), /points\[0\] is no point/],
    ];
    for (const [text, why] of cases) assert.throws(() => parseProject(text), (error) => error instanceof ProjectError && why.test(error.message), String(why));
  });
});

describe('exports', () => {
  const cloud = { id: 'town', crsName: 'ETRS89 / UTM zone 33N', crsUnit: 'metre', crsEpsg: 25833 };
  const list = [
    made('distance', at([0, 0, 0], [3, 4, 0]), { name: 'a, "b"' }), made('area', at([0, 0, 0], [4, 0, 0], [4, 4, 0]), { name: '=cmd()' }), made('circle', at([1, 0, 0], [0, 1, 0], [-1, 0, 0]), { name: 'Säule\n1' }),
    made('point', at([0, 0, 0]), { name: 'nail' }),
  ];
  it('CSV: a row for each point, in the coordinates of the file, and no formula', () => {
    const rows = csvOf(list, cloud, words.kinds).split('\r\n');
    assert.equal(rows[0], 'name,kind,value,unit,point,x,y,z,step,crs');
    assert.equal(rows[1], '"a, ""b""",Distance,5,m,1,389459.271,5819743.97,45.426,0.001,ETRS89 / UTM zone 33N');
    assert.match(rows[3], /^'=cmd\(\),Area,8,m2,1,/);
    assert.equal(rows.length, 1 + 2 + 3 + 3 + 1 + 1);
  });
  it('DXF: pairs of codes and values, every entity closed, coordinates exact, ASCII only', () => {
    const text = dxfOf(list, cloud, words.kinds, unitOf('metre', 'm'));
    assert.match(text, /^[\x20-\x7e\r\n]*$/);
    const lines = text.split('\r\n');
    assert.equal(lines.pop(), '');
    assert.equal(lines.length % 2, 0);
    const pairs = Array.from({ length: lines.length / 2 }, (_, i) => [Number(lines[2 * i]), lines[2 * i + 1]]);
    assert.ok(pairs.every(([code]) => Number.isInteger(code)));
    const count = (name) => pairs.filter(([code, value]) => code === 0 && value === name).length;
    assert.deepEqual([count('POLYLINE'), count('SEQEND'), count('TEXT'), count('POINT')], [3, 3, 4, 4]);
    assert.deepEqual([count('SECTION'), count('ENDSEC'), count('EOF')], [3, 3, 1]);
    assert.equal(count('VERTEX'), 2 + 3 + 72);
    const first = pairs.findIndex(([, value]) => value === 'VERTEX');
    assert.deepEqual(pairs.slice(first + 2, first + 5), [[10, '389459.271'], [20, '5819743.97'], [30, '45.426']]);
    assert.ok(pairs.some(([code, value]) => code === 1 && value === 'S\\U+00E4ule 1: 1.000 m'));
    assert.ok(pairs.some(([code, value]) => code === 999 && value.includes('ETRS89 / UTM zone 33N, m')));
    assert.ok(pairs.some(([code, value]) => code === 70 && value === '9'), 'the area is closed');
  });
  it('GeoJSON: only of WGS 84', () => {
    assert.ok(isWgs84({ crsEpsg: 4326 }) && isWgs84({ crsEpsg: 4979 }) && !isWgs84(cloud) && !isWgs84({}));
    const { features } = JSON.parse(geoJsonOf(list));
    assert.deepEqual(features.map(({ geometry }) => geometry.type), ['LineString', 'Polygon', 'MultiPoint', 'Point']);
    const [ring] = features[1].geometry.coordinates;
    assert.deepEqual(ring[0], ring.at(-1));
  });
});

describe('over the picture', () => {
  const size = { width: 960, height: 600 };
  const camera = (changes = {}) => ({ target: [0, 0, 2], azimuth: -1.2, elevation: 0.5, distance: 60, fov: 45, projection: 'perspective', upAxis: 'z', ...changes });
  it('places are where the camera puts them, whatever margin the picture has', () => {
    const next = random(8);
    for (const projection of ['perspective', 'orthographic']) {
      for (let i = 0; i < 40; ++i) {
        const from = camera({ projection, azimuth: next() * 6, elevation: next() - 0.2, distance: 10 + 90 * next() });
        const places = new Places(poseOf(from, town.bounds, size.width / size.height, { x: 1.08, y: 1.1 }), size);
        const point = [20 * next() - 10, 20 * next() - 10, 5 * next()];
        const wanted = projected(from, point, size);
        const found = places.of(point);
        if (!wanted || Math.abs(wanted.x) > 2000 || Math.abs(wanted.y) > 2000) continue;
        near(found.x, wanted.x, 1e-3);
        near(found.y, wanted.y, 1e-3);
      }
    }
  });
  it('lines end before the eye, and not far outside of the picture', () => {
    const places = new Places(poseOf(camera({ elevation: 0.05 }), town.bounds, 1.6), size);
    const [from, to] = places.line([0, 0, 2], [40, -100, 2]); // passes behind the eye
    near(from.x, 480, 1);
    assert.ok([from, to].every(({ x, y }) => Math.abs(x) <= 5 * size.width && Math.abs(y) <= 5 * size.height));
    assert.equal(places.line([400, -1000, 2], [500, -1000, 2]), undefined);
    assert.equal(places.of([40, -1000, 2]), undefined);
  });
  it('what is behind a wall is hidden; what is on it is not; between the two it stays as it was', () => {
    const seen = seenOf(town.all, camera({ azimuth: -Math.PI / 2, elevation: 0.25 }), 1.6, town.bounds);
    assert.equal(isCovered(seen, [0, 40, 1], 0.1, false), true, 'behind');
    assert.equal(isCovered(seen, [0, 20, 8], 0.1, false), false, 'on it');
    assert.equal(isCovered(seen, [0, 5, 0], 0.1, false), false, 'on the ground before it');
    assert.equal(isCovered(seen, [0, 20, 24], 0.1, true), false, 'against the sky');
    assert.equal(isCovered(seen, [0, -200, 0], 0.1, true), true, 'behind the eye: as it was');
    assert.equal(isCovered(undefined, [0, 0, 0], 0.1, false), false);
    // Step by step away behind the wall, and back: it changes once each way, later than where it changes back.
    const way = Array.from({ length: 200 }, (_, i) => [0, 20 + i * 0.02, 8]);
    const walk = (points, first) => points.reduce((states, point) => [...states, isCovered(seen, point, 0.1, states.at(-1))], [first]);
    const [there, back] = [walk(way, false), walk(way.toReversed(), true).toReversed()];
    const changes = (states) => states.slice(1).filter((state, i) => state !== states[i]).length;
    assert.deepEqual([changes(there), changes(back)], [1, 1]);
    assert.ok(there.indexOf(true) > back.indexOf(true), 'hysteresis');
  });
  it('the nearest within reach is meant', () => {
    assert.equal(nearestTo([undefined, { x: 5, y: 0 }, { x: 0, y: 3 }], { x: 0, y: 0 }, 10), 2);
    assert.equal(nearestTo([{ x: 5, y: 0 }], { x: 0, y: 0 }, 4), -1);
    assert.deepEqual(boundsOf([[1, 5, 3], [2, 4, 3]]), { min: [1, 4, 3], max: [2, 5, 3] });
  });
});
