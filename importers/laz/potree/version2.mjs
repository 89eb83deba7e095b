// A Potree 2 octree: metadata.json, hierarchy.bin and octree.bin, as pieces for the workers.
import { grouped, malformed, unsupported } from '../failure.mjs';
import { attributeOf, columnsOf, layOutAttributes } from './attributes.mjs';
import { checkTotal } from './check.mjs';
import { boundsOf, checkGrid, countOf, crsOf, vectorOf } from './folder.mjs';
import { nodesOfHierarchy } from './nodes_2.mjs';
import { nodeExtent } from './piece.mjs';

const octreeFile = 'octree.bin';

/// { pieces, mayHave16Bits, scan, notes }
export function readVersion2(folder, json) {
  const version = String(json.version ?? '').slice(0, 20);
  if (!version.startsWith('2.')) throw unsupported(`metadata.json has version "${version}"; 2.0 and 2.1 are read`);
  const encoding = String(json.encoding ?? 'DEFAULT').slice(0, 20);
  // What stands in "encoding" of files that are not compressed depends on the converter's release.
  if (!['DEFAULT', 'UNCOMPRESSED', 'BROTLI'].includes(encoding))
    throw unsupported(`the encoding "${encoding}" is not known here; DEFAULT and BROTLI are`);
  const grid = { scale: vectorOf(json.scale, '"scale"'), offset: vectorOf(json.offset, '"offset"') };
  checkGrid(grid, folder.entry);
  const layout = layOutAttributes(json.attributes);
  const position = attributeOf(layout, 'position');
  if (position.stored !== 'int32') throw malformed('metadata.json: "position" must have 12 bytes');
  const firstChunk = countOf(json.hierarchy?.firstChunkSize, '"hierarchy.firstChunkSize"');
  const isBrotli = encoding === 'BROTLI';
  // What is compressed has bytes even without points.
  const nodes = nodesOfHierarchy(folder, firstChunk).filter(({ points }) => points > 0 || !isBrotli);
  const path = folder.resolve(octreeFile);
  const size = folder.sizeOf(octreeFile);
  const pieces = nodes.map(({ name, points, at, bytes }) => {
    if (at + bytes > size)
      throw malformed(`the node ${name} is said to end at byte ${grouped(at + bytes)} of ${octreeFile}, which has ${grouped(size)}`);
    return { path, node: { name, at, bytes, points, layout, grid, encoding: isBrotli ? 'brotli' : 'plain' } };
  });
  for (const { node } of pieces) nodeExtent(node);
  const color = attributeOf(layout, 'color');
  return {
    pieces,
    notes: checkTotal(json.points, nodes, folder.entry),
    mayHave16Bits: color?.stored === 'uint16',
    scan: {
      format: `Potree ${version}, ${encoding}`,
      points: nodes.reduce((total, { points }) => total + points, 0),
      columns: columnsOf(layout),
      bounds: boundsOf(json.boundingBox?.min, json.boundingBox?.max),
      gridStep: grid.scale,
      gridOrigin: grid.offset,
      ...crsOf(json.projection),
    },
  };
}
