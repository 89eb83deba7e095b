// A Potree 1.x octree: cloud.js and a file for every node, as pieces for the workers.
import { ScanFailure, failureCode, grouped, malformed, unsupported } from '../failure.mjs';
import { lasColumns } from '../las_columns.mjs';
import { openLaz } from '../laz_import.mjs';
import { attributeOf, columnsOf, layOutAttributes } from './attributes.mjs';
import { checkHierarchy, checkTotal } from './check.mjs';
import { boundsOf, checkGrid, countOf, crsOf, numberOf, vectorOf } from './folder.mjs';
import { cornerOf, listedInFiles, listedInJson, nodePath, nodesWithFiles } from './nodes.mjs';
import { nodeExtent } from './piece.mjs';

const mostStep = 30;

/// { pieces, mayHave16Bits, scan, notes }
export function readVersion1(folder, json) {
  const version = /^1\.(\d{1,3})/.exec(String(json.version ?? ''));
  if (!version) throw unsupported(`cloud.js has version "${String(json.version ?? '').slice(0, 20)}"; 1.0 to 1.8 are read`);
  const minor = Number(version[1]);
  const { octreeDir, step } = placeOfNodes(folder, json, minor);
  const isLas = json.pointAttributes === 'LAZ' || json.pointAttributes === 'LAS';
  const extension = isLas ? json.pointAttributes.toLowerCase() : 'bin';
  const fileOf = (name) => `${octreeDir}/${nodePath(name, step)}.${extension}`;
  const listed = json.hierarchy ? listedInJson(json.hierarchy) : listedInFiles(folder, octreeDir, step);
  const files = nodesWithFiles(folder, octreeDir, step, extension).map((name) => ({ name, file: fileOf(name) }));
  const octree = isLas ? readLasNodes(folder, json, files) : readBinNodes(folder, json, files, minor);
  const notes = checkHierarchy(octree.nodes, listed, fileOf);
  notes.push(...checkTotal(json.points, octree.nodes, folder.entry));
  return { ...octree, notes };
}

function placeOfNodes(folder, json, minor) {
  const octreeDir = json.octreeDir ?? 'data';
  if (typeof octreeDir !== 'string' || octreeDir.includes('\0')) throw malformed('cloud.js: "octreeDir" must be a folder');
  folder.resolve(octreeDir);
  if (minor < 5) return { octreeDir, step: 0 };
  const step = countOf(json.hierarchyStepSize, '"hierarchyStepSize"', mostStep);
  if (step === 0) throw malformed('cloud.js: "hierarchyStepSize" is 0');
  return { octreeDir, step };
}

const corners = (box) => [
  [box?.lx, box?.ly, box?.lz],
  [box?.ux, box?.uy, box?.uz],
];

const scanOf = (json, kind, nodes, columns) => ({
  format: `Potree ${String(json.version).slice(0, 20)}, ${kind}`,
  points: nodes.reduce((total, { points }) => total + points, 0),
  columns,
  bounds: boundsOf(...corners(json.tightBoundingBox ?? json.boundingBox)),
  ...crsOf(json.projection),
});

function readLasNodes(folder, json, files) {
  const pieces = [];
  const nodes = [];
  let first = null;
  let sameGrid = true;
  for (const { name, file } of files) {
    const path = folder.resolve(file);
    const { las, chunks } = inFile(file, () => openNode(path));
    nodes.push({ name, file, points: las?.points ?? 0 });
    if (!las) continue;
    first ??= las;
    if (lasColumns(las).color !== lasColumns(first).color)
      throw unsupported(`some of its files have colours and some have none (${file})`);
    sameGrid &&= [0, 1, 2].every((i) => las.scale[i] === first.scale[i] && las.offset[i] === first.offset[i]);
    for (const chunk of chunks) pieces.push({ path, las, chunk });
  }
  const scan = scanOf(json, json.pointAttributes, nodes, first ? lasColumns(first) : {});
  if (sameGrid && first) Object.assign(scan, { gridStep: first.scale, gridOrigin: first.offset });
  return { pieces, nodes, mayHave16Bits: first !== null, scan };
}

/// Without `las` where a node's file has no points.
function openNode(path) {
  try {
    return openLaz(path, { mayBePlain: true });
  } catch (error) {
    if (error instanceof ScanFailure && error.code === failureCode.empty) return {};
    throw error;
  }
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

function readBinNodes(folder, json, files, minor) {
  const layout = layOutAttributes(json.pointAttributes);
  const position = attributeOf(layout, 'position');
  const [low, high] = corners(json.boundingBox).map((corner) => vectorOf(corner, '"boundingBox"'));
  const size = low.map((value, i) => high[i] - value);
  // Before 1.4, positions were floats of the file's own unit.
  const isFloat = minor <= 3;
  if (isFloat) position.stored = 'float';
  const scale = isFloat ? 1 : numberOf(json.scale, '"scale"');
  checkGrid({ scale: [scale, scale, scale], offset: high }, folder.entry);
  const nodes = files.map(({ name, file }) => {
    const bytes = folder.sizeOf(file);
    if (bytes % layout.bytes !== 0)
      throw malformed(`its file ${file} has ${grouped(bytes)} bytes, no whole number of points of ${layout.bytes} bytes`);
    return { name, file, bytes, points: bytes / layout.bytes };
  });
  const pieces = nodes.filter(({ points }) => points > 0).map(({ name, file, bytes, points }) => {
    const grid = { scale: [scale, scale, scale], offset: cornerOf(name, low, size) };
    return { path: folder.resolve(file), node: { name, at: 0, bytes, points, layout, grid, encoding: 'plain' } };
  });
  for (const { node } of pieces) nodeExtent(node);
  return {
    pieces,
    nodes,
    mayHave16Bits: attributeOf(layout, 'color')?.stored === 'uint16',
    scan: scanOf(json, 'BIN', nodes, columnsOf(layout)),
  };
}
