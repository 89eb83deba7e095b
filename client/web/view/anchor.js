// The point that a hand takes hold of: of the surface under the cursor, where a picture has seen one; else a point as
// far away as something nearby; else one in the plane that was last worked at. Pure.

import { axes, centerOf, corners, depthOf, drawnFrom, pointUnderCursor, radiusOf } from './camera.js';
import { hitAlong } from './seen.js';
import { add, scale, subtract } from './vectors.js';

/** CSS pixels around the cursor in which a surface is still meant. */
const reaches = [9, 18, 27];
const around = [0, 1, 2, 3, 4, 5, 6, 7].map((i) => [Math.cos((i * Math.PI) / 4), Math.sin((i * Math.PI) / 4)]);

/** Nearer to a surface than this one does not come: its points would be far apart, or cut off by the server's near plane. */
export const leastDistanceTo = ({ spacing = 0, bounds }) => Math.max(8 * spacing, 4e-4 * radiusOf(bounds));

/** Farther away than this there is nothing to see. */
export const mostDistanceTo = ({ bounds }) => 20 * Math.max(radiusOf(bounds), 1e-6);

/** Depth of the cloud's corner that is farthest ahead. */
export const farthestDepth = (camera, bounds) => Math.max(...corners(bounds).map((corner) => depthOf(camera, corner)));

/** The surface under the cursor: { point, depth }, undefined where no picture has seen any there. */
export function surfaceUnder(seen, camera, cursor, size, bounds) {
  if (!seen) return undefined;
  const orthographic = camera.projection === 'orthographic';
  // Without perspective, what lies behind the camera's own eye is seen, too.
  const start = orthographic ? camera.distance - drawnFrom(camera, bounds) : 0;
  const origin = orthographic ? pointUnderCursor(camera, cursor, size, start) : add(camera.target, scale(axes(camera).back, camera.distance));
  const direction = orthographic
    ? scale(axes(camera).back, -1)
    : scale(subtract(pointUnderCursor(camera, cursor, size), origin), 1 / camera.distance);
  const range = Math.max(farthestDepth(camera, bounds) - start, 0) * 1.05 + 1e-9;
  const along = hitAlong(seen, origin, direction, range);
  return along === undefined ? undefined : { point: add(origin, scale(direction, along)), depth: start + along };
}

/**
 * What a hand at the cursor holds: { point, depth, of }, `of` being 'surface', 'beside' (a surface near the cursor lies that
 * far away) or 'plane' (nothing near). `planeDepth`: how far away that plane lies, the target's unless something else is known.
 */
export function anchorUnder(seen, camera, cursor, size, bounds, planeDepth = camera.distance) {
  const surface = surfaceUnder(seen, camera, cursor, size, bounds);
  if (surface) return { ...surface, of: 'surface' };
  const at = (depth, of) => ({ point: pointUnderCursor(camera, cursor, size, depth), depth, of });
  for (const reach of seen ? reaches : []) {
    const depths = around
      .map(([x, y]) => surfaceUnder(seen, camera, { x: cursor.x + x * reach, y: cursor.y + y * reach }, size, bounds)?.depth)
      .filter((depth) => depth !== undefined);
    if (depths.length > 0) return at(Math.min(...depths), 'beside');
  }
  return at(withinCloud(camera, planeDepth, bounds), 'plane');
}

/** A depth that is not past the cloud: while it lies ahead, no farther than its middle or, close by, its far end. */
function withinCloud(camera, depth, bounds) {
  const farthest = farthestDepth(camera, bounds);
  if (!(farthest > 0)) return depth;
  const middle = depthOf(camera, centerOf(bounds));
  return Math.min(depth, middle > 0 ? Math.max(middle, farthest * 0.5) : farthest * 0.5);
}
