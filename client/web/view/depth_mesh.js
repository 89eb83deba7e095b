// The depth of a frame as a mesh on which the frame is drawn anew from elsewhere: cells, each a square of its own, whose
// corners meet where the surface goes on and part where it ends. What is seen between them then is in depth_filling.js, which
// squares are drawn as one in mesh_triangles.js. Pure: cells in, arrays for WebGL out.
//
// `nearness` is what a plane's picture is linear in: 1 / depth in perspective, `deepest` - depth where it is orthographic;
// 0 = background.

import { fillingOf } from './depth_filling.js';
import { trianglesOf } from './mesh_triangles.js';

const invisible = 0.015; // of the scene's nearness: edges that move apart by less are none
const gentle = 0.03; // of the nearness itself
const flat = 0.01; // of the scene's nearness: by so much larger triangles may leave a surface

/**
 * @typedef {object} DepthMesh
 * @property {number} columns of squares, those outside included
 * @property {number} rows
 * @property {Float32Array} nearness of the squares' corners: above left, above right, below left, below right
 * @property {Uint32Array} triangles three of these corners each
 * @property {ReturnType<typeof fillingOf>} filling what is seen where edges have parted
 * @property {number} deepest 0 in perspective
 * @property {{ least: number, greatest: number }} depths
 */

/** Nearness of each cell. */
function nearnessOf({ inverse }, orthographic) {
  let [least, most] = [Infinity, 0];
  for (const value of inverse) {
    if (!(value > 0)) continue;
    least = Math.min(least, value);
    most = Math.max(most, value);
  }
  const depths = most > 0 ? { least: 1 / most, greatest: 1 / least } : { least: 1, greatest: 1 };
  if (!orthographic) return { values: inverse, deepest: 0, depths };
  const deepest = depths.greatest + 0.01 * (depths.greatest - depths.least) + 1e-6 * depths.greatest;
  return { values: inverse.map((value) => (value > 0 ? deepest - 1 / value : 0)), deepest, depths };
}

/** The nearness that most of the scene stays below; a few points right before the eye say nothing about it. */
function usualNearness(values) {
  const some = values.filter((value, i) => i % 7 === 0 && value > 0).sort();
  return some[Math.floor(some.length * 0.95)] ?? 0;
}

/** Which neighbours are of one surface: `across[i]` tells it of cells i and i + 1, `down[i]` of i and the one below. */
function surfaces(values, width, height, tolerance) {
  // Steep; then the surface comes or goes on like that, which an edge does not.
  const goesOn = (rise, slope) => Math.abs(rise - slope) <= 0.6 * Math.abs(rise);
  const joined = (i, step, before, after) => {
    const a = values[i], b = values[i + step];
    if (!(a > 0) || !(b > 0)) return a === b;
    const rise = b - a;
    const size = Math.abs(rise);
    if (size <= tolerance || size <= gentle * Math.min(a, b)) return true;
    const first = before ? values[i - step] : 0, last = after ? values[i + 2 * step] : 0;
    return (first > 0 && goesOn(rise, a - first)) || (last > 0 && goesOn(rise, last - b));
  };
  const across = new Uint8Array(width * height);
  const down = new Uint8Array(width * height);
  for (let row = 0, i = 0; row < height; ++row) {
    for (let column = 0; column < width; ++column, ++i) {
      if (column + 1 < width) across[i] = Number(joined(i, 1, column > 0, column + 2 < width));
      if (row + 1 < height) down[i] = Number(joined(i, width, row > 0, row + 2 < height));
    }
  }
  return { across, down };
}

/** Nearness of the corners of all squares: each the mean of those around it that are of one surface. */
function corners(values, width, height, { across, down }) {
  const columns = width + 2, rows = height + 2;
  const nearness = new Float32Array(4 * columns * rows);
  for (let y = 0; y <= rows - 2; ++y) {
    const upper = Math.min(Math.max(y - 1, 0), height - 1) * width;
    const lower = Math.min(y, height - 1) * width;
    for (let x = 0; x <= columns - 2; ++x) {
      const left = Math.min(Math.max(x - 1, 0), width - 1), right = Math.min(x, width - 1);
      const a = values[upper + left], b = values[upper + right], c = values[lower + left], d = values[lower + right];
      const top = left === right ? 1 : across[upper + left], bottom = left === right ? 1 : across[lower + left];
      const before = upper === lower ? 1 : down[upper + left], after = upper === lower ? 1 : down[upper + right];
      let na = a, nb = b, nc = c, nd = d;
      if (top + bottom + before + after >= 3) na = nb = nc = nd = (a + b + c + d) / 4;
      // Else at most two of the four edges hold: three squares around one of them, or pairs.
      else if (top && before) na = nb = nc = (a + b + c) / 3;
      else if (top && after) na = nb = nd = (a + b + d) / 3;
      else if (bottom && before) na = nc = nd = (a + c + d) / 3;
      else if (bottom && after) nb = nc = nd = (b + c + d) / 3;
      else {
        if (top) na = nb = (a + b) / 2;
        if (bottom) nc = nd = (c + d) / 2;
        if (before) na = nc = (a + c) / 2;
        if (after) nb = nd = (b + d) / 2;
      }
      // This corner is the last of the square above left, and the first of the one below right.
      const square = 4 * (y * columns + x);
      nearness[square + 3] = na;
      nearness[square + 4 + 2] = nb;
      nearness[square + 4 * columns + 1] = nc;
      nearness[square + 4 * columns + 4] = nd;
    }
  }
  // The outermost corners, beyond the picture, continue what lies inside.
  for (let y = 0; y < rows; ++y) {
    const first = 4 * y * columns, last = first + 4 * (columns - 1);
    nearness[first] = nearness[first + 1];
    nearness[first + 2] = nearness[first + 3];
    nearness[last + 1] = nearness[last];
    nearness[last + 3] = nearness[last + 2];
  }
  for (let x = 0; x < columns; ++x) {
    const first = 4 * x, last = 4 * ((rows - 1) * columns + x);
    nearness[first] = nearness[first + 2];
    nearness[first + 1] = nearness[first + 3];
    nearness[last + 2] = nearness[last];
    nearness[last + 3] = nearness[last + 1];
  }
  return nearness;
}

/**
 * The mesh of a frame's depth.
 * @param {{ width: number, height: number, inverse: Float32Array }} depth
 * @param {boolean} orthographic what the frame's projection was
 * @returns {DepthMesh}
 */
export function depthMesh(depth, orthographic) {
  const { width, height } = depth;
  const { values, deepest, depths } = nearnessOf(depth, orthographic);
  const usual = usualNearness(values);
  const joints = surfaces(values, width, height, invisible * usual);
  const nearness = corners(values, width, height, joints);
  const [columns, rows] = [width + 2, height + 2];
  return {
    columns,
    rows,
    nearness,
    triangles: trianglesOf(nearness, columns, rows, flat * usual),
    filling: fillingOf(values, width, height, joints, usual, { nearness, columns }),
    deepest,
    depths,
  };
}

