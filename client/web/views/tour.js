// A tour's flight from view to view: a centripetal Catmull-Rom spline through what is looked at, the direction from which, and how far
// away it is, so that the camera never passes through what it looks at, and neither loops nor overshoots between views that are near to
// each other. It passes each view at its time; where the tour pauses it comes to rest there, elsewhere it only changes its speed
// smoothly. Pure. `scancast-client path --project` flies the same way (client/cpp/program/tour).

import { changed, eyeOf } from '../view/camera.js';
import { length, subtract } from '../view/vectors.js';

const shortWay = (angle) => Math.atan2(Math.sin(angle), Math.cos(angle));

/** [x, y, z of the target, azimuth, elevation, log distance] of each camera, azimuths going on from one to the next. */
function placesOf(cameras) {
  let azimuth = cameras[0].azimuth;
  return cameras.map((camera) => {
    azimuth += shortWay(camera.azimuth - azimuth);
    return [...camera.target, azimuth, camera.elevation, Math.log(camera.distance)];
  });
}

/** The spline's parameter at each camera: it grows by the root of how far eye and target go. */
function knotsOf(cameras) {
  const ways = cameras.slice(1).map((camera, i) => length(subtract(eyeOf(camera), eyeOf(cameras[i]))) + length(subtract(camera.target, cameras[i].target)));
  const least = 1e-6 * Math.max(...ways, 1e-9); // where two views are the same
  return ways.reduce((knots, way) => [...knots, knots.at(-1) + Math.sqrt(Math.max(way, least))], [0]);
}

const mixed = (a, b, t) => a.map((value, i) => value + (b[i] - value) * t);

/** The spline between places i and i + 1 at parameter u, by the pyramid of Barry and Goldman; beyond the ends it goes on straight. */
function splineAt(places, knots, i, u) {
  const [u1, u2] = [knots[i], knots[i + 1]];
  const [p1, p2] = [places[i], places[i + 1]];
  const [u0, p0] = i > 0 ? [knots[i - 1], places[i - 1]] : [u1 - (u2 - u1), mixed(p2, p1, 2)];
  const [u3, p3] = i + 2 < places.length ? [knots[i + 2], places[i + 2]] : [u2 + (u2 - u1), mixed(p1, p2, 2)];
  const share = (from, to) => (u - from) / (to - from);
  const [a, b, c] = [mixed(p0, p1, share(u0, u1)), mixed(p1, p2, share(u1, u2)), mixed(p2, p3, share(u2, u3))];
  return mixed(mixed(a, b, share(u0, u2)), mixed(b, c, share(u1, u3)), share(u1, u2));
}

/** How fast the parameter grows at each camera, for legs of one second: not at all where one rests, else as the legs beside agree (Fritsch and Butland). */
function speedsOf(knots, rests) {
  return knots.map((knot, i) => {
    if (rests || i === 0 || i === knots.length - 1) return 0;
    const [before, after] = [knot - knots[i - 1], knots[i + 1] - knot];
    return (2 * before * after) / (before + after);
  });
}

export class Tour {
  #cameras;
  #places;
  #knots;
  #speeds;
  #seconds;
  #pause;

  /**
   * `cameras`: two or more, as camera.js has them, of one up axis; `seconds` from one to the next, `pause` at each of them but where a tour that
   * loops comes back to the first.
   */
  constructor(cameras, { seconds, pause, loop = false }) {
    this.#cameras = loop ? [...cameras, cameras[0]] : cameras;
    this.#places = placesOf(this.#cameras);
    this.#knots = knotsOf(this.#cameras);
    this.#speeds = speedsOf(this.#knots, pause > 0);
    this.#seconds = seconds;
    this.#pause = pause;
  }

  get count() { return this.#cameras.length; }

  /** Until it has paused at the last view; of one that loops, until it is back at the first. */
  get length() { return (this.count - 1) * (this.#seconds + this.#pause) + this.#pause; }

  /** When it arrives at view number `index`. */
  arrivalAt(index) { return index * (this.#seconds + this.#pause); }

  /**
   * { camera, index, rests } that many seconds after its beginning, which is at rest at the first view: `index` of the view that it was at
   * last, whose style holds; whether it `rests` there. The camera of a view itself while it does.
   */
  at(time) {
    const leg = this.#seconds + this.#pause;
    const index = Math.min(this.count - 1, Math.max(0, Math.floor(time / leg + 1e-9)));
    const within = time - index * leg;
    if (within <= this.#pause || index === this.count - 1) return { camera: this.#cameras[index], index, rests: true };
    const s = Math.min(1, (within - this.#pause) / this.#seconds);
    return { camera: this.#between(index, s), index, rests: false };
  }

  #between(i, s) {
    const [from, to] = [this.#knots[i], this.#knots[i + 1]];
    const [s2, s3] = [s * s, s * s * s];
    // A cubic whose slopes are positive and no more than three times the mean one: time never goes back.
    const u = from * (2 * s3 - 3 * s2 + 1) + to * (3 * s2 - 2 * s3) + this.#speeds[i] * (s3 - 2 * s2 + s) + this.#speeds[i + 1] * (s3 - s2);
    const [x, y, z, azimuth, elevation, far] = splineAt(this.#places, this.#knots, i, u);
    const { near, far: cutOff, ...camera } = this.#cameras[i];
    const share = (u - from) / (to - from);
    return changed({ ...camera, fov: camera.fov + (this.#cameras[i + 1].fov - camera.fov) * share }, { target: [x, y, z], azimuth, elevation, distance: Math.exp(far) });
  }
}
