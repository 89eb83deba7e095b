// The browser's half of the notebook's view (client/python/scancast/widget.js): the module in a page that is no server's of ours, with a model
// as anywidget gives it, against the real server in headless Chromium.

import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { dirname, join } from 'node:path';
import { after, before, describe, it } from 'node:test';

import { startBrowser } from './support/browser.mjs';
import { RealServer } from './support/real_server.mjs';
import { writeScans } from './support/scans.mjs';

const program = process.env.SCANCAST_PROGRAM;
if (!program) throw new Error('Set SCANCAST_PROGRAM, such as SCANCAST_PROGRAM=build/release/bin/scancast');
const widget = readFileSync(new URL('../../client/python/scancast/widget.js', import.meta.url));

/** A cell of a notebook: `window.model` is its model, `window.leave()` takes the view out. */
const notebook = (traits) => `<!doctype html><title>A notebook</title><div id="cell"></div>
<script type="module">
  import widget from '/widget.js';
  class Model extends EventTarget {
    traits = ${JSON.stringify(traits)};
    saved = [];
    sent = [];
    handlers = new Map();
    get(name) { return structuredClone(this.traits[name]); }
    set(name, value) { this.traits[name] = structuredClone(value); }
    save_changes() { this.saved.push(structuredClone(this.traits)); }
    send(message) { this.sent.push(message); }
    on(event, act) { this.handlers.set(event, [...(this.handlers.get(event) ?? []), act]); }
    off(event, act) { this.handlers.set(event, this.handlers.get(event).filter((one) => one !== act)); }
    tell(event, ...values) { for (const act of this.handlers.get(event) ?? []) act(...values); }
    python(name, value) { this.set(name, value); this.tell('change:' + name); }
  }
  window.model = new Model();
  window.leave = await widget.render({ model: window.model, el: document.getElementById('cell') });
  window.rendered = true;
</script>`;

describe('a view in a notebook', { timeout: 290_000 }, () => {
  let scans, server, locked, browser, site, origin, url, cloud;
  let page = '';

  before(async () => {
    scans = writeScans();
    site = createServer(({ url: path }, answer) => {
      const [type, text] = path === '/widget.js' ? ['text/javascript', widget] : ['text/html', page];
      answer.writeHead(200, { 'Content-Type': type }).end(text);
    });
    await new Promise((listening) => { site.listen(0, '127.0.0.1', listening); });
    origin = `http://localhost:${site.address().port}`;
    server = new RealServer(program, scans.files, ['--allowed-origin', origin]);
    url = await server.start();
    while (!(await fetch(`${url}readyz`)).ok) await new Promise((later) => { setTimeout(later, 50); });
    cloud = (await (await fetch(`${url}api/v1/clouds`)).json()).clouds[0].id;
    browser = await startBrowser();
  });
  after(async () => {
    await browser?.close();
    await server?.stop();
    await locked?.stop();
    site.closeAllConnections();
    site.close();
    scans?.remove();
  });

  async function inNotebook(traits, use) {
    page = notebook({ _server: url, _locked: false, _asked: [0, ''], _shown: {}, cloud, controls: 'orbit', height: 300, picked: null, status: '', ...traits });
    const context = await browser.newContext();
    try {
      const tab = await context.newPage();
      await tab.goto(`${origin}/`.replace('localhost', traits.host ?? 'localhost'));
      await tab.waitForFunction(() => window.rendered, undefined, { timeout: 20_000 });
      await use(tab);
    } finally {
      await context.close();
    }
  }

  const shown = (tab) => tab.evaluate(() => window.model.traits._shown);
  const saw = (tab, what, value) => tab.waitForFunction(([name, wanted]) => JSON.stringify(window.model.traits._shown?.camera?.[name]) === wanted,
    [what, JSON.stringify(value)], { timeout: 20_000 });

  it('shows what it was given, and both sides hear of each other', () => inNotebook({ _asked: [0, 'eye=0,-9,4&target=0,0,0&color=elevation'] }, async (tab) => {
    await saw(tab, 'eye', [0, -9, 4]);
    const first = await shown(tab);
    assert.equal(first.color, 'elevation');
    assert.ok(!('width' in first) && !('ratio' in first), 'the cell says how large it is');
    assert.equal(await tab.evaluate(() => document.querySelector('.scancast').getBoundingClientRect().height), 300);

    // From Python.
    await tab.evaluate(() => window.model.python('_asked', [1, 'eye=9,0,4&target=0,0,0&color=rgb']));
    await saw(tab, 'eye', [9, 0, 4]);
    assert.equal((await shown(tab)).color, 'rgb');
    await tab.evaluate(() => window.model.python('height', 200));
    assert.equal(await tab.evaluate(() => document.querySelector('.scancast').getBoundingClientRect().height), 200);

    // From the hand: what it leaves is what Python has, however many steps were left out.
    const before = await tab.evaluate(() => {
      window.steps = 0;
      document.querySelector('scancast-view').addEventListener('viewchange', () => { window.steps += 1; window.last = performance.now(); });
      return window.model.saved.length;
    });
    const box = await tab.locator('scancast-view').boundingBox();
    await tab.mouse.move(box.x + 200, box.y + 90);
    await tab.mouse.down();
    await tab.mouse.move(box.x + 260, box.y + 90, { steps: 30 });
    await tab.mouse.up();
    await tab.waitForFunction(() => window.steps > 0 && performance.now() - window.last > 500, undefined, { timeout: 20_000 });
    await tab.waitForFunction(() => {
      const words = new URLSearchParams(document.querySelector('scancast-view').view);
      return words.get('eye') === window.model.traits._shown.camera.eye.join(',');
    }, undefined, { timeout: 20_000 });
    assert.notDeepEqual((await shown(tab)).camera.eye, [9, 0, 4]);
    const [steps, messages] = await tab.evaluate((saved) => [window.steps, window.model.saved.length - saved], before);
    assert.ok(messages > 0 && messages <= steps + 2, `${messages} messages for ${steps} steps`);

    // What is clicked is picked; a drag is no click.
    await tab.evaluate(() => window.model.python('_asked', [2, 'eye=0,-0.1,9&target=0,0,0']));
    await saw(tab, 'eye', [0, -0.1, 9]);
    assert.equal(await tab.evaluate(() => window.model.traits.picked), null);
    let picked = null;
    for (let y = 20; y < 200 && picked === null; y += 20) {
      for (let x = 20; x < box.width && picked === null; x += 60) {
        await tab.mouse.click(box.x + x, box.y + y);
        await tab.waitForTimeout(30);
        picked = await tab.evaluate(() => window.model.traits.picked);
      }
    }
    picked ??= await tab.waitForFunction(() => window.model.traits.picked, undefined, { timeout: 20_000 }).then((one) => one.jsonValue()); // it may come late
    assert.ok(picked?.position.every(Number.isFinite), 'nothing can be picked');

    // By name, and gone.
    await tab.evaluate(() => window.model.tell('msg:custom', { type: 'standard', name: 'top' }));
    await tab.waitForFunction(() => { const { eye, target } = window.model.traits._shown.camera; return Math.hypot(eye[0] - target[0], eye[1] - target[1]) < 1e-2 * Math.abs(eye[2] - target[2]); },
      undefined, { timeout: 20_000 });
    await tab.evaluate(() => window.leave());
    assert.equal(await tab.locator('scancast-view').count(), 0);
    assert.ok(await tab.evaluate(() => [...window.model.handlers.values()].every((list) => list.length === 0)), 'handlers are left');
  }));

  it('says what to do where the server does not know the notebook', () => inNotebook({ host: '127.0.0.1' }, async (tab) => {
    const said = await tab.evaluate(() => [window.model.traits.status, document.querySelector('.scancast').textContent]);
    assert.match(said[0], /--allowed-origin http:\/\/127\.0\.0\.1:\d+/);
    assert.ok(said[1].startsWith(said[0]));
    // Python draws meanwhile.
    assert.deepEqual(await tab.evaluate(() => window.model.sent.map(({ type, height }) => [type, height])), [['still', 300]]);
    const jpeg = Buffer.from(await (await fetch(`${url}api/v1/clouds/${cloud}/snapshot.jpg?width=64&height=36`)).arrayBuffer()).toString('base64');
    await tab.evaluate((data) => window.model.tell('msg:custom', { type: 'still' }, [new DataView(Uint8Array.from(atob(data), (c) => c.charCodeAt(0)).buffer)]), jpeg);
    await tab.waitForFunction(() => document.querySelector('.scancast img').naturalWidth === 64, undefined, { timeout: 20_000 });
    await tab.evaluate(() => window.model.python('_asked', [1, 'eye=1,2,3']));
    assert.equal(await tab.evaluate(() => window.model.sent.length), 2);
    await tab.evaluate(() => window.leave());
    assert.equal(await tab.locator('.scancast').count(), 0);
  }));

  it('asks Python for the token, and only where there is one', async () => {
    const token = Buffer.from(crypto.getRandomValues(new Uint8Array(32))).toString('base64url');
    const file = join(dirname(scans.files[0]), 'notebook-token');
    writeFileSync(file, `${token}\n`, { mode: 0o600 });
    locked = new RealServer(program, scans.files, ['--allowed-origin', origin, '--auth-token-file', file]);
    const secured = await locked.start();
    await inNotebook({ _server: secured, _locked: true }, async (tab) => {
      await tab.waitForFunction(() => window.model.sent.some(({ type }) => type === 'token'), undefined, { timeout: 20_000 });
      await tab.evaluate((value) => window.model.tell('msg:custom', { type: 'token', token: value }), token);
      await tab.waitForFunction(() => Array.isArray(window.model.traits._shown?.camera?.eye), undefined, { timeout: 20_000 });
      assert.ok(!(await tab.evaluate(() => JSON.stringify(window.model.traits))).includes(token), 'a trait would be saved with the notebook');
    });
  });
});
