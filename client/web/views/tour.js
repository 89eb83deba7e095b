// A tour's flight from view to view: what is looked at, the direction from which, and how far away it is, each along a cubic through the views that
// never leaves what lies between two of them (Fritsch, Butland: "A Method for Constructing Local Monotone Piecewise Cubic Interpolants",
// 1984). So the camera goes round what it looks at and never through it, and neither loops nor overshoots, however unlike the legs are. It passes
// each view at its time; where the tour pauses it comes to rest there, elsewhere it only changes its speed smoothly. Pure.
// `scancast-client path --project` flies the same way (client/cpp/program/tour).

import { changed } from '../view/camera.js';

const shortWay = (angle) => Math.atan2(Math.sin(angle), Math.cos(angle));

/** [x, y, z of the target, azimuth, elevation, log distance, field of view] of each camera, azimuths going on from one to the next. */
function placesOf(cameras) {
  let azimuth = cameras[0].azimuth;
  return cameras.map((camera) => {
    azimuth += shortWay(camera.azimuth - azimuth);
    return [...camera.target, azimuth, camera.elevation, Math.log(camera.distance), camera.fov];
  });
}

/** At a place between two legs, in legs: their harmonic mean, or none where the way turns back. */
const slope = (before, after) => (before * after > 0 ? (2 * before * after) / (before + after) : 0);

/** The slopes of all coordinates at each place: none where one rests. */
function slopesOf(places, rests, loop) {
  const last = places.length - 1;
  const leg = (i) => places[i + 1].map((value, k) => value - places[i][k]);
  return places.map((place, i) => {
    if (rests || (!loop && (i === 0 || i === last))) return place.map(() => 0);
    const [before, after] = [leg(i === 0 ? last - 1 : i - 1), leg(i === last ? 0 : i)];
    return place.map((_, k) => slope(before[k], after[k]));
  });
}

export class Tour {
  #cameras;
  #places;
  #slopes;
  #seconds;
  #pause;

  /**
   * `cameras`: two or more, as camera.js has them, of one up axis; `seconds` from one to the next, `pause` at each of them but where a tour that
   * loops comes back to the first.
   */
  constructor(cameras, { seconds, pause, loop = false }) {
    this.#cameras = loop ? [...cameras, cameras[0]] : cameras;
    this.#places = placesOf(this.#cameras);
    this.#slopes = slopesOf(this.#places, pause > 0, loop);
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
    const [s2, s3] = [s * s, s * s * s];
    const [x, y, z, azimuth, elevation, far, fov] = this.#places[i].map((from, k) => (
      from * (2 * s3 - 3 * s2 + 1) + this.#places[i + 1][k] * (3 * s2 - 2 * s3) + this.#slopes[i][k] * (s3 - 2 * s2 + s) + this.#slopes[i + 1][k] * (s3 - s2)));
    const { near, far: cutOff, ...camera } = this.#cameras[i];
    return changed({ ...camera, fov }, { target: [x, y, z], azimuth, elevation, distance: Math.exp(far) });
  }
}
