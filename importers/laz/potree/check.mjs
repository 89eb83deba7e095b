// What a Potree octree says of its points against what its files hold: the files are right, and every difference is told.
// Pure functions.
import { grouped, malformed } from '../failure.mjs';

const sum = (nodes) => nodes.reduce((total, { points }) => total + points, 0);

/// `nodes`: [{ name, file, points }] of the files; `listed`: name → points of the hierarchy; `fileOf`: a node's file.
/// Returns notes, sentences for the user. Fails when the file of a node is missing that may have points: 0 points are
/// believed as long as no other node of 0 points has some.
export function checkHierarchy(nodes, listed, fileOf) {
  const found = new Set(nodes.map(({ name }) => name));
  const zerosHold = nodes.every(({ name, points }) => points === 0 || listed.get(name) !== 0);
  const missing = [...listed].filter(([name, points]) => !found.has(name) && !(zerosHold && points === 0));
  if (missing.length > 0) {
    const more = missing.length === 1 ? '' : ` and so are ${grouped(missing.length - 1)} more that its hierarchy has`;
    throw malformed(`its file ${fileOf(missing[0][0])} is missing${more}`);
  }
  const notes = [];
  const unlisted = nodes.filter(({ name, points }) => points > 0 && !listed.has(name));
  if (unlisted.length > 0)
    notes.push(
      `${grouped(unlisted.length)} of its files (${grouped(sum(unlisted))} points; one is ${unlisted[0].file}) are not in ` +
        'its hierarchy; they were read, too',
    );
  const short = nodes.filter(({ name, points }) => points < (listed.get(name) ?? 0));
  if (short.length > 0)
    notes.push(
      `${grouped(short.length)} of its files hold fewer points than its hierarchy says (${short[0].file} ` +
        `${grouped(short[0].points)} of ${grouped(listed.get(short[0].name))}); what they hold was read`,
    );
  return notes;
}

/// `said`: the number of points that the octree's JSON file has, if it has one.
export function checkTotal(said, nodes, entry) {
  const held = sum(nodes);
  if (!Number.isSafeInteger(said) || said < 0 || said === held) return [];
  return [`${entry} says ${grouped(said)} points, the octree's files hold ${grouped(held)}; these were read`];
}
