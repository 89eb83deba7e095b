// The scale bar: how long something on the picture is. Without perspective it is as long everywhere; with it, it holds at one depth, which
// is that of what is seen in the picture's middle, and it says so.

import { element } from '../parameter_fields.js';
import { planStrings } from '../strings/plan.js';
import { lengthText, roundBelow } from './lengths.js';

const words = planStrings.scale;
const widest = 132; // CSS pixels

/**
 * Units of the cloud that a CSS pixel is wide, in a picture of that height.
 * @param {import('../../view/pose.js').Pose} pose
 * @param {number} height CSS pixels
 * @param {number} depth at which that is to hold; without perspective it is the same everywhere
 */
export function unitsPerPixel(pose, height, depth) {
  const halfHeight = pose.halfHeight / pose.stretch;
  return (2 * halfHeight * (pose.orthographic ? 1 : depth)) / height;
}

/** { length, pixels, text }: the longest round length that is no wider than `most` pixels. Pure. */
export function scaleBarOf(perPixel, crsUnit, most = widest) {
  const length = roundBelow(perPixel * most);
  return { length, pixels: length / perPixel, text: lengthText(length, crsUnit) };
}

export class ScaleBar {
  #bar = element('i');
  #text = element('span');
  #where = element('small');
  node = element('div', { id: 'scale-bar' }, element('p', {}, this.#text, this.#where), this.#bar);

  constructor() {
    this.node.setAttribute('role', 'img');
  }

  /** `depth`: of what the middle of the picture shows; undefined where it shows nothing. */
  show({ pose, size, depth, crsUnit }) {
    const perPixel = unitsPerPixel(pose, size.height, depth ?? pose.distance);
    this.node.hidden = !(perPixel > 0 && Number.isFinite(perPixel));
    if (this.node.hidden) return;
    const { pixels, text, length } = scaleBarOf(perPixel, crsUnit);
    const where = pose.orthographic ? '' : depth === undefined ? words.target : words.centre;
    this.#bar.style.width = `${pixels.toFixed(2)}px`;
    this.node.dataset.length = String(length);
    const label = words.label(text, where);
    if (this.node.getAttribute('aria-label') === label) return;
    this.node.setAttribute('aria-label', label);
    this.#text.textContent = text;
    this.#where.textContent = where;
  }
}
