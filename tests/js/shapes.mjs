// Meshes for tests, in Node and in pages.

/** A closed grid on a sphere about the origin, of 4·n·(n − 1) faces. */
export function ball(n, radius = 1) {
  const positions = [0, 0, radius], indices = [];
  for (let i = 1; i < n; ++i)
    for (let j = 0; j < 2 * n; ++j) {
      const a = (Math.PI * i) / n, b = (Math.PI * j) / n;
      positions.push(radius * Math.sin(a) * Math.cos(b), radius * Math.sin(a) * Math.sin(b), radius * Math.cos(a));
    }
  positions.push(0, 0, -radius);
  const at = (i, j) => 1 + (i - 1) * 2 * n + (j % (2 * n)), last = positions.length / 3 - 1;
  for (let j = 0; j < 2 * n; ++j) {
    indices.push(0, at(1, j), at(1, j + 1), last, at(n - 1, j + 1), at(n - 1, j));
    for (let i = 1; i + 1 < n; ++i) indices.push(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i, j + 1));
  }
  return { positions: Float64Array.from(positions), indices: Uint32Array.from(indices) };
}
