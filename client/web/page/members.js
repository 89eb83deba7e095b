// The clouds that a view shows together (its word `with`): this one and the others, with what each is called and in which colour it is drawn where
// colours tell them apart. Pure.

/** Of those that have no tint, by their places in the list: the server's (protocol/view/viewed_clouds.hpp). */
const palette = ['#56b4e9', '#e69f00', '#009e73', '#cc79a7', '#f0e442', '#0072b2', '#d55e00'];

/** What this cloud itself is called in the word. */
export const itself = '.';

/** [{ cloud, name, color, shift, tint, hidden }], this one first where the view does not say another place. `clouds`: all that there are. */
export function membersOf(view, cloud, clouds) {
  const said = view.with ?? [];
  const listed = said.some((one) => one.cloud === itself) ? said : [{ cloud: itself }, ...said];
  return listed.map((/** @type {any} */ one, i) => {
    const of = one.cloud === itself ? cloud : clouds.find(({ id }) => id === one.cloud);
    return { ...one, name: of?.title || of?.id || one.cloud, color: one.tint ?? palette[i % palette.length] };
  });
}

/** How far this cloud itself is shifted from where its file has it; undefined where it is not. */
export const ownShift = (view) => {
  const shift = view?.with?.find(({ cloud }) => cloud === itself)?.shift;
  return shift?.some((value) => value !== 0) ? shift : undefined;
};

/** Whether other clouds are seen with this one, or it is not where its file has it: then what is computed of its points alone says something else. */
export const isAlone = (view) => !ownShift(view) && !view?.with?.some(({ cloud, hidden }) => cloud !== itself && !hidden);

/** The word for these members: null where this cloud is alone, as it is. */
export function wordOf(members) {
  const plain = members.map(({ cloud, shift, tint, hidden }) => ({
    cloud, ...(shift?.some((value) => value !== 0) ? { shift } : {}), ...(tint ? { tint } : {}), ...(hidden ? { hidden } : {}),
  }));
  // The first is this one anyway.
  const said = plain[0]?.cloud === itself && Object.keys(plain[0]).length === 1 ? plain.slice(1) : plain;
  return said.length > 0 ? said : null;
}
