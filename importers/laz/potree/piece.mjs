// The points of one Potree node, in a worker: bytes to CHNK records, a piece at a time.
import { grouped, malformed, tooLarge } from '../failure.mjs';
import { chunkPoints } from '../point_stream.mjs';
import { brotliBytes, inBrotli } from './brotli.mjs';
import { depthOfColumns, encodeColumns, inRecords } from './columns.mjs';

// A node is held in memory as a whole. Real ones have some ten thousand points.
const longestNode = 512 * 2 ** 20;

/// Checks a node's numbers against each other before anything is allocated for it.
export function nodeExtent({ name, bytes, points, layout, encoding }) {
  const plain = points * layout.bytes;
  if (encoding === 'plain' && bytes !== plain)
    throw malformed(`the node ${name} has ${grouped(bytes)} bytes; its ${grouped(points)} points need ${grouped(plain)}`);
  const most = Math.max(bytes, encoding === 'brotli' ? brotliBytes(layout, points) : plain);
  if (most > longestNode)
    throw tooLarge(`the node ${name} has ${grouped(most)} bytes; nodes of up to ${grouped(longestNode)} are read`);
}

function load(file, node) {
  const bytes = file.readAll(node.at, node.bytes, `the node ${node.name}`);
  return node.encoding === 'brotli' ? inBrotli(node.layout, bytes, node.points, node.name) : inRecords(node.layout, bytes);
}

export const depthOfNode = (file, node) => depthOfColumns(load(file, node), node.points);

/// Calls `give(buffer, points)` with whole CHNK records; it may return a promise.
export async function encodeNode(file, node, depth, give) {
  const places = load(file, node);
  for (let first = 0; first < node.points; first += chunkPoints) {
    const count = Math.min(chunkPoints, node.points - first);
    const buffer = encodeColumns(places, node.layout, node.grid, depth, first, count);
    if (places.position.stored === 'float') checkFinite(new Float64Array(buffer, 8, 3 * count), node.name);
    await give(buffer, count);
  }
}

function checkFinite(positions, name) {
  if (!positions.every(Number.isFinite)) throw malformed(`a coordinate in the node ${name} is NaN or infinite`);
}
