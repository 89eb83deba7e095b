// A Potree octree, 1.x or 2.x, to the point stream: description, nodes, then all points of all nodes.
import { empty, grouped, malformed, unsupported } from './failure.mjs';
import { colorDepth, lasColumns } from './las_columns.mjs';
import { nodeExtent } from './potree_piece.mjs';
import { WorkerPool } from './worker_pool.mjs';
import { judgeColors, openLaz, workerUrl, writePieces } from './laz_import.mjs';
import { attributeOf, columnsOf, layOutAttributes } from './potree_attributes.mjs';
import { PotreeFolder, countOf, numberOf, vectorOf } from './potree_folder.mjs';
import { cornerOf, nodePath, nodesOfFiles, nodesOfList } from './potree_nodes.mjs';
import { nodesOfHierarchy } from './potree_nodes_2.mjs';

const octreeFile = 'octree.bin';
const mostStep = 30;

export async function importPotree(path, writer) {
  const folder = new PotreeFolder(path);
  const json = folder.readJson();
  const octree = folder.entry === 'metadata.json' ? readVersion2(folder, json) : readVersion1(folder, json);
  if (octree.pieces.length === 0) throw empty('it is a Potree octree without points');
  const pool = new WorkerPool(workerUrl, octree.pieces.length);
  try {
    const depth = octree.mayHave16Bits ? await judgeColors(pool, octree.pieces) : colorDepth.eightBits;
    writer.header(octree.scan);
    await writePieces(pool, octree.pieces, depth, writer);
  } finally {
    await pool.close();
  }
}

/// Whatever `value` is, the coordinate reference system that it names, if any. PROJ's strings are none.
function crsOf(value) {
  if (typeof value !== 'string') return {};
  const epsg = /^\s*EPSG:(\d{4,6})\s*$/i.exec(value);
  if (epsg) return { epsg: Number(epsg[1]) };
  return /^\s*[A-Z_]{4,}\s*\[/.test(value) ? { wkt: value } : {};
}

const sum = (nodes) => nodes.reduce((total, { points }) => total + points, 0);

function checkGrid({ scale, offset }, file) {
  if (scale.some((s, i) => !(s > 0) || !Number.isFinite(Math.abs(offset[i]) + 2 ** 32 * s)))
    throw malformed(`${file}: the scale must be positive, and the points near enough to be numbers`);
}

// ---- Potree 2

function readVersion2(folder, json) {
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
  const nodes = nodesOfHierarchy(folder, firstChunk).filter(({ points }) => points > 0);
  const path = folder.resolve(octreeFile);
  const size = folder.sizeOf(octreeFile);
  const pieces = nodes.map(({ name, points, at, bytes }) => {
    if (at + bytes > size)
      throw malformed(`the node ${name} is said to end at byte ${grouped(at + bytes)} of ${octreeFile}, which has ${grouped(size)}`);
    return { path, node: { name, at, bytes, points, layout, grid, encoding: encoding === 'BROTLI' ? 'brotli' : 'plain' } };
  });
  for (const { node } of pieces) nodeExtent(node);
  const color = attributeOf(layout, 'color');
  return {
    pieces,
    mayHave16Bits: color?.stored === 'uint16',
    scan: {
      format: `Potree ${version}, ${encoding}`,
      points: sum(nodes),
      columns: columnsOf(layout),
      bounds: boundsOf(json.boundingBox?.min, json.boundingBox?.max),
      gridStep: grid.scale,
      gridOrigin: grid.offset,
      ...crsOf(json.projection),
    },
  };
}

/// A hint, so a wrong one is none.
function boundsOf(min, max) {
  const sound = [min, max].every((corner) => Array.isArray(corner) && corner.length === 3 && corner.every(Number.isFinite));
  return sound && min.every((low, i) => low <= max[i]) ? [min, max] : undefined;
}

// ---- Potree 1

function readVersion1(folder, json) {
  const version = /^1\.(\d{1,3})/.exec(String(json.version ?? ''));
  if (!version) throw unsupported(`cloud.js has version "${String(json.version ?? '').slice(0, 20)}"; 1.0 to 1.8 are read`);
  const minor = Number(version[1]);
  const octreeDir = json.octreeDir ?? 'data';
  if (typeof octreeDir !== 'string' || octreeDir.includes('\0')) throw malformed('cloud.js: "octreeDir" must be a folder');
  folder.resolve(octreeDir);
  const inSteps = minor >= 5;
  const step = inSteps ? countOf(json.hierarchyStepSize, '"hierarchyStepSize"', mostStep) : 0;
  if (inSteps && step === 0) throw malformed('cloud.js: "hierarchyStepSize" is 0');
  const listed = json.hierarchy ? nodesOfList(json.hierarchy) : nodesOfFiles(folder, octreeDir, step);
  const nodes = listed.filter(({ points }) => points > 0);
  const fileOf = (name, extension) => `${octreeDir}/${nodePath(name, step)}.${extension}`;
  const crs = crsOf(json.projection);
  if (json.pointAttributes === 'LAZ' || json.pointAttributes === 'LAS')
    return readLasNodes(folder, json, nodes, (name) => fileOf(name, json.pointAttributes.toLowerCase()), crs);
  return readBinNodes(folder, json, nodes, (name) => fileOf(name, 'bin'), minor, crs);
}

const corners = (box) => [
  [box?.lx, box?.ly, box?.lz],
  [box?.ux, box?.uy, box?.uz],
];

const formatOf = (json, kind) => `Potree ${String(json.version).slice(0, 20)}, ${kind}`;

function readLasNodes(folder, json, nodes, fileOf, crs) {
  const pieces = [];
  let first = null;
  let sameGrid = true;
  for (const { name, points } of nodes) {
    const path = folder.resolve(fileOf(name));
    const { las, chunks } = inFile(fileOf(name), () => openLaz(path, { mayBePlain: true }));
    if (las.points !== points)
      throw malformed(`its file ${fileOf(name)} has ${grouped(las.points)} points; the hierarchy says ${grouped(points)}`);
    first ??= las;
    if (lasColumns(las).color !== lasColumns(first).color)
      throw unsupported(`some of its files have colours and some have none (${fileOf(name)})`);
    sameGrid &&= [0, 1, 2].every((i) => las.scale[i] === first.scale[i] && las.offset[i] === first.offset[i]);
    for (const chunk of chunks) pieces.push({ path, las, chunk });
  }
  return {
    pieces,
    mayHave16Bits: first !== null,
    scan: {
      format: formatOf(json, json.pointAttributes),
      points: sum(nodes),
      columns: first ? lasColumns(first) : {},
      bounds: boundsOf(...corners(json.tightBoundingBox ?? json.boundingBox)),
      gridStep: sameGrid ? first?.scale : undefined,
      gridOrigin: sameGrid ? first?.offset : undefined,
      ...crs,
    },
  };
}

/// A failure within one of the octree's files names it.
function inFile(name, act) {
  try {
    return act();
  } catch (error) {
    error.message = `its file ${name}: ${error.message}`;
    throw error;
  }
}

function readBinNodes(folder, json, nodes, fileOf, minor, crs) {
  const layout = layOutAttributes(json.pointAttributes);
  const position = attributeOf(layout, 'position');
  const [low, high] = corners(json.boundingBox).map((corner) => vectorOf(corner, '"boundingBox"'));
  const size = low.map((value, i) => high[i] - value);
  // Before 1.4, positions were floats of the file's own unit.
  const isFloat = minor <= 3;
  if (isFloat) position.stored = 'float';
  const scale = isFloat ? 1 : numberOf(json.scale, '"scale"');
  checkGrid({ scale: [scale, scale, scale], offset: high }, folder.entry);
  const pieces = nodes.map(({ name, points }) => {
    const file = fileOf(name);
    const bytes = folder.sizeOf(file);
    if (bytes !== points * layout.bytes)
      throw malformed(
        `its file ${file} has ${grouped(bytes)} bytes; the hierarchy says ${grouped(points)} points of ${layout.bytes} bytes`,
      );
    const grid = { scale: [scale, scale, scale], offset: cornerOf(name, low, size) };
    return { path: folder.resolve(file), node: { name, at: 0, bytes, points, layout, grid, encoding: 'plain' } };
  });
  for (const { node } of pieces) nodeExtent(node);
  return {
    pieces,
    mayHave16Bits: attributeOf(layout, 'color')?.stored === 'uint16',
    scan: {
      format: formatOf(json, 'BIN'),
      points: sum(nodes),
      columns: columnsOf(layout),
      bounds: boundsOf(...corners(json.tightBoundingBox ?? json.boundingBox)),
      ...crs,
    },
  };
}
