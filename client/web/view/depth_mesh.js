// The depth of a frame as a mesh on which the frame is drawn anew from elsewhere: cells, each a square of its own, whose
// corners meet where the surface goes on and part where it ends; and behind each such edge cells of what lies
// farther back, so that nothing tears when the nearer side moves away. Pure: cells in, arrays for WebGL out.
//
// `nearness` is what a plane's picture is linear in: 1 / depth in perspective, `deepest` - depth where it is orthographic;
// 0 = background.

const invisible = 0.015; // of the scene's nearness: edges that move apart by less are none
const gentle = 0.03; // of the nearness itself
const mirrorable = 1.1; // of the farther nearness: what is nearer is of something else
const reach = 10; // cells that are filled behind an edge
const beyond = 0.5; // of half the picture, by which its border cells go on outside

/**
 * @typedef {object} DepthMesh
 * @property {number} columns of squares, those outside included
 * @property {number} rows
 * @property {Float32Array} nearness of the squares' corners: above left, above right, below left, below right
 * @property {Float32Array} filling squares behind edges, corners in that order: x, y, nearness, and x, y of what is seen there
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
function surfaces(values, width, height) {
  const tolerance = invisible * usualNearness(values);
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

/** For each cell near an edge on the nearer side, the cell on the farther side whose surface goes on behind it; else -1. */
function behindEdges(values, width, height, { across, down }) {
  const source = new Int32Array(width * height).fill(-1);
  let front = [];
  const offer = (near, far) => {
    if (source[near] < 0) front.push(near);
    if (source[near] < 0 || values[far] < values[source[near]]) source[near] = far;
  };
  const compare = (i, j) => (values[i] > values[j] ? offer(i, j) : offer(j, i));
  for (let row = 0, i = 0; row < height; ++row) {
    for (let column = 0; column < width; ++column, ++i) {
      if (column + 1 < width && !across[i]) compare(i, i + 1);
      if (row + 1 < height && !down[i]) compare(i, i + width);
    }
  }
  for (let step = 1; step < reach; ++step) {
    const next = [];
    for (const i of front) {
      const column = i % width, row = (i - column) / width, far = values[source[i]];
      const go = (j) => {
        if (source[j] >= 0 || !(values[j] > far)) return;
        source[j] = source[i];
        next.push(j);
      };
      if (column > 0) go(i - 1);
      if (column + 1 < width) go(i + 1);
      if (row > 0) go(i - width);
      if (row + 1 < height) go(i + width);
    }
    front = next;
  }
  return source;
}

/** The cell that `own` falls on when it is mirrored at the border at which `other` faces it. */
const mirrorOf = (own, other) => (own < other ? 2 * other - own - 1 : own > other ? 2 * other - own + 1 : own);

/** Squares for them. What is there nobody knows: what lies beside the edge, mirrored, looks most like it. */
function fillings(squares, at, values, width, height, source) {
  for (let i = 0; i < source.length; ++i) {
    if (source[i] < 0 || !(values[source[i]] > 0)) continue; // the backdrop is behind everything by itself
    const column = i % width, row = (i - column) / width;
    const otherColumn = source[i] % width, otherRow = (source[i] - otherColumn) / width;
    const far = values[source[i]];
    let u = mirrorOf(column, otherColumn), v = mirrorOf(row, otherRow);
    const there = u >= 0 && u < width && v >= 0 && v < height ? values[v * width + u] : 0;
    if (!(there > 0 && there <= far * mirrorable)) {
      u = otherColumn;
      v = otherRow;
    }
    for (let corner = 0; corner < 4; ++corner, at += 5) {
      const right = corner & 1, lower = corner >> 1;
      squares[at] = (2 * (column + right)) / width - 1;
      squares[at + 1] = 1 - (2 * (row + lower)) / height;
      squares[at + 2] = far;
      squares[at + 3] = (u + (column === otherColumn ? right : 1 - right)) / width;
      squares[at + 4] = (v + (row === otherRow ? lower : 1 - lower)) / height;
    }
  }
  return at;
}

/** What lies behind everything: of each row the colour that it has where nothing else is, from one side to the other. */
function backdrops(squares, at, values, width, height) {
  for (let row = 0; row < height; ++row) {
    const column = values.subarray(row * width, (row + 1) * width).indexOf(0);
    if (column < 0) continue;
    for (let corner = 0; corner < 4; ++corner, at += 5) {
      const y = row + (corner >> 1);
      const isEnd = y === 0 || y === height; // there it goes on outside
      squares[at] = (corner & 1 ? 1 : -1) * (1 + beyond);
      squares[at + 1] = (1 - (2 * y) / height) * (isEnd ? 1 + beyond : 1);
      squares[at + 2] = 0;
      squares[at + 3] = (column + 0.5) / width;
      squares[at + 4] = Math.min(Math.max(y, 0.5), height - 0.5) / height;
    }
  }
  return at;
}

/** All of both: twenty numbers for each square. */
function fillingOf(values, width, height, joints) {
  const source = behindEdges(values, width, height, joints);
  let count = height;
  for (const far of source) count += far < 0 ? 0 : 1;
  const squares = new Float32Array(20 * count);
  const filled = fillings(squares, 0, values, width, height, source);
  return squares.subarray(0, backdrops(squares, filled, values, width, height));
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
  const joints = surfaces(values, width, height);
  return {
    columns: width + 2,
    rows: height + 2,
    nearness: corners(values, width, height, joints),
    filling: fillingOf(values, width, height, joints),
    deepest,
    depths,
  };
}

/** Where the corners of all squares lie, in -1 … 1: x, y, and x, y in the picture (0 … 1 from its top left, mirrored outside). */
export function gridOf(columns, rows) {
  const along = (count) => (i) => (i === 0 ? -1 - beyond : i === count ? 1 + beyond : (2 * (i - 1)) / (count - 2) - 1);
  const [placeX, placeY] = [along(columns), along(rows)];
  const grid = new Float32Array(16 * columns * rows);
  let at = 0;
  for (let row = 0; row < rows; ++row) {
    for (let column = 0; column < columns; ++column) {
      for (let corner = 0; corner < 4; ++corner) {
        const x = placeX(column + (corner & 1)), y = -placeY(row + (corner >> 1));
        grid.set([x, y, (1 + x) / 2, (1 - y) / 2], at);
        at += 4;
      }
    }
  }
  return grid;
}

/** Two triangles for each of `count` squares. */
export function squareIndices(count) {
  const indices = new Uint32Array(6 * count);
  for (let i = 0; i < count; ++i) indices.set([0, 2, 1, 1, 2, 3].map((corner) => 4 * i + corner), 6 * i);
  return indices;
}
