// The nodes of a Potree 1 octree: from .hrc files (1.5-1.8) or from cloud.js itself (up to 1.4).
import { grouped, malformed } from './failure.mjs';
import { countOf } from './potree_folder.mjs';

export const mostNodes = 20e6;
export const deepest = 60;
const hrcEntryBytes = 5; // u8 children, u32 points
const longestHrc = 256 << 20;

/// Where the files of a node are: "r/012345/r012345678" with steps of 6; without steps beside each other.
export function nodePath(name, step) {
  if (step === 0) return name;
  let path = 'r/';
  for (let at = 1; at + step <= name.length; at += step) path += `${name.slice(at, at + step)}/`;
  return path + name;
}

/// [{ name, points }] of `cloud.hierarchy`.
export function nodesOfList(list) {
  if (!Array.isArray(list) || list.length === 0) throw malformed('cloud.js: "hierarchy" must be a list of nodes');
  const seen = new Set();
  return list.map((entry, i) => {
    const [name, points] = Array.isArray(entry) ? entry : [];
    if (typeof name !== 'string' || !/^r[0-7]*$/.test(name) || name.length > deepest)
      throw malformed(`cloud.js: node ${i} of "hierarchy" has no name like "r042"`);
    if (seen.has(name)) throw malformed(`cloud.js: "hierarchy" has the node ${name} twice`);
    seen.add(name);
    return { name, points: countOf(points, `cloud.js: points of ${name}`, 0xffffffff) };
  });
}

/// [{ name, points }] of the .hrc files, which are read one for every `step` levels.
export function nodesOfFiles(folder, octreeDir, step) {
  const nodes = [];
  const roots = ['r'];
  for (let i = 0; i < roots.length; ++i) readHrc(folder, octreeDir, step, roots[i], nodes, roots);
  return nodes;
}

/// A file holds, level after level, a node and what is below it, `step` levels deep; the deepest of them that have
/// children go on in files of their own.
function readHrc(folder, octreeDir, step, root, nodes, roots) {
  const file = `${octreeDir}/${nodePath(root, step)}.hrc`;
  const bytes = folder.readFile(file, longestHrc);
  if (bytes.length === 0 || bytes.length % hrcEntryBytes !== 0)
    throw malformed(`its file ${file} has ${grouped(bytes.length)} bytes, no multiple of ${hrcEntryBytes}`);
  const names = [root];
  for (let i = 0; i < names.length; ++i) {
    const at = i * hrcEntryBytes;
    if (at >= bytes.length) throw malformed(`its file ${file} ends at byte ${grouped(at)}, before the node ${names[i]}`);
    const children = bytes[at];
    const isOwnFile = names[i].length - root.length === step && step > 0;
    // The root of a file that is not the first is in the file above already.
    if (i > 0 || root === 'r') nodes.push({ name: names[i], points: bytes.readUInt32LE(at + 1) });
    if (nodes.length > mostNodes || names[i].length > deepest)
      throw malformed(`its octree is deeper or larger than any real one (${grouped(nodes.length)} nodes)`);
    if (isOwnFile && children !== 0) roots.push(names[i]);
    for (let child = 0; !isOwnFile && child < 8; ++child) if (children & (1 << child)) names.push(names[i] + child);
  }
  if (names.length * hrcEntryBytes !== bytes.length)
    throw malformed(`its file ${file} has ${grouped(bytes.length)} bytes; its ${grouped(names.length)} nodes need less`);
}

/// Lower corner of a node's cube: every digit halves it; bit 2 is x, bit 1 is y, bit 0 is z.
export function cornerOf(name, min, size) {
  const corner = [...min];
  let half = size.map((s) => s / 2);
  for (const digit of name.slice(1)) {
    for (let axis = 0; axis < 3; ++axis) if (Number(digit) & (4 >> axis)) corner[axis] += half[axis];
    half = half.map((h) => h / 2);
  }
  return corner;
}
