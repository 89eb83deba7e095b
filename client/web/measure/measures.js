// The measures of one scan.

import { SteppedList } from './stepped_list.js';
import { kinds } from './values.js';

/** More than a list can be read with, and a page can draw. */
export const mostMeasures = 500;

export class Measures extends SteppedList {
  constructor() {
    super(mostMeasures);
  }

  change(id, changes) {
    const isOther = 'points' in changes || 'option' in changes; // of which the server has said nothing yet
    super.change(id, { ...(isOther ? { answer: undefined, trouble: undefined } : {}), ...changes });
  }

  /** A measure without that point; without the measure, where too few are left. */
  removePoint(id, index) {
    const one = this.find(id);
    if (!one?.points[index]) return;
    if (one.points.length <= kinds[one.kind].least) this.remove(id);
    else this.change(id, { points: one.points.filter((_, i) => i !== index) });
  }
}

/** Those of `more` that `list` does not have: of the same kind, at the same points. Pure. */
export function unknownOf(list, more) {
  const keyOf = ({ kind, points }) => JSON.stringify([kind, points]);
  const known = new Set(list.map(keyOf));
  return more.filter((one) => !known.has(keyOf(one)));
}
