// Filters by values, colours by columns, clouds together, addresses for a GIS: what the page's handles, fields and buttons say to the server, against the
// test double; what a server makes of these words is tested against the renderer. Accessibility is judged by axe.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { after, afterEach, before, beforeEach, describe, it } from 'node:test';

import { choose, closePage, isTrue, openPage, startBrowser, waitUntilSharp } from './support/browser.mjs';
import { clouds, FakeServer } from './support/fake_server.mjs';

const axe = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
const counts = [900, 300, 80, 10, 2];
const columns = [
  { name: 'return_number', type: 'uint8', range: [1, 5], usual: [1, 5], histogram: { low: 0.5, high: 5.5, counts } },
  { name: 'gps_time', type: 'float64', range: [1000, 4600], usual: [1100, 4500], histogram: { low: 1100, high: 4500, counts: Array.from({ length: 64 }, (_, i) => i + 1) } },
  { name: 'Amplitude', type: 'float32', description: 'Echo amplitude in dB', unit: 'dB', range: [0, 60] },
  { name: 'point_source_id', type: 'uint16', range: [1, 12] },
];
const known = columns.map(({ histogram, ...one }) => one);
const metric = { crsUnit: 'metre', crsEpsg: 25833, crsName: 'ETRS89 / UTM zone 33N' };
const named = [
  { ...clouds[0], ...metric, columns: known, attributes: [{ name: 'rgb' }, { name: 'intensity', range: [0, 255] }] }, { ...clouds[1], ...metric, bounds: { min: [30, -10, -10], max: [50, 10, 10] } },
  { ...clouds[1], id: 'valley', title: 'A valley', crsEpsg: 2056, crsName: 'CH1903+ / LV95' },
];

describe('values, and clouds together', { timeout: 290_000 }, () => {
  let browser, server, page;

  before(async () => { browser = await startBrowser(); });
  after(() => browser?.close());
  beforeEach(() => {
    server = new FakeServer();
    server.clouds = named;
    server.told = { ring: { columns } };
  });
  afterEach(async () => {
    const complaints = await closePage(page);
    page = undefined;
    await server.stop();
    assert.deepEqual(complaints, []);
  });

  const open = async (hash = '', options = {}) => {
    page = await openPage(browser, (await server.start()) + hash, options);
    await waitUntilSharp(page);
  };
  const views = () => server.received.filter(({ type }) => type === 'view');
  /** What the server has been told last of a word. */
  const said = (word) => views().filter((view) => view[word] !== undefined).at(-1)?.[word];
  const isSaid = async (word, value) => {
    await isTrue(() => JSON.stringify(said(word)) === JSON.stringify(value), `${word}: ${JSON.stringify(value)}`).catch((error) => {
      throw new Error(`${error.message}, not ${JSON.stringify(said(word))}`);
    });
  };
  const slider = (name) => page.locator(`#filter-list input[type=range][aria-label="${name}"]`);
  const field = (name) => page.locator(`#filter-list input[type=number][aria-label="${name}"]`);
  const begin = async (tool, hash, options) => {
    await open(hash, options);
    await page.click(`#tool-${tool}`);
    await page.waitForSelector(tool === 'filter' ? '#filter-list svg' : '#together-others li, #together-list li');
  };

  describe('filtering', () => {
    it('a handle that is drawn filters, by keys as well; the views that tell of it are few, and the last one is right', async () => {
      await begin('filter');
      const { x, y, width, height } = await slider('Return number: greatest value').boundingBox();
      const before = views().length;
      await page.mouse.move(x + width - 8, y + height / 2);
      await page.mouse.down();
      await page.mouse.move(x + 8 + (width - 16) * 0.4, y + height / 2, { steps: 60 });
      await page.mouse.up();
      await isSaid('filter', [{ column: 'return_number', high: 2 }]);
      assert.ok(views().length - before <= 10, `${views().length - before} views for five numbers`);
      await slider('Return number: least value').focus();
      await page.keyboard.press('ArrowRight');
      await isSaid('filter', [{ column: 'return_number', low: 2, high: 2 }]);
      await page.keyboard.press('ArrowRight'); // it goes no farther than the other
      await page.waitForTimeout(100);
      assert.equal(await slider('Return number: least value').getAttribute('aria-valuetext'), '2');
      await page.keyboard.press('Home');
      await isSaid('filter', [{ column: 'return_number', high: 2 }]);
      assert.deepEqual(await page.$$eval('#filter-list li:has(h3[title=return_number]) rect', (bars) => bars.map((bar) => bar.classList.contains('out'))), [false, false, true, true, true]);
      await page.click('#filter-list [aria-label="Return number: all values"]');
      await isSaid('filter', null);
    });

    it('numbers are typed; a third of them, four at most; all are taken back; undo brings them back', async () => {
      await begin('filter');
      await field('GPS time: least value').fill('1200.5');
      await field('GPS time: greatest value').fill('1100');
      await page.keyboard.press('Tab');
      assert.match(await page.textContent('#filter-list li:has(h3[title=gps_time]) .refusal'), /less than the maximum/);
      await field('GPS time: greatest value').fill('1300');
      await page.keyboard.press('Enter');
      await isSaid('filter', [{ column: 'gps_time', low: 1200.5, high: 1300 }]);
      for (const [name, value] of [['Intensity', '10'], ['Return number', '2'], ['Amplitude', '5.5']]) {
        await field(`${name}: least value`).fill(value);
        await page.keyboard.press('Enter');
      }
      await isSaid('filter', [{ column: 'gps_time', low: 1200.5, high: 1300 }, { column: 'intensity', low: 10 }, { column: 'return_number', low: 2 }, { column: 'Amplitude', low: 5.5 }]);
      assert.match(await page.textContent('#filter-state'), /the most/);
      assert.ok(await slider('Point source: least value').isDisabled() && !(await slider('Amplitude: least value').isDisabled()));
      await page.waitForFunction(() => /filter=gps_time:1200\.5\.\.1300;intensity:10\.\.;return_number:2\.\.;Amplitude:5\.5\.\./.test(location.hash));
      await page.waitForTimeout(700); // a step of its own
      await page.click('#filter-none');
      await isSaid('filter', null);
      await page.waitForTimeout(700);
      await page.click('#undo');
      await isTrue(() => said('filter')?.length === 4, 'they are there again');
      assert.equal(await field('Amplitude: least value').inputValue(), '5.5');
      await page.focus('#filter-none');
      await page.keyboard.press('Escape');
      assert.ok(!(await page.isVisible('#filtering')));
    });

    it('colours by a column: in the card and in the panel, with a ramp over the same histogram, and a legend that names it', async () => {
      await begin('filter');
      await page.click('#filter-list [aria-label="Colour by GPS time"]');
      await isSaid('color', 'column:gps_time');
      await page.waitForFunction(() => document.querySelector('#plan-legend h2')?.textContent === 'GPS time (s)');
      assert.equal(await page.getAttribute('#filter-list [aria-label="Colour by GPS time"]', 'aria-pressed'), 'true');
      const fills = await page.$$eval('#filter-list li:has(h3[title=gps_time]) rect', (bars) => [bars[0], bars.at(-1)].map((bar) => getComputedStyle(bar).fill));
      assert.deepEqual(fills, ['rgb(68, 1, 84)', 'rgb(253, 231, 37)']);
      await slider('Ramp over GPS time: least value').focus();
      await page.keyboard.press('PageUp');
      await isTrue(() => said('range')?.[0] > 1400 && said('range')[1] === 4500, 'the ramp begins later');
      await page.click('#filter-list [aria-label="Ramp over GPS time: all values"]');
      await isSaid('range', null);
      await choose(page, '#color', 'column:Amplitude');
      await isSaid('color', 'column:Amplitude');
      await page.waitForFunction(() => /^Amplitude \(dB\)0/.test(document.getElementById('plan-legend').textContent) && /Echo amplitude in dB/.test(document.getElementById('plan-legend').textContent));
      assert.equal(await page.getAttribute('#filter-list [aria-label="Colour by Amplitude"]', 'aria-pressed'), 'true');
      assert.ok(await page.isVisible('#ramp'));
      await page.waitForFunction(() => location.hash.includes('color=column:Amplitude'));
    });

    it('a link with a filter while the scan is still being read holds: it is asked for when the columns are known', async () => {
      server.clouds = [{ ...named[0], state: 'loading', columns: [] }, named[1]];
      await open('#cloud=ring&color=column:gps_time&filter=gps_time:1200..');
      assert.ok(server.received.every(({ view, filter, color }) => !filter && !view?.filter && color !== 'column:gps_time'), 'nobody is asked for what is not known');
      assert.ok(await page.evaluate(() => location.hash.includes('filter=gps_time:1200..')));
      await page.click('#tool-filter');
      await page.waitForFunction(() => /once it has been read/.test(document.getElementById('filter-state')?.textContent) || document.querySelector('#filter-list li'));
      server.clouds = [{ ...named[0], revision: '2' }, named[1]];
      await isSaid('filter', [{ column: 'gps_time', low: 1200 }]);
      await isSaid('color', 'column:gps_time');
      await page.waitForSelector('#filter-list svg');
      assert.equal(await field('GPS time: least value').inputValue(), '1200');
    });

    it('has no button, and no such colours, where the server does not filter', async () => {
      const { filter, with: others, ...view } = named[0].view;
      server.clouds = [{ ...named[0], view }];
      await open();
      assert.equal(await page.locator('#tool-filter, #tool-together').count(), 0);
      assert.equal(await page.locator('#color input[value^=column]').count(), 0);
    });
  });

  describe('together', () => {
    it('another cloud is added, hidden, tinted, shifted by steps, and removed; others say why they cannot be', async () => {
      await begin('together');
      assert.deepEqual(await page.$$eval('#together-others button', (buttons) => buttons.map((button) => [button.textContent, button.disabled])),
        [['+ Helix1.2 million points', false], ['A valleyin another coordinate system: CH1903+ / LV95', true]]);
      await page.click('[data-key=add-helix]');
      await isSaid('with', [{ cloud: 'helix' }]);
      await page.click('[data-key=row-helix]');
      for (const [key, times] of [['more-2-helix', 3], ['less-0-helix', 1]]) for (let i = 0; i < times; ++i) await page.click(`[data-key=${key}]`);
      await isSaid('with', [{ cloud: 'helix', shift: [-0.1, 0, 0.3] }]);
      await page.selectOption('#together-list select', '0.01');
      await page.focus('[data-key=more-1-helix]');
      await page.keyboard.press('Enter');
      await isSaid('with', [{ cloud: 'helix', shift: [-0.1, 0.01, 0.3] }]);
      assert.equal(await page.evaluate(() => document.activeElement.dataset.key), 'more-1-helix', 'the focus stays');
      await page.fill('[data-key=shift-0-helix]', '12.5');
      await page.keyboard.press('Enter');
      await isSaid('with', [{ cloud: 'helix', shift: [12.5, 0.01, 0.3] }]);
      await page.click('[data-key=still-helix]');
      await isSaid('with', [{ cloud: 'helix' }]);
      await page.fill('[aria-label="Tint of Helix"]', '#ff8800');
      await isSaid('with', [{ cloud: 'helix', tint: '#ff8800' }]);
      await page.click('[data-key="eye-."]');
      await isSaid('with', [{ cloud: '.', hidden: true }, { cloud: 'helix', tint: '#ff8800' }]);
      await page.waitForFunction(() => location.hash.includes('with=.,hidden;helix,tint:ff8800'));
      await page.click('[data-key="eye-."]');
      await page.click('[data-key=remove-helix]');
      await isSaid('with', null);
      assert.deepEqual(await page.$$eval('#together-others button:enabled', (buttons) => buttons.map((button) => button.textContent.slice(0, 7))), ['+ Helix']);
    });

    it('clouds have colours of their own, with a legend; “fit” shows all that is seen, and what is hidden does not count', async () => {
      await begin('together', '#cloud=ring&with=helix');
      await page.click('#together-color');
      await isSaid('color', 'cloud');
      await isSaid('shading', 'eyedome'); // one colour shows no shapes
      await page.waitForFunction(() => document.getElementById('plan-legend').textContent === 'CloudsA ring of stonesHelix');
      assert.deepEqual(await page.$$eval('#plan-legend .swatch', (all) => all.map((one) => getComputedStyle(one).backgroundColor)), ['rgb(86, 180, 233)', 'rgb(230, 159, 0)']);
      const targetAfter = async (act) => {
        await act();
        await page.waitForTimeout(500);
        return page.evaluate(() => document.getElementById('view').viewer.camera.target.map(Math.round));
      };
      assert.deepEqual(await targetAfter(() => page.click('#together-fit')), [20, 0, 0]); // of both: x from -10 to 50
      await page.click('[data-key=eye-helix]');
      assert.deepEqual(await targetAfter(() => page.click('#together-fit')), [0, 0, 0]);
      await page.click('#together-none');
      await isSaid('with', null);
      await isSaid('color', 'auto');
      await isSaid('shading', null);
      await page.waitForFunction(() => document.getElementById('plan-legend').hidden);
    });

    it('many clouds are searched', async () => {
      server.clouds = [...named, ...Array.from({ length: 40 }, (_, i) => ({ ...named[1], id: `tile-${i}`, title: `Tile ${i}` }))];
      await begin('together');
      assert.match(await page.textContent('#together-state'), /12 more/);
      await page.fill('#together-search', 'tile 39');
      assert.deepEqual(await page.$$eval('#together-others span', (names) => names.map((name) => name.textContent)), ['+ Tile 39']);
      await page.click('#together-others button');
      await isSaid('with', [{ cloud: 'tile-39' }]);
      await page.fill('#together-search', 'nowhere');
      assert.match(await page.textContent('#together-state'), /No cloud of that name/);
    });
  });

  it('the dialog of exports has the addresses of maps in the present look, and says how large a raster will be', async () => {
    await open('#cloud=ring&color=elevation&filter=return_number:1..1');
    const regions = [];
    await page.route('**/points', (route) => {
      regions.push(route.request().postDataJSON().region);
      return route.fulfill({ status: 200, contentType: 'text/csv', body: 'x,y,z\n' });
    });
    const asked = [];
    await page.route('**/*.tif*', (route) => {
      asked.push(new URL(route.request().url()));
      return route.fulfill({ status: 200, contentType: 'image/tiff', body: 'II*' });
    });
    await page.addInitScript(() => { globalThis.showSaveFilePicker = undefined; });
    await page.evaluate(() => { globalThis.showSaveFilePicker = undefined; });
    await page.click('#tool-export');
    await isTrue(() => regions.length > 0, 'it is counted');
    assert.deepEqual(regions.at(-1), { filter: [{ column: 'return_number', low: 1, high: 1 }] });
    await page.uncheck('#export-filter');
    await isTrue(() => regions.length > 1 && regions.at(-1) === undefined, 'all of the scan');
    await page.click('#map-services summary');
    const wms = new URL(await page.inputValue('#map-wms'));
    assert.equal(wms.pathname, '/api/v1/clouds/ring/wms');
    assert.deepEqual(Object.fromEntries(wms.searchParams), { SERVICE: 'WMS', REQUEST: 'GetCapabilities', color: 'elevation', filter: 'return_number:1..1' });
    assert.match(await page.inputValue('#map-tiles'), /\/tiles\/mercator\/\{z\}\/\{x\}\/\{y\}\.png\?color=elevation/);
    await page.click('summary:has-text("Elevation and orthophoto")');
    await page.fill('#raster-cell', '0.5');
    await page.keyboard.press('Tab');
    assert.match(await page.textContent('#raster-size'), /^About 40 × 40 cells, 6\.4 kB before they are packed$/);
    await page.fill('#raster-cell', '0');
    assert.match(await page.textContent('#raster-refusal'), /above 0/);
    await page.fill('#raster-cell', '0.25');
    await page.keyboard.press('Tab');
    const save = async () => {
      const [file] = await Promise.all([page.waitForEvent('download'), page.click('#raster-save')]);
      await page.waitForFunction(() => /has been saved/.test(document.getElementById('export-state').textContent));
      return file.suggestedFilename();
    };
    await page.selectOption('#raster-kind', 'mean');
    assert.equal(await save(), 'ring-dem-mean.tif');
    assert.deepEqual([asked[0].pathname, asked[0].search], ['/api/v1/clouds/ring/dem.tif', '?cell=0.25&value=mean&filter=return_number:1..1']);
    await page.selectOption('#raster-kind', 'ortho');
    assert.equal(await save(), 'ring-ortho.tif');
    assert.deepEqual([asked[1].pathname, asked[1].search], ['/api/v1/clouds/ring/ortho.tif', '?cell=0.25&color=elevation&filter=return_number:1..1']);
  });

  for (const options of [{ colorScheme: 'light' }, { colorScheme: 'dark', viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true }]) {
    it(`axe finds nothing in the ${options.colorScheme} theme, ${options.isMobile ? 'on a phone' : 'on a desk'}`, async () => {
      const findings = async () => {
        await page.evaluate(axe);
        return page.evaluate(async () => (await globalThis.axe.run(document, { resultTypes: ['violations'] })).violations
          .flatMap(({ id, nodes }) => nodes.map((node) => `${id}: ${node.target.join(' ')} ${node.failureSummary}`)));
      };
      await begin('filter', '#cloud=ring&color=column:gps_time&filter=gps_time:1200..&with=helix,shift:1:0:0', options);
      assert.deepEqual(await findings(), []);
      await page.click('#tool-together');
      await page.waitForSelector('#together-list li');
      await page.click('[data-key=row-helix]');
      assert.ok(!(await page.isVisible('#filtering')));
      assert.deepEqual(await findings(), []);
      await page.route('**/points', (route) => route.fulfill({ status: 200, contentType: 'text/csv', body: 'x,y,z\n' }));
      await page.click('#tool-export');
      await page.evaluate(() => document.querySelectorAll('#exporting details').forEach((details) => { details.open = true; }));
      await page.waitForTimeout(400);
      assert.deepEqual(await findings(), []);
    });
  }
});
