// The line that says where the cursor is, in the scan's own coordinates: about there, by the depth of the newest frame; exactly, of a
// point of the scan that was clicked.

import { strings } from '../page/strings.js';
import { exactText, placeText, unitOf } from './units.js';

const words = strings.coordinates;
const heldPx = 8; // as long as the cursor stays there, what was clicked is shown
const longestName = 60;

/** What stands behind coordinates: their unit, and what the system is called. Pure. */
export function systemText(cloud) {
  const name = String(cloud.crsName || (cloud.crsEpsg ? `EPSG:${cloud.crsEpsg}` : ''));
  const [unit, up] = [cloud.crsUnit, cloud.crs?.verticalUnit].map((one) => unitOf(one, undefined).name);
  return [up && up !== unit ? `${unit}, z ${up}` : unit, name && `· ${name.length > longestName ? `${name.slice(0, longestName)}…` : name}`].filter(Boolean).join(' ');
}

/** "x 389,459.27  y 5,819,744.0  z 45.4". Pure. */
export function axesText(point, step) {
  return placeText(point, step).split('  ').map((one, i) => `${'xyz'[i]} ${one}`).join('  ');
}

/** "0.001 m"; without the unit where it is not known. Pure. */
export const stepText = (step, cloud) => [exactText(Number(step.toPrecision(2))), unitOf(cloud.crsUnit, undefined).name].filter(Boolean).join(' ');

export class Coordinates {
  #element;
  #viewer;
  #held; // the cursor at which something exact is shown

  constructor(element, viewer) {
    this.#element = element;
    this.#viewer = viewer;
    viewer.addEventListener('camera', () => this.#put('')); // what was under the cursor is elsewhere now
    viewer.addEventListener('begin', () => this.#put(''));
  }

  #put(text) {
    this.#held = undefined;
    this.#element.hidden = text === '';
    this.#element.textContent = text;
  }

  /** `surface`: what surfaceAt() found under the cursor; undefined for nothing, or no cursor. */
  about(surface, cursor) {
    const { cloud, seen } = this.#viewer;
    if (this.#held && (!cursor || Math.hypot(cursor.x - this.#held.x, cursor.y - this.#held.y) < heldPx)) return;
    if (!surface || !cloud || !seen) {
      this.#put('');
      return;
    }
    // As exact as a cell of the depth is large there.
    const cell = (2 * seen.top * (seen.perspective ? surface.depth : 1)) / seen.depth.height;
    this.#put(words.about([axesText(surface.point, cell), systemText(cloud)].filter(Boolean).join(' ')));
    this.#element.dataset.exact = 'false';
  }

  /** A picked point; `id`: of the cloud that it is of, where several are shown together. */
  exact(point, step, cursor, id = undefined) {
    const { cloud, catalog } = this.#viewer;
    const of = id && id !== cloud.id && catalog.clouds.find((one) => one.id === id);
    const text = words.exact([axesText(point, step), systemText(cloud)].filter(Boolean).join(' '), stepText(step, cloud));
    this.#put(of ? words.of(text, of.title || of.id) : text);
    this.#element.dataset.exact = 'true';
    this.#held = cursor;
  }
}
