// What lies behind the edges of a frame's depth, so that nothing tears when the nearer side moves away: the farther side goes on
// there, as nobody has seen it. And behind everything the backdrop, which stays where it is on screen. Pure.

import { beyond } from './mesh_triangles.js';

const reach = { least: 1.5, most: 10, share: 16 }; // cells that are filled behind an edge: the more, the farther apart both sides are
const mirrorable = 1.1; // of the farther nearness: what is nearer is of something else

/**
 * For each cell near an edge on the nearer side, the cell on the farther side whose surface goes on behind it; else -1.
 * @param {number} usual nearness of the scene
 */
function behindEdges(values, width, height, { across, down }, usual) {
  const source = new Int32Array(width * height).fill(-1);
  const left = new Float32Array(width * height); // cells that it still goes on from there
  let front = [];
  const offer = (near, far) => {
    if (source[near] < 0) front.push(near);
    if (source[near] >= 0 && !(values[far] < values[source[near]])) return;
    source[near] = far;
    left[near] = Math.min(reach.most, reach.least + (reach.share * (values[near] - values[far])) / usual);
  };
  const compare = (i, j) => (values[i] > values[j] ? offer(i, j) : offer(j, i));
  for (let row = 0, i = 0; row < height; ++row) {
    for (let column = 0; column < width; ++column, ++i) {
      if (column + 1 < width && !across[i]) compare(i, i + 1);
      if (row + 1 < height && !down[i]) compare(i, i + width);
    }
  }
  while (front.length > 0) {
    const next = [];
    for (const i of front) {
      if (left[i] < 2) continue;
      const column = i % width, row = (i - column) / width, far = values[source[i]];
      const go = (j) => {
        if (source[j] >= 0 || !(values[j] > far)) return;
        source[j] = source[i];
        left[j] = left[i] - 1;
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

/** From each edge's nearer side to its farther one, in the colours of the latter: for gaps that are wider than what is filled. */
function bridges(squares, at, mesh, values, width, height, { across, down }) {
  const { nearness, columns } = mesh;
  const corner = (row, column, which) => nearness[4 * ((row + 1) * columns + column + 1) + which];
  const vertex = (x, y, near, u, v) => {
    squares[at] = (2 * x) / width - 1;
    squares[at + 1] = 1 - (2 * y) / height;
    squares[at + 2] = near;
    squares[at + 3] = u / width;
    squares[at + 4] = v / height;
    at += 5;
  };
  for (let row = 0, i = 0; row < height; ++row) {
    for (let column = 0; column < width; ++column, ++i) {
      if (column + 1 < width && !across[i] && values[i] > 0 && values[i + 1] > 0) {
        const x = column + 1, u = values[i] < values[i + 1] ? column + 0.5 : column + 1.5;
        for (let y = row; y <= row + 1; ++y) {
          vertex(x, y, corner(row, column, y === row ? 1 : 3), u, y);
          vertex(x, y, corner(row, column + 1, y === row ? 0 : 2), u, y);
        }
      }
      if (row + 1 < height && !down[i] && values[i] > 0 && values[i + width] > 0) {
        const y = row + 1, v = values[i] < values[i + width] ? row + 0.5 : row + 1.5;
        for (let x = column; x <= column + 1; ++x) {
          vertex(x, y, corner(row, column, x === column ? 2 : 3), x, v);
          vertex(x, y, corner(row + 1, column, x === column ? 0 : 1), x, v);
        }
      }
    }
  }
  return at;
}

/**
 * Squares behind edges, bridges across them, and what is behind everything, each drawn where nothing is that comes before it. Twenty
 * numbers a square: of the corners above left, above right, below left and below right their place in -1 … 1, their nearness
 * (depth_mesh.js), and the place in the picture (0 … 1 from its top left) of what is seen there.
 * @returns {{ squares: Float32Array, behind: number, across: number, backdrop: number }} how many there are of each
 */
export function fillingOf(values, width, height, joints, usual, mesh) {
  const source = behindEdges(values, width, height, joints, usual);
  let most = height;
  for (let i = 0; i < source.length; ++i) {
    most += source[i] < 0 ? 0 : 1;
    most += (joints.across[i] ? 0 : 1) + (joints.down[i] ? 0 : 1);
  }
  const squares = new Float32Array(20 * most);
  const first = fillings(squares, 0, values, width, height, source);
  const second = bridges(squares, first, mesh, values, width, height, joints);
  const third = backdrops(squares, second, values, width, height);
  return { squares: squares.subarray(0, third), behind: first / 20, across: (second - first) / 20, backdrop: (third - second) / 20 };
}
