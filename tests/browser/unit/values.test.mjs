// Filters by values, clouds together, maps: all that is arithmetic. What the words look like is the protocol's (view_hash.test.mjs).

import assert from 'node:assert/strict';
import { describe, it } from 'node:test';

import { otherColour } from '../../../client/web/compare/sides.js';
import { addressesOf, rasterSize, usualCell, wordsFor } from '../../../client/web/export/maps.js';
import { columnsFor, filtered } from '../../../client/web/filter/filtering.js';
import { colorAt, handlesAt, heightsOf, reachOf, valuesAt } from '../../../client/web/filter/value_slider.js';
import { colourOptions } from '../../../client/web/page/colour_choice.js';
import { columnTitle, columnsOf, unitOfColumn } from '../../../client/web/page/columns.js';
import { regionOf } from '../../../client/web/export/region.js';
import { isAlone, membersOf, ownShift, wordOf } from '../../../client/web/page/members.js';
import { legendLines, legendOf } from '../../../client/web/page/plan/legend.js';
import { parseHash, printHash } from '../../../client/web/view/view_hash.js';
import { askable, boundsOf } from '../../../client/web/view/usual.js';
import { othersOf, reasonAgainst, stepped } from '../../../client/web/together/together.js';

const returns = { name: 'return_number', type: 'uint8', range: [1, 5], histogram: { low: 0.5, high: 5.5, counts: [900, 300, 80, 10, 2] } };
const time = { name: 'gps_time', type: 'float64', range: [1000, 4600], usual: [1100, 4500], histogram: { low: 1100, high: 4500, counts: [1, 4, 16] } };
const cloud = { id: 'town', view: { filter: null, with: null }, columns: [returns, time], attributes: [{ name: 'rgb' }, { name: 'intensity', range: [0, 255] }], bounds: { min: [0, 0, 0], max: [100, 50, 20] } };

describe('two handles over a histogram', () => {
  it('of whole numbers stand between them: each number can be had alone', () => {
    const reach = reachOf(returns);
    assert.deepEqual(reach, { low: 0.5, high: 5.5, step: 1, whole: true });
    for (const [at, values] of [[[0.5, 5.5], [null, null]], [[0.5, 1.5], [null, 1]], [[1.5, 2.5], [2, 2]], [[2.5, 5.5], [3, null]]]) {
      assert.deepEqual(valuesAt(at, reach), values);
      assert.deepEqual(handlesAt(values, reach), at);
    }
  });
  it('of other numbers are plain ones; an end is open; what was typed beyond stands at the end', () => {
    const reach = reachOf(time);
    assert.equal(reach.whole, false);
    assert.deepEqual(valuesAt([1100, 4500], reach), [null, null]);
    assert.deepEqual(valuesAt([1106.8, 3000.123456], reach), [1107, 3000]);
    assert.deepEqual(handlesAt([1000, 9000], reach), [1100, 4500]);
  });
  it('reach over the range where there is no histogram; over nothing where nothing is known', () => {
    assert.deepEqual(reachOf({ type: 'uint8', range: [0, 3] }), { low: -0.5, high: 3.5, step: 1, whole: true });
    assert.deepEqual(reachOf({ type: 'float32', range: [2, 2] }), { low: 1.5, high: 2.5, step: 0.002, whole: false });
    assert.equal(reachOf({ name: 'x', type: 'float64' }), undefined);
  });
  it('small parts are drawn so that they are seen; colours are the ramp’s', () => {
    assert.deepEqual(heightsOf({ counts: [0, 1, 4, 16] }), [0, 0.25, 0.5, 1]);
    const ramp = { colors: ['a', 'b', 'c'], range: [0, 10] };
    assert.deepEqual([-5, 0, 4, 6, 10, 99].map((value) => colorAt(value, ramp)), ['a', 'a', 'b', 'b', 'c', 'c']);
  });
});

describe('filters', () => {
  it('are added, changed in their place, and taken away when both ends are open', () => {
    const one = filtered(null, 'return_number', [null, 1]);
    assert.deepEqual(one, [{ column: 'return_number', high: 1 }]);
    const two = filtered(one, 'gps_time', [1200, 1300]);
    assert.deepEqual(filtered(two, 'return_number', [2, 2]), [{ column: 'return_number', low: 2, high: 2 }, { column: 'gps_time', low: 1200, high: 1300 }]);
    assert.deepEqual(filtered(two, 'return_number', [null, null]), [{ column: 'gps_time', low: 1200, high: 1300 }]);
    assert.equal(filtered(one, 'return_number', [null, null]), null);
    assert.equal(filtered(null, 'gps_time', [null, null]), null);
  });
  it('are offered of columns, of intensity and classes where something is known of them', () => {
    assert.deepEqual(columnsFor({ ...cloud, attributes: [...cloud.attributes, { name: 'classification' }], classes: [2, 6] }).map(({ name, range }) => [name, range]),
      [['intensity', [0, 255]], ['classification', [2, 6]], ['return_number', [1, 5]], ['gps_time', [1000, 4600]]]);
    assert.deepEqual(columnsFor({ columns: [{ name: 'x', type: 'float64' }] }), []);
  });
  it('of a cloud that is still being read wait for its columns, and are wanted all the same', () => {
    const view = { filter: [{ column: 'gps_time', low: 5 }], color: 'column:gps_time', range: [0, 1], method: 'point' };
    assert.equal(askable(view, cloud), view);
    assert.deepEqual(askable(view, { ...cloud, state: 'loading', columns: [] }), { filter: null, color: 'auto', range: null, method: 'point' });
    assert.deepEqual(askable(view, { ...cloud, state: 'loading' }), view);
    const both = { filter: [...view.filter, { column: 'later', high: 1 }] };
    assert.deepEqual(askable(both, { ...cloud, state: 'loading' }), { filter: view.filter }, 'what is known holds meanwhile');
  });
});

describe('columns as colours', () => {
  it('are offered by their names where the server knows them', () => {
    assert.deepEqual(colourOptions(['auto', 'rgb'], cloud, 'auto').options.map(({ value }) => value), ['auto', 'rgb', 'flat', 'column:return_number', 'column:gps_time']);
    assert.deepEqual(columnsOf({ ...cloud, view: {} }), []);
    assert.deepEqual(['gps_time', 'Pulse_width'].map(columnTitle), ['GPS time', 'Pulse width']);
    assert.deepEqual([unitOfColumn(time, cloud), unitOfColumn({ name: 'a', unit: 'dB' }, cloud), unitOfColumn({ name: 'distance' }, { crsUnit: 'metre' }), unitOfColumn(returns, cloud)], ['s', 'dB', 'm', '']);
  });
  it('have a legend with name, unit, description and ends', () => {
    const of = { ...cloud, columns: [{ ...time, description: 'Seconds of the week' }] };
    const view = { color: 'column:gps_time', colormap: 'viridis', range: null };
    const ramps = { viridis: ['#000', '#fff'] };
    assert.equal(legendOf({ view, cloud: of, ramps }), undefined, 'the server has not said the ends yet');
    const legend = legendOf({ view, cloud: of, ramps, stats: { color: 'column:gps_time', colormap: 'viridis', range: [1100, 4500] } });
    assert.deepEqual(legend, { title: 'GPS time', colors: ['#000', '#fff'], ends: ['1,100', '4,500'], unit: 's', note: 'Seconds of the week' });
    assert.deepEqual(legendLines(legend), [{ text: 'Seconds of the week' }]);
  });
});

describe('clouds together', () => {
  const tile = { id: 'tile', title: 'A tile', bounds: { min: [100, 0, 0], max: [200, 50, 20] }, crsEpsg: 25833, crsName: 'UTM 33' };
  const clouds = [cloud, tile];
  it('have colours by their places in the list, this one first unless the view says another place', () => {
    const members = membersOf({ with: [{ cloud: 'tile', tint: '#ff0000' }, { cloud: 'x' }] }, { ...cloud, title: 'Town' }, clouds);
    assert.deepEqual(members.map(({ name, color }) => [name, color]), [['Town', '#56b4e9'], ['A tile', '#ff0000'], ['x', '#009e73']]);
    assert.deepEqual(membersOf({ with: [{ cloud: 'tile' }, { cloud: '.' }] }, cloud, clouds).map(({ cloud: id, color }) => [id, color]), [['tile', '#56b4e9'], ['.', '#e69f00']]);
    assert.equal(wordOf(membersOf({ with: null }, cloud, clouds)), null);
    const word = [{ cloud: '.', hidden: true }, { cloud: 'tile', shift: [0, 0, 0.5], tint: '#ff0000' }];
    assert.deepEqual(wordOf(membersOf({ with: word }, cloud, clouds)), word);
    assert.deepEqual(wordOf([{ cloud: '.' }, { cloud: 'tile', shift: [0, 0, 0], hidden: false }]), [{ cloud: 'tile' }]);
  });
  it('stand in the legend as far as they are seen', () => {
    const legend = legendOf({ view: { color: 'cloud', with: [{ cloud: 'tile', hidden: true }, { cloud: 'x' }] }, cloud, clouds });
    assert.deepEqual(legendLines(legend), [{ text: 'town', color: '#56b4e9' }, { text: 'x', color: '#009e73' }]);
  });
  it('are bounded by all that is seen, each where it is shifted to', () => {
    assert.equal(boundsOf(cloud, null, clouds), cloud.bounds);
    assert.deepEqual(boundsOf(cloud, [{ cloud: 'tile', shift: [0, 0, 5] }], clouds), { min: [0, 0, 0], max: [200, 50, 25] });
    assert.deepEqual(boundsOf(cloud, [{ cloud: '.', hidden: true }, { cloud: 'tile' }], clouds), tile.bounds);
    assert.deepEqual(boundsOf(cloud, [{ cloud: 'tile', hidden: true }], clouds), cloud.bounds);
  });
  it('of which the own one is shifted: what is asked of its file is asked where its file has it', () => {
    const view = { with: [{ cloud: '.', shift: [1, 2, 3] }], clip: { min: [1, 2, 3], max: [2, 3, 4] }, clips: [{ box: { center: [1, 2, 3], size: [1, 1, 1] }, keep: 'inside' }, { plane: { point: [2, 2, 3], normal: [0, 0, 1] } }] };
    assert.deepEqual(regionOf(view, { shapes: true, polygon: [[1, 2, 3], [5, 2, 3], [5, 9, 3]] }), {
      clip: { min: [0, 0, 0], max: [1, 1, 1] }, clips: [{ box: { center: [0, 0, 0], size: [1, 1, 1] }, keep: 'inside' }, { plane: { point: [1, 0, 0], normal: [0, 0, 1] } }],
      polygon: [[0, 0], [4, 0], [4, 7]],
    });
    assert.deepEqual([ownShift(view), ownShift({ with: [{ cloud: 'tile', shift: [1, 1, 1] }] })], [[1, 2, 3], undefined]);
    assert.deepEqual([view, { with: [{ cloud: 'tile' }] }, { with: [{ cloud: 'tile', hidden: true }] }, {}].map(isAlone), [false, false, true, true]);
  });
  it('can be added where they are in the same coordinates: the nearest first; others say why not', () => {
    const own = { ...cloud, crsEpsg: 25833 };
    const far = { ...tile, id: 'far', bounds: { min: [900, 0, 0], max: [950, 1, 1] } };
    const swiss = { ...tile, id: 'swiss', title: 'Swiss', crsEpsg: 2056, crsName: 'LV95' };
    assert.match(reasonAgainst(own, swiss), /another coordinate system: LV95/);
    assert.equal(reasonAgainst({ ...own, crsEpsg: undefined }, swiss), '', 'who says nothing is taken by the other’s word');
    assert.match(reasonAgainst({ ...own, crsEpsg: undefined, crsUnit: 'metre' }, { ...swiss, crsUnit: 'foot' }), /another/);
    const all = { clouds: [own, swiss, far, tile], pending: [{ id: 'late', state: 'loading' }] };
    assert.deepEqual(othersOf(own, ['.'], all).map(({ cloud: { id }, reason }) => [id, reason.slice(0, 10)]), [['tile', ''], ['far', ''], ['swiss', 'in another'], ['late', 'still load']]);
    assert.deepEqual(othersOf(own, ['.', 'tile'], all, ' SWI').map(({ cloud: { id } }) => id), ['swiss']);
    assert.deepEqual([stepped(0.3, -0.1), stepped(1e-7, 1e-8)], [0.2, 1.1e-7]);
  });
});

describe('maps and rasters', () => {
  it('addresses say the look only where it is not the cloud’s own', () => {
    const usual = { method: 'auto', color: 'auto', colormap: 'viridis', filter: null };
    assert.equal(wordsFor(usual, usual, Object.keys(usual)), '');
    assert.equal(wordsFor({ ...usual, color: 'elevation', filter: [{ column: 'a b', low: 1 }] }, usual, Object.keys(usual)), 'color=elevation&filter=a%20b:1..');
    assert.deepEqual(addressesOf('https://a.example', 'my town', 'color=elevation'), {
      wms: 'https://a.example/api/v1/clouds/my%20town/wms?SERVICE=WMS&REQUEST=GetCapabilities&color=elevation',
      wmts: 'https://a.example/api/v1/clouds/my%20town/wmts?SERVICE=WMTS&REQUEST=GetCapabilities&color=elevation',
      tiles: 'https://a.example/api/v1/clouds/my%20town/tiles/mercator/{z}/{x}/{y}.png?color=elevation',
    });
  });
  it('a raster is as large as it is said to be; the first cell is a round one', () => {
    assert.deepEqual(rasterSize([0, 0, 10, 5.1], 0.1), { columns: 100, rows: 51, bytes: 4 * 5100 });
    assert.deepEqual([0.012, 0.3, 0].map((spacing) => usualCell({ spacing, bounds: cloud.bounds })), [0.05, 1, 0.02]);
  });
});

describe('comparing begins with two sides that differ', () => {
  const colors = ['rgb', 'elevation', 'intensity', 'classification'];
  it('by another colour than the left one has', () => {
    assert.equal(otherColour({ color: 'auto' }, cloud, colors), 'elevation');
    assert.equal(otherColour({ color: 'elevation*intensity' }, cloud, colors), 'intensity');
    assert.equal(otherColour({ color: 'elevation' }, { attributes: [] }, colors), undefined);
    assert.equal(otherColour({ color: 'auto' }, { attributes: [{ name: 'rgb' }], look: { color: 'elevation' } }, colors), 'rgb');
  });
});

describe('the words of filters and of clouds together', () => {
  const text = 'color=column:Pulse%20width&filter=return_number:1..1;gps_time:3600..;a:b%253B%2525:..-2.5&with=.,tint:ff8800;town-2024,shift:0:0:0.12;town-2019,hidden';
  it('are read and written as the protocol has them', () => {
    const { style } = parseHash(`#${text}`);
    assert.deepEqual(style, {
      color: 'column:Pulse width', filter: [{ column: 'return_number', low: 1, high: 1 }, { column: 'gps_time', low: 3600 }, { column: 'a:b;%', high: -2.5 }],
      with: [{ cloud: '.', tint: '#ff8800' }, { cloud: 'town-2024', shift: [0, 0, 0.12] }, { cloud: 'town-2019', hidden: true }],
    });
    assert.equal(printHash('a', style), `#cloud=a&${text}`);
    assert.deepEqual(parseHash('#with=auto&filter=auto').style, { with: null, filter: null });
  });
  it('that are none are left out', () => {
    for (const word of ['filter=a', 'filter=a:..', 'filter=a:2..1', 'filter=:1..2', 'filter=a:1..2;', 'filter=a:x..', `filter=${'a:1..;'.repeat(5)}a:1..`, 'with=a b', 'with=a,shift:1:2', 'with=a,tint:red', 'with=a,seen', 'color=column:'])
      assert.deepEqual(parseHash(`#${word}`).style, {}, word);
  });
});
