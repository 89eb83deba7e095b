// Why nobody falls through the ground: what pictures have seen of the surface stops who walks into it, and who would sink
// beneath it. Pure; the pictures come from seen.js, the newest first.
//
// What no picture has seen stops nobody, but for two guesses: the ground goes on below one's feet as it is seen a little
// farther ahead, and there is none below the cloud.

import { axes, corners, depthOf, centerOf, eyeOf, move, radiusOf, upwards } from './camera.js';
import { coveredShare, hitAlong } from './seen.js';
import { add, dot, length, scale, subtract } from './vectors.js';

const flattest = 4; // sideways to downwards, of the ray to ground that one still takes for what is below one's feet
const steepest = 0.4; // rise to run, of what may be ground
const emptyFrom = 0.3; // share of a picture that is covered: from here on walking ahead becomes slower
const emptyTo = 0.15; // and here it ends

/** The first surface that a ray of unit length meets within `range`, as far as any picture knows. */
function firstHit(pictures, origin, direction, range) {
  let first;
  for (const seen of pictures) {
    const hit = hitAlong(seen, origin, direction, Math.min(range, first ?? range));
    if (hit !== undefined) first = hit;
  }
  return first;
}

const summaries = new WeakMap();

/** What a picture says in a few numbers: { covered, near, floor }, found when somebody asks for the first time. */
export function summaryOf(seen) {
  if (!summaries.has(seen)) summaries.set(seen, summed(seen));
  return summaries.get(seen);
}

/** Every other cell will do. */
function summed(seen) {
  const { inverse, width, height } = seen.depth;
  const dropTo = fallOf(seen);
  const values = [];
  const floors = [];
  for (let row = 0; row < height; row += 2) {
    for (let column = 0; column < width; column += 2) {
      const value = inverse[row * width + column];
      if (!(value > 0)) continue;
      values.push(value);
      const { drop, aside } = dropTo(column, row, value);
      if (!(drop > 0) || aside > flattest * drop || row + 2 >= height) continue;
      // Level is what hardly rises from one cell to the next, as a wall close by does.
      const next = dropTo(column, row + 2, inverse[(row + 2) * width + column]);
      if (Math.abs(next.drop - drop) <= steepest * Math.abs(next.aside - aside)) floors.push(drop);
    }
  }
  values.sort((a, b) => b - a);
  floors.sort((a, b) => a - b);
  return {
    covered: coveredShare(seen),
    near: values.length > 0 ? 1 / values[Math.floor(values.length / 10)] : undefined, // a tenth of what is there is nearer
    // Height of the ground below this eye, of which a few of many stones may stick out.
    floor: floors.length > 8 ? dot(seen.eye, upwards(seen.camera)) - floors[Math.floor(floors.length / 4)] : undefined,
  };
}

/** How far below the eye, and how far from the vertical through it, what a cell shows lies. */
function fallOf(seen) {
  const { width, height } = seen.depth;
  const up = upwards(seen.camera);
  const [right, upright, ahead] = [dot(seen.right, up) * seen.side, dot(seen.up, up) * seen.top, -dot(seen.back, up)];
  return (column, row, value) => {
    const [x, y] = [((column + 0.5) / width) * 2 - 1, 1 - ((row + 0.5) / height) * 2];
    const spread = seen.perspective ? 1 : value; // sideways, of what lies one ahead
    const down = -(ahead + (x * right + y * upright) * spread);
    const slant = Math.hypot(1, x * seen.side * spread, y * seen.top * spread);
    return { drop: down / value, aside: Math.sqrt(Math.max(0, slant * slant - down * down)) / value };
  };
}

/** How high the ground lies below `point`, along `up`; undefined where nothing is known of it. */
function groundBelow(pictures, point, up, range) {
  const hit = firstHit(pictures, point, scale(up, -1), range);
  const height = dot(point, up);
  if (hit !== undefined) return height - hit;
  const [newest] = pictures;
  const floor = newest && summaryOf(newest).floor;
  if (floor === undefined) return undefined;
  const aside = subtract(point, newest.eye);
  const sideways = length(subtract(aside, scale(up, dot(aside, up))));
  return sideways <= flattest * Math.abs(dot(newest.eye, up) - floor) ? floor : undefined;
}

/** The height below which there surely is nothing, of a cloud that stands on a ground. */
const deepestOf = ({ bounds, hasGround }, up) => (hasGround ? Math.min(...corners(bounds).map((corner) => dot(corner, up))) : -Infinity);

/** Who does not walk may come nearer to the ground than a walker's eye is: a part of the least distance to a surface. */
const lowest = 0.25;

/** By how much the eye has to be lifted, on its way from one camera to another, to stay so much above the ground. */
export function liftOf(pictures, before, after, limits, clearance = lowest * limits.least) {
  const up = upwards(after);
  const [from, to] = [dot(eyeOf(before), up), dot(eyeOf(after), up)];
  const drop = from - to;
  if (!(drop > 0) || after.projection === 'orthographic') return 0;
  const above = add(eyeOf(after), scale(up, drop));
  const ground = groundBelow(pictures, above, up, drop + clearance) ?? deepestOf(limits, up);
  // Who is nearer to the ground already stays where he is; nobody is thrown up.
  return ground <= from ? Math.max(0, Math.min(ground + clearance, from) - to) : 0;
}

/** The camera after a move that must not lead through the ground: lifted by as much as it takes. */
export function lifted(pictures, before, after, limits, clearance = undefined) {
  const lift = liftOf(pictures, before, after, limits, clearance);
  return lift > 0 ? move(after, { up: lift }) : after;
}

/** How fast it is sensible to be, in cloud units a step: by what is ahead, and slower where something is close by. */
export function reachAhead(pictures, camera, { least, bounds }) {
  const radius = radiusOf(bounds);
  const [newest] = pictures;
  const ahead = scale(camera.projection === 'orthographic' ? [0, 0, 0] : subtract(camera.target, eyeOf(camera)), 1 / camera.distance);
  const hit = newest && length(ahead) > 0.5 ? firstHit([newest], eyeOf(camera), ahead, 40 * radius) : undefined;
  const near = newest && summaryOf(newest).near;
  const reach = Math.min(hit ?? near ?? camera.distance, near ? 3 * near : Infinity);
  return Math.min(Math.max(reach, 2 * least), 2 * radius);
}

/** From 1 at `full` to 0 at `none`. */
const fading = (value, full, none) => Math.min(1, Math.max(0, (value - none) / (full - none)));

/** How much of a way ahead leads on into a picture with something in it: 1 all of it, 0 none. */
export function worthWalking(pictures, camera, limits) {
  const { bounds } = limits;
  const [newest] = pictures;
  if (!newest) return depthOf(camera, centerOf(bounds)) > -0.5 * radiusOf(bounds) ? 1 : 0;
  // From far away the cloud is small, and that is where one is going.
  const center = subtract(centerOf(bounds), eyeOf(camera));
  const { right, up, back } = axes(camera);
  const depth = -dot(center, back);
  const spread = newest.perspective ? depth : 1;
  const isInSight = depth > 0 && Math.abs(dot(center, right)) <= newest.side * spread && Math.abs(dot(center, up)) <= newest.top * spread;
  if (isInSight && length(center) > radiusOf(bounds)) return 1;
  return fading(coveredFrom(newest, camera), emptyFrom, emptyTo);
}

/**
 * Which share of the picture from `camera` will be covered by what an earlier one shows: the next one may be long in coming.
 * Every fourth cell of it is looked at, as large as it will be.
 */
export function coveredFrom(seen, camera) {
  const { inverse, width, height } = seen.depth;
  const now = axes(camera);
  const shift = subtract(seen.eye, eyeOf(camera));
  // Pictures may have a margin, of which nothing is to be seen.
  const margin = seen.top / (Math.tan((camera.fov * Math.PI) / 360) * (seen.perspective ? 1 : camera.distance));
  const turned = ['right', 'up', 'back'].map((axis) => ['right', 'up', 'back'].map((other) => dot(now[axis], seen[other])));
  const [x0, y0, z0] = [dot(now.right, shift), dot(now.up, shift), -dot(now.back, shift)];
  let covered = 0, all = 0;
  for (let row = 2; row < height; row += 4) {
    for (let column = 2; column < width; column += 4) {
      ++all;
      const value = inverse[row * width + column];
      if (!(value > 0)) continue;
      const depth = 1 / value;
      const spread = seen.perspective ? depth : 1;
      const x = (((column + 0.5) / width) * 2 - 1) * seen.side * spread;
      const y = (1 - ((row + 0.5) / height) * 2) * seen.top * spread;
      const at = turned.map(([right, up, back]) => right * x + up * y - back * depth);
      const ahead = z0 - at[2];
      const w = seen.perspective ? ahead : 1;
      if (ahead > 0 && margin * Math.abs(x0 + at[0]) <= seen.side * w && margin * Math.abs(y0 + at[1]) <= seen.top * w) {
        covered += (margin * (seen.perspective ? depth / ahead : 1)) ** 2;
      }
    }
  }
  return Math.min(1, covered / all);
}

/**
 * Walks by `steps` of move(), but stops `least` before what is in the way, slides along the ground, and does not leave
 * the cloud for nothing.
 */
export function walk(pictures, camera, steps, limits) {
  const worth = (from) => worthWalking(pictures, from, limits);
  const ahead = steps.ahead > 0 ? steps.ahead * Math.min(worth(camera), worth(move(camera, steps))) : (steps.ahead ?? 0);
  const wanted = move(camera, { ...steps, ahead });
  const free = stopped(pictures, camera, wanted, limits);
  const up = upwards(camera);
  const next = lifted(pictures, camera, free, limits, limits.least);
  // Where the ground is in the way, one goes on along it.
  const shift = subtract(wanted.target, camera.target);
  const rise = dot(shift, up);
  if (rise >= 0 || length(subtract(next.target, camera.target)) > 0.2 * length(shift)) return next;
  const level = move(wanted, { up: -rise });
  return lifted(pictures, camera, stopped(pictures, camera, level, limits), limits, limits.least);
}

/** Of the way between two cameras the part that ends before the surface, each step half of what is left. */
function stopped(pictures, camera, wanted, { least }) {
  const shift = subtract(wanted.target, camera.target);
  const way = length(shift);
  if (!(way > 0)) return camera;
  const direction = scale(shift, 1 / way);
  const hit = firstHit(pictures, eyeOf(camera), direction, 2 * way + 2 * least);
  if (hit === undefined) return wanted;
  const allowed = Math.max(0, hit - least) / 2;
  return allowed >= way ? wanted : { ...camera, target: add(camera.target, scale(direction, allowed)) };
}
