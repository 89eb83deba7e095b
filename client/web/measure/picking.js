// The scan's own point under a cursor, by the server, for tools that place points; says why where there is none.

import { strings } from '../page/strings.js';
import { measure as words } from '../page/strings/measure.js';

/** The picked point as the protocol has it, or nothing. */
export async function pickOr(viewer, overlays, cursor) {
  try {
    const found = await viewer.pickAt(cursor);
    if (!found) overlays.toast(words.messages.nothing, words.messages.nothingDetail);
    return found;
  } catch (/** @type {any} */ error) {
    overlays.toast(words.messages.failed, error.title ? error.message : strings.messages.noAnswer);
    return undefined;
  }
}
