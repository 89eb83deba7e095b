// Seeded random cameras for tests.

/** mulberry32: small, and the same numbers everywhere. */
export function random(seed) {
  let state = seed >>> 0;
  return () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let t = Math.imul(state ^ (state >>> 15), state | 1);
    t ^= t + Math.imul(t ^ (t >>> 7), t | 61);
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

export function manyCameras(count = 60, seed = 1) {
  const next = random(seed);
  return Array.from({ length: count }, (_, i) => ({
    target: [next() * 200 - 100, next() * 200 - 100, next() * 50],
    azimuth: next() * 6 - 3,
    elevation: next() * 3 - 1.5,
    distance: 10 ** (next() * 4 - 1),
    fov: 20 + next() * 80,
    projection: i % 2 ? 'orthographic' : 'perspective',
    upAxis: i % 3 === 2 ? (i % 4 < 2 ? 'y' : '-y') : 'z',
  }));
}
