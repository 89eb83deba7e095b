// A profile's line over the picture, with its corridor, as measures are drawn (measure/marks.js); and the place that the panel's cross is at.

import { Marks } from '../measure/marks.js';
import { Places } from '../measure/places.js';
import { svgIn } from '../page/plan/svg.js';
import { outlineOf } from './line.js';

const id = 1; // there is one line

export class LineMarks {
  root;
  #viewer;
  #marks;
  #spot;
  #at;

  constructor(viewer) {
    this.#viewer = viewer;
    this.root = Object.assign(document.createElement('div'), { id: 'profile-marks', className: 'over marks' });
    this.root.setAttribute('aria-hidden', 'true');
    document.getElementById('marks').after(this.root);
    this.#marks = new Marks(this.root, viewer);
    this.#spot = svgIn(this.root.querySelector('svg'), 'circle', 'over-all');
    viewer.addEventListener('shown', () => this.#place());
    this.spot(undefined);
  }

  /** `points`: of the line, in space; `pending`: which of them are not picked yet; `text`: its length. */
  show({ points, step = 0.005, width, text, drawn = false, pending = [] }) {
    if (points.length === 0) {
      this.#marks.show([]);
      return;
    }
    const figure = { lines: [points], helpers: outlineOf(points, width), label: points.at(-1), legs: [] };
    const measure = { id, kind: 'horizontal', up: 'z', visible: true, points, step };
    this.#marks.show([{ measure, look: { key: '', selected: !drawn, drawn, pending, text, leg: () => '', figure } }]);
  }

  /** Where the hand would take hold of the surface. */
  point(at) { this.#marks.point(at); }

  /** A place of the profile, in the scan's coordinates; undefined for none. */
  spot(at) {
    this.#at = at;
    this.#place();
  }

  #place() {
    const { shownPose, cssSize } = this.#viewer;
    const on = this.#at && shownPose ? new Places(shownPose, cssSize).of(this.#at) : undefined;
    this.#spot.style.display = on ? '' : 'none';
    if (on) this.#spot.setAttribute('transform', `translate(${on.x.toFixed(1)} ${on.y.toFixed(1)})`);
  }
}
