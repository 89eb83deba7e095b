// Moving frames as video, in the page and in a real browser: they come as H.264 and are shown, the still at the end is JPEG, and a decoder
// that fails costs nothing but the video.

import assert from 'node:assert/strict';
import { after, before, describe, it } from 'node:test';

import { drag, newPage, pixels, differing, seriousComplaints, startBrowser, waitUntilSharp } from './support/browser.mjs';
import { RealServer } from './support/real_server.mjs';
import { writeScans } from './support/scans.mjs';

const program = process.env.SCANCAST_PROGRAM;
if (!program) throw new Error('Set SCANCAST_PROGRAM, such as SCANCAST_PROGRAM=build/release/bin/scancast');

const codecs = { 1: 'jpeg', 2: 'h264' };
const isServerWithout = (server) => /moving frames: no H\.264/.test(server.log);

describe('video', { timeout: 120_000 }, () => {
  let scans, server, browser, url;
  before(async () => {
    scans = writeScans();
    server = new RealServer(program, scans.files);
    url = await server.start();
    browser = await startBrowser();
  });
  after(async () => {
    await browser?.close();
    await server?.stop();
    scans?.remove();
  });

  /** A page that is sharp, and what its connection hears: { hellos, welcomes, frames: [{ codec, moving, final }] }. */
  async function watchedPage(script) {
    const page = await newPage(browser);
    const heard = { hellos: [], welcomes: [], frames: [] };
    page.on('websocket', (socket) => {
      socket.on('framesent', ({ payload }) => {
        const message = JSON.parse(payload);
        if (message.type === 'hello') heard.hellos.push(message);
      });
      socket.on('framereceived', ({ payload }) => {
        if (typeof payload === 'string') {
          const message = JSON.parse(payload);
          if (message.type === 'welcome') heard.welcomes.push(message);
          return;
        }
        heard.frames.push({ codec: codecs[payload[8]], moving: (payload[9] & 1) !== 0, final: (payload[9] & 4) !== 0 });
      });
    });
    if (script) await page.addInitScript(script);
    await page.goto(url);
    await waitUntilSharp(page);
    return { page, heard };
  }

  /** Turns the cloud and back again; what is seen while it moves is another picture. */
  async function turn(page) {
    const earlier = await pixels(page);
    await drag(page, [300, 300], [420, 260]);
    await waitUntilSharp(page);
    assert.ok(differing(earlier, await pixels(page)) > 0.004);
  }

  const figures = async (page) => {
    await page.evaluate(() => { document.getElementById('hud').open = true; });
    await page.waitForSelector('#hud-figures dd');
    return page.textContent('#hud-figures');
  };

  it('moves as video and stands as JPEG', async (test) => {
    if (isServerWithout(server)) return test.skip('NOT TESTED: this server has no libopenh264');
    const { page, heard } = await watchedPage();
    const { supported } = await page.evaluate(() => VideoDecoder.isConfigSupported({ codec: 'avc1.42c033', optimizeForLatency: true }));
    if (!supported) return test.skip('NOT TESTED: this browser decodes no H.264');
    assert.deepEqual(heard.hellos[0].codecs, ['h264', 'jpeg']);
    assert.equal(heard.welcomes[0].movingCodec, 'h264');
    await turn(page);
    const moving = heard.frames.filter((frame) => frame.moving);
    assert.ok(moving.length > 0 && moving.every(({ codec }) => codec === 'h264'), JSON.stringify(heard.frames));
    const last = heard.frames.at(-1);
    assert.deepEqual(last, { codec: 'jpeg', moving: false, final: true });
    assert.equal(heard.hellos.length, 1, 'nothing went wrong with it');
    assert.match(await figures(page), /Moving framesVideo \(H\.264\)/);
    assert.deepEqual(seriousComplaints(page), []);
    return page.context().close();
  });

  it('goes on with JPEG where the decoder fails', async (test) => {
    if (isServerWithout(server)) return test.skip('NOT TESTED: this server has no libopenh264');
    const { page, heard } = await watchedPage(() => {
      VideoDecoder.isConfigSupported = async () => ({ supported: true });
      VideoDecoder.prototype.decode = () => { throw new Error('a decoder that fails'); };
    });
    assert.deepEqual(heard.hellos[0].codecs, ['h264', 'jpeg']);
    await turn(page);
    await page.waitForFunction(() => document.getElementById('hud').dataset.state === 'sharp');
    assert.equal(heard.hellos.length, 2);
    assert.equal(heard.hellos[1].codecs, undefined);
    assert.equal(heard.welcomes[1].session, heard.welcomes[0].session, 'the session is the same');
    const known = heard.frames.length;
    await turn(page);
    assert.ok(heard.frames.slice(known).every(({ codec }) => codec === 'jpeg'));
    assert.match(await figures(page), /JPEG: this browser could not show the video/);
    return page.context().close();
  });
});
