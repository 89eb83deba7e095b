// How near the page's reprojection comes to the truth: frames of an orbit, each shown as it would look some degrees later,
// beside the picture that the server draws of that very view. Everything comes from snapshots, so it is the same
// whenever it is measured.
//
//   scancast serve town.scan autzen.scan &
//   node tests/browser/measure/reprojection.mjs http://127.0.0.1:8080/ [--out FOLDER] [--size 960x540] [--closer 0.4] [CLOUD…]
//
// prints, as a mean over the orbit, PSNR to the true picture in dB of the frame as it was, of the frame as the page shows
// it, and of that with a margin drawn around the frame; the share of pixels with something in them that the frame has not
// shown; and milliseconds for each in this browser, its loading included. With --out, the pictures themselves.

import { mkdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

import { startBrowser } from '../support/browser.mjs';
import { PageProxy } from '../support/page_proxy.mjs';

const degreesPerSecond = 30;
const lags = [0.1, 0.25]; // seconds
const turns = [0, 60, 120, 180, 240, 300]; // degrees of the orbit
const margins = [0, 0.04];

const words = process.argv.slice(2);
const option = (name, usual) => {
  const at = words.indexOf(`--${name}`);
  return at < 0 ? usual : words.splice(at, 2)[1];
};
const out = option('out', '');
const [width, height] = option('size', '960x540').split('x').map(Number);
const closer = Number(option('closer', '1')); // share of the distance
const [server = 'http://127.0.0.1:8080/', ...only] = words;
if (out) mkdirSync(out, { recursive: true });

const proxy = new PageProxy(server);
const url = await proxy.start();
const browser = await startBrowser();
// A document of that origin which is nothing but the place for a canvas.
const page = await (await browser.newContext({ viewport: { width, height } })).newPage();
await page.route(`${url}blank`, (route) => route.fulfill({
  contentType: 'text/html',
  body: `<style>body{margin:0}canvas{position:fixed;inset:0;width:100%;height:100%}</style><canvas width="${width}" height="${height}"></canvas>`,
}));
await page.goto(`${url}blank`);

/** In the browser: everything that is measured of one cloud at one place of the orbit. */
async function measure({ url, cloud, turn, lag, margins, width, height, degreesPerSecond, wantsPictures, closer }) {
  const at = (path) => import(new URL(path, url));
  const [{ fromProtocol, toProtocol }, { poseOf }, { Reprojection }] = await Promise.all(
    ['view/camera.js', 'view/pose.js', 'view/reprojection.js'].map(at),
  );
  const canvas = document.querySelector('canvas');
  const context = canvas.getContext('2d', { willReadFrequently: true });
  const usual = fromProtocol(cloud.view.camera);
  const first = { ...usual, distance: usual.distance * closer };
  const turned = (degrees) => ({ ...first, azimuth: first.azimuth + (degrees * Math.PI) / 180 });
  const [before, now] = [turned(turn), turned(turn + degreesPerSecond * lag)];

  const snapshot = async (camera, margin, accept, size) => {
    const view = { ...toProtocol(camera, cloud.bounds), near: null, far: null };
    const stretch = { x: size.width / width, y: size.height / height };
    if (view.fov) view.fov = (360 / Math.PI) * Math.atan(Math.tan((view.fov * Math.PI) / 360) * stretch.y);
    else view.viewHeight *= stretch.y;
    const answer = await fetch(new URL(`api/v1/clouds/${cloud.id}/snapshot`, url), {
      method: 'POST', headers: { 'Content-Type': 'application/json', Accept: accept }, body: JSON.stringify({ camera: view, ...size }),
    });
    if (!answer.ok) throw new Error(await answer.text());
    return { answer, stretch };
  };
  const bitmapOf = async ({ answer }) => createImageBitmap(await answer.blob());

  /** As the server makes them of a frame's depth: what lies nearest to the middle of each cell. */
  const cellsOf = (depth, w, h) => {
    const longer = Math.max(w, h), cells = Math.min(160, longer);
    const [columns, rows] = [w, h].map((side) => Math.max(2, Math.floor((side * cells + longer / 2) / longer)));
    const inverse = new Float32Array(columns * rows);
    for (let j = 0; j < rows; ++j) {
      for (let i = 0; i < columns; ++i) {
        const [left, right] = [Math.floor((i * w) / columns), Math.floor(((i + 1) * w) / columns)];
        const [top, bottom] = [Math.floor((j * h) / rows), Math.floor(((j + 1) * h) / rows)];
        let found = depth[((top + bottom - 1) >> 1) * w + ((left + right - 1) >> 1)], least = Infinity;
        for (let y = top; y < bottom && !(found < Infinity && least === Infinity); ++y) {
          for (let x = left; x < right; ++x) {
            const distance = (2 * x - left - right + 1) ** 2 + (2 * y - top - bottom + 1) ** 2;
            if (depth[y * w + x] < Infinity && distance < least) [found, least] = [depth[y * w + x], distance];
          }
        }
        inverse[j * columns + i] = 1 / found;
      }
    }
    return { width: columns, height: rows, inverse };
  };

  const pixels = () => context.getImageData(0, 0, width, height).data;
  const psnr = (a, b) => {
    let sum = 0;
    for (let i = 0; i < a.length; ++i) if (i % 4 !== 3) sum += (a[i] - b[i]) ** 2;
    return 10 * Math.log10(255 ** 2 / Math.max(1e-9, sum / (0.75 * a.length)));
  };
  const pictures = {};
  const keep = (name) => { if (wantsPictures) pictures[name] = canvas.toDataURL('image/png'); };

  const size = { width, height };
  context.drawImage(await bitmapOf(await snapshot(now, 0, 'image/png', size)), 0, 0);
  const truth = pixels();
  const trueDepth = new Float32Array(await (await snapshot(now, 0, 'application/octet-stream', size)).answer.arrayBuffer());
  keep('true');
  const result = { warped: {}, uncovered: {}, milliseconds: [] };
  for (const margin of margins) {
    const larger = { width: width + 2 * Math.round(margin * width), height: height + 2 * Math.round(margin * height) };
    const picture = await snapshot(before, margin, 'image/jpeg', larger);
    const bitmap = await bitmapOf(picture);
    const raw = await (await snapshot(before, margin, 'application/octet-stream', larger)).answer.arrayBuffer();
    const depth = cellsOf(new Float32Array(raw), larger.width, larger.height);
    const pose = poseOf(before, cloud.bounds, width / height, picture.stretch);
    const wanted = poseOf(now, cloud.bounds, width / height);
    const stale = () => context.drawImage(bitmap, (width - larger.width) / 2, (height - larger.height) / 2);

    stale();
    if (margin === 0) {
      keep('stale');
      result.stale = psnr(pixels(), truth);
    }
    const show = () => {
      const reprojection = new Reprojection(canvas);
      const over = canvas.nextElementSibling;
      reprojection.setFrame({ bitmap, depth, pose });
      reprojection.show(wanted);
      context.drawImage(over, 0, 0);
      const data = pixels();
      return { reprojection, over, data };
    };
    const { reprojection, over, data } = show();
    result.warped[margin] = psnr(data, truth);
    keep(`warped-${margin}`);
    for (let i = 0; i < 5; ++i) {
      reprojection.setFrame({ bitmap, depth, pose });
      reprojection.show(wanted);
      await new Promise((done) => { setTimeout(done, 60); });
      if (reprojection.milliseconds) result.milliseconds.push(reprojection.milliseconds);
    }
    over.getContext('webgl2').getExtension('WEBGL_lose_context').loseContext();
    over.remove();

    // Once more without what is made up: no fillings, and nothing beyond the picture's border.
    const getContext = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
      const gl = getContext.call(this, kind, ...rest);
      if (kind === 'webgl2' && gl) {
        const { shaderSource, drawElements } = gl;
        gl.shaderSource = (shader, text) =>
          shaderSource.call(gl, shader, text.replace('color =', 'if (any(notEqual(at, clamp(at, 0.0, 1.0)))) discard; color ='));
        let draws = 0;
        gl.drawElements = (...all) => { if (draws++ === 0) drawElements.apply(gl, all); };
      }
      return gl;
    };
    context.clearRect(0, 0, width, height);
    const bare = show();
    HTMLCanvasElement.prototype.getContext = getContext;
    let holes = 0;
    for (let i = 0; i < trueDepth.length; ++i) holes += trueDepth[i] < Infinity && bare.data[4 * i + 3] < 128 ? 1 : 0;
    result.uncovered[margin] = holes / (width * height);
    keep(`uncovered-${margin}`);
    bare.over.getContext('webgl2').getExtension('WEBGL_lose_context').loseContext();
    bare.over.remove();
    bitmap.close();
  }
  return { ...result, pictures };
}

const { clouds } = await (await fetch(new URL('api/v1/clouds', server))).json();
const mean = (values) => values.reduce((a, b) => a + b, 0) / values.length;
try {
  for (const lag of lags) {
    console.log(`\n${degreesPerSecond}°/s, ${1000 * lag} ms late, ${width} × ${height}`);
    console.log(`cloud                     stale   ${margins.map((m) => `warped, margin ${100 * m} %   uncovered`).join('   ')}     ms`);
    for (const cloud of clouds.filter(({ id }) => only.length === 0 || only.includes(id))) {
      const results = [];
      for (const turn of turns) {
        const result = await page.evaluate(`(${measure})(${JSON.stringify({ url, cloud: { id: cloud.id, view: cloud.view, bounds: cloud.bounds }, turn, lag, margins, width, height, degreesPerSecond, wantsPictures: out !== '', closer })})`);
        for (const [name, data] of Object.entries(result.pictures)) {
          writeFileSync(join(out, `${cloud.id}-${turn}-${1000 * lag}ms-${name}.png`), Buffer.from(data.split(',')[1], 'base64'));
        }
        results.push(result);
      }
      const db = (of) => mean(results.map(of)).toFixed(1).padStart(5);
      console.log(`${cloud.id.padEnd(24)}  ${db((r) => r.stale)}   ${margins.map((m) =>
        `${db((r) => r.warped[m])} dB            ${(100 * mean(results.map((r) => r.uncovered[m]))).toFixed(1).padStart(5)} %  `).join('   ')}   ${mean(results.flatMap((r) => r.milliseconds)).toFixed(1).padStart(5)}`);
    }
  }
} finally {
  await browser.close();
  await proxy.stop();
}
