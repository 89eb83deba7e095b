// Notes, saved views, tours, names of pictures and sides of a comparison, without a browser. Files and addresses may come from anywhere.

import assert from 'node:assert/strict';
import { describe, it } from 'node:test';

import { linkOf, pointOf, readNotes, writtenNotes } from '../../../client/web/annotate/notes.js';
import { parseSides, printSides, rightStyle } from '../../../client/web/compare/sides.js';
import { ProjectError } from '../../../client/web/measure/checks.js';
import { csvOf, dxfOf, geoJsonOf } from '../../../client/web/measure/export.js';
import { parseProject, printProject, refusalOf } from '../../../client/web/measure/project.js';
import { SteppedList } from '../../../client/web/measure/stepped_list.js';
import { legendLines, legendTitle } from '../../../client/web/page/plan/legend.js';
import { strings } from '../../../client/web/page/strings.js';
import { measure } from '../../../client/web/page/strings/measure.js';
import { mostSide, pictureName, presetsOf, sideOf } from '../../../client/web/picture/file_name.js';
import { northOn, scaleOn, textSize } from '../../../client/web/picture/furniture.js';
import { eyeOf, fromProtocol, standardView } from '../../../client/web/view/camera.js';
import { poseOf } from '../../../client/web/view/pose.js';
import { readTours, readViews, stopsOf, toursOf } from '../../../client/web/views/saved.js';
import { Tour } from '../../../client/web/views/tour.js';

const cloud = { id: 'town', title: 'Old town', revision: 'r1', crsName: 'ETRS89 / UTM zone 33N', crsUnit: 'metre', crsEpsg: 25833 };
const notes = [
  { name: 'Crack', text: 'Since 2021,\n"widening"', link: 'https://example.org/a?b=1', point: [389459.271, 5819743.97, 45.426], step: 0.001, visible: true },
  { name: '=1+1', text: '', link: '', point: [1, 2, 3], step: 0, visible: false },
];
const views = [{ name: 'south', view: 'eye=0,-9,0&target=0,0,0' }, { name: 'east', view: 'eye=9,0,0&target=0,0,0' }];
const tours = [{ name: 'Walk', views: ['south', 'east', 'south'], seconds: 3, pause: 0, loop: true }, { name: 'All', views: undefined, seconds: 4, pause: 2, loop: false }];
const numbered = (list) => list.map((one, i) => ({ id: i + 1, ...one }));
const whole = (kept = undefined) => printProject({ cloud, view: '', unit: 'm', measures: [], notes: numbered(notes), views: numbered(views), tours: numbered(toursOf(tours, numbered(views))), kept });

describe('notes, views and tours in a project file', () => {
  it('come back as they were, with what a later version added', () => {
    const text = whole({ later: [{ a: 1 }] });
    const read = parseProject(text);
    assert.deepEqual([read.notes, read.views, read.tours, read.kept], [notes, views, tours, { later: [{ a: 1 }] }]);
    assert.equal(printProject({ cloud, view: '', unit: 'm', measures: [], ...read, views: numbered(read.views), tours: toursOf(read.tours, numbered(read.views)), cloud }), text);
    assert.ok(!('views' in JSON.parse(printProject({ cloud, view: '', unit: 'm', measures: [] }))), 'nothing is written of nothing');
  });
  it('that are none are refused with a sentence that names what is wrong', () => {
    const change = (act) => {
      const file = JSON.parse(whole());
      act(file);
      return JSON.stringify(file);
    };
    const cases = [
      [(file) => { file.annotations = {}; }, /annotations is no list/], [(file) => { file.annotations[0] = 7; }, /annotations\[0\] is no annotation/],
      [(file) => { file.annotations = Array(501).fill(file.annotations[0]); }, /There are 501 annotations/],
      [(file) => { delete file.annotations[1].title; }, /annotations\[1\]\.title/], [(file) => { file.annotations[0].text = 'x'.repeat(4001); }, /annotations\[0\]\.text/],
      ...['javascript:alert(1)', 'JAVASCRIPT:alert(1)', ' https://a.example', 'data:text/html,x', 'https://', '//a.example', 'file:///etc/passwd', 'x'.repeat(9000), 7, null, ['https://a.example']]
        .map((link) => [(file) => { file.annotations[0].link = link; }, /annotations\[0\]\.link/]),
      [(file) => { file.annotations[0].point = [1, 2]; }, /annotations\[0\]\.point/], [(file) => { file.annotations[0].point = [1, 2, '3']; }, /annotations\[0\]\.point/],
      [(file) => { file.annotations[0].point = [1, 2, 1e13]; }, /annotations\[0\]\.point/], [(file) => { file.annotations[0].step = -1; }, /annotations\[0\]\.step/],
      [(file) => { file.annotations[0].visible = 1; }, /annotations\[0\]\.visible/],
      [(file) => { file.views = 'all'; }, /views is no list/], [(file) => { file.views[1] = null; }, /views\[1\] is no view/], [(file) => { file.views[1].name = 'south'; }, /views\[1\]\.name: there are two/],
      [(file) => { file.views[0].name = ' '; }, /views\[0\]\.name/], [(file) => { file.views[0].view = ''; }, /views\[0\]\.view/], [(file) => { file.views[0].view = 'x'.repeat(5000); }, /views\[0\]\.view/],
      [(file) => { file.views = Array.from({ length: 201 }, (_, i) => ({ name: String(i), view: 'a=b' })); }, /There are 201 views/],
      [(file) => { file.tours = 7; }, /tours is no list/], [(file) => { file.tours[1].name = 'Walk'; }, /tours\[1\]\.name: there are two/],
      [(file) => { file.tours[0].views[1] = 'north'; }, /tours\[0\]\.views\[1\]: there is no view "north"/], [(file) => { file.tours[0].views = 'south'; }, /tours\[0\]\.views is no list/],
      [(file) => { file.tours[0].views = Array(501).fill('south'); }, /tours\[0\]\.views is no list/], [(file) => { file.tours[0].views[0] = ['south']; }, /there is no view/],
      [(file) => { file.tours[0].seconds = 0; }, /tours\[0\]\.seconds/], [(file) => { file.tours[0].pause = -1; }, /tours\[0\]\.pause/], [(file) => { file.tours[0].loop = 'yes'; }, /tours\[0\]\.loop/],
    ];
    for (const [act, why] of cases) assert.throws(() => parseProject(change(act)), (error) => error instanceof ProjectError && why.test(error.message), String(why));
  });
  it('reads what a hand would write', () => {
    assert.deepEqual(readNotes({ annotations: [{ title: 'a', point: [0, 0, 0] }] }), [{ name: 'a', text: '', link: '', point: [0, 0, 0], step: 0, visible: true }]);
    assert.deepEqual(readTours({ tours: [{ name: 'a' }] }, readViews({})), [{ name: 'a', views: undefined, seconds: 4, pause: 2, loop: false }]);
    assert.deepEqual(writtenNotes(numbered([notes[1]])), [{ title: '=1+1', visible: false, step: 0, point: [1, 2, 3] }]);
  });
  it('a link leads to a page, or is none', () => {
    assert.equal(linkOf('HTTP://Example.org'), 'http://example.org/');
    for (const text of ['', 'example.org', 'ftp://a.example', 'javascript://https://a.example', undefined, 5]) assert.equal(linkOf(text), undefined, String(text));
  });
  it('a tour follows its views, whatever they are called; what is written can be read again, whatever has been taken back', () => {
    const [list, flights] = [new SteppedList(9), new SteppedList(9)];
    list.replace(views);
    flights.replace(toursOf(tours, list.list));
    const [walk, all] = flights.list;
    const reread = () => parseProject(printProject({ cloud, view: '', unit: 'm', measures: [], views: list.list, tours: flights.list })).tours.map(({ views: names }) => names);
    assert.deepEqual(stopsOf(walk, list.list).map(({ name }) => name), ['south', 'east', 'south']);
    assert.equal(stopsOf(all, list.list), list.list);
    list.change(list.list[0].id, { name: 'North' });
    assert.deepEqual(reread(), [['North', 'east', 'North'], undefined]);
    list.undo();
    assert.deepEqual(reread(), [['south', 'east', 'south'], undefined]);
    list.remove(list.list[0].id);
    assert.deepEqual(reread(), [['east'], undefined]);
    list.undo();
    assert.deepEqual(reread(), [['south', 'east', 'south'], undefined]);
    list.replace([{ name: 'other', view: 'a=b' }]); // another project, and its tours
    flights.replace(toursOf([{ ...tours[1], views: ['other'] }], list.list));
    list.undo();
    assert.deepEqual(reread(), [[]], 'of views that are gone');
  });
  it('what cannot be read is known before it is written', () => {
    assert.equal(refusalOf(whole()), '');
    assert.match(refusalOf(printProject({ cloud, view: '', unit: 'm', measures: [], views: [{ id: 1, name: 'long', view: 'x'.repeat(5000) }] })), /views\[0\]\.view/);
  });
  it('are exported as points', () => {
    const points = numbered(notes).map(pointOf);
    const [head, crack, formula] = csvOf(points, cloud, measure.kinds).split('\r\n');
    assert.match(head, /,crs,text,link$/);
    assert.match(csvOf(points, cloud, measure.kinds), /"Since 2021,\n""widening""",https:\/\/example\.org\/a\?b=1/);
    assert.match(crack, /^Crack,Note,,,1,389459\.271,5819743\.97,45\.426,0\.001,/);
    assert.ok(formula !== undefined && csvOf(points, cloud, measure.kinds).includes("'=1+1,Note"), 'no formula');
    assert.match(dxfOf(points, cloud, measure.kinds, { factor: 1, name: 'm' }), /POINT\r\n8\r\nNOTE/);
    const [feature] = JSON.parse(geoJsonOf(points)).features;
    assert.deepEqual(feature.properties, { name: 'Crack', kind: 'note', text: notes[0].text, link: notes[0].link });
    assert.deepEqual(feature.geometry, { type: 'Point', coordinates: notes[0].point });
  });
});

describe('a list whose changes can be taken back', () => {
  it('moves entries, and is full at some time', () => {
    const list = new SteppedList(3);
    for (const name of ['a', 'b', 'c']) list.add({ name });
    assert.equal(list.add({ name: 'd' }), undefined);
    const names = () => list.list.map(({ name }) => name).join('');
    list.move(3, -1);
    assert.equal(names(), 'acb');
    list.move(1, 9);
    assert.equal(names(), 'cba');
    list.move(3, -1); // the first stays the first
    assert.equal(names(), 'cba');
    list.undo();
    list.undo();
    assert.equal(names(), 'abc');
    list.redo();
    assert.equal(names(), 'acb');
  });
});

describe('a tour', () => {
  const orbit = (degrees, more = {}) => {
    const angle = (degrees * Math.PI) / 180;
    return { ...fromProtocol({ type: 'perspective', eye: [10 * Math.cos(angle), 10 * Math.sin(angle), 5], target: [0, 0, 0], up: [0, 0, 1], fov: 60 }), ...more };
  };
  const distance = (a, b) => Math.hypot(...a.map((value, i) => value - b[i]));
  it('of an orbit stays one: as far from the axis and as high as its views, by the shorter way round', () => {
    const tour = new Tour([0, 90, 180, 270].map((one) => orbit(one)), { seconds: 2, pause: 0, loop: true });
    assert.equal(tour.length, 8);
    for (let time = 0; time <= 8; time += 0.125) {
      const [x, y, z] = eyeOf(tour.at(time).camera);
      assert.ok(Math.abs(Math.hypot(x, y) - 10) < 1e-6 && Math.abs(z - 5) < 1e-6, `${time}: ${x}, ${y}, ${z}`);
    }
    assert.ok(distance(eyeOf(tour.at(7.999).camera), [10, 0, 5]) < 0.05);
  });
  it('rests at each view, which is that very camera, and goes slowly there and away', () => {
    const cameras = [0, 60, 120].map((one) => orbit(one));
    const tour = new Tour(cameras, { seconds: 2, pause: 1 });
    assert.equal(tour.length, 7);
    assert.equal(tour.arrivalAt(2), 6);
    for (const [time, index] of [[0, 0], [1, 0], [3, 1], [3.5, 1], [4, 1], [6, 2], [7, 2], [99, 2]]) {
      assert.equal(tour.at(time).camera, cameras[index], String(time));
      assert.deepEqual([tour.at(time).index, tour.at(time).rests], [index, true]);
    }
    const speed = (time) => distance(eyeOf(tour.at(time).camera), eyeOf(tour.at(time + 0.01).camera)) / 0.01;
    assert.ok(speed(1.001) < 0.2 * speed(2) && speed(2.98) < 0.2 * speed(2));
    assert.equal(tour.at(2).index, 0, 'its style stays until it has arrived');
  });
  it('without a pause its speed does not jump at a view, and it never goes back', () => {
    const line = (x) => ({ ...orbit(0), target: [x, 0, 0] });
    const tour = new Tour([0, 2, 30, 30, 90].map(line), { seconds: 2, pause: 0 });
    const at = (time) => tour.at(time).camera.target;
    for (const time of [2, 4]) {
      const [before, after] = [(at(time)[0] - at(time - 1e-5)[0]) / 1e-5, (at(time + 1e-5)[0] - at(time)[0]) / 1e-5];
      assert.ok(Math.abs(before - after) < 1e-2 * before + 1e-3, `${time}: ${before}, ${after}`);
    }
    let last = -1e-9;
    for (let time = 0; time <= 8; time += 0.02) {
      assert.ok(at(time)[0] >= last - 1e-6, String(time));
      [last] = at(time);
    }
  });
  it('neither loops nor overshoots, however unlike its legs are', () => {
    const away = (degrees, distance) => ({ ...orbit(degrees), elevation: 0, distance });
    const cameras = [away(0, 1), away(90, 1), away(90, 1000), away(90, 10), away(90, 1), away(90, 1000)];
    for (const pause of [0, 2]) {
      const tour = new Tour(cameras, { seconds: 4, pause });
      for (let time = 0; time <= tour.length; time += 0.05) {
        const leg = Math.min(4, Math.floor(time / (4 + pause)));
        const { distance: far, azimuth } = tour.at(time).camera;
        const ends = [cameras[leg].distance, cameras[leg + 1].distance];
        assert.ok(far >= Math.min(...ends) * (1 - 1e-9) && far <= Math.max(...ends) * (1 + 1e-9), `${time}: ${far}`);
        assert.ok(azimuth >= -1e-9 && azimuth <= Math.PI / 2 + 1e-9, `${time}: ${azimuth}`);
      }
    }
  });
  it('does not pass through what it looks at, from one side to the other', () => {
    const tour = new Tour([orbit(0), orbit(179)], { seconds: 2, pause: 0 });
    for (let time = 0; time <= 2; time += 0.1) assert.ok(distance(eyeOf(tour.at(time).camera), [0, 0, 0]) > 10);
  });
});

describe('a picture to be saved', () => {
  const date = new Date(2026, 10, 26, 12);
  it('has a name that says what it is', () => {
    assert.equal(pictureName({ cloud: 'town', method: 'ewa', width: 3840, height: 2160, format: 'png', date }), 'town-2026-11-26-ewa-3840x2160.png');
    assert.equal(pictureName({ cloud: '../Stadt Ä', method: '', width: 16, height: 16, format: 'jpg', date }), 'stadt-2026-11-26-16x16.jpg');
    assert.equal(pictureName({ cloud: '..', method: '/', width: 16, height: 16, format: 'exe', date }), 'scan-2026-11-26-16x16.png');
  });
  it('has sides within what the server draws', () => {
    assert.deepEqual([16, mostSide, 15, mostSide + 1, 20.5, NaN, Infinity].map(sideOf), [16, mostSide, undefined, undefined, undefined, undefined, undefined]);
    const presets = presetsOf({ width: 6000, height: 3000 });
    assert.ok(presets.every(([name, width, height]) => sideOf(width) && sideOf(height) && strings && name));
    assert.ok(!presets.some(([name]) => name === 'four'), 'that would be too large');
  });
  it('has a scale bar of a round length, and north where that is', () => {
    const bounds = { min: [0, 0, 0], max: [100, 100, 10] };
    const size = { width: 1200, height: 800 };
    const start = { target: [50, 50, 5], azimuth: 0, elevation: 0.5, distance: 100, fov: 60, projection: 'orthographic', upAxis: 'z' };
    const top = standardView(start, 'top', bounds, size);
    const pose = poseOf(top, bounds, size.width / size.height);
    const { pixels, text, where } = scaleOn(pose, size, { crsUnit: 'metre' });
    const metres = Number(/^(\d+) m$/.exec(text)[1]);
    // What the plan shows of 100 m, by the camera itself.
    assert.ok(Math.abs(pixels / metres - size.height / (2 * top.distance * Math.tan(Math.PI / 6))) < 1e-6);
    assert.ok(pixels <= size.width / 6 && pixels > size.width / 20 && where === '');
    const { x, y } = northOn(pose, 'z');
    assert.ok(Math.abs(x) < 1e-9 && y === -1, 'up');
    assert.equal(northOn(poseOf(standardView(start, 'front', bounds, size), bounds, 1.5), 'z'), undefined, 'into the picture');
    assert.ok(northOn(poseOf(standardView(start, 'side', bounds, size), bounds, 1.5), 'z').x > 0.99, 'seen from the east, to the right');
    assert.ok(textSize({ width: 16384, height: 9216 }) > 10 * textSize({ width: 960, height: 600 }));
  });
  it('has the legend of the page', () => {
    assert.equal(legendTitle({ title: 'Elevation', unit: 'm' }), 'Elevation (m)');
    assert.deepEqual(legendLines({ classes: [{ name: 'Ground', color: '#123456' }], more: 2 }), [{ text: 'Ground', color: '#123456' }, { text: 'and 2 more' }]);
    assert.deepEqual(legendLines({ colors: ['#000000'], note: 'x' }), [{ text: 'x' }]);
  });
});

describe('two sides', () => {
  it('are said by an address, and read again; nonsense is left out', () => {
    const sides = { at: 33.3, method: 'point', color: '#ff0000', shading: 'auto', classes: 6, cloud: 'town' };
    assert.deepEqual(parseSides(`#cloud=a${printSides(sides)}`), sides);
    assert.deepEqual(parseSides(printSides({ at: 50, color: 'rgb*intensity' })), { at: 50, color: 'rgb*intensity' });
    assert.equal(parseSides('#cloud=a&eye=1,2,3'), undefined);
    assert.deepEqual(parseSides('#compare=at:900;method:<b>;color:%zz;classes:999;constructor:1;__proto__:2;shading'), { at: 50 });
    assert.equal(parseSides(`#compare=${'x'.repeat(900)}`), undefined);
  });
  it('differ in what was chosen, and in what hangs together with it', () => {
    const style = { method: 'ewa', param: { scale: 2 }, detail: 1, color: 'elevation', range: [0, 9], shading: null, classes: [2] };
    assert.deepEqual(rightStyle(style, { at: 50 }), style);
    assert.deepEqual(rightStyle(style, { method: 'point', color: 'rgb', classes: 'all', shading: 'phong' }),
      { method: 'point', param: {}, detail: null, color: 'rgb', range: null, shading: 'phong', classes: null });
    assert.deepEqual(rightStyle(style, { method: 'ewa', shading: 'auto', classes: 6 }), { ...style, classes: [6] });
  });
});
