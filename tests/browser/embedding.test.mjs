// The page and its server, used by pages of other websites: those of --allowed-origin, and one that is not. The websites are
// servers of this test; the browser decides what they may, as it does outside.
//
// 127.0.0.1 with another port is the same site as ours, localhost is another site.

import assert from 'node:assert/strict';
import { createServer } from 'node:http';
import { after, before, describe, it } from 'node:test';

import { startBrowser } from './support/browser.mjs';
import { RealServer } from './support/real_server.mjs';
import { writeScans } from './support/scans.mjs';

const program = process.env.SCANCAST_PROGRAM;
if (!program) throw new Error('Set SCANCAST_PROGRAM, such as SCANCAST_PROGRAM=build/release/bin/scancast');

/** A website with one page, which tries everything and notes what worked in `window.tried`. */
class Website {
  #server = createServer((_, answer) => {
    answer.writeHead(200, { 'Content-Type': 'text/html' });
    answer.end(this.page);
  });
  page = '';

  async start() {
    await new Promise((listening) => { this.#server.listen(0, listening); });
    return this.#server.address().port;
  }

  stop() {
    this.#server.closeAllConnections();
    this.#server.close();
  }
}

const tries = (scancast) => `<!doctype html><title>Another website</title>
<iframe src="${scancast}" width="640" height="400"></iframe>
<script type="module">
  const worked = (promise) => promise.then(() => true, () => false);
  const opened = (socket) => new Promise((done) => { socket.onopen = () => done(true); socket.onerror = () => done(false); });
  const loaded = (image) => new Promise((done) => { image.onload = () => done(true); image.onerror = () => done(false); });
  const api = '${scancast}api/v1/';
  const images = [Object.assign(new Image(), { crossOrigin: 'anonymous' }), new Image()];
  const pictures = images.map(loaded);  // before they can have come
  for (const image of images) image.src = api + 'clouds/CLOUD/snapshot.jpg?width=32&height=16';
  window.tried = {
    fetch: await worked(fetch(api + 'clouds').then((answer) => answer.json())),
    stream: await opened(new WebSocket(api.replace('http', 'ws') + 'stream', ['scancast.v1'])),
    module: await worked(import('${scancast}view/vectors.js')),
    picture: await pictures[0],
    pictureWithoutOrigin: await pictures[1],
  };
</script>`;

describe('on other websites', { timeout: 120_000 }, () => {
  const allowed = new Website();
  const stranger = new Website();
  let scans, server, browser, addresses;

  before(async () => {
    scans = writeScans();
    const [mine, other] = [await allowed.start(), await stranger.start()];
    addresses = { sameSite: `http://127.0.0.1:${mine}`, crossSite: `http://localhost:${mine}`, stranger: `http://127.0.0.1:${other}` };
    server = new RealServer(program, scans.files, ['--allowed-origin', addresses.sameSite, '--allowed-origin', addresses.crossSite]);
    const url = await server.start();
    while (!(await fetch(`${url}readyz`)).ok) await new Promise((later) => { setTimeout(later, 50); });
    const list = await (await fetch(`${url}api/v1/clouds`)).json();
    const cloud = list.clouds[0].id;
    allowed.page = stranger.page = tries(url).replace('CLOUD', cloud);
    browser = await startBrowser();
  });
  after(async () => {
    await browser?.close();
    await server?.stop();
    allowed.stop();
    stranger.stop();
    scans?.remove();
  });

  async function withWebsite(address, use) {
    const context = await browser.newContext();
    try {
      const page = await context.newPage();
      await page.goto(address);
      await page.waitForFunction(() => window.tried !== undefined, undefined, { timeout: 20_000 });
      await use(page, await page.evaluate(() => window.tried));
    } finally {
      await context.close();
    }
  }

  for (const where of ['sameSite', 'crossSite']) {
    it(`an allowed one, ${where}, shows the page and uses the server`, () => withWebsite(addresses[where], async (page, tried) => {
      const { pictureWithoutOrigin, ...rest } = tried;
      assert.deepEqual(rest, { fetch: true, stream: true, module: true, picture: true });
      assert.equal(pictureWithoutOrigin, false, 'nobody knows whose page it is on');
      const inside = page.frames()[1];
      await inside.waitForFunction(() => document.getElementById('hud')?.dataset.state === 'sharp', undefined, { timeout: 20_000 });
    }));
  }

  it('another one does neither', () => withWebsite(addresses.stranger, async (page, tried) => {
    assert.deepEqual(tried, { fetch: false, stream: false, module: false, picture: false, pictureWithoutOrigin: false });
    const inside = page.frames()[1];
    assert.match(inside.url(), /^chrome-error:/);
  }));
});
