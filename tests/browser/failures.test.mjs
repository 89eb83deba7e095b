// What a good server does not do on demand: being slow, sending nonsense, having nothing to show. The page against the
// test double.

import assert from 'node:assert/strict';
import { after, afterEach, before, beforeEach, describe, it } from 'node:test';

import { choose, chosen, differing, drag, openPage, pixels, seriousComplaints, startBrowser, waitUntilSharp } from './support/browser.mjs';
import { blockJpeg } from './support/block_jpeg.mjs';
import { clouds, FakeServer } from './support/fake_server.mjs';

describe('the page, when things go wrong', { timeout: 120_000 }, () => {
  let browser, server, page;

  before(async () => { browser = await startBrowser(); });
  after(() => browser?.close());
  beforeEach(() => { server = new FakeServer(); });
  afterEach(async () => {
    const complaints = page ? seriousComplaints(page) : [];
    await page?.context().close();
    page = undefined;
    await server.stop();
    assert.deepEqual(complaints, []);
  });

  const open = async (hash = '') => {
    page = await openPage(browser, (await server.start()) + hash);
    return page;
  };
  const coverSays = (text) =>
    page.waitForFunction((wanted) => {
      const cover = document.getElementById('cover');
      return !cover.hidden && cover.textContent.includes(wanted);
    }, text, { timeout: 8000 });
  const session = () => [...server.sessions][0];
  const shownFrame = () => page.getAttribute('#picture', 'data-frame').then(Number);

  it('shows progress while a cloud loads, and the cloud when it is there', async () => {
    server.clouds = [];
    server.pending = [{ id: 'ring', title: 'ring.las', state: 'loading', stage: 'sorting points', progress: 0.4 }];
    await open();
    await coverSays('Loading ring.las');
    assert.match(await page.textContent('#cover-detail'), /Sorting points/);
    assert.equal(await page.evaluate(() => document.getElementById('cover-progress').value), 0.4);
    server.clouds = clouds;
    server.pending = [];
    await waitUntilSharp(page);
    assert.ok(!(await page.isVisible('#cover')));
  });

  it('says that parts cannot be read, as long as that is so', async () => {
    server.damaged = true;
    await open();
    await waitUntilSharp(page);
    assert.equal(await page.textContent('#damage'), 'Parts of this cloud cannot be read; coarser points are shown in their place.');
    assert.ok(await page.isVisible('#damage'));
    server.damaged = false;
    await drag(page, [300, 300], [420, 380]);
    await page.waitForFunction(() => document.getElementById('damage').hidden, undefined, { timeout: 8000 });
    await waitUntilSharp(page);
    assert.ok(!(await page.isVisible('#damage')));
  });

  it("takes a guest's link out of the address, looks by it, and says when it is over", async () => {
    server.token = 'the.pass';
    server.guestLink = 'scg1.the.link';
    await open('#guest=scg1.the.link&method=ewa');
    await waitUntilSharp(page);
    assert.equal(new URL(page.url()).hash, '#method=ewa');
    assert.ok(!(await page.evaluate(() => JSON.stringify(history.state) + document.documentElement.outerHTML)).includes('scg1'));
    assert.ok(server.received.some((message) => message.type === 'view' && message.method === 'ewa'), 'the rest is a view');
    await page.reload();
    await waitUntilSharp(page);
    const exchanges = () => server.received.filter((message) => message.type === 'guest-session').length;
    assert.equal(exchanges(), 2, 'the tab still has it');
    // A tab that was asleep: its pass is over, and so is its line.
    server.token = 'another.pass';
    session().socket.destroy();
    await page.waitForFunction((before) => document.getElementById('picture').dataset.frame !== before, await page.getAttribute('#picture', 'data-frame'));
    await waitUntilSharp(page);
    assert.equal(exchanges(), 3);
    server.guestLink = 'none';
    session().socket.destroy();
    await coverSays('This link is not good any more');
    await page.fill('#token', server.token);
    await page.keyboard.press('Enter');
    await waitUntilSharp(page);
    assert.equal(exchanges(), 4, 'no guest any more');
  });

  it('renews a pass before it ends', async () => {
    server.token = 'the.pass';
    server.guestLink = 'scg1.the.link';
    server.passSeconds = 1;
    await open('#guest=scg1.the.link');
    await waitUntilSharp(page);
    const exchanges = () => server.received.filter((message) => message.type === 'guest-session').length;
    assert.equal(exchanges(), 1);
    const end = Date.now() + 20_000;
    while (exchanges() < 2 && Date.now() < end) await new Promise((done) => setTimeout(done, 50));
    assert.equal(exchanges(), 2);
  });

  it('asks for a token, says when it is wrong, and takes it along everywhere but in addresses', async () => {
    server.token = 'a+token/with=signs?';
    await open();
    await coverSays('Whoever runs this server has it');
    await page.fill('#token', 'a wrong one');
    await page.keyboard.press('Enter');
    await coverSays('That was not it');
    await page.fill('#token', server.token);
    await page.keyboard.press('Enter');
    await waitUntilSharp(page);
    assert.ok(!(await page.isVisible('#cover')));
    assert.ok(!page.url().includes('token'));
    await page.reload();
    await waitUntilSharp(page);
    await page.click('#save-picture');
    await page.waitForFunction(() => document.getElementById('toast').textContent.includes('draws no snapshots'));
    page.complaints = page.complaints.filter((text) => !text.includes('503'));
  });

  it('offers a cloud that finishes later, without a reload', async () => {
    server.clouds = [clouds[0]];
    server.pending = [{ id: 'helix', title: 'Helix', state: 'loading' }];
    await open();
    await waitUntilSharp(page);
    assert.ok(await page.evaluate(() => document.querySelector('#cloud option[value=helix]').disabled));
    server.clouds = clouds;
    server.pending = [];
    await page.waitForFunction(() => !document.querySelector('#cloud option[value=helix]').disabled, undefined, { timeout: 8000 });
    await page.selectOption('#cloud', 'helix');
    await waitUntilSharp(page);
    assert.equal(await page.textContent('h1'), 'Helix');
  });

  it('says what to do when there is no cloud, and which file was no cloud', async () => {
    server.clouds = [];
    await open();
    await coverSays('scancast serve');
    server.pending = [{ id: 'x', title: 'broken.las', state: 'failed' }];
    await coverSays('broken.las');
  });

  it('never draws a frame that is older than the one on screen', async () => {
    await open();
    await waitUntilSharp(page);
    const newest = await shownFrame();
    const before = await pixels(page);
    const red = blockJpeg(960, 600, () => [250, 0, 0]);
    session().sendFrame(true, red, 960, 600, newest - 1);
    await page.waitForTimeout(400);
    assert.equal(await shownFrame(), newest);
    assert.equal(differing(before, await pixels(page)), 0);
    // The same picture as a newer frame is drawn: the check above can fail.
    session().sendFrame(true, red, 960, 600);
    await page.waitForFunction((old) => Number(document.getElementById('picture').dataset.frame) > old, newest);
    assert.ok(differing(before, await pixels(page)) > 0.9);
  });

  it('a slow server gets the latest request, and the page acknowledges what it has drawn', async () => {
    server.frameDelay = 250;
    await open();
    await waitUntilSharp(page);
    server.received.length = 0;
    await drag(page, [300, 300], [420, 380]);
    await waitUntilSharp(page);
    const views = server.received.filter((message) => message.type === 'view');
    assert.ok(views.length >= 1 && views.length <= 12, `${views.length} views for 8 steps of the mouse`);
    assert.ok(views.every((view, i) => i === 0 || view.seq === views[i - 1].seq + 1));
    assert.equal(await page.getAttribute('#picture', 'data-shown'), String(views.at(-1).seq));
    const lastAck = server.received.filter((message) => message.type === 'ack').at(-1);
    assert.equal(lastAck.frame, session().frameId);
    assert.match(await page.textContent('#hud-state'), /Sharp/);
  });

  it('sends at most one view for each frame of the display, however fast the mouse', async () => {
    await open();
    await waitUntilSharp(page);
    server.received.length = 0;
    const frames = await page.evaluate(async () => {
      const canvas = document.getElementById('picture');
      const send = (type, clientX) => canvas.dispatchEvent(new PointerEvent(type, { pointerId: 1, clientX, clientY: 200, bubbles: true, button: 0 }));
      canvas.setPointerCapture = () => {}; // only real pointers can be captured
      let count = 0;
      const tick = () => { count += 1; requestAnimationFrame(tick); };
      requestAnimationFrame(tick);
      send('pointerdown', 100);
      for (let i = 0; i < 300; ++i) {
        send('pointermove', 100 + i);
        if (i % 30 === 0) await new Promise((done) => { setTimeout(done, 20); });
      }
      await new Promise((done) => { setTimeout(done, 80); }); // at rest, nothing glides on
      send('pointerup', 400);
      return count;
    });
    await waitUntilSharp(page);
    const views = server.received.filter((message) => message.type === 'view').length;
    assert.ok(views >= 1 && views <= frames + 2, `${views} views in ${frames} frames`);
  });

  it('a picture that cannot be decoded is said and got over', async () => {
    await open();
    await waitUntilSharp(page);
    session().sendFrame(true, Buffer.from('this is no JPEG'), 960, 600);
    await page.waitForSelector('#toast:not([hidden])');
    await drag(page, [300, 300], [420, 380]);
    await waitUntilSharp(page);
  });

  it('bytes that are no frame end the connection, and a new one is made', async () => {
    await open();
    await waitUntilSharp(page);
    session().socket.sendBinary(Buffer.from('garbage'));
    await coverSays('Connection lost');
    await page.waitForSelector('#cover', { state: 'hidden', timeout: 10_000 });
    await waitUntilSharp(page);
    const hellos = server.received.filter((message) => message.type === 'hello');
    assert.deepEqual(hellos.map((hello) => hello.resume), [undefined, 'token-1'], 'it asks to go on with its session');
  });

  it('a refused snapshot is explained', async () => {
    await open();
    await waitUntilSharp(page);
    await page.click('#save-picture');
    await page.waitForSelector('#toast:not([hidden])');
    assert.match(await page.textContent('#toast'), /draws no snapshots/);
    page.complaints = page.complaints.filter((text) => !text.includes('503'));
    const { words } = server.received.find((message) => message.type === 'snapshot');
    assert.equal(words.method, 'paraboloid');
    assert.equal(words.width, '960');
  });

  it('a server that shuts down politely is named as the reason', async () => {
    await open();
    await waitUntilSharp(page);
    session().socket.sendText(JSON.stringify({ type: 'bye', code: 1001, reason: '' }));
    session().socket.close(1001);
    await coverSays('shutting down');
  });

  it('a hostile link does nothing but show the usual view', async () => {
    await open('#cloud=%22%3E%3Cimg%20src=x%20onerror=alert(1)%3E&method=%3Cb%3E&eye=NaN,1,2&param.x=<script>');
    await waitUntilSharp(page);
    assert.equal(await chosen(page, '#method'), 'paraboloid');
    assert.equal(await page.textContent('h1'), 'A ring of stones');
  });

  it('greys out what a cloud cannot be shown with, and says why', async () => {
    await open();
    await waitUntilSharp(page);
    assert.equal(await page.isDisabled('#method input[value=surfel]'), true);
    assert.match(await page.textContent('#method .choice:has([value=surfel])'), /needs normals/);
    const colors = () => page.$$eval('#color .name', (nodes) => nodes.map((node) => node.textContent));
    assert.equal((await colors())[0], 'Automatic');
    assert.ok(!(await colors()).includes('Intensity'));
    assert.match(await page.textContent('#color-note'), /Not in this scan: .*Intensity/);
    assert.match(await page.textContent('#color-note'), /Hidden points are shown by the method “Reconstructed surface” only/);
    await choose(page, '#color', 'elevation');
    assert.ok(!(await page.isVisible('#by-intensity')), 'no shading by an intensity that is not there');
    await page.selectOption('#cloud', 'helix');
    assert.ok((await colors()).includes('Intensity'));
    await choose(page, '#color', 'elevation');
    await page.check('#by-intensity');
    await waitUntilSharp(page);
    assert.equal(server.received.filter((message) => message.color).at(-1).color, 'elevation*intensity');
  });

  it('opens well-named controls: every one of them has a label', async () => {
    await open();
    await waitUntilSharp(page);
    const nameless = await page.evaluate(() =>
      [...document.querySelectorAll('button, input, select, summary, canvas')]
        .filter((node) => !node.closest('[hidden], [aria-hidden="true"]') && !(node.labels?.length || node.getAttribute('aria-label') || node.textContent.trim() || node.title))
        .map((node) => node.outerHTML));
    assert.deepEqual(nameless, []);
  });
});
