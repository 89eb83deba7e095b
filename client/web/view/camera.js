// The camera: a point that is looked at, the direction from which, and the distance. Pure functions from one camera
// to the next; none of them changes its argument, and none of them ever returns a camera with NaN in it.
//
//   { target: [x, y, z], azimuth, elevation, distance, fov, projection, upAxis }
//
// Right-handed, the cloud's own coordinates. Z is up, or Y where `upAxis` is 'y', as it is in scans of things that
// were modelled rather than surveyed, or -Y where it is '-y', as depth cameras count. `azimuth` and `elevation` are the direction from the target to the
// eye, in radians; elevation stays within ±90°, which is why the picture never turns over at the pole. `fov` is the
// full vertical field of view in degrees. An orthographic camera sees the same height at its target as a perspective
// one, so that switching between the two keeps the size of what is looked at.
//
// What keeps hold of a point while it moves stands in moves.js. Cursor positions are CSS pixels from the picture's top left corner; `size` is the picture's { width, height } in them.

import { add, areNumbers, dot, length, mix, scale, subtract } from './vectors.js';

const quarterTurn = Math.PI / 2;
const leastDistance = 1e-6;
const greatestDistance = 1e11;
const poleZone = 1e-3; // radians; nearer to the pole than this, Z is no usable up direction
const defaultFov = 60;

const clamp = (value, low, high) => Math.min(high, Math.max(low, value));
const radians = (degrees) => (degrees * Math.PI) / 180;
const halfTangent = (camera) => Math.tan(radians(camera.fov) / 2);

/** From a frame in which Z is up to the cloud's, and back. */
export const toCloud = (v, upAxis) => (upAxis === 'y' ? [v[0], v[2], -v[1]] : upAxis === '-y' ? [v[0], -v[2], v[1]] : v);
const toUpright = (v, upAxis) => (upAxis === 'y' ? [v[0], -v[2], v[1]] : upAxis === '-y' ? [v[0], v[2], -v[1]] : v);

const isSound = (camera) =>
  areNumbers(camera.target) &&
  camera.target.every((value) => Math.abs(value) <= 1e12) &&
  [camera.azimuth, camera.elevation, camera.distance, camera.fov].every(Number.isFinite);

/** `camera` with some values changed, kept within its limits; `camera` itself when the change makes no sense. */
export function changed(camera, changes) {
  const next = { ...camera, ...changes };
  if (!isSound(next)) return camera;
  next.azimuth = Math.atan2(Math.sin(next.azimuth), Math.cos(next.azimuth));
  next.elevation = clamp(next.elevation, -quarterTurn, quarterTurn);
  next.distance = clamp(next.distance, leastDistance, greatestDistance);
  return next;
}

/** Unit vectors of the picture: to the right, up, and back to the viewer. */
export function axes(camera) {
  const sinA = Math.sin(camera.azimuth), cosA = Math.cos(camera.azimuth);
  const sinE = Math.sin(camera.elevation), cosE = Math.cos(camera.elevation);
  return {
    right: toCloud([-sinA, cosA, 0], camera.upAxis),
    up: toCloud([-sinE * cosA, -sinE * sinA, cosE], camera.upAxis),
    back: toCloud([cosE * cosA, cosE * sinA, sinE], camera.upAxis),
  };
}

/** `camera` turned about its target until its eye lies in that direction, of any length. */
export function facing(camera, direction) {
  const [x, y, z] = toUpright(direction, camera.upAxis);
  const flat = Math.hypot(x, y);
  // Straight up or down says nothing about the azimuth.
  const azimuth = flat > poleZone * Math.abs(z) ? Math.atan2(y, x) : camera.azimuth;
  return changed(camera, { azimuth, elevation: Math.atan2(z, flat) });
}

export const eyeOf = (camera) => add(camera.target, scale(axes(camera).back, camera.distance));

/** Height of what is seen at the target, in cloud units. */
export const heightAtTarget = (camera) => 2 * camera.distance * halfTangent(camera);

/** How far a point lies ahead of the eye, along the view direction; negative behind it. */
export const depthOf = (camera, point) => camera.distance - dot(subtract(point, camera.target), axes(camera).back);

/** The point under the cursor at that depth; without one, on the plane through the target that faces the viewer. */
export function pointUnderCursor(camera, cursor, size, depth = camera.distance) {
  const { right, up, back } = axes(camera);
  const height = camera.projection === 'orthographic' ? heightAtTarget(camera) : 2 * depth * halfTangent(camera);
  const unitsPerPixel = height / size.height;
  const sideways = add(
    scale(right, (cursor.x - size.width / 2) * unitsPerPixel),
    scale(up, (size.height / 2 - cursor.y) * unitsPerPixel),
  );
  return add(camera.target, add(sideways, scale(back, camera.distance - depth)));
}

/** Where a point appears: CSS pixels and depth; undefined for points behind the eye. */
export function project(camera, point, size) {
  const { right, up, back } = axes(camera);
  const offset = subtract(point, camera.target);
  const depth = camera.distance - dot(offset, back);
  const perspective = camera.projection !== 'orthographic';
  if (perspective && depth <= 0) return undefined;
  const height = perspective ? 2 * depth * halfTangent(camera) : heightAtTarget(camera);
  const pixelsPerUnit = size.height / height;
  return {
    x: size.width / 2 + dot(offset, right) * pixelsPerUnit,
    y: size.height / 2 - dot(offset, up) * pixelsPerUnit,
    depth,
  };
}

/** Turns around the target. Dragging across the picture's height is half a turn. */
export function orbit(camera, dx, dy, size) {
  const turn = Math.PI / size.height;
  return changed(camera, { azimuth: camera.azimuth - dx * turn, elevation: camera.elevation + dy * turn });
}

/** A unit vector against gravity. */
export const upwards = (camera) => toCloud([0, 0, 1], camera.upAxis);

/** Turns around the eye: what is under the cursor follows it. */
export function look(camera, dx, dy, size) {
  const turn = radians(camera.fov) / size.height;
  const eye = eyeOf(camera);
  const turned = changed(camera, { azimuth: camera.azimuth + dx * turn, elevation: camera.elevation - dy * turn });
  return changed(turned, { target: subtract(eye, scale(axes(turned).back, turned.distance)) });
}

/** Moves eye and target together: `steps` to the right, up (against gravity) and ahead, in cloud units. */
export function move(camera, steps) {
  const { right, back } = axes(camera);
  const shift = add(add(scale(right, steps.right ?? 0), scale(upwards(camera), steps.up ?? 0)), scale(back, -(steps.ahead ?? 0)));
  return changed(camera, { target: add(camera.target, shift) });
}

export const corners = (bounds) =>
  [0, 1, 2, 3, 4, 5, 6, 7].map((i) => [
    bounds[i & 1 ? 'max' : 'min'][0],
    bounds[i & 2 ? 'max' : 'min'][1],
    bounds[i & 4 ? 'max' : 'min'][2],
  ]);

export const centerOf = (bounds) => mix(bounds.min, bounds.max, 0.5);
export const radiusOf = (bounds) => length(subtract(bounds.max, bounds.min)) / 2;

/**
 * Shows all of `bounds` from the direction that the camera has, as large as it fits, with a little air around it. `free`
 * is the part in the middle of the picture that nothing lies over.
 */
export function fit(camera, bounds, size, free = size, margin = 1.06) {
  const { right, up, back } = axes(camera);
  const target = centerOf(bounds);
  const tanOfPixels = halfTangent(camera) / size.height;
  const tanX = tanOfPixels * free.width;
  const tanY = tanOfPixels * free.height;
  let distance = leastDistance;
  for (const corner of corners(bounds)) {
    const offset = subtract(corner, target);
    const sideways = Math.max(Math.abs(dot(offset, right)) / tanX, Math.abs(dot(offset, up)) / tanY) * margin;
    const ahead = camera.projection === 'orthographic' ? 0 : dot(offset, back);
    distance = Math.max(distance, sideways + ahead);
  }
  return changed(camera, { target, distance });
}

/** The same direction and target from `times` as far. */
export const farther = (camera, times) => changed(camera, { distance: camera.distance * times });

/** A camera fitted to a picture of 16:9, from so much farther away that all of it is seen in the part `free` of `size`. */
export function fittedInto(camera, size, free) {
  const share = Math.min(free.height, (free.width * 9) / 16) / size.height;
  return changed(camera, { distance: camera.distance / share });
}

const directions = {
  top: { azimuth: -quarterTurn, elevation: quarterTurn },
  bottom: { azimuth: -quarterTurn, elevation: -quarterTurn },
  front: { azimuth: -quarterTurn, elevation: 0 },
  back: { azimuth: quarterTurn, elevation: 0 },
  side: { azimuth: 0, elevation: 0 },
  left: { azimuth: Math.PI, elevation: 0 },
};

/**
 * The whole cloud from "top" or "bottom" (north is up), "front" (from the south), "back", "side" (from the east) or "left"
 * (from the west).
 */
export const standardView = (camera, name, bounds, size, free = size) =>
  fit(changed(camera, directions[name] ?? {}), bounds, size, free);

/** A camera on the way from one to another, t in 0–1; turns by the shorter way. */
export function between(from, to, t) {
  const turn = to.azimuth - from.azimuth;
  const shortTurn = Math.atan2(Math.sin(turn), Math.cos(turn));
  return changed(to, {
    target: mix(from.target, to.target, t),
    azimuth: from.azimuth + shortTurn * t,
    elevation: from.elevation + (to.elevation - from.elevation) * t,
    distance: from.distance * (to.distance / from.distance) ** t,
  });
}

/** How far from the target pictures are drawn: an orthographic eye stands outside `bounds`, so that nothing is cut off. */
export function drawnFrom(camera, bounds) {
  if (camera.projection !== 'orthographic' || !bounds) return camera.distance;
  return Math.max(camera.distance, length(subtract(camera.target, centerOf(bounds))) + 1.1 * radiusOf(bounds));
}

/** The camera as the protocol spells it, its eye where drawnFrom() says. */
export function toProtocol(camera, bounds) {
  const { up, back } = axes(camera);
  const orthographic = camera.projection === 'orthographic';
  const distance = drawnFrom(camera, bounds);
  const atPole = quarterTurn - Math.abs(camera.elevation) < poleZone;
  const common = {
    eye: add(camera.target, scale(back, distance)),
    target: [...camera.target],
    up: atPole ? up : toCloud([0, 0, 1], camera.upAxis),
  };
  return orthographic
    ? { type: 'orthographic', ...common, viewHeight: heightAtTarget(camera) }
    : { type: 'perspective', ...common, fov: camera.fov };
}

/** Reads what toProtocol() writes, and every other upright look-at camera; undefined for anything else. */
export function fromProtocol(wire, upAxis = 'z') {
  if (!wire || !areNumbers(wire.eye) || !areNumbers(wire.target)) return undefined;
  const offset = toUpright(subtract(wire.eye, wire.target), upAxis);
  const distance = length(offset);
  if (!(distance > 0)) return undefined;
  const elevation = Math.asin(clamp(offset[2] / distance, -1, 1));
  const atPole = quarterTurn - Math.abs(elevation) < poleZone;
  const up = areNumbers(wire.up) ? toUpright(wire.up, upAxis) : [0, 0, 1];
  // At the pole the eye says nothing about the azimuth, but the picture's up direction does.
  const azimuth =
    atPole && Math.hypot(up[0], up[1]) > 1e-9
      ? Math.atan2(-up[1] * Math.sign(elevation), -up[0] * Math.sign(elevation))
      : Math.atan2(offset[1], offset[0]);
  const orthographic = wire.type === 'orthographic';
  const fov = !orthographic && wire.fov > 1 && wire.fov < 170 ? wire.fov : defaultFov;
  const camera = {
    target: [...wire.target],
    azimuth,
    elevation,
    distance: orthographic && wire.viewHeight > 0 ? wire.viewHeight / (2 * Math.tan(radians(fov) / 2)) : distance,
    fov,
    projection: orthographic ? 'orthographic' : 'perspective',
    upAxis,
  };
  return isSound(camera) ? changed(camera, {}) : undefined;
}
