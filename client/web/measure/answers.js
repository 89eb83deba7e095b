// What only the server can measure, because it takes the scan's own points and not only those that were picked: volumes, and shapes
// that are fitted. It is asked once for each measure, and again where that has changed; one question at a time, as a link may hold hundreds.

import { isAlone } from '../page/members.js';
import { measure as words } from '../page/strings/measure.js';
import { fits } from './fits.js';
import { kinds } from './values.js';

/** What of a view decides which points count. */
const counting = ['classes', 'clip', 'clips', 'filter', 'outliers', 'mirrors', 'behindMirrors'];

/** The question, as `POST /clouds/{id}/measure` has it. Pure. */
export function questionOf({ kind, points, option }, view) {
  const which = Object.fromEntries(counting.filter((word) => view?.[word] !== undefined && view[word] !== null).map((word) => [word, view[word]]));
  const how = kind === 'volume' ? { base: option ?? 'lowest' } : { within: option };
  return { measure: fits[kind]?.measure ?? kind, points, ...how, ...(Object.keys(which).length > 0 ? { view: which } : {}) };
}

export class Answers {
  #viewer;
  #measures;
  #isAsking = false;

  constructor(viewer, measures) {
    this.#viewer = viewer;
    this.#measures = measures;
    measures.addEventListener('change', () => this.#askAll());
  }

  /** A measure of which the server has said nothing yet, be it that it failed: an empty trouble is one, too. */
  get #next() {
    return this.#measures.list.find((one) => kinds[one.kind].asks && one.visible && !one.answer && one.trouble === undefined);
  }

  async #askAll() {
    if (this.#isAsking) return;
    this.#isAsking = true;
    for (let one = this.#next; one; one = this.#next) await this.#ask(one);
    this.#isAsking = false;
  }

  async #ask(measure) {
    const { cloud, view, server } = this.#viewer;
    let facts;
    try {
      if (!isAlone(view)) throw Object.assign(new Error(words.notAlone), { title: words.notAlone });
      const answer = await server.measure(cloud.id, questionOf(measure, view));
      facts = answer ? { answer } : { trouble: '' };
    } catch (/** @type {any} */ error) {
      facts = { trouble: error.title ? error.message : '' };
    }
    const now = this.#measures.find(measure.id);
    // It may have another name by now; with other points it is another question, which comes next.
    if (now?.points === measure.points && now.option === measure.option) this.#measures.tell(now, facts);
  }
}
