// The page and its server, used by pages of other websites: those of --allowed-origin, and one that is not. The websites are
// servers of this test; the browser decides what they may, as it does outside.
//
// 127.0.0.1 with another port is the same site as ours, localhost is another site.

import assert from 'node:assert/strict';
import { createServer } from 'node:http';
import { after, before, describe, it } from 'node:test';

import { bundle } from '../../client/embed/pack.mjs';
import { startBrowser } from './support/browser.mjs';
import { RealServer } from './support/real_server.mjs';
import { writeScans } from './support/scans.mjs';

const program = process.env.SCANCAST_PROGRAM;
if (!program) throw new Error('Set SCANCAST_PROGRAM, such as SCANCAST_PROGRAM=build/release/bin/scancast');

/** A website with one page, which tries everything and notes what worked in `window.tried`. */
class Website {
  #server = createServer(({ url }, answer) => {
    const [type, text] = this.files[url] ?? ['text/html', this.page];
    answer.writeHead(200, { 'Content-Type': type }).end(text);
  });
  page = '';
  files = {}; // path → [type, text], beside the page

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

/** A page with the element in it; `module`: where that comes from. Notes what the element tells, in `window.told`. */
const embedding = (module, attributes) => `<!doctype html><title>Another website</title>
<style>scancast-view { width: 480px; height: 300px }</style>
<h1>Our building</h1>
<scancast-view id="view" ${attributes}></scancast-view>
<script type="module" src="${module}"></script>
<script>
  window.told = [];
  const view = document.getElementById('view');
  for (const name of ['connection', 'cloudchange', 'viewchange', 'frame', 'problem'])
    view.addEventListener(name, ({ detail }) => window.told.push(name === 'frame' ? { name, final: detail.final } : { name }));
</script>`;

describe('on other websites', { timeout: 120_000 }, () => {
  const allowed = new Website();
  const stranger = new Website();
  let scans, server, browser, addresses, own;

  before(async () => {
    scans = writeScans();
    const [mine, other] = [await allowed.start(), await stranger.start()];
    addresses = { sameSite: `http://127.0.0.1:${mine}`, crossSite: `http://localhost:${mine}`, stranger: `http://127.0.0.1:${other}` };
    server = new RealServer(program, scans.files, ['--allowed-origin', addresses.sameSite, '--allowed-origin', addresses.crossSite]);
    const url = own = await server.start();
    while (!(await fetch(`${url}readyz`)).ok) await new Promise((later) => { setTimeout(later, 50); });
    const list = await (await fetch(`${url}api/v1/clouds`)).json();
    const cloud = list.clouds[0].id;
    allowed.page = stranger.page = tries(url).replace('CLOUD', cloud);
    const eye = 'view="eye=0,-9,4&amp;target=0,0,0&amp;background=ffffff"';
    allowed.files = {
      '/element': ['text/html', embedding(`${url}scancast-view.js`, `cloud="${cloud}" ${eye}`)],
      '/packed': ['text/html', embedding('/scancast-view.js', `src="${url}" cloud="${cloud}" controls="none" ${eye}`)],
      '/missing': ['text/html', embedding(`${url}scancast-view.js`, 'cloud="nothing"')],
      '/scancast-view.js': ['text/javascript', bundle()],
    };
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

  const isSharp = () => window.told.some(({ name, final }) => name === 'frame' && final);

  /** Uses the element in a page of the allowed website; nothing but what it does itself stands in the console. */
  async function withElement(path, use) {
    const context = await browser.newContext();
    try {
      const page = await context.newPage();
      const complaints = [];
      page.on('console', (message) => { if (message.type() === 'error') complaints.push(message.text()); });
      page.on('pageerror', (error) => complaints.push(String(error)));
      await page.goto(addresses.crossSite + path);
      await use(page);
      assert.deepEqual(complaints, []);
    } finally {
      await context.close();
    }
  }

  it('the element shows the view that it was given, and tells and does what its page asks', () => withElement('/element', async (page) => {
    await page.waitForFunction(isSharp, undefined, { timeout: 20_000 });
    const words = new URLSearchParams(await page.evaluate(() => document.getElementById('view').view));
    assert.deepEqual([words.get('eye'), words.get('target'), words.get('background')], ['0,-9,4', '0,0,0', 'ffffff']);
    const told = await page.evaluate(() => window.told.map(({ name }) => name));
    for (const name of ['connection', 'cloudchange', 'viewchange', 'frame']) assert.ok(told.includes(name), name);
    assert.ok(!told.includes('problem'));
    const size = await page.evaluate(async () => {
      const bitmap = await createImageBitmap(await document.getElementById('view').snapshot({ width: 64, height: 32 }));
      return [bitmap.width, bitmap.height];
    });
    assert.deepEqual(size, [64, 32]);
    // Somewhere on the ring: the server's own point, near to the plane that it lies on.
    const point = await page.evaluate(async () => {
      const view = document.getElementById('view');
      for (let y = 40; y < 300; y += 20) for (let x = 40; x < 480; x += 40) {
        const found = await view.pick(x, y);
        if (found) return found.position;
      }
      return null;
    });
    assert.ok(point !== null && point.every(Number.isFinite), 'nothing is under any pixel');
    // Keys steer it only while it has the focus; dragging does.
    const before = await page.evaluate(() => document.getElementById('view').view);
    await page.keyboard.press('ArrowLeft');
    assert.equal(await page.evaluate(() => document.getElementById('view').view), before);
    const box = await page.locator('#view').boundingBox();
    await page.mouse.move(box.x + 240, box.y + 150);
    await page.mouse.down();
    await page.mouse.move(box.x + 330, box.y + 150, { steps: 4 });
    await page.mouse.up();
    await page.waitForFunction((old) => document.getElementById('view').view !== old, before);
    // Another view, by its attribute.
    await page.evaluate(() => document.getElementById('view').setAttribute('view', 'eye=9,0,4&target=0,0,0'));
    await page.waitForFunction(() => /eye=9,0,4/.test(document.getElementById('view').view), undefined, { timeout: 5000 });
  }));

  it('the element ends its connection with its place in a document, and takes it up again', () => withElement('/element', async (page) => {
    await page.waitForFunction(isSharp, undefined, { timeout: 20_000 });
    const sessions = async () => Number(/^scancast_sessions (\d+)$/m.exec(await (await fetch(`${own}metrics`)).text())[1]);
    const until = async (count) => {
      for (let tries = 0; tries < 100 && (await sessions()) !== count; ++tries) await new Promise((later) => { setTimeout(later, 50); });
      assert.equal(await sessions(), count);
    };
    await until(1);
    await page.evaluate(() => { window.kept = document.getElementById('view'); window.kept.remove(); });
    await until(0);
    await page.evaluate(() => { window.told.length = 0; document.body.append(window.kept); });
    await page.waitForFunction(isSharp, undefined, { timeout: 20_000 });
    assert.match(await page.evaluate(() => window.kept.view), /eye=0,-9,4/);
    await until(1);
  }));

  it('in one file, and where nothing can be moved', () => withElement('/packed', async (page) => {
    await page.waitForFunction(isSharp, undefined, { timeout: 20_000 });
    const before = await page.evaluate(() => document.getElementById('view').view);
    const box = await page.locator('#view').boundingBox();
    await page.mouse.move(box.x + 240, box.y + 150);
    await page.mouse.down();
    await page.mouse.move(box.x + 330, box.y + 150, { steps: 4 });
    await page.mouse.up();
    assert.equal(await page.evaluate(() => document.getElementById('view').view), before);
  }));

  it('says what it cannot show', () => withElement('/missing', async (page) => {
    const says = page.locator('#view').locator('p');
    await says.filter({ hasText: 'This server has no scan named nothing.' }).waitFor({ timeout: 10_000 });
  }));

  it('another one does neither', () => withWebsite(addresses.stranger, async (page, tried) => {
    assert.deepEqual(tried, { fetch: false, stream: false, module: false, picture: false, pictureWithoutOrigin: false });
    const inside = page.frames()[1];
    assert.match(inside.url(), /^chrome-error:/);
  }));
});
