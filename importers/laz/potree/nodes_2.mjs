// The nodes of a Potree 2 octree: hierarchy.bin, a tree of chunks that refer to each other by place.
import { grouped, malformed } from '../failure.mjs';
import { number64 } from '../las_header.mjs';
import { deepest, mostNodes } from './nodes.mjs';

const entryBytes = 22; // u8 kind, u8 children, u32 points, u64 place, u64 bytes
const proxy = 2;
const file = 'hierarchy.bin';

/// [{ name, points, at, bytes }]: where the points of every node that has some are in octree.bin.
export function nodesOfHierarchy(folder, firstChunkBytes) {
  const hierarchy = folder.open(file);
  try {
    const nodes = [];
    const seen = new Set();
    const chunks = [{ name: 'r', at: 0, bytes: firstChunkBytes }];
    // Chunks grow while they are read: a proxy in one is the root of another.
    for (const chunk of chunks) {
      if (seen.has(chunk.at))
        throw malformed(`${file}, byte ${grouped(chunk.at)}: two nodes (one is ${chunk.name}) share the chunk there: a circle`);
      seen.add(chunk.at);
      readChunk(hierarchy, chunk, nodes, chunks);
    }
    return nodes;
  } finally {
    hierarchy.close();
  }
}

function readChunk(hierarchy, chunk, nodes, chunks) {
  const { at, bytes } = chunk;
  if (bytes === 0 || bytes % entryBytes !== 0 || at + bytes > hierarchy.size)
    throw malformed(
      `${file}: the chunk of the node ${chunk.name} is said to have ${grouped(bytes)} bytes at byte ${grouped(at)}; ` +
        `the file has ${grouped(hierarchy.size)}, a node has ${entryBytes}`,
    );
  const content = hierarchy.readAll(at, bytes, file);
  const names = [chunk.name];
  for (let i = 0; i < names.length; ++i) {
    const entry = i * entryBytes;
    const wrong = (reason) => malformed(`${file}, byte ${grouped(at + entry)}: ${reason}`);
    if (entry >= bytes) throw wrong(`the chunk of ${chunk.name} ends before its node ${names[i]}`);
    if (names[i].length > deepest || nodes.length + names.length > mostNodes)
      throw wrong('the octree is deeper or larger than any real one');
    const kind = content[entry];
    const place = number64(content, entry + 6);
    const size = number64(content, entry + 14);
    if (kind > proxy) throw wrong(`the node ${names[i]} is of kind ${kind}; 0, 1 and 2 are known`);
    if (kind === proxy) {
      if (i === 0) throw wrong(`the chunk of ${chunk.name} starts with another reference: a circle`);
      chunks.push({ name: names[i], at: place, bytes: size });
      continue;
    }
    // Some inner nodes claim points although they have none; their bytes tell.
    if (size > 0) nodes.push({ name: names[i], points: content.readUInt32LE(entry + 2), at: place, bytes: size });
    for (let child = 0; child < 8; ++child) if (content[entry + 1] & (1 << child)) names.push(names[i] + child);
  }
  if (names.length * entryBytes !== bytes)
    throw malformed(`${file}: the chunk of the node ${chunk.name} has ${grouped(bytes)} bytes for ${grouped(names.length)} nodes`);
}
