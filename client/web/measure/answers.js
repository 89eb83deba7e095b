// What only the server can measure, because it takes the scan's own points and not only those that were picked: volumes, and shapes
// that are fitted. It is asked once for each measure, and again where that has changed.

import { kinds } from './values.js';

/** What of a view decides which points count. */
const counting = ['classes', 'clip', 'clips', 'outliers', 'mirrors', 'behindMirrors'];

/** The question, as `POST /clouds/{id}/measure` has it. Pure. */
export function questionOf({ kind, points, option }, view) {
  const which = Object.fromEntries(counting.filter((word) => view?.[word] !== undefined && view[word] !== null).map((word) => [word, view[word]]));
  const how = kind === 'volume' ? { base: option ?? 'lowest' } : { within: option };
  return { measure: kind, points, ...how, ...(Object.keys(which).length > 0 ? { view: which } : {}) };
}

export class Answers {
  #viewer;
  #measures;
  #asked = new Set(); // of measures, which are never changed

  constructor(viewer, measures) {
    this.#viewer = viewer;
    this.#measures = measures;
    measures.addEventListener('change', () => this.#askAll());
  }

  #askAll() {
    for (const one of this.#measures.list) if (kinds[one.kind].asks && one.visible && !one.answer && !one.trouble && !this.#asked.has(one.points)) this.#ask(one);
  }

  async #ask(measure) {
    const { cloud, view, server } = this.#viewer;
    this.#asked.add(measure.points);
    let facts;
    try {
      facts = { answer: await server.measure(cloud.id, questionOf(measure, view)) };
    } catch (/** @type {any} */ error) {
      facts = { trouble: error.title ? error.message : '' };
    }
    this.#asked.delete(measure.points);
    const now = this.#measures.find(measure.id);
    // It may have another name by now; with other points it is another question, which has been asked by then.
    if (now?.points === measure.points && now.option === measure.option) this.#measures.tell(now, facts);
    else this.#askAll();
  }
}
