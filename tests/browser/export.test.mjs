// Exports, as a user makes them, against the real server: how many points are said to come, and what is in the file. SCANCAST_PROGRAM names the server's
// program; CTest sets it.
//
// Oracle: the scan is a grid that this test has written, so what lies in a box or an outline is counted here.

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';

import { newPage, seriousComplaints, startBrowser, waitUntilSharp } from './support/browser.mjs';
import { RealServer } from './support/real_server.mjs';
import { courtOrigin, courtSpacing, writeCourt } from './support/scans.mjs';

const program = process.env.SCANCAST_PROGRAM;
if (!program) throw new Error('Set SCANCAST_PROGRAM, such as SCANCAST_PROGRAM=build/release/bin/scancast');
const axe = readFileSync(new URL('node_modules/axe-core/axe.min.js', import.meta.url), 'utf8');

const at = (x, y, z = 0) => [x, y, z].map((value, axis) => value + courtOrigin[axis]);
const fromSouth = `eye=${at(10, -14, 14)}&target=${at(10, 8, 0)}&up=0,0,1&projection=perspective&fov=45`;
const all = 201 * 201 + 121 * 61;
/** The court's points for which that holds. */
function counted(holds) {
  let count = 0;
  for (let j = 0; j <= 200; ++j) {
    for (let i = 0; i <= 200; ++i) {
      const [x, y] = [i * courtSpacing, j * courtSpacing];
      if (holds(x, y, 0)) count += 1;
      if (j <= 60 && i >= 40 && i <= 160 && holds(x, 12, y)) count += 1;
    }
  }
  return count;
}

describe('exporting', { timeout: 200_000 }, () => {
  let scan, server, browser, url, tokens, token;

  before(async () => {
    scan = writeCourt();
    tokens = mkdtempSync(join(tmpdir(), 'scancast-token-'));
    const line = execFileSync(program, ['token', 'alice'], { encoding: 'utf8', stdio: ['ignore', 'pipe', 'ignore'] }).trim();
    token = line.split(' ')[1];
    writeFileSync(join(tokens, 'token'), line, { mode: 0o600 });
    server = new RealServer(program, [scan.file, '--auth-token-file', join(tokens, 'token')]);
    url = await server.start();
    browser = await startBrowser();
  });
  after(async () => {
    await browser?.close();
    await server?.stop();
    scan?.remove();
    if (tokens) rmSync(tokens, { recursive: true, force: true });
  });

  async function withPage(use, { words = '', init = () => { globalThis.showSaveFilePicker = undefined; }, options = {} } = {}) {
    const page = await newPage(browser, { viewport: { width: 1440, height: 700 }, ...options });
    page.setDefaultTimeout(20_000);
    page.asked = [];
    page.on('request', (request) => { if (request.url().endsWith('/points')) page.asked.push({ body: request.postDataJSON(), headers: request.headers() }); });
    await page.addInitScript(init);
    await page.addInitScript((text) => sessionStorage.setItem('scancast-token', text), token);
    try {
      await page.goto(`${url}#cloud=court&${fromSouth}${words}`);
      await waitUntilSharp(page, 40_000);
      await use(page);
      assert.deepEqual(seriousComplaints(page).filter((text) => !/status of 422/.test(text)), []);
    } finally {
      await page.context().close();
    }
  }

  const open = async (page) => {
    await page.click('#tool-export');
    await page.waitForSelector('#exporting', { state: 'visible' });
  };
  const isCounted = (page, count) => page.waitForFunction((text) => document.getElementById('export-count').textContent.startsWith(text),
    count >= 1e6 ? '' : `${count.toLocaleString('en')} point`);
  const rowsOf = async (page) => {
    const [file] = await Promise.all([page.waitForEvent('download'), page.click('#export-save')]);
    await page.waitForFunction(() => /has been saved/.test(document.getElementById('export-state').textContent));
    return { name: file.suggestedFilename(), rows: readFileSync(await file.path()).toString().trim().split('\n').slice(1).map((row) => row.split(',').map(Number)) };
  };

  it('all of the scan, where a token is needed: as many points as were said', () => withPage(async (page) => {
    await open(page);
    await isCounted(page, all);
    assert.match(await page.textContent('#export-count'), /about [\d.]+ MB/);
    assert.ok(await page.isDisabled('#exporting [value=shapes]') && await page.isDisabled('#exporting [value=polygon]'), 'nothing of the kind is there');
    await page.selectOption('#export-format', 'csv');
    await isCounted(page, all);
    const { name, rows } = await rowsOf(page);
    assert.equal(name, 'court.csv');
    assert.equal(rows.length, all);
    assert.equal(page.asked.at(-1).headers.authorization, `Bearer ${token}`);
    await page.click('#export-close');
    assert.ok(!(await page.isVisible('#exporting')));
  }));

  it('what boxes leave, and what lies within an outline that has been measured', () => withPage(async (page) => {
    const area = [at(2, 2), at(9, 2), at(9, 7), at(2, 7)];
    await page.keyboard.press('m');
    await page.waitForSelector('#measuring', { state: 'visible' });
    await page.check('#measure-kinds input[value=area]');
    const project = { format: 'scancast-project', version: 1, cloud: { id: 'court' }, measures: [{ name: 'Yard', kind: 'area', step: 0.001, points: area.map(([x, y, z]) => [x - 0.05, y - 0.05, z]) }] };
    await page.setInputFiles('#project-file', { name: 'court.project.json', mimeType: 'application/json', buffer: Buffer.from(JSON.stringify(project)) });
    await page.waitForSelector('#measure-list .name');
    await open(page);
    const inBox = counted((x, y, z) => Math.abs(x - 10) <= 3.03 && Math.abs(y - 12) <= 1.03 && Math.abs(z - 2) <= 1.03);
    await isCounted(page, inBox);
    await page.selectOption('#export-format', 'csv');
    const { name, rows } = await rowsOf(page);
    assert.equal(name, 'court-part.csv');
    assert.equal(rows.length, inBox);
    assert.ok(rows.every(([x, y, z]) => Math.abs(x - at(10)[0]) < 3.04 && y === at(0, 12)[1] && Math.abs(z - at(0, 0, 2)[2]) < 1.04));
    await page.check('#exporting [value=polygon]');
    const within = counted((x, y) => x > 1.95 && x < 8.95 && y > 1.95 && y < 6.95);
    await isCounted(page, within);
    assert.equal(await page.textContent('#export-outline option:checked'), 'Yard');
    assert.equal((await rowsOf(page)).rows.length, within);
    assert.deepEqual(page.asked.at(-1).body.region.polygon.length, 4);
  }, { words: `&clips=box:${at(10, 12, 2)},6.06,2.06,2.06` }));

  it('goes into the file that was chosen, piece by piece; is stopped; says where nothing is', () => withPage(async (page) => {
    await open(page);
    await isCounted(page, all);
    await page.click('#export-save');
    await page.waitForFunction(() => /court-chosen\.las has been saved/.test(document.getElementById('export-state').textContent));
    const { chunks, size, isClosed } = await page.evaluate(() => globalThis.chosen);
    assert.ok(chunks > 0 && isClosed);
    const [, said] = /about ([\d.]+) MB/.exec(await page.textContent('#export-count'));
    assert.ok(Math.abs(size / 1e6 / Number(said) - 1) < 0.06, `${size} bytes, and ${said} MB had been said`);
    // Stopped while it waits for the disk.
    await page.evaluate(() => { globalThis.isSlow = true; });
    await page.click('#export-save');
    await page.waitForFunction(() => globalThis.goOn);
    assert.ok(await page.isVisible('#export-progress') && await page.isVisible('#export-stop'));
    await page.keyboard.press('Escape');
    await page.evaluate(() => globalThis.goOn());
    await page.waitForFunction(() => /Stopped/.test(document.getElementById('export-state').textContent));
    assert.ok(await page.evaluate(() => globalThis.chosen.isAborted && globalThis.chosen.isRemoved));
    assert.ok(await page.isVisible('#exporting'), 'the first Escape only ends the file');
    await page.keyboard.press('Escape');
    assert.ok(!(await page.isVisible('#exporting')));
    await page.evaluate((clips) => { document.getElementById('view').viewer.changeStyle({ clips }); }, [{ box: { center: at(10, 5, 90), size: [1, 1, 1], turn: [0, 0, 0] }, keep: 'inside' }]);
    await open(page);
    await page.waitForFunction(() => document.getElementById('export-count').textContent === 'No point lies there.');
    assert.ok(await page.isDisabled('#export-save'));
  }, {
    init: () => {
      globalThis.showSaveFilePicker = async () => {
        const chosen = { chunks: 0, size: 0, isClosed: false, isAborted: false, isRemoved: false };
        globalThis.chosen = chosen;
        return {
          name: 'court-chosen.las',
          remove: async () => { chosen.isRemoved = true; },
          createWritable: async () => ({
            async write(chunk) {
              chosen.chunks += 1;
              chosen.size += chunk.length;
              if (globalThis.isSlow) await new Promise((done) => { globalThis.goOn = done; });
            },
            async close() { chosen.isClosed = true; },
            async abort() { chosen.isAborted = true; },
          }),
        };
      };
    },
  }));

  it('a guest is offered what the server gives him, and told why not the rest', async () => {
    const keys = execFileSync(program, ['token', 'guests'], { encoding: 'utf8', stdio: ['ignore', 'pipe', 'ignore'] });
    writeFileSync(join(tokens, 'guests'), keys, { mode: 0o600 });
    for (const mayExport of [false, true]) {
      const closed = new RealServer(program, [scan.file], ['--auth-token-file', join(tokens, 'token'), '--guest-key-file', join(tokens, 'guests'), ...(mayExport ? ['--guests-may-export'] : [])]);
      const page = await newPage(browser, { viewport: { width: 1440, height: 900 } });
      page.setDefaultTimeout(20_000);
      try {
        const address = await closed.start();
        const asked = [];
        // Where it is busy, the page asks again.
        page.on('response', (response) => { if (/\/points$|\.tif/.test(response.url()) && ![429, 503].includes(response.status())) asked.push(response.status()); });
        await page.addInitScript(() => { globalThis.showSaveFilePicker = undefined; });
        const link = execFileSync(program, ['guest-link', '--key-file', join(tokens, 'guests'), '--cloud', 'court', '--expires', '60m', '--url', address], { encoding: 'utf8', stdio: ['ignore', 'pipe', 'ignore'] }).trim();
        await page.goto(`${link}&${fromSouth}`);
        await waitUntilSharp(page, 40_000);
        await open(page);
        assert.equal(await page.isVisible('#export-guest'), !mayExport);
        for (const part of ['#export-format', '#export-save', '#export-count']) assert.equal(await page.isVisible(part), mayExport, part);
        assert.ok(!(await page.isVisible('#map-services')), 'no other program has his pass');
        if (mayExport) {
          await isCounted(page, all);
          await page.click('#rasters summary');
        }
        const kinds = await page.$$eval('#raster-kind option', (options) => options.map(({ value }) => value));
        assert.deepEqual(kinds, mayExport ? ['highest', 'lowest', 'mean', 'count', 'ortho'] : ['ortho']);
        const [file] = await Promise.all([page.waitForEvent('download'), page.click('#raster-save')]);
        assert.equal(file.suggestedFilename(), mayExport ? 'court-dem-highest.tif' : 'court-ortho.tif');
        await page.waitForFunction(() => /has been saved/.test(document.getElementById('export-state').textContent));
        assert.ok(asked.length > 0 && asked.every((status) => status === 200), `${asked}: nothing is offered that is refused`);
        await page.click('#export-close');
        // Of a profile, the picture.
        await page.click('#tool-profile');
        await page.waitForSelector('#profiling', { state: 'visible' });
        await page.evaluate(() => { document.getElementById('profile-panel').hidden = false; document.getElementById('profile-files').showPopover(); });
        const formats = await page.$$eval('#profile-files button', (buttons) => buttons.filter((button) => !button.hidden).map((button) => button.dataset.format));
        assert.deepEqual(formats, mayExport ? ['csv', 'las', 'ply', 'png'] : ['png']);
        assert.deepEqual(seriousComplaints(page), []);
      } finally {
        await page.context().close();
        await closed.stop();
      }
    }
  });

  for (const options of [{ colorScheme: 'light' }, { colorScheme: 'dark', viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true }]) {
    it(`axe finds nothing in the ${options.colorScheme} theme, ${options.isMobile ? 'on a phone' : 'on a desk'}`, () => withPage(async (page) => {
      await open(page);
      await isCounted(page, all);
      await page.evaluate(axe);
      const findings = await page.evaluate(async () => (await globalThis.axe.run(document, { resultTypes: ['violations'] })).violations
        .flatMap(({ id, nodes }) => nodes.map((node) => `${id}: ${node.target.join(' ')} ${node.failureSummary}`)));
      assert.deepEqual(findings, []);
    }, { options }));
  }
});
