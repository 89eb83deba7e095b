// How the server shows a cloud when nobody says anything, in the page's own terms. Pure.

import { styleKeys } from '../protocol/view_words.js';

/** Those that `view` has, be it null: a server refuses words that it does not know, and its clouds' views have all that it knows. */
export const pick = (view, keys) => Object.fromEntries(keys.filter((key) => view?.[key] !== undefined).map((key) => [key, view[key]]));

/** The style in which the server would show the cloud by itself. */
export const usualStyle = (of) => pick(of?.view, styleKeys);

/** `style` with some members changed; of the light, a change may say a part. */
export const restyled = (style, changes = /** @type {any} */ ({})) =>
  ({ ...style, ...changes, ...(changes.light ? { light: { ...style.light, ...changes.light } } : {}) });

/** The axis that the server takes for up, which it tells by its default view. */
export function usualUpAxis(of) {
  const y = of.look?.up?.[1] ?? of.view?.camera?.up?.[1] ?? 0;
  return y > 0.5 ? 'y' : y < -0.5 ? '-y' : 'z';
}
