// Scenes whose surface is known exactly, and the depth pictures that a server would send of them: 160 × 90 cells at most,
// each octave of 1 / depth in 512 steps.

import { axes, drawnFrom } from '../../../client/web/view/camera.js';
import { poseOf } from '../../../client/web/view/pose.js';
import { seenFrom } from '../../../client/web/view/seen.js';
import { add, dot, scale, subtract } from '../../../client/web/view/vectors.js';

const least = (...values) => Math.min(...values.map((value) => (value > 0 ? value : Infinity)));

/** Where a ray meets them: how far along, in lengths of its direction; Infinity for never. */
export const plane = (point, normal, inside = () => true) => (origin, direction) => {
  const t = dot(subtract(point, origin), normal) / dot(direction, normal);
  return t > 0 && inside(add(origin, scale(direction, t))) ? t : Infinity;
};
export const sphere = (center, radius) => (origin, direction) => {
  const offset = subtract(origin, center);
  const [a, b, c] = [dot(direction, direction), dot(offset, direction), dot(offset, offset) - radius * radius];
  const root = Math.sqrt(b * b - a * c);
  return Number.isNaN(root) ? Infinity : least((-b - root) / a, (-b + root) / a);
};
export const both = (...things) => (origin, direction) => Math.min(...things.map((thing) => thing(origin, direction)));

/** A ground of 200 × 200, a wall of 40 × 20 across y = 20, and the crown of a tree above (-15, 0). */
export const town = {
  bounds: { min: [-100, -100, 0], max: [100, 100, 20] },
  spacing: 0.1,
  ground: plane([0, 0, 0], [0, 0, 1], ([x, y]) => Math.abs(x) <= 100 && Math.abs(y) <= 100),
  wall: plane([0, 20, 0], [0, 1, 0], ([x, , z]) => Math.abs(x) <= 20 && z >= 0 && z <= 20),
  tree: sphere([-15, 0, 8], 4),
};
town.all = both(town.ground, town.wall, town.tree);

/** What one sees of `surface` through a place of the picture, x and y from -1 to 1: origin and direction of the ray, whose length is 1 in depth. */
function rayThrough(camera, bounds, aspect, x, y) {
  const { right, up, back } = axes(camera);
  const eye = add(camera.target, scale(back, drawnFrom(camera, bounds)));
  const half = Math.tan((camera.fov * Math.PI) / 360);
  const sideways = add(scale(right, x * half * aspect), scale(up, y * half));
  if (camera.projection !== 'orthographic') return [eye, subtract(sideways, back)];
  return [add(eye, scale(sideways, camera.distance)), scale(back, -1)];
}

export function seenOf(surface, camera, aspect, bounds, width = 160, height = 90) {
  const inverse = new Float32Array(width * height);
  for (let row = 0, i = 0; row < height; ++row) {
    for (let column = 0; column < width; ++column, ++i) {
      const [x, y] = [((column + 0.5) / width) * 2 - 1, 1 - ((row + 0.5) / height) * 2];
      const depth = surface(...rayThrough(camera, bounds, aspect, x, y));
      inverse[i] = depth < Infinity ? 2 ** (Math.round(Math.log2(1 / depth) * 512) / 512) : 0;
    }
  }
  return seenFrom(camera, { width, height, inverse }, poseOf(camera, bounds, aspect));
}

/** The true point under the cursor, undefined for the sky. */
export function truthUnder(surface, camera, cursor, size, bounds) {
  const [origin, direction] = rayThrough(camera, bounds, size.width / size.height, (cursor.x / size.width) * 2 - 1, 1 - (cursor.y / size.height) * 2);
  const depth = surface(origin, direction);
  return depth < Infinity ? add(origin, scale(direction, depth)) : undefined;
}
