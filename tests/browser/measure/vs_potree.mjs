// The page beside Potree, in the same browser, on the same scan, with the same camera path, without a GPU:
//
//   (mkdir -p /tmp/potree && cd /tmp/potree && npm init -y && npm install --ignore-scripts potree-core@2.0.15 three)
//   node tests/browser/measure/vs_potree.mjs build/release/bin/scancast shared/lion /tmp/potree
//
// The second argument is an octree in Potree's format (2.0: metadata.json, or 1.7/1.8: cloud.js), which both read: Potree from a
// plain HTTP server, Scancast through its importer. Prints, for each: time from the request of the page to the first
// picture with points in it and to the last refinement, bytes over the wire until then, frames/s that the display got
// in an orbit of ten seconds, and bytes of that. Both start as they start by themselves; the orbit is half a turn.

import { existsSync, readFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { extname, join, normalize, resolve } from 'node:path';

import { RealServer } from '../support/real_server.mjs';
import { PageProxy } from '../support/page_proxy.mjs';

const [, , program, octree, tools] = process.argv;
if (!program || !octree || !tools || !existsSync(join(tools, 'node_modules/potree-core'))) {
  console.error('Usage: node vs_potree.mjs SCANCAST POTREE_OCTREE FOLDER_WITH_POTREE_CORE   (how to get that: at the top of this file)');
  process.exit(2);
}
const { chromium } = await import('playwright-core');
const size = { width: 1280, height: 720 };
const orbitMs = 10_000;

const versionOf = (name) => JSON.parse(readFileSync(join(tools, 'node_modules', name, 'package.json'))).version;

const potreePage = `<!doctype html><meta charset=utf-8><title>Potree</title><link rel=icon href=data:,>
<style>html,body{margin:0;height:100%}canvas{display:block;width:100vw;height:100vh}</style><canvas id=c></canvas>
<script type=importmap>{"imports":{"three":"/tools/three/build/three.module.js","potree-core":"/tools/potree-core/dist/index.js"}}</script>
<script type=module>
import { PerspectiveCamera, Scene, WebGLRenderer, Box3, Vector3, Color } from 'three';
import { Potree } from 'potree-core';
const canvas = document.getElementById('c');
const renderer = new WebGLRenderer({ canvas, preserveDrawingBuffer: true });
renderer.setSize(innerWidth, innerHeight, false);
const scene = new Scene();
scene.background = new Color(0x000000);
const camera = new PerspectiveCamera(60, innerWidth / innerHeight, 0.01, 1e5);
const potree = new Potree();
potree.pointBudget = 2_000_000;
const cloud = await potree.loadPointCloud('${existsSync(join(octree, 'metadata.json')) ? 'metadata.json' : 'cloud.js'}', '/octree/');
cloud.material.size = 1; cloud.material.pointSizeType = 2;
scene.add(cloud);
cloud.updateMatrixWorld(true);
const box = cloud.pcoGeometry.tightBoundingBox.clone().applyMatrix4(cloud.matrixWorld);
const centre = box.getCenter(new Vector3());
const radius = box.getSize(new Vector3()).length() / 2;
window.measured = { frames: 0, first: 0, quiet: 0, points: 0 };
let angle = 0; let from = 0;
window.orbit = () => { from = performance.now(); window.measured.frames = 0; };
let still = 0; let visible = -1;
const pixels = new Uint8Array(4 * 64 * 36);
function loop(now) {
  if (from) angle = Math.PI * (performance.now() - from) / ${orbitMs};
  camera.up.set(0, 0, 1);
  camera.position.set(centre.x + 2 * radius * Math.sin(angle), centre.y - 2 * radius * Math.cos(angle), centre.z + 0.7 * radius);
  camera.lookAt(centre);
  camera.updateMatrixWorld();
  const result = potree.updatePointClouds([cloud], camera, renderer);
  renderer.render(scene, camera);
  const gl = renderer.getContext(); gl.finish();
  ++window.measured.frames;
  const shown = result.numVisiblePoints;
  window.measured.points = shown;
  if (!window.measured.first && shown > 0) {
    const all = new Uint8Array(4 * canvas.width * canvas.height);
    gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, all);
    if (all.some((value, i) => i % 4 !== 3 && value > 8)) window.measured.first = performance.now();
  }
  if (shown === visible && shown > 0 && (result.nodeLoadPromises?.length ?? 0) === 0) { if (++still === 30) window.measured.quiet = performance.now(); } else { still = 0; visible = shown; window.measured.lastChange = performance.now(); }
  requestAnimationFrame(loop);
}
requestAnimationFrame(loop);
</script>`;

const types = { '.js': 'text/javascript', '.json': 'application/json', '.html': 'text/html' };

/** A plain file server with ranges, as Potree expects one. */
function potreeServer() {
  const server = createServer((request, answer) => {
    const path = normalize(decodeURIComponent(new URL(request.url, 'http://x/').pathname));
    if (path === '/') { answer.writeHead(200, { 'Content-Type': 'text/html' }).end(potreePage); return; }
    const file = path.startsWith('/tools/') ? join(tools, 'node_modules', path.slice(7)) : join(octree, path.replace('/octree/', ''));
    try {
      const bytes = readFileSync(file);
      const [, from, to] = /bytes=(\d+)-(\d+)/.exec(request.headers.range ?? '') ?? [];
      const head = { 'Content-Type': types[extname(file)] ?? 'application/octet-stream' };
      if (from === undefined) answer.writeHead(200, head).end(bytes);
      else {
        const part = bytes.subarray(Number(from), Number(to) + 1);
        answer.writeHead(206, { ...head, 'Content-Range': `bytes ${from}-${Number(from) + part.length - 1}/${bytes.length}` }).end(part);
      }
    } catch {
      answer.writeHead(404).end();
    }
  });
  return new Promise((done) => { server.listen(0, '127.0.0.1', () => done(server)); });
}

/** A page that counts what comes over the wire. */
async function countedPage(browser, url) {
  const page = await (await browser.newContext({ viewport: size })).newPage();
  const network = await page.context().newCDPSession(page);
  await network.send('Network.enable');
  page.bytes = 0;
  page.webSocketFrames = 0;
  network.on('Network.dataReceived', ({ encodedDataLength, dataLength }) => { page.bytes += encodedDataLength || dataLength; });
  network.on('Network.webSocketFrameReceived', ({ response }) => {
    page.bytes += response.opcode === 2 ? Math.floor((response.payloadData.length * 3) / 4) : response.payloadData.length;
    page.webSocketFrames += 1;
  });
  page.on('console', (message) => { if (message.type() === 'error') console.error(`  ${message.text()}`); });
  page.on('pageerror', (error) => console.error(`  ${error}`));
  await page.goto(url);
  return page;
}

const rows = [];
const browser = await chromium.launch({
  executablePath: process.env.SCANCAST_CHROMIUM ?? '/usr/bin/chromium',
  args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-dev-shm-usage'],
});

// ---- Potree
{
  const server = await potreeServer();
  const page = await countedPage(browser, `http://127.0.0.1:${server.address().port}/`);
  await page.waitForFunction(() => window.measured?.quiet > 0, undefined, { timeout: 120_000 });
  const loaded = await page.evaluate(() => ({ ...window.measured }));
  const loadedBytes = page.bytes;
  page.bytes = 0;
  await page.evaluate(() => window.orbit());
  await page.waitForTimeout(orbitMs);
  const { frames, points } = await page.evaluate(() => window.measured);
  if (process.env.PICTURES) await page.screenshot({ path: join(process.env.PICTURES, 'potree.png') });
  rows.push({ name: `potree-core ${versionOf('potree-core')}, three ${versionOf('three')}`, first: loaded.first, last: loaded.lastChange, bytes: loadedBytes, fps: frames / (orbitMs / 1000), orbitBytes: page.bytes, points });
  await page.context().close();
  server.close();
}

// ---- Scancast: the page of the working tree, before the program
{
  const real = new RealServer(resolve(program), [resolve(octree)]);
  const address = await real.start();
  // The scan is imported first: Potree's was, too.
  for (;;) {
    const { clouds } = await (await fetch(new URL('/api/v1/clouds', address))).json();
    if (clouds.some((cloud) => cloud.state === 'ready')) break;
    await new Promise((done) => { setTimeout(done, 100); });
  }
  const proxy = new PageProxy(address);
  const page = await countedPage(browser, await proxy.start());
  const shown = await page.waitForFunction(() => (document.getElementById('picture').dataset.shown !== undefined ? performance.now() : 0), undefined, { timeout: 60_000, polling: 'raf' });
  const first = await shown.jsonValue();
  const sharp = await page.waitForFunction(() => (document.getElementById('hud').dataset.state === 'sharp' ? performance.now() : 0), undefined, { timeout: 60_000, polling: 'raf' });
  const last = await sharp.jsonValue();
  const loadedBytes = page.bytes;
  page.bytes = 0;
  await page.evaluate(() => {
    window.drawn = { pictures: 0, changes: 0 };
    const canvas = document.getElementById('picture');
    let frame;
    const look = () => {
      if (canvas.dataset.frame !== frame) { frame = canvas.dataset.frame; window.drawn.pictures += 1; }
      window.drawn.changes += 1;
      requestAnimationFrame(look);
    };
    requestAnimationFrame(look);
  });
  const [x, y] = [size.width / 2, size.height / 2];
  await page.mouse.move(x - 300, y);
  await page.mouse.down();
  const start = Date.now();
  for (let now = 0; now < orbitMs; now = Date.now() - start) {
    await page.mouse.move(x - 300 + (600 * now) / orbitMs, y);
    await page.waitForTimeout(12);
  }
  await page.mouse.up();
  const drawn = await page.evaluate(() => window.drawn);
  if (process.env.PICTURES) await page.screenshot({ path: join(process.env.PICTURES, 'scancast.png') });
  rows.push({ name: 'Scancast', first, last, bytes: loadedBytes, fps: drawn.changes / (orbitMs / 1000), pictures: drawn.pictures / (orbitMs / 1000), orbitBytes: page.bytes });
  await page.context().close();
  await proxy.stop();
  await real.stop();
}
await browser.close();

const MB = (bytes) => `${(bytes / 1e6).toFixed(2)} MB`;
for (const row of rows) {
  const fps = row.pictures === undefined ? row.fps.toFixed(1) : `${row.pictures.toFixed(1)} new pictures (display: ${row.fps.toFixed(1)})`;
  console.log(`${row.name}: first picture ${Math.round(row.first)} ms, whole ${Math.round(row.last)} ms, ${MB(row.bytes)} until then; `
    + `orbit ${fps} frames/s, ${MB(row.orbitBytes)} in ${orbitMs / 1000} s${row.points ? `, ${row.points} points drawn` : ''}`);
}
