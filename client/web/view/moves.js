// Moves of the camera that hold a point: whatever they do, it stays where it is in the picture, or goes where the cursor
// goes. Pure functions from one camera to the next, like those of camera.js, in which cursors and sizes are explained.
//
// Where the point comes from - the surface under the cursor - is anchor.js's business.

import { axes, changed, depthOf, eyeOf, facing, pointUnderCursor } from './camera.js';
import { add, dot, length, scale, subtract } from './vectors.js';

const isOrthographic = (camera) => camera.projection === 'orthographic';

/** `turned` moved without turning, so that `point` lies before its eye as it lies before that of `camera`. */
function holding(camera, turned, point) {
  const before = axes(camera);
  const after = axes(turned);
  const offset = subtract(point, eyeOf(camera));
  let eye = point;
  for (const axis of ['right', 'up', 'back']) eye = subtract(eye, scale(after[axis], dot(offset, before[axis])));
  return changed(turned, { target: subtract(eye, scale(after.back, turned.distance)) });
}

/** The same picture; from here on the point's depth is the target's, which is what later moves go by. */
export function focusOn(camera, point) {
  const depth = depthOf(camera, point);
  const { back } = axes(camera);
  // Without perspective the distance is the scale; but the target may lie anywhere along the view direction.
  if (isOrthographic(camera)) return changed(camera, { target: add(camera.target, scale(back, camera.distance - depth)) });
  if (!(depth > 0)) return camera;
  return changed(camera, { distance: depth, target: subtract(eyeOf(camera), scale(back, depth)) });
}

/** Turns about the point by angles in radians; at the poles it only stops, as every camera does. */
export const turnAbout = (camera, point, azimuth, elevation = 0) =>
  holding(camera, changed(camera, { azimuth: camera.azimuth + azimuth, elevation: camera.elevation + elevation }), point);

/** Turns about the point by a drag; across the picture's height is half a turn. */
export function orbitAbout(camera, point, dx, dy, size) {
  const turn = Math.PI / size.height;
  return turnAbout(camera, point, -dx * turn, dy * turn);
}

/** Moves sideways until the point is under the cursor, at the depth that it has. */
export function dragTo(camera, point, cursor, size) {
  const there = pointUnderCursor(camera, cursor, size, depthOf(camera, point));
  return changed(camera, { target: add(camera.target, subtract(point, there)) });
}

/**
 * Comes nearer to the point by `factor` (0.5 = half the way to it): never nearer than `least`, never farther away than `most`,
 * which stop it and never throw it back. Both are distances of the eye; without perspective, of one that would see as much.
 */
export function zoomTo(camera, point, factor, { least = 0, most = Infinity } = {}) {
  if (!(factor > 0) || !Number.isFinite(factor)) return camera;
  const eye = eyeOf(camera);
  const now = isOrthographic(camera) ? camera.distance : length(subtract(eye, point));
  if (!(now > 0)) return camera;
  const wanted = factor < 1 ? Math.max(now * factor, Math.min(least, now)) : Math.min(now * factor, Math.max(most, now));
  const share = wanted / now;
  const distance = camera.distance * share;
  // The eye runs along its ray to the point, so the point's place in the picture cannot change.
  const nearer = add(point, scale(subtract(eye, point), share));
  return changed(camera, { distance, target: subtract(nearer, scale(axes(camera).back, distance)) });
}

/** From `distance` away the point in the middle, from the direction that the camera has. */
export const centerOn = (camera, point, distance) => changed(camera, { target: [...point], distance });

/** The same, along the line on which the eye sees the point now: surely a free one, but another direction. */
export function centerAhead(camera, point, distance) {
  const ray = subtract(eyeOf(camera), point);
  return length(ray) > 0 ? centerOn(facing(camera, ray), point, distance) : camera;
}
