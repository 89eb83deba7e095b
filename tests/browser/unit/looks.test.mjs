// What the page offers and how it says it: the pure parts of panel, rail and galleries.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { describe, it } from 'node:test';

import { backgroundNamed } from '../../../client/web/page/controls.js';
import { colourOptions, takesIntensity } from '../../../client/web/page/colour_choice.js';
import { nearestHeight, sheetHeights } from '../../../client/web/page/layout.js';
import { lackingFor, quickChoices, wordFor } from '../../../client/web/page/method_choice.js';
import { asksToPresent } from '../../../client/web/page/presentation.js';
import { creditOf, dateText, extentText, factsOfScan } from '../../../client/web/page/scan_facts.js';
import { counted, stringAt } from '../../../client/web/page/strings.js';
import { middleOf, thumbnailUrl } from '../../../client/web/page/thumbnails.js';
import { placeOf } from '../../../client/web/page/tools.js';

const method = (name, needs = []) => ({ name, title: name, needs });
const methods = [method('paraboloid'), method('point'), method('hqs'), method('ewa', ['surfels']), method('pyramid'), method('auto')];
const bare = { attributes: [], surfels: false };

describe('Sharp, Smooth and Raw', () => {
  const meanings = (cloud, offered = methods) => Object.fromEntries(quickChoices(offered, cloud).map(({ word, method: means, reason }) => [word, means ?? reason]));
  it('mean what the scan can be drawn with', () => {
    assert.deepEqual(meanings({ ...bare, surfels: true }), { sharp: 'auto', smooth: 'ewa', raw: 'point' });
    assert.deepEqual(meanings(bare), { sharp: 'auto', smooth: 'pyramid', raw: 'point' });
    assert.deepEqual(meanings(bare, [method('paraboloid'), method('hqs'), method('square')]), { sharp: 'paraboloid', smooth: 'hqs', raw: 'square' });
  });
  it('say why where there is none', () => {
    assert.match(meanings(bare, [method('ewa', ['surfels'])]).smooth, /needs surface normals/);
    assert.match(meanings(bare, [method('ewa', ['surfels'])]).raw, /not offered/);
  });
  it('are told from a method, and from none of them', () => {
    const quick = quickChoices(methods, { ...bare, surfels: true });
    assert.deepEqual(['auto', 'paraboloid', 'ewa', 'point', 'pyramid', 'cone'].map((name) => wordFor(name, quick)), ['sharp', 'sharp', 'smooth', 'raw', undefined, undefined]);
  });
  it('know what a cloud lacks', () => {
    assert.deepEqual(lackingFor(method('x', ['surfels', 'rgb']), { attributes: [{ name: 'rgb' }] }), ['surfels']);
    assert.deepEqual(lackingFor(undefined, bare), []);
  });
});

describe('colours', () => {
  const colors = ['auto', 'rgb*intensity', 'elevation*intensity', 'rgb', 'intensity', 'elevation', 'visibility'];
  const values = (list) => list.map(({ value }) => value);
  it('are those that a scan has; the rest says why not', () => {
    const { options, missing } = colourOptions(colors, { attributes: [{ name: 'rgb' }] }, 'auto');
    assert.deepEqual(values(options), ['auto', 'rgb', 'elevation', 'flat']);
    assert.deepEqual(missing.map(({ label, reason }) => `${label}: ${reason}`), ['Intensity: not in this scan', 'Hidden points: only with the method “Reconstructed surface”']);
    assert.ok(values(colourOptions(colors, bare, 'pyramid').options).includes('visibility'));
  });
  it('can be shaded by intensity where the scan and the server have that', () => {
    const cloud = { attributes: [{ name: 'intensity' }] };
    assert.deepEqual(['rgb', 'elevation', '#ff0000', 'intensity', 'auto'].map((one) => takesIntensity(one, colors, cloud)), [true, true, true, false, false]);
    assert.ok(!takesIntensity('rgb', colors, bare));
  });
  it('of backgrounds have names', () => {
    assert.deepEqual([null, undefined, ['#3a424e', '#16191e'], '#ffffff', '#000000', ['#f4f6f8', '#c3ccd5'], '#123456', 'transparent'].map(backgroundNamed),
      ['dusk', 'dusk', 'dusk', 'white', 'black', 'daylight', 'custom', 'custom']);
  });
});

describe('the rail', () => {
  it('keeps places for tools that come later', () => {
    const order = ['present', 'measure', 'orbit', 'annotate', 'views', 'something', 'look', 'clip'];
    const key = (id) => placeOf(id)[0] * 100 + placeOf(id)[1];
    assert.deepEqual([...order].sort((a, b) => key(a) - key(b)), ['orbit', 'look', 'measure', 'clip', 'annotate', 'views', 'present', 'something']);
  });
});

describe('the sheet', () => {
  it('comes to rest at the nearest height, and closes below half of the lowest', () => {
    for (const [name, height] of Object.entries(sheetHeights)) assert.equal(nearestHeight(height), name);
    assert.equal(nearestHeight(1), 'full');
    assert.equal(nearestHeight(0.05), undefined);
    assert.equal(nearestHeight(0.36), 'peek');
  });
});

describe('what is said of a scan', () => {
  it('is its size, its day and whose it is', () => {
    const bounds = { min: [0, 0, 0], max: [200.01, 1234, 33.82] };
    assert.equal(extentText(bounds, 'metre'), '200 × 1,230 × 33.8 m');
    assert.equal(extentText(bounds, ''), '200 × 1,230 × 33.8');
    assert.deepEqual(['2024-05-13', '2024-05', '2024', '', undefined, 'yesterday', 17].map(dateText), ['13 May 2024', 'May 2024', '2024', '', '', '', '']);
    assert.equal(creditOf({ attribution: ' City of Graz, CC BY 4.0 ' }), 'City of Graz, CC BY 4.0');
    assert.equal(creditOf({}), '');
    const facts = Object.fromEntries(factsOfScan({ points: 1, bounds, spacing: 0.123, crsUnit: 'metre', attributes: [{ name: 'rgb' }, { name: 'gps_time' }], notes: [], droppedPoints: 0 }));
    assert.deepEqual(facts, { Points: '1', Extent: '200 × 1,230 × 33.8 m', 'Point spacing': '0.12 m', Attributes: 'RGB, gps_time' });
  });
  it('counts one as one', () => {
    assert.deepEqual([0, 1, 2, 1_234_567].map((n) => counted(n, 'point')), ['0 points', '1 point', '2 points', '1.2 million points']);
  });
});

describe('strings', () => {
  it('are there for everything in the document that names one, and the document has no others', () => {
    const html = readFileSync(new URL('../../../client/web/index.html', import.meta.url), 'utf8');
    const named = [...html.matchAll(/ data-(?:text|label|tip|hint)="([^"]+)"/g)].map(([, path]) => path);
    assert.ok(named.length > 50);
    for (const path of named) assert.equal(typeof stringAt(path), 'string', path);
    assert.equal(stringAt('panel.constructor'), undefined);
    assert.equal(stringAt('nothing.at.all'), undefined);
  });

  it('are there for everything in the cards of the tools, which bring their own', async () => {
    for (const [name, least] of Object.entries({ measure: 20, clip: 8 })) {
      const { card } = await import(`../../../client/web/${name}/card.js`);
      const words = (await import(`../../../client/web/page/strings/${name}.js`))[name];
      const named = [...card.matchAll(/ data-(?:text|label|tip|hint)="([^"]+)"/g)].map(([, path]) => path);
      assert.ok(named.length >= least, `${name}: ${named.length}`);
      for (const path of named) assert.equal(typeof stringAt(path, words), 'string', `${name}: ${path}`);
    }
  });
});

describe('thumbnails', () => {
  const view = { method: 'point', param: {}, camera: { type: 'perspective', eye: [1, 2, 3], target: [0, 0, 0], up: [0, 0, 1], fov: 60 } };
  it('are small snapshots', () => {
    const url = new URL(thumbnailUrl('a b', view), 'http://localhost');
    assert.equal(url.pathname, '/api/v1/clouds/a%20b/snapshot.jpg');
    assert.deepEqual(['width', 'height', 'method', 'quality'].map((word) => url.searchParams.get(word)), ['216', '144', 'point', '75']);
  });
  it('of methods show the middle, a pixel of theirs for each of the screen', () => {
    const seen = (fov) => Math.tan((fov * Math.PI) / 360);
    assert.ok(Math.abs(seen(middleOf(view.camera, 720).fov) / seen(60) - 144 / 720) < 1e-12);
    assert.equal(middleOf({ type: 'orthographic', viewHeight: 10 }, 288).viewHeight, 5);
    assert.equal(middleOf({ type: 'orthographic', viewHeight: 10 }, 100).viewHeight, 10, 'no more than there is');
  });
});

describe('#present', () => {
  it('is a word of its own', () => {
    for (const hash of ['#present', '#cloud=a&present', '#present=true&cloud=a']) assert.ok(asksToPresent(hash), hash);
    for (const hash of ['', '#', '#cloud=present', '#presenter', '#present=false']) assert.ok(!asksToPresent(hash), hash);
  });
});
