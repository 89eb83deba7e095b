// What a good server does not do on demand: being slow, sending nonsense, having nothing to show. The page against the
// test double.

import assert from 'node:assert/strict';
import { after, afterEach, before, beforeEach, describe, it } from 'node:test';

import { choose, chosen, closePage, differing, drag, isTrue, openPage, pixels, startBrowser, waitUntilSharp } from './support/browser.mjs';
import { blockJpeg } from './support/block_jpeg.mjs';
import { clouds, FakeServer } from './support/fake_server.mjs';

describe('the page, when things go wrong', { timeout: 280_000 }, () => {
  let browser, server, page;

  before(async () => { browser = await startBrowser(); });
  after(() => browser?.close());
  beforeEach(() => { server = new FakeServer(); });
  afterEach(async () => {
    const complaints = await closePage(page);
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
  const waitFor = (condition, what) => page.waitForFunction(condition, what, { timeout: 8000 });
  /** The address says the view there is: it is written once that has been still for a moment. */
  const addressSays = (text) => waitFor((wanted) => decodeURIComponent(location.hash).includes(wanted), text);
  /** Does it, and resolves to the picture that is there once it is sharp. */
  const afterwards = async (act) => {
    const asked = await page.getAttribute('#picture', 'data-asked');
    await act();
    await waitFor((before) => document.getElementById('picture').dataset.asked !== before, asked);
    await waitUntilSharp(page);
    return pixels(page);
  };
  const toastSays = (text) => waitFor((wanted) => !document.getElementById('toast').hidden && document.getElementById('toast').textContent.includes(wanted), text);
  const shownFrame = () => page.getAttribute('#picture', 'data-frame').then(Number);

  it('shows progress while a cloud loads, and the cloud when it is there', async () => {
    server.clouds = [];
    server.pending = [{ id: 'ring', title: 'ring.las', state: 'loading', stage: 'sorting points', progress: 0.4 }];
    await open();
    await coverSays('Loading ring.las');
    assert.equal(await page.textContent('#cover-detail'), 'Sorting points · 40 %');
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
    assert.equal(await page.textContent('#lack'), 'Parts of this point cloud cannot be read; coarser points are shown in their place.');
    assert.ok(await page.isVisible('#lack'));
    server.damaged = false;
    await drag(page, [300, 300], [420, 380]);
    await page.waitForFunction(() => document.getElementById('lack').hidden, undefined, { timeout: 8000 });
    await waitUntilSharp(page);
    assert.ok(!(await page.isVisible('#lack')));
  });

  it('says that a part of the server is away, while pictures say so, in both themes', async () => {
    server.away = true;
    await open();
    const note = page.locator('#lack');
    await page.waitForFunction(() => !document.getElementById('lack').hidden);
    assert.equal(await note.textContent(), 'Part of the server is away: the picture is coarser until it is back.');
    assert.equal(await note.getAttribute('aria-live'), 'polite');
    for (const colorScheme of ['dark', 'light']) {
      await page.emulateMedia({ colorScheme });
      assert.ok(await note.isVisible());
      const [words, ground] = await note.evaluate((shown) => [getComputedStyle(shown).color, getComputedStyle(shown).backgroundColor]);
      assert.notEqual(words, ground);
    }
    assert.notEqual(await page.getAttribute('#hud', 'data-state'), 'lost');
    assert.ok(!(await page.isVisible('#toast')), 'nothing has failed');
    server.comeBack();
    await waitUntilSharp(page);
    assert.ok(!(await page.isVisible('#lack')));
  });

  it("takes a guest's link out of the address, looks by it, and says when it is over", async () => {
    server.token = 'the.pass';
    server.guestLink = 'scg1.the.link';
    await open('#guest=scg1.the.link&method=point');
    await waitUntilSharp(page);
    assert.match(new URL(page.url()).hash, /^#(cloud=ring&.*)?method=point/);
    assert.ok(!(await page.evaluate(() => JSON.stringify(history.state) + document.documentElement.outerHTML)).includes('scg1'));
    assert.ok(server.received.some((message) => message.type === 'view' && message.method === 'point'), 'the rest is a view');
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
    await coverSays('This link is no longer valid');
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
    await coverSays('You need an access token');
    assert.equal(await page.textContent('#cover-title'), `127.0.0.1:${server.port}`, 'whose entrance it is');
    await page.fill('#token', 'a wrong one');
    await page.keyboard.press('Enter');
    await coverSays('That token was not accepted. Ask whoever runs this server.');
    await page.click('#token-reveal');
    assert.equal(await page.getAttribute('#token', 'type'), 'text');
    await page.fill('#token', server.token);
    await page.keyboard.press('Enter');
    await waitUntilSharp(page);
    assert.equal(await page.getAttribute('#token', 'type'), 'password');
    assert.equal(await page.evaluate(() => localStorage.length), 0, 'for this tab only');
    assert.ok(!(await page.isVisible('#cover')));
    assert.ok(!page.url().includes('token'));
    await page.reload();
    await waitUntilSharp(page);
    await page.click('#save-picture');
    await page.click('#picture-save');
    await page.waitForFunction(() => document.getElementById('toast').textContent.includes('draws no snapshots'));
    page.complaints = page.complaints.filter((text) => !text.includes('503'));
    // Forgotten, and remembered on the device: another tab is let in, too.
    await page.click('#forget-token');
    await coverSays('You need an access token');
    await page.fill('#token', server.token);
    await page.check('#token-remember');
    await page.click('#token-open');
    await waitUntilSharp(page);
    const tab = await page.context().newPage();
    await tab.goto(page.url());
    await waitUntilSharp(tab);
    await tab.close();
    await page.click('#forget-token');
    await coverSays('You need an access token');
    assert.equal(await page.evaluate(() => localStorage.length + sessionStorage.length), 0);
  });

  it('offers a cloud that finishes later, without a reload', async () => {
    server.clouds = [clouds[0]];
    server.pending = [{ id: 'helix', title: 'Helix', state: 'loading' }];
    await open();
    await waitUntilSharp(page);
    assert.equal(await page.textContent('#cloud option[value=helix]'), 'Helix (loading…)');
    await page.selectOption('#cloud', 'helix'); // who cannot wait is told how far it is, and what else there is
    await coverSays('Loading Helix');
    assert.deepEqual(await page.$$eval('#cover-list button', (nodes) => nodes.map((node) => node.textContent)), ['A ring of stones']);
    await addressSays('#cloud=helix');
    server.clouds = clouds;
    server.pending = [];
    await waitFor(() => document.querySelector('h1').textContent === 'Helix');
    await waitUntilSharp(page);
    await addressSays('#cloud=helix&eye=');
  });

  it('says what to do when there is no cloud, and which file was no cloud', async () => {
    server.clouds = [];
    await open();
    await coverSays('scancast serve');
    server.pending = [{ id: 'x', title: 'broken.las', state: 'failed', error: 'It ends in the middle of point 7' }];
    await coverSays('broken.las could not be loaded');
    assert.equal(await page.textContent('#cover-detail'), 'It ends in the middle of point 7.');
    server.pending.push({ id: 'y', title: 'empty.las', state: 'failed', error: 'It has no points.' });
    await coverSays('Nothing could be loaded');
    assert.equal(await page.textContent('#cover-reasons'), 'broken.lasIt ends in the middle of point 7.empty.lasIt has no points.');
  });

  it('keeps the view in the address: reload, back, forward and undo show it again, to the pixel', async () => {
    await open();
    await waitUntilSharp(page);
    await addressSays('#cloud=ring&eye=');
    const same = async (picture, what) => assert.equal(differing(picture, await pixels(page), 0), 0, what);
    const dragged = await afterwards(() => drag(page, [300, 300], [420, 380]));
    const elevated = await afterwards(() => choose(page, '#color', 'elevation'));
    await addressSays('color=elevation');
    await page.reload();
    await waitUntilSharp(page);
    await same(elevated, 'after a reload');
    assert.equal(await chosen(page, '#color'), 'elevation');
    const top = await afterwards(() => page.click('[data-view=top]'));
    await addressSays('up=0,1,0');
    const helix = await afterwards(() => page.selectOption('#cloud', 'helix'));
    await addressSays('#cloud=helix');
    await afterwards(() => page.goBack());
    await same(top, 'back to the other cloud');
    assert.equal(await page.textContent('h1'), 'A ring of stones');
    await afterwards(() => page.goBack());
    await waitUntilSharp(page);
    await addressSays('#cloud=ring&eye=');
    await waitUntilSharp(page);
    await same(elevated, 'back before the jump');
    await page.evaluate(() => history.go(2));
    await waitFor(() => document.querySelector('h1').textContent === 'Helix');
    await waitUntilSharp(page);
    await same(helix, 'forward');
    // Undo knows every view that was looked at for a moment, jump or not.
    await waitFor(() => !document.getElementById('undo').disabled);
    await afterwards(() => choose(page, '#appearance', 'raw'));
    await addressSays('method=point');
    await page.keyboard.press('Control+z'); // a choice has the focus
    await waitFor(() => document.querySelector('#method input:checked').value === 'paraboloid');
    await waitUntilSharp(page);
    await same(helix, 'undone');
    await afterwards(() => page.click('#redo'));
    assert.equal(await chosen(page, '#method'), 'point');
    await waitFor(() => document.getElementById('redo').disabled);
    assert.ok(dragged.length > 0);
  });

  it('understands every word of a link, and keeps it', async () => {
    await open('#cloud=ring&exposure=0.5&clip=-5,-5,-5,5,5,5&classes=2&light.sun=135,40&samples=2&up=0.3,0,1&eye=9,-14,8&target=0,0,0&near=1');
    await waitUntilSharp(page);
    const sent = server.received.find((message) => message.type === 'view');
    assert.deepEqual([sent.exposure, sent.classes, sent.samples, sent.light.sun, sent.camera.up, sent.camera.near, sent.clip],
      [0.5, [2], 2, [135, 40], [0.3, 0, 1], 1, { min: [-5, -5, -5], max: [5, 5, 5] }]);
    await addressSays('exposure=0.5');
    const { hash } = new URL(page.url());
    for (const word of ['clip=-5,-5,-5,5,5,5', 'classes=2', 'light.sun=135,40', 'samples=2', 'up=0.3,0,1', 'eye=9,-14,8', 'near=1'])
      assert.ok(hash.includes(word), `${word} is not in ${hash}`);
    await afterwards(() => drag(page, [300, 300], [330, 310]));
    await waitFor((before) => location.hash !== before, hash);
    assert.match(new URL(page.url()).hash, /clip=-5,-5,-5,5,5,5.*samples=2/, 'the hand changes the camera only');
  });

  it('a cloud that could not be loaded says why, can be tried again, and is no dead end', async () => {
    server.clouds = [clouds[1]];
    server.pending = [{ id: 'ring', title: 'ring.laz', state: 'failed', error: 'The file is cut off' }];
    await open('#cloud=ring&method=point');
    await coverSays('ring.laz could not be loaded');
    await coverSays('The file is cut off.');
    assert.equal(server.sessions.size, 0, 'no other cloud is shown');
    await page.click('#cover-list [data-cloud=helix]');
    await waitUntilSharp(page);
    assert.equal(await page.textContent('h1'), 'Helix');
    await page.selectOption('#cloud', 'ring');
    await coverSays('The file is cut off.');
    await page.goBack();
    await waitFor(() => document.getElementById('cover').hidden);
    await waitUntilSharp(page);
    assert.equal(await page.inputValue('#cloud'), 'helix');
    await page.goForward();
    await coverSays('ring.laz could not be loaded');
    server.clouds = clouds;
    server.pending = [];
    await page.click('#cover-retry');
    await waitFor(() => document.querySelector('h1').textContent === 'A ring of stones');
    await waitUntilSharp(page);
  });

  it('a cloud that vanishes is missed: no other takes its place, and it comes back by itself', async () => {
    await open();
    await waitUntilSharp(page);
    const dragged = await afterwards(() => drag(page, [300, 300], [420, 380]));
    server.remove('ring');
    await coverSays('A ring of stones is no longer here');
    assert.deepEqual(await page.$$eval('#cover-list button', (nodes) => nodes.map((node) => node.textContent)), ['Helix']);
    assert.ok(!(await page.isVisible('#toast')), 'said once');
    server.clouds = clouds;
    await page.click('#cover-retry');
    await waitFor(() => document.getElementById('cover').hidden);
    await waitUntilSharp(page);
    assert.equal(differing(dragged, await pixels(page), 0), 0, 'the view there was');
  });

  it('a link to a cloud that is not there says so', async () => {
    await open('#cloud=statue');
    await coverSays('There is no point cloud named “statue”');
    assert.equal(server.sessions.size, 0);
    assert.equal(new URL(page.url()).hash, '#cloud=statue');
    await page.click('#cover-list [data-cloud=helix]');
    await waitUntilSharp(page);
    await addressSays('#cloud=helix&eye=');
    await page.evaluate(() => { location.hash = '#cloud=statue'; });
    await coverSays('There is no point cloud named “statue”');
  });

  it('marks a picture of a part as coarse, and renews everything when the cloud is complete', async () => {
    const { attributes, ...rest } = clouds[0];
    server.clouds = [{ ...rest, attributes: [], points: 1000, revision: 'part', state: 'loading', stage: 'building', progress: 0.5 }];
    await open();
    await waitUntilSharp(page);
    assert.equal(await page.textContent('#loading-title'), 'Coarse: still loading, 60 %');
    assert.match(await page.textContent('#loading-detail'), /^Building the levels of detail/);
    assert.match(await page.textContent('#cloud-facts'), /1,000 points so far/);
    const rgb = () => page.$$eval('#color input[value=rgb]', (nodes) => nodes.length);
    assert.equal(await rgb(), 0);
    server.clouds = [{ ...clouds[0], attributes }];
    await waitFor(() => document.getElementById('loading').hidden);
    assert.match(await page.textContent('#cloud-facts'), /1.2 million points/);
    assert.equal(await rgb(), 1);
    await waitUntilSharp(page);
  });

  it('shows the figures of the frame on screen, or none', async () => {
    await open();
    await waitUntilSharp(page);
    const brief = (text) => waitFor((wanted) => document.getElementById('hud-brief').textContent === wanted, text);
    await brief('812,345 samples');
    server.statsOf = 'no frame';
    await afterwards(() => drag(page, [300, 300], [420, 380]));
    await brief('960 × 600');
    session().sendStats(session().frameId - 1);
    session().sendStats(session().frameId + 7);
    await page.click('#hud summary');
    await waitFor(() => document.getElementById('hud-figures').textContent.includes('960 × 600'));
    assert.ok(!(await page.textContent('#hud-figures')).includes('Samples'), 'of another frame');
    session().sendStats(session().frameId);
    await brief('812,345 samples');
    await waitFor(() => document.getElementById('hud-figures').textContent.includes('Samples'));
  });

  it('says which method the automatic one is, and why', async () => {
    await open('#method=auto');
    await waitUntilSharp(page);
    await waitFor(() => document.getElementById('method-chosen').textContent !== '');
    assert.equal(await page.textContent('#method-chosen'), 'Chosen for this scan: Paraboloids. Coloured points: they close the gaps.');
    assert.equal(await page.textContent('#method-name'), 'Automatic (Paraboloids)');
    await choose(page, '#appearance', 'raw');
    await waitFor(() => document.getElementById('method-chosen').textContent === '');
    assert.equal(await page.textContent('#method-name'), 'Points');
    assert.equal(await page.textContent('#method .choice:has([value=auto]) .name'), 'Automatic');
  });

  it('fields say why they refuse a value, and go back to the one that holds', async () => {
    await open('#method=paraboloid&color=elevation');
    await waitUntilSharp(page);
    await page.click('#tuning summary');
    const refusal = (selector) => page.$eval(selector, (input) =>
      [input.getAttribute('aria-invalid'), document.getElementById(input.getAttribute('aria-describedby'))?.textContent ?? '']);
    server.received.length = 0;
    await page.fill('#parameter-sizePx', '999');
    await page.press('#parameter-sizePx', 'Enter');
    assert.deepEqual(await refusal('#parameter-sizePx'), ['true', 'Must be at most 256 px.']);
    await page.press('#parameter-sizePx', 'Escape');
    assert.deepEqual([await page.inputValue('#parameter-sizePx'), ...(await refusal('#parameter-sizePx'))], ['0', null, '']);
    await page.fill('#range-low', '5');
    assert.deepEqual(await refusal('#range-low'), ['true', 'The minimum must be less than the maximum.']);
    await page.press('#range-low', 'Tab'); // to the high end, which is to be changed, too
    assert.equal(await page.inputValue('#range-low'), '5');
    assert.ok(!server.received.some(({ type }) => type === 'view'), 'nothing of this was asked for');
    await page.fill('#range-high', '9');
    await page.press('#range-high', 'Enter');
    await addressSays('range=5,9');
    assert.deepEqual(await refusal('#range-low'), [null, '']);
    await page.fill('#range-high', '1');
    await page.focus('#cloud');
    assert.equal(await page.inputValue('#range-high'), '9');
    // What only the server can refuse.
    await page.fill('#parameter-scale', '66');
    await page.press('#parameter-scale', 'Enter');
    await toastSays('not today');
    assert.deepEqual(await refusal('#parameter-scale'), ['true', 'The server did not accept this value.']);
    await page.focus('#cloud');
    assert.equal(await page.inputValue('#parameter-scale'), '1');
  });

  it('closes the panel when the window becomes small, and opens it again', async () => {
    await open();
    await waitUntilSharp(page);
    await page.setViewportSize({ width: 480, height: 700 });
    await waitFor(() => document.body.classList.contains('panel-closed'));
    await page.setViewportSize({ width: 1280, height: 600 });
    await waitFor(() => !document.body.classList.contains('panel-closed'));
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

  it('a server that knows nothing of depth is asked without it, and the hand takes hold of a plane', async () => {
    server.knowsDepth = false;
    await open();
    await waitUntilSharp(page);
    const hellos = server.received.filter((message) => message.type === 'hello');
    assert.deepEqual(hellos.map(({ depth }) => depth), [true, undefined]);
    assert.equal(hellos[1].width, hellos[0].width);
    server.received.length = 0;
    await drag(page, [300, 300], [420, 380], 'right');
    await page.mouse.wheel(0, -300);
    await waitUntilSharp(page);
    assert.ok(server.received.some(({ camera }) => camera), 'nothing moves');
  });

  it('a slow server gets the latest request, and the page acknowledges what it has drawn', async () => {
    server.frameDelay = 250;
    await open();
    await waitUntilSharp(page);
    server.received.length = 0;
    await drag(page, [300, 300], [420, 380]);
    await waitUntilSharp(page);
    const views = server.received.filter((message) => message.type === 'view');
    assert.ok(views.length >= 1 && views.length <= 16, `${views.length} views for 8 steps of the mouse`);
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

  /** Whether the cover was there, or the canvas empty, since this was called. */
  const watchForGaps = async () => {
    await page.evaluate(() => {
      const [cover, canvas] = [document.getElementById('cover'), /** @type {any} */ (document.getElementById('picture'))];
      globalThis.gaps = 0;
      const look = () => {
        const pixel = canvas.getContext('2d').getImageData(canvas.width / 2, canvas.height / 2, 1, 1).data;
        if (!cover.hidden || pixel[3] === 0) globalThis.gaps += 1;
        requestAnimationFrame(look);
      };
      look();
    });
    return () => page.evaluate(() => globalThis.gaps);
  };
  const hellos = () => server.received.filter((message) => message.type === 'hello');

  it('a server that leaves is left for another one: one reconnection, the same view, and no gap', async () => {
    await open();
    await waitUntilSharp(page);
    const before = await afterwards(() => drag(page, [300, 300], [420, 380]));
    const camera = server.received.findLast((message) => message.camera).camera;
    const gaps = await watchForGaps();
    const frame = await shownFrame();
    const first = session();
    first.drain(50);
    await isTrue(() => !server.sessions.has(first), 'the page leaves it');
    await waitFor((shown) => Number(document.getElementById('picture').dataset.frame) > shown, frame);
    await waitUntilSharp(page);
    assert.deepEqual(await pixels(page), before);
    assert.equal(hellos().length, 2);
    const [, again] = hellos();
    assert.equal(again.resume, 'token-1');
    assert.equal(again.cloud, 'ring');
    assert.equal(again.frame, frame);
    assert.deepEqual(again.view.camera, camera);
    assert.notDeepEqual(await afterwards(() => drag(page, [300, 300], [200, 260])), before, 'the hand goes on');
    assert.equal(await gaps(), 0);
  });

  it('what the other server begins with is not shown once something newer has been', async () => {
    await open();
    await waitUntilSharp(page);
    let release;
    server.holdsHello = new Promise((done) => { release = done; });
    server.showsAtOnce = true;
    await page.evaluate(() => {
      const canvas = document.getElementById('picture');
      globalThis.shown = [];
      new MutationObserver(() => globalThis.shown.push(Number(canvas.dataset.shown))).observe(canvas, { attributeFilter: ['data-shown'] });
    });
    const first = session();
    first.drain(0);
    await isTrue(() => hellos().length === 2, 'it comes to the other one');
    await afterwards(() => drag(page, [300, 300], [420, 380]));
    const before = await page.getAttribute('#picture', 'data-shown').then(Number);
    assert.ok(before > hellos()[1].seq, 'the first one draws on');
    await page.mouse.move(300, 300);
    await page.mouse.down();
    await page.mouse.move(340, 330, { steps: 4 });
    release();
    await isTrue(() => !server.sessions.has(first), 'it goes');
    assert.equal(first.socket.closeCode, 1000, 'for good');
    await page.mouse.up();
    await waitUntilSharp(page);
    const shown = await page.evaluate(() => globalThis.shown);
    assert.deepEqual(shown, shown.toSorted((a, b) => a - b));
    assert.deepEqual(session().view.camera, server.received.findLast((message) => message.camera).camera);
  });

  it('as long as there is no other server, the one that leaves is not left', async () => {
    await open();
    await waitUntilSharp(page);
    const gaps = await watchForGaps();
    const first = session();
    server.refusedStreams = 2;
    first.drain(0);
    await isTrue(() => server.refusedStreams < 2, 'it tries');
    await afterwards(() => drag(page, [300, 300], [420, 380]));
    await isTrue(() => !server.sessions.has(first), 'and goes in the end');
    await afterwards(() => drag(page, [300, 300], [420, 380]));
    assert.equal(hellos().length, 2);
    assert.equal(await gaps(), 0);
    page.complaints = page.complaints.filter((text) => !text.includes('503'));
  });

  it('a hand that drags while servers change is not let go', async () => {
    await open();
    await waitUntilSharp(page);
    const gaps = await watchForGaps();
    const first = session();
    await page.mouse.move(300, 300);
    await page.mouse.down();
    first.drain(0);
    for (let step = 1; step <= 40; ++step) await page.mouse.move(300 + 3 * step, 300 + step);
    await isTrue(() => !server.sessions.has(first), 'the page leaves it');
    const seen = server.received.length;
    await page.mouse.move(500, 340, { steps: 5 });
    await isTrue(() => server.received.slice(seen).some((message) => message.camera), 'the hand still turns the cloud');
    await page.mouse.up();
    await waitUntilSharp(page);
    assert.deepEqual(session().view.camera, server.received.findLast((message) => message.camera).camera);
    assert.equal(await gaps(), 0);
  });

  it('a refused snapshot is explained', async () => {
    await open();
    await waitUntilSharp(page);
    await page.click('#save-picture');
    await page.click('#picture-save');
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
        .filter((node) => !node.closest('[hidden], [aria-hidden=true]') && !(node.labels?.length || node.getAttribute('aria-label') || node.textContent.trim() || node.title))
        .map((node) => node.outerHTML));
    assert.deepEqual(nameless, []);
  });
});
