// Two small scans, written by hand as LAS 1.2 with colours (point format 2), so that these tests need nothing but the
// server that they test.

import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

import { blockJpeg } from './block_jpeg.mjs';
import { random } from './cameras.mjs';
import { e57Bytes } from './e57.mjs';

const headerLength = 227;
const recordLength = 26;
const step = 0.001;

/** `points`: arrays of x, y, z, r, g, b with colours 0–255, and a class after them, 1 where there is none. */
export function lasBytes(points) {
  const bytes = Buffer.alloc(headerLength + points.length * recordLength);
  bytes.write('LASF');
  bytes[24] = 1;
  bytes[25] = 2;
  bytes.writeUInt16LE(headerLength, 94);
  bytes.writeUInt32LE(headerLength, 96); // offset to the points
  bytes[104] = 2;
  bytes.writeUInt16LE(recordLength, 105);
  bytes.writeUInt32LE(points.length, 107);
  bytes.writeUInt32LE(points.length, 111);
  for (let axis = 0; axis < 3; ++axis) {
    const values = points.map((point) => point[axis]);
    bytes.writeDoubleLE(step, 131 + 8 * axis);
    bytes.writeDoubleLE(values.reduce((a, b) => Math.max(a, b)), 179 + 16 * axis);
    bytes.writeDoubleLE(values.reduce((a, b) => Math.min(a, b)), 187 + 16 * axis);
  }
  points.forEach((point, i) => {
    const at = headerLength + i * recordLength;
    for (let axis = 0; axis < 3; ++axis) bytes.writeInt32LE(Math.round(point[axis] / step), at + 4 * axis);
    bytes.writeUInt16LE(Math.round(20 + 200 * (point[3] / 255)), at + 12); // intensity
    bytes[at + 14] = 0b001001; // first return of one
    bytes[at + 15] = point[6] ?? 1;
    for (let channel = 0; channel < 3; ++channel) bytes.writeUInt16LE(point[3 + channel] * 257, at + 20 + 2 * channel);
  });
  return bytes;
}

/** A ring, orange above and blue below, in five stretches of different brightness: it looks different from everywhere. */
function ring(count) {
  const next = random(11);
  return Array.from({ length: count }, () => {
    const a = next() * 2 * Math.PI, b = next() * 2 * Math.PI;
    const z = 3 * Math.sin(b);
    const light = [1, 0.75, 0.95, 0.65, 0.85][Math.floor((a / (2 * Math.PI)) * 5)];
    const color = (z > 0 ? [240, 140, 40] : [50, 140, 220]).map((value) => Math.round(value * light));
    return [(7 + 3 * Math.cos(b)) * Math.cos(a), (7 + 3 * Math.cos(b)) * Math.sin(a), z, ...color];
  });
}

/** Three walls of a room, green. */
function corner(count) {
  const next = random(12);
  return Array.from({ length: count }, (_, i) => {
    const point = [next() * 8, next() * 8, next() * 5];
    point[i % 3] = i % 3 === 1 ? 8 : 0;
    return [...point, 40 + 30 * (i % 3), 200 - 50 * (i % 3), 90];
  });
}

/** A yard of 40 × 40: grass, a wall of 20 × 8 along y = 10, and a tree whose crown of radius 3 is round (-9, 0, 5). */
function yard(count) {
  const next = random(15);
  return Array.from({ length: count }, (_, i) => {
    const shade = 0.7 + 0.3 * next();
    const painted = (...color) => color.map((value) => Math.round(value * shade));
    if (i % 6 === 0) return [next() * 20 - 10, 10, next() * 8, ...painted(210, 190, 170)];
    if (i % 6 > 1) return [next() * 40 - 20, next() * 40 - 20, 0, ...painted(110, 150, 80)];
    const [a, z] = [next() * 2 * Math.PI, next() * 2 - 1];
    const aside = Math.sqrt(1 - z * z);
    return [-9 + 3 * aside * Math.cos(a), 3 * aside * Math.sin(a), 5 + 3 * z, ...painted(60, 120, 50)];
  });
}

/** Ground of 40 × 40 (class 2, brown) about the origin, and on it a block whose roof is 10 × 10 (class 6, red), with a corner at (0, 0, 6). */
export function writePlot(count = 120_000) {
  const next = random(16);
  const points = Array.from({ length: count }, (_, i) => (i % 3 === 0
    ? [next() * 10, next() * 10, 6, 220, 30, 30, 6]
    : [next() * 40 - 20, next() * 40 - 20, 0, 120, 100, 60, 2]));
  const folder = mkdtempSync(join(tmpdir(), 'scancast-plot-'));
  const file = join(folder, 'plot.las');
  writeFileSync(file, lasBytes(points));
  return { file, remove: () => rmSync(folder, { recursive: true, force: true }) };
}

/** Where the court lies: a survey's coordinates. */
export const courtOrigin = [400_000, 1_500_000, 40];
export const courtSpacing = 0.1;

/**
 * A court of 20 × 20 whose points are a grid of 0.1, with a red spot of radius 0.5 round (6, 6), and a wall of 12 × 6 along y = 12,
 * from x = 4 to 16: lengths between its points are known.
 */
function court() {
  const points = [];
  const add = (x, y, z, ...color) => points.push([x + courtOrigin[0], y + courtOrigin[1], z + courtOrigin[2], ...color]);
  for (let j = 0; j <= 200; ++j) {
    for (let i = 0; i <= 200; ++i) {
      const [x, y] = [i * courtSpacing, j * courtSpacing];
      if (Math.hypot(x - 6, y - 6) < 0.55) add(x, y, 0, 230, 20, 20);
      else add(x, y, 0, 90, 120 + 8 * ((i + j) % 3), 90);
      if (j <= 60 && i >= 40 && i <= 160) add(x, 12, y, 200, 190, 170);
    }
  }
  return points;
}

export function writeCourt() {
  const folder = mkdtempSync(join(tmpdir(), 'scancast-court-'));
  const file = join(folder, 'court.las');
  writeFileSync(file, lasBytes(court()));
  return { file, folder, remove: () => rmSync(folder, { recursive: true, force: true }) };
}

/** The yard in a folder of its own. */
export function writeYard() {
  const folder = mkdtempSync(join(tmpdir(), 'scancast-yard-'));
  const file = join(folder, 'yard.las');
  writeFileSync(file, lasBytes(yard(150_000)));
  return { file, remove: () => rmSync(folder, { recursive: true, force: true }) };
}

/** A room in PTX, seen by two scanners: red by the one in the west, who faces north, blue by the other. */
export function ptxOfTwoScanners(count) {
  const next = random(13);
  return [[2, '200 30 30'], [6, '30 30 200']].map(([x, color]) => {
    const points = Array.from({ length: count }, (_, i) => {
      const point = [next() * 4 - 2, next() * 8 - 4, next() * 3 - 1.5];
      point[i % 3] = i % 3 === 2 ? -1.5 : Math.sign(next() - 0.5) * (i % 3 === 0 ? 2 : 4);
      return `${point.map((value) => value.toFixed(4)).join(' ')} 0.5 ${color}`;
    });
    // The scanner's x axis is the file's y: its points are turned back, so that they come out where they were meant.
    const turned = points.map((line) => {
      const [a, b, ...rest] = line.split(' ');
      return [b, String(-Number(a)), ...rest].join(' ');
    });
    return [count, 1, '0 0 0', '1 0 0', '0 1 0', '0 0 1', '0 1 0 0', '-1 0 0 0', '0 0 1 0', `${x} 4 1.5 1`, ...turned, ''].join('\n');
  }).join('');
}

/**
 * A room in E57, seen by a scanner in its middle, 1.5 above the floor, with two photos of one colour each: an orange panorama, and a
 * violet one that looks north along y, taken 1 east of the scanner.
 */
export function e57WithPhotos(count) {
  const next = random(14);
  const points = Array.from({ length: count }, (_, i) => {
    const point = [next() * 8 - 4, next() * 8 - 4, next() * 3 - 1.5];
    point[i % 3] = i % 3 === 2 ? -1.5 : 4 * Math.sign(next() - 0.5);
    return [...point, 90 + 40 * (i % 3), 150, 200 - 50 * (i % 3)];
  });
  const half = Math.SQRT1_2; // of a quarter turn
  const place = { rotation: [half, 0, 0, half], translation: [10, 20, 1.5] }; // it faces north
  const photos = [
    { name: 'All round', scan: 0, jpeg: blockJpeg(640, 320, () => [230, 130, 20]), width: 640, height: 320, angle: Math.PI / 320, pose: place },
    { name: 'North wall', scan: 0, jpeg: blockJpeg(320, 240, () => [120, 40, 200]), width: 320, height: 240, focal: 0.012, pixel: 0.0001,
      pose: { rotation: [half, half, 0, 0], translation: [11, 20, 1.5] } }, // a camera looks along its -z: that is north now
  ];
  return { bytes: e57Bytes([{ name: 'Hall', points, pose: place }], photos), jpegs: photos.map(({ jpeg }) => jpeg) };
}

export function writeScans() {
  const folder = mkdtempSync(join(tmpdir(), 'scancast-browser-'));
  const files = { ring: join(folder, 'ring.las'), corner: join(folder, 'corner.las') };
  writeFileSync(files.ring, lasBytes(ring(60_000)));
  writeFileSync(files.corner, lasBytes(corner(40_000)));
  return { folder, files: Object.values(files), remove: () => rmSync(folder, { recursive: true, force: true }) };
}
