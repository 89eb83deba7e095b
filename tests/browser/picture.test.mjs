// Saving pictures: their size, what is drawn on them and what is not, their names, and giving up; against the real server, and against the test
// double where it must be slow.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { after, before, describe, it } from 'node:test';

import { closePage, isTrue, openPage, startBrowser, waitUntilSharp } from './support/browser.mjs';
import { FakeServer } from './support/fake_server.mjs';
import { RealServer } from './support/real_server.mjs';
import { courtOrigin, writeCourt } from './support/scans.mjs';

const program = process.env.SCANCAST_PROGRAM;
if (!program) throw new Error('Set SCANCAST_PROGRAM, such as SCANCAST_PROGRAM=build/release/bin/scancast');

const axe = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
const at = (x, y, z = 0) => [x, y, z].map((value, axis) => value + courtOrigin[axis]);
const fromAbove = `eye=${at(10, 10, 60)}&target=${at(10, 10)}&up=0,1,0&projection=orthographic&viewHeight=24&color=elevation`;

describe('saving pictures', { timeout: 290_000 }, () => {
  let scan, server, browser, url;

  before(async () => {
    scan = writeCourt();
    server = new RealServer(program, [scan.file]);
    url = await server.start();
    browser = await startBrowser();
  });
  after(async () => {
    await browser?.close();
    await server?.stop();
    scan?.remove();
  });

  async function withPage(use, address, options) {
    const page = await openPage(browser, address, options);
    let complaints;
    try {
      await waitUntilSharp(page, 40_000);
      await page.click('#save-picture');
      await page.waitForSelector('#picture-dialog[open]');
      await use(page);
    } finally {
      complaints = await closePage(page);
    }
    assert.deepEqual(complaints.filter((text) => !text.includes('503')), []);
  }
  const save = async (page) => {
    const [download] = await Promise.all([page.waitForEvent('download'), page.click('#picture-save')]);
    return { name: download.suggestedFilename(), bytes: readFileSync(await download.path()) };
  };
  const sized = async (page, width, height) => {
    await page.fill('#picture-width', String(width));
    await page.fill('#picture-height', String(height));
  };
  /** Pixels that differ between two files, by the part of the picture that they lie in: { middle, corners: [upper left, upper right, lower left, lower right] }. */
  const compared = (page, a, b) => page.evaluate(async (files) => {
    const [one, other] = await Promise.all(files.map(async (text) => {
      const bitmap = await createImageBitmap(new Blob([Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0))]));
      const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d');
      context.drawImage(bitmap, 0, 0);
      return context.getImageData(0, 0, bitmap.width, bitmap.height);
    }));
    const count = { size: [one.width, one.height], middle: 0, corners: [0, 0, 0, 0] };
    for (let i = 0; i < one.data.length; i += 4) {
      if ([0, 1, 2].every((k) => Math.abs(one.data[i + k] - other.data[i + k]) <= 2)) continue;
      const [x, y] = [(i / 4) % one.width / one.width, Math.floor(i / 4 / one.width) / one.height];
      if (x > 0.42 && x < 0.58 && y > 0.1 && y < 0.9) count.middle += 1;
      else count.corners[(y < 0.5 ? 0 : 2) + (x < 0.5 ? 0 : 1)] += 1;
    }
    return count;
  }, [a, b].map((bytes) => bytes.toString('base64')));

  it('of any size, with title, scale and legend in their corners and the scan’s own pixels between them', () => withPage(async (page) => {
    await sized(page, 1600, 900);
    assert.equal(await page.inputValue('#picture-preset'), 'free');
    const { name, bytes } = await save(page);
    assert.match(name, /^court-\d{4}-\d\d-\d\d-[a-z]+-1600x900\.png$/);
    await page.click('#save-picture');
    await sized(page, 1600, 900);
    for (const part of ['scale', 'legend', 'credit']) await page.uncheck(`#picture-${part}`);
    const plain = await save(page);
    const { size, middle, corners } = await compared(page, bytes, plain.bytes);
    assert.deepEqual(size, [1600, 900]);
    assert.equal(middle, 0, 'nothing stands on the scan');
    const [, legend, credit, scale] = corners;
    assert.ok(legend > 500 && credit > 500 && scale > 500, JSON.stringify(corners));
    // Without furniture it is what anybody gets of the server.
    const words = await page.evaluate(() => {
      const [, hash] = location.hash.split('#');
      return hash;
    });
    const own = Buffer.from(await (await fetch(new URL(`/api/v1/clouds/court/snapshot.png?${words.replace(/^cloud=court&/, '')}&width=1600&height=900`, url))).arrayBuffer());
    assert.ok(own.equals(plain.bytes), 'the server’s own bytes');
    await page.click('#save-picture');
    await page.selectOption('#picture-preset', 'hd');
    await page.selectOption('#picture-format', 'jpg');
    const jpeg = await save(page);
    assert.match(jpeg.name, /-1920x1080\.jpg$/);
    assert.deepEqual([...jpeg.bytes.subarray(0, 2)], [0xff, 0xd8]);
  }, `${url}#cloud=court&${fromAbove}`));

  it('sizes that are none are refused, those that no browser draws on come plain, and say so; a wait can be given up', async () => {
    const fake = new FakeServer();
    fake.snapshotMs = 60_000;
    const run = async () => withPage(async (page) => {
      await sized(page, 20_000, 600);
      assert.ok(await page.isVisible('#picture-refusal') && await page.isDisabled('#picture-save'));
      await sized(page, 16_384, 16_384);
      assert.match(await page.textContent('#picture-note'), /comes without scale bar/);
      await sized(page, 640, 480);
      assert.equal(await page.textContent('#picture-note'), '');
      await page.selectOption('#picture-format', 'jpg');
      for (const part of ['scale', 'legend', 'credit']) await page.uncheck(`#picture-${part}`);
      await page.click('#picture-save');
      await isTrue(() => fake.received.some(({ type }) => type === 'snapshot'), 'it was asked for');
      assert.match(await page.textContent('#picture-said'), /drawing/);
      await page.keyboard.press('Escape');
      await isTrue(() => fake.snapshotsGivenUp === 1, 'the server hears that nobody wants it');
      assert.match(await page.textContent('#picture-note'), /Cancelled/);
      await page.evaluate(axe);
      assert.deepEqual(await page.evaluate(async () => (await globalThis.axe.run(document, { resultTypes: ['violations'] })).violations
        .flatMap(({ id, nodes }) => nodes.map((node) => `${id}: ${node.target.join(' ')} ${node.failureSummary}`))), []);
      await page.keyboard.press('Escape');
      assert.ok(!(await page.isVisible('#picture-dialog')));
    }, await fake.start(), { colorScheme: 'light', viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true });
    await run().finally(() => fake.stop());
  });
});
