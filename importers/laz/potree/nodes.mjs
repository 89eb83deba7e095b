// The nodes of a Potree 1 octree: what its hierarchy says of them - .hrc files (1.5-1.8) or cloud.js itself (up to 1.4) -
// and which files there are. The files are the truth: the usual converter writes 0 for every leaf into its .hrc files,
// leaves old counts in those that it need not write again, and does not tell the file above of a file's later children.
import { grouped, malformed } from '../failure.mjs';
import { countOf } from './folder.mjs';

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

/// The names of all nodes that have a file, level after level.
export function nodesWithFiles(folder, octreeDir, step, extension) {
  const fileName = new RegExp(`^(r[0-7]*)\\.${extension}$`);
  const folderName = step === 0 ? /^(?!)/ : new RegExp(`^[0-7]{${step}}$`);
  const names = [];
  const places = [step === 0 ? { path: octreeDir, prefix: '' } : { path: `${octreeDir}/r`, prefix: 'r' }];
  for (const { path, prefix } of places) {
    for (const entry of folder.list(path)) {
      const place = `${path}/${entry.name}`;
      const below = prefix + entry.name;
      if (entry.isDirectory()) {
        if (folderName.test(entry.name) && below.length <= deepest) places.push({ path: place, prefix: below });
        continue;
      }
      const name = fileName.exec(entry.name)?.[1];
      if (name && `${octreeDir}/${nodePath(name, step)}.${extension}` === place) names.push(name);
    }
    if (names.length > mostNodes || places.length > mostNodes)
      throw malformed(`its octree is larger than any real one (${grouped(names.length)} nodes)`);
  }
  return names.sort((a, b) => a.length - b.length || (a < b ? -1 : 1));
}

/// Name → points, as `cloud.hierarchy` has them.
export function listedInJson(list) {
  if (!Array.isArray(list) || list.length === 0) throw malformed('cloud.js: "hierarchy" must be a list of nodes');
  const listed = new Map();
  list.forEach((entry, i) => {
    const [name, points] = Array.isArray(entry) ? entry : [];
    if (typeof name !== 'string' || !/^r[0-7]*$/.test(name) || name.length > deepest)
      throw malformed(`cloud.js: node ${i} of "hierarchy" has no name like "r042"`);
    if (listed.has(name)) throw malformed(`cloud.js: "hierarchy" has the node ${name} twice`);
    listed.set(name, countOf(points, `cloud.js: points of ${name}`, 0xffffffff));
  });
  return listed;
}

/// Name → points, as the .hrc files have them, one for every `step` levels.
export function listedInFiles(folder, octreeDir, step) {
  const listed = new Map();
  const roots = ['r'];
  for (let i = 0; i < roots.length; ++i) readHrc(folder, octreeDir, step, roots[i], listed, roots);
  return listed;
}

/// A file holds, level after level, a node and what is below it, `step` levels deep; the deepest of them go on in files of
/// their own: if they have children, or got some after this file was written.
function readHrc(folder, octreeDir, step, root, listed, roots) {
  const hrcOf = (name) => `${octreeDir}/${nodePath(name, step)}.hrc`;
  const file = hrcOf(root);
  const bytes = folder.readFile(file, longestHrc);
  if (bytes.length === 0 || bytes.length % hrcEntryBytes !== 0)
    throw malformed(`its file ${file} has ${grouped(bytes.length)} bytes, no multiple of ${hrcEntryBytes}`);
  const names = [root];
  for (let i = 0; i < names.length; ++i) {
    const at = i * hrcEntryBytes;
    if (at >= bytes.length) throw malformed(`its file ${file} ends at byte ${grouped(at)}, before the node ${names[i]}`);
    const children = bytes[at];
    listed.set(names[i], bytes.readUInt32LE(at + 1));
    if (listed.size > mostNodes || names[i].length > deepest)
      throw malformed(`its octree is deeper or larger than any real one (${grouped(listed.size)} nodes)`);
    if (names[i].length - root.length < step) {
      for (let child = 0; child < 8; ++child) if (children & (1 << child)) names.push(names[i] + child);
    } else if (children !== 0 || folder.has(hrcOf(names[i]))) {
      roots.push(names[i]);
    }
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
