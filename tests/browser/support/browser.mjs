// Starts Debian's Chromium without a window and with a fresh profile, and talks to pages as a user would.

import assert from 'node:assert/strict';
import { existsSync } from 'node:fs';

const flags = [
  '--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking',
  '--disable-component-update', '--disable-sync', '--disable-dev-shm-usage',
];

async function playwright() {
  try {
    return (await import('playwright-core')).chromium;
  } catch {
    throw new Error('playwright-core is missing. Run: (cd tests/browser && npm ci --ignore-scripts)');
  }
}

export async function startBrowser() {
  const executablePath = process.env.SCANCAST_CHROMIUM ?? '/usr/bin/chromium';
  if (!existsSync(executablePath)) throw new Error(`There is no ${executablePath}. Run: apt-get install chromium`);
  // A profile of its own, new and empty, is what launch() makes.
  return (await playwright()).launch({ executablePath, headless: true, args: flags });
}

/** A page that remembers everything the console complained of. The panel leaves 960 × 600 to the picture. `options` as for newContext. */
export async function openPage(browser, url, options = {}) {
  const page = await newPage(browser, options);
  await page.goto(url);
  return page;
}

/** The same before it goes anywhere: its `complaints` are what the console says. */
export async function newPage(browser, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 600 }, ...options });
  const page = await context.newPage();
  page.complaints = [];
  page.on('console', (message) => {
    if (message.type() === 'error' || message.type() === 'warning') page.complaints.push(message.text());
  });
  page.on('pageerror', (error) => page.complaints.push(String(error)));
  return page;
}

/**
 * Waits until the picture of the newest request is there in full quality. What was done a moment ago is asked for with the page's next
 * display frame; until then the picture before it is the newest.
 */
export async function waitUntilSharp(page, timeout = 20_000) {
  waits += 1;
  await page.waitForFunction((wait) => {
    const { asked, shown } = document.getElementById('picture').dataset;
    if (globalThis.waitsAs !== wait) {
      globalThis.waitsAs = wait;
      globalThis.hasAsked = false;
      requestAnimationFrame(() => requestAnimationFrame(() => { globalThis.hasAsked = true; }));
    }
    return globalThis.hasAsked && document.getElementById('hud').dataset.state === 'sharp' && asked !== undefined && asked === shown;
  }, waits, { timeout, polling: 50 });
}
let waits = 0;

/** Waits until something holds that is seen from here, such as what a server has received; the page sends with its next display frame. */
export async function isTrue(condition, what) {
  for (const end = Date.now() + 10_000; !(await condition());) {
    assert.ok(Date.now() < end, what);
    await new Promise((done) => { setTimeout(done, 10); });
  }
}

/** Chooses one of a group of radio buttons (client/web/page/choices.js): `#color`, `#method`, …; what it stands in is opened first. */
export async function choose(page, group, value) {
  await page.evaluate((selector) => {
    const details = document.querySelector(selector).closest('details');
    if (details) details.open = true;
  }, group);
  await page.check(`${group} input[value="${value}"]`);
}

/** The value that is chosen of such a group; undefined where none is. */
export const chosen = (page, group) => page.evaluate((selector) => document.querySelector(`${selector} input:checked`)?.value, group);

/** The canvas's pixels, thinned out, as bytes r, g, b, r, …. */
export async function pixels(page) {
  const text = await page.evaluate(() => {
    const canvas = document.getElementById('picture');
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    let thin = '';
    for (let i = 0; i < data.length; i += 4 * 7) thin += String.fromCharCode(data[i], data[i + 1], data[i + 2]);
    return btoa(thin);
  });
  return Buffer.from(text, 'base64');
}

/** Share of the pixels that differ by more than what JPEG may do to them. */
export function differing(a, b, tolerance = 24) {
  if (a.length !== b.length) return 1;
  let count = 0;
  for (let i = 0; i < a.length; i += 3) {
    if (Math.max(Math.abs(a[i] - b[i]), Math.abs(a[i + 1] - b[i + 1]), Math.abs(a[i + 2] - b[i + 2])) > tolerance) ++count;
  }
  return count / (a.length / 3);
}

/** Ends at rest, so that nothing glides on. */
export async function drag(page, from, to, button = 'left') {
  await page.mouse.move(...from);
  await page.mouse.down({ button });
  await page.mouse.move(...to, { steps: 8 });
  await page.waitForTimeout(80);
  await page.mouse.up({ button });
}

const serverAway = /ERR_CONNECTION|ERR_EMPTY_RESPONSE|ERR_SOCKET|WebSocket connection to .* failed/;
const tokenAsked = /status of 401/; // by the browser; the page asks for the token
const ownReading = /willReadFrequently/; // pixels() reads the canvas; the page never does
const browsersReading = /GPU stall due to ReadPixels/; // a browser without a graphics processor reads what WebGL draws

/** Closes a test's page, if there is one, and returns what its console said that is serious. */
export async function closePage(page) {
  const complaints = page ? seriousComplaints(page) : [];
  await page?.context().close();
  return complaints;
}

/** What the console said that is not the browser's own complaint about a server that is away. */
export const seriousComplaints = (page) =>
  page.complaints.filter((text) => ![serverAway, tokenAsked, ownReading, browsersReading].some((known) => known.test(text)));
