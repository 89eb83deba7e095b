// What the parts of a project file are checked by. Pure.

const farthest = 1e12;

/** Why a file is no project, in a sentence. */
export class ProjectError extends Error {}

export function check(holds, sentence) {
  if (!holds) throw new ProjectError(sentence);
}

export const isObject = (value) => typeof value === 'object' && value !== null && !Array.isArray(value);
export const isText = (value, longest) => typeof value === 'string' && value.length <= longest;
export const isPoint = (point) =>
  Array.isArray(point) && point.length === 3 && point.every((value) => typeof value === 'number' && Math.abs(value) <= farthest);
export const isLength = (value) => typeof value === 'number' && value >= 0 && value <= farthest;

/** The entries of a list that may be missing, each as `read(entry, where)` has it. */
export function listOf(file, name, most, read) {
  const { [name]: list = [] } = file;
  check(Array.isArray(list), `${name} is no list.`);
  check(list.length <= most, `There are ${list.length} ${name} in the file; ${most} is the most.`);
  return list.map((one, i) => {
    const where = `${name}[${i}]`;
    check(isObject(one), `${where} is no ${name.slice(0, -1)}.`);
    return read(one, where);
  });
}
