import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { describe, it } from 'node:test';

import { pointUnderCursor, project } from '../../../client/web/view/camera.js';
import { cameraOf, wireOf } from '../../../client/web/view/camera_words.js';
import { parseHash, printHash } from '../../../client/web/view/view_hash.js';
import { printQuery, snapshotUrl, wordsOf } from '../../../client/web/protocol/view_words.js';
import { manyCameras, random } from '../support/cameras.mjs';

const style = {
  method: 'paraboloid', param: { sizePx: 5.5, footprint: 'square', smooth: true }, color: 'elevation', colormap: 'turbo',
  range: [-3, 25.25], shading: 'eyedome', mirrors: false, behindMirrors: true,
  background: ['#102030', '#000000'], detail: 0.5,
};

describe('the hash', () => {
  it('round trip: a link shows what its sender saw', () => {
    for (const camera of manyCameras()) {
      const read = parseHash(printHash('town', { camera: wireOf(camera), ...style }, camera.upAxis));
      assert.equal(read.cloud, 'town');
      assert.deepEqual(read.style, style);
      const again = cameraOf(read.camera, undefined, read.upAxis);
      assert.equal(again.upAxis, camera.upAxis);
      assert.deepEqual(wireOf(again), wireOf(camera), 'the same words are sent: the same picture to the last bit');
      // Rounding moves nothing that one could see: the same points appear at the same places of the picture.
      const size = { width: 1000, height: 1000 };
      for (const cursor of [{ x: 500, y: 500 }, { x: 30, y: 900 }]) {
        const seen = project(again, pointUnderCursor(camera, cursor, size), size);
        assert.ok(Math.hypot(seen.x - cursor.x, seen.y - cursor.y) < 1e-3);
      }
    }
  });

  it('one colour, one background, and what the server is left to choose', () => {
    const view = { ...style, color: '#ff8800', background: '#ffffff', range: null, shading: null, mirrors: null, behindMirrors: null, detail: null, param: {} };
    const read = parseHash(printHash('a.b-c_d', view));
    assert.equal(read.cloud, 'a.b-c_d');
    assert.deepEqual(read.style, { method: 'paraboloid', param: {}, color: '#ff8800', colormap: 'turbo', background: '#ffffff' });
    assert.equal(read.camera, undefined);
  });

  it('a colour times intensity', () => {
    for (const color of ['rgb*intensity', '#ff8800*intensity']) {
      const hash = printHash('town', { ...style, color });
      assert.equal(parseHash(hash).style.color, color, hash);
    }
    for (const text of ['*intensity', 'rgb*depth', 'rgb*<b>*intensity']) assert.equal(parseHash(`#color=${text}`).style.color, undefined, text);
  });

  const everyWord = 'exposure=0.5&classes=2,6&clip=0,0,0,10,10,5&clips=box:1,2,3,4,5,6;-box:0,0,0,1,2,3,30;box:0,0,0,1,2,3,30,-10,5;plane:0,0,1,0,0,-2&filter=return_number:1..1;a%20b:..-2.5&with=.,tint:ff8800;town-2,shift:0:-1:0.5,hidden&light.ambient=0.3&light.headlight=0.7&light.sunlight=0.8&light.shine=0.2' +
    '&light.shadow=0.9&light.occlusion=0.6&light.sun=135,40&outliers=show&budget=5000000&samples=4&quality=50&subsampling=4:4:4';

  it('keeps every word of the vocabulary, whoever wrote it', () => {
    const { style: read } = parseHash(`#method=cone&color=rgb&${everyWord}`);
    assert.deepEqual(read, {
      method: 'cone', param: {}, color: 'rgb', exposure: 0.5, classes: [2, 6], clip: { min: [0, 0, 0], max: [10, 10, 5] },
      clips: [
        { box: { center: [1, 2, 3], size: [4, 5, 6], turn: [0, 0, 0] }, keep: 'inside' },
        { box: { center: [0, 0, 0], size: [1, 2, 3], turn: [30, 0, 0] }, keep: 'outside' },
        { box: { center: [0, 0, 0], size: [1, 2, 3], turn: [30, -10, 5] }, keep: 'inside' },
        { plane: { point: [0, 0, 1], normal: [0, 0, -2] } },
      ],
      filter: [{ column: 'return_number', low: 1, high: 1 }, { column: 'a b', high: -2.5 }],
      with: [{ cloud: '.', tint: '#ff8800' }, { cloud: 'town-2', shift: [0, -1, 0.5], hidden: true }],
      light: { ambient: 0.3, headlight: 0.7, sunlight: 0.8, shine: 0.2, shadow: 0.9, occlusion: 0.6, sun: [135, 40] },
      outliers: 'show', budget: 5e6, samples: 4, quality: 50, subsampling: '4:4:4',
    });
    assert.equal(printHash('a', read), `#cloud=a&method=cone&color=rgb&${everyWord}`);
    // What the cloud has anyway is not repeated, and what is left to the server against that is said.
    const usual = { ...read, method: 'point', exposure: 1, range: [0, 1], background: '#ffffff' };
    assert.equal(printHash('a', { ...read, exposure: null, range: null, background: null }, 'z', usual),
      '#cloud=a&method=cone&color=rgb&range=auto&background=3a424e,16191e&exposure=auto');
    assert.deepEqual(parseHash('#range=auto&light.sun=auto&classes=none&near=auto').style, { range: null, light: { sun: null }, classes: [] });
  });

  it('knows each word that the protocol has, by its own example', () => {
    const protocol = readFileSync(new URL('../../../protocol/PROTOCOL.md', import.meta.url), 'utf8');
    const table = protocol.slice(protocol.indexOf('| word | flag | value |'), protocol.indexOf('- `auto` puts a word back'));
    const examples = [...table.matchAll(/^\| `[^`]+` .*\| `([^`]+)` \|$/gm)].map(([, example]) => example);
    assert.ok(examples.length >= 35, String(examples.length));
    for (const example of examples) {
      if (/^(width|height)=/.test(example)) continue; // the window says that
      const { camera, style: read } = parseHash(`#${example}`);
      assert.ok(camera || Object.keys(read).length > 0, example);
    }
  });

  it('keeps cameras that no hand can steer, until they are moved', () => {
    const usual = { type: 'perspective', eye: [0, -10, 0], target: [0, 0, 0], up: [0, 0, 1], fov: 45, near: null, far: null };
    const shown = (hash) => wireOf(cameraOf(parseHash(hash).camera, usual));
    const rolled = '#eye=1,2,3&target=0,0,0&up=0.5,0,1&projection=perspective&fov=50&near=0.5&far=200';
    assert.deepEqual(shown(rolled), { type: 'perspective', eye: [1, 2, 3], target: [0, 0, 0], up: [0.5, 0, 1], fov: 50, near: 0.5, far: 200 });
    assert.equal(printHash('a', { camera: shown(rolled) }), rolled.replace('#', '#cloud=a&'));
    const moved = { ...cameraOf(parseHash(rolled).camera, usual), fov: 51 };
    assert.deepEqual([wireOf(moved).up, wireOf(moved).near], [[0, 0, 1], 0.5], 'it stands up when a hand takes it');
    assert.deepEqual(shown('#eye=5,5,5'), { ...usual, eye: [5, 5, 5] }, 'what is not said is the usual');
    // World to view by a quarter turn about X: looking along +Y from (0, -10, 0).
    const matrix = [1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, -10, 1];
    const camera = cameraOf(parseHash(`#viewMatrix=${matrix}`).camera, usual);
    assert.deepEqual(wireOf(camera), { type: 'perspective', viewMatrix: matrix, fov: 45, near: null, far: null });
    assert.deepEqual(wireOf({ ...camera }), usual);
    assert.equal(cameraOf(parseHash('#eye=3,1,-9&target=0,0,0&up=0,-1,0').camera, usual).upAxis, '-y');
  });

  it('is undefined when there is none, or one beyond all measure', () => {
    for (const hash of ['', '#', undefined, null, 7, `#cloud=${'x'.repeat(5000)}`]) assert.equal(parseHash(hash), undefined);
  });

  it('leaves out what is hostile or broken, and keeps the rest', () => {
    const hostile = [
      '#cloud=../../etc/passwd&method=<script>alert(1)</script>&color=cone', '#cloud=%00&eye=1,2,3&target=1,2,3',
      '#eye=NaN,0,0&target=0,0,0', '#eye=1e999,0,0&target=0,0,0', '#eye=1,2&target=0,0,0', '#eye=0x10,0,0&target=0,0,0',
      '#%E0%A4%A=1&method=%E0%A4%A', '#range=5,1', '#range=1', '#detail=-1', '#detail=1e9', '#background=javascript:alert(1)',
      '#background=red,green,blue', '#method=cone&param.__proto__=1&param.constructor=2&param.sizePx=1e999', '#====&&&=&a', '#color=%23zzzzzz',
      '#colormap=url(x)', '#shading=a%20b', '#mirrors=yes&behindMirrors=1', '#exposure=4&classes=1,999&clip=1,1,1,0,0,0&light.sun=0,91',
      '#light.ambient=2&light.nonsense=1&outliers=maybe&budget=0&samples=1.5&quality=101&subsampling=4:1:1&width=5&height=5',
      '#near=-1&fov=180', '#viewMatrix=1,2,3', '#viewMatrix=1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1&eye=1,2,3',
    ];
    const nine = new Array(9).fill('plane:0,0,0,0,0,1').join(';');
    for (const text of ['', 'box', 'box:1', 'box:0,0,0,1,1,0', 'box:0,0,0,1,1,1,400', 'box:0,0,0,1,1,1,1,1', '-plane:0,0,0,0,0,1', 'plane:0,0,0,0,0,0', 'ball:1;', nine])
      hostile.push(`#clips=${text}`);
    for (const text of ['', ';', 'b,', 'b,shift:1:2', 'b,shift:1:2:', 'b,shift:1e13:0:0', 'b,tint:red', '<b>', '../b', new Array(65).fill('b').join(';')])
      hostile.push(`#with=${text}`);
    for (const hash of hostile) {
      const read = parseHash(hash);
      assert.equal(read.camera, undefined, hash);
      assert.equal(read.cloud, undefined, hash);
      const { method, param, color, ...others } = read.style;
      assert.deepEqual(others, {}, hash);
      assert.ok(method === undefined || method === 'cone', hash);
      assert.deepEqual({ ...param, constructor: undefined }, { constructor: undefined }, hash);
      assert.equal({}.sizePx, undefined);
    }
  });

  it('survives random damage to a good one', () => {
    const next = random(5);
    const good = printHash('town', { camera: wireOf(manyCameras()[0]), ...style });
    for (let round = 0; round < 2000; ++round) {
      const characters = [...good];
      for (let i = 0; i < 5; ++i) characters[Math.floor(next() * characters.length)] = String.fromCharCode(Math.floor(next() * 300));
      const read = parseHash(characters.join(''));
      const camera = read?.camera && cameraOf(read.camera, wireOf(manyCameras()[1]), read.upAxis);
      if (camera) assert.ok([...camera.target, camera.distance, camera.azimuth].every(Number.isFinite));
    }
  });
});

describe('the words of a snapshot', () => {
  it('say the view in the vocabulary', () => {
    const camera = { type: 'orthographic', eye: [1, 2, 3], target: [0, 0, 0.1 + 0.2], up: [0, 0, 1], viewHeight: 25 };
    assert.equal(
      snapshotUrl('my town', { camera, ...style }, 800, 600),
      '/api/v1/clouds/my%20town/snapshot.png?eye=1,2,3&target=0,0,0.3&up=0,0,1&projection=orthographic&viewHeight=25' +
        '&method=paraboloid&param.sizePx=5.5&param.footprint=square&param.smooth=true&color=elevation&colormap=turbo' +
        '&range=-3,25.25&shading=eyedome&mirrors=false&behindMirrors=true&background=102030,000000&detail=0.5&width=800&height=600',
    );
  });

  it('say nothing of what is null', () => {
    assert.equal(printQuery(wordsOf({ method: 'cone', param: { gain: null }, range: null, shading: null, detail: null })), 'method=cone');
  });

  it('escape what means something in a URL', () => {
    assert.equal(printQuery([['a&b', 'c=d#e+f']]), 'a%26b=c%3Dd%23e%2Bf');
  });
});
