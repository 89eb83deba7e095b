// How the server shows a cloud when nobody says anything, in the page's own terms. Pure.

import { columnOf, styleKeys } from '../protocol/view_words.js';

/** Those that `view` has, be it null: a server refuses words that it does not know, and its clouds' views have all that it knows. */
export const pick = (view, keys) => Object.fromEntries(keys.filter((key) => view?.[key] !== undefined).map((key) => [key, view[key]]));

/** The style in which the server would show the cloud by itself. */
export const usualStyle = (of) => pick(of?.view, styleKeys);

/** `style` with some members changed; of the light, a change may say a part. */
export const restyled = (style, changes = /** @type {any} */ ({})) =>
  ({ ...style, ...changes, ...(changes.light ? { light: { ...style.light, ...changes.light } } : {}) });

/** What of a view can be asked for by now: where only a part of a cloud has been read, nothing by columns that it does not know yet. */
export function askable(view, of) {
  if (of?.state !== 'loading') return view;
  const isUnknown = (name) => name !== undefined && !of.columns?.some((one) => one.name === name);
  const known = view.filter?.filter(({ column }) => !isUnknown(column));
  return {
    ...view, ...(known && known.length < view.filter.length ? { filter: known.length > 0 ? known : null } : {}),
    ...(isUnknown(columnOf(view.color)) ? { color: 'auto', range: null } : {}),
  };
}

/** Around all that is shown: a cloud, and those `members` of a view (its word `with`) that are to be seen, each where it is shifted to. */
export function boundsOf(of, members, clouds) {
  if (!members || !of?.bounds) return of?.bounds;
  const known = members.some(({ cloud }) => cloud === '.') ? members : [{ cloud: '.' }, ...members];
  const boxes = known.filter(({ hidden }) => !hidden).map(({ cloud, shift = [0, 0, 0] }) => {
    const box = cloud === '.' ? of.bounds : clouds.find(({ id }) => id === cloud)?.bounds;
    return box && [box.min, box.max].map((corner) => corner.map((value, axis) => value + shift[axis]));
  }).filter(Boolean);
  if (boxes.length === 0) return of.bounds;
  const [min, max] = [Math.min, Math.max].map((most, end) => [0, 1, 2].map((axis) => most(...boxes.map((box) => box[end][axis]))));
  return { min, max };
}

/** The axis that the server takes for up, which it tells by its default view. */
export function usualUpAxis(of) {
  const y = of.look?.up?.[1] ?? of.view?.camera?.up?.[1] ?? 0;
  return y > 0.5 ? 'y' : y < -0.5 ? '-y' : 'z';
}
