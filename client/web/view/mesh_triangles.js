// The triangles of a depth mesh (depth_mesh.js): few where a surface is flat, because each costs time where there is no
// graphics processor. Squares lie in rows; those at the border reach beyond the picture. Pure.

/** Of half the picture: by so much its border goes on outside. */
export const beyond = 0.5;

const sides = [4, 2, 1]; // of what becomes one square, the largest first

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

/** Whether `side` × `side` squares from there on are one plane, so nearly that they may be drawn as one. */
function isFlat(nearness, columns, column, row, side, tolerance) {
  const corner = (x, y) => nearness[4 * ((row + Math.min(y, side - 1)) * columns + column + Math.min(x, side - 1)) + (x === side ? 1 : 0) + (y === side ? 2 : 0)];
  const a = corner(0, 0), b = corner(side, 0), c = corner(0, side), d = corner(side, side);
  if (!(a > 0 && b > 0 && c > 0 && d > 0)) return false;
  for (let y = 0; y < side; ++y) {
    for (let x = 0; x < side; ++x) {
      const square = 4 * ((row + y) * columns + column + x);
      for (let k = 0; k < 4; ++k) {
        const s = (x + (k & 1)) / side, t = (y + (k >> 1)) / side;
        const expected = (a * (1 - s) + b * s) * (1 - t) + (c * (1 - s) + d * s) * t;
        if (!(Math.abs(nearness[square + k] - expected) <= tolerance)) return false;
      }
    }
  }
  return true;
}

/** Which squares become one: for each the side of that one, and 0 where the backdrop is seen, which is not drawn here. */
function sizesOf(nearness, columns, rows, tolerance) {
  const sizes = new Uint8Array(columns * rows);
  for (let i = 0; i < sizes.length; ++i) sizes[i] = nearness[4 * i] > 0 ? 1 : 0;
  for (const side of sides.slice(0, -1)) {
    // Those at the border are larger already.
    for (let row = 1; row + side < rows; row += side) {
      for (let column = 1; column + side < columns; column += side) {
        if (sizes[row * columns + column] !== 1) continue;
        if (!isFlat(nearness, columns, column, row, side, tolerance)) continue;
        for (let y = 0; y < side; ++y) sizes.fill(side, (row + y) * columns + column, (row + y) * columns + column + side);
      }
    }
  }
  return sizes;
}

/**
 * Three corners for each triangle, each 4 · square + (0: above left, 1: above right, 2: below left, 3: below right).
 * @param {Float32Array} nearness of these corners; 0 = backdrop, which has no triangles
 * @param {number} tolerance of nearness: by so much a triangle may leave the squares that it stands for
 */
export function trianglesOf(nearness, columns, rows, tolerance) {
  const sizes = sizesOf(nearness, columns, rows, tolerance);
  const indices = new Uint32Array(6 * columns * rows);
  let count = 0;
  const triangle = (a, b, c) => {
    indices[count] = a;
    indices[count + 1] = b;
    indices[count + 2] = c;
    count += 3;
  };
  const ring = new Int32Array(16);
  for (let row = 0; row < rows; ++row) {
    for (let column = 0; column < columns; ++column) {
      const side = sizes[row * columns + column];
      if (side === 0 || (side > 1 && ((row - 1) % side !== 0 || (column - 1) % side !== 0))) continue;
      const square = (x, y) => 4 * ((row + y) * columns + column + x);
      const last = side - 1;
      if (side === 1) {
        const own = square(0, 0);
        triangle(own, own + 2, own + 1);
        triangle(own + 1, own + 2, own + 3);
        continue;
      }
      // Where a neighbour has corners between its own, it has them, too: else there would be cracks.
      let corners = 0;
      const size = (x, y) => sizes[(row + y) * columns + column + x] || side;
      for (let x = 0; x < side; ++x) if (x % Math.min(side, size(x, -1)) === 0) ring[corners++] = square(x, 0);
      for (let y = 0; y < side; ++y) if (y % Math.min(side, size(side, y)) === 0) ring[corners++] = square(last, y) + 1;
      for (let x = last; x >= 0; --x) if ((x + 1) % Math.min(side, size(x, side)) === 0) ring[corners++] = square(x, last) + 3;
      for (let y = last; y >= 0; --y) if ((y + 1) % Math.min(side, size(-1, y)) === 0) ring[corners++] = square(0, y) + 2;
      if (corners === 4) {
        triangle(ring[0], ring[3], ring[1]);
        triangle(ring[1], ring[3], ring[2]);
        continue;
      }
      const middle = square(side / 2, side / 2);
      for (let i = 0; i < corners; ++i) triangle(middle, ring[i], ring[(i + 1) % corners]);
    }
  }
  return indices.subarray(0, count);
}

/** Two triangles for each of `count` squares. */
export function squareIndices(count) {
  const indices = new Uint32Array(6 * count);
  for (let i = 0; i < count; ++i) indices.set([0, 2, 1, 1, 2, 3].map((corner) => 4 * i + corner), 6 * i);
  return indices;
}
