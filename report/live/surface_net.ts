// The surface where a function is zero: S. F. F. Gibson, "Constrained Elastic Surface Nets" (1998), without the relaxation.
type Point = [number, number, number];

export function surfaceNet(
  f: (x: number, y: number, z: number) => number,
  lo: Point,
  hi: Point,
  spacing: number,
) {
  const n = lo.map((x, k) => Math.ceil((hi[k] - x) / spacing) + 1);
  const values = new Float64Array(n[0] * n[1] * n[2]);
  const at = (x: number, y: number, z: number) => (z * n[1] + y) * n[0] + x;
  for (let z = 0; z < n[2]; ++z)
    for (let y = 0; y < n[1]; ++y)
      for (let x = 0; x < n[0]; ++x)
        values[at(x, y, z)] = f(lo[0] + spacing * x, lo[1] + spacing * y, lo[2] + spacing * z);
  const vertexOf = new Int32Array(values.length).fill(-1); // of the cell at each corner
  const positions: number[] = [];
  const offsets = Array.from({ length: 8 }, (_, c) => at(c & 1, (c >> 1) & 1, c >> 2));
  for (let z = 0; z + 1 < n[2]; ++z)
    for (let y = 0; y + 1 < n[1]; ++y)
      for (let x = 0; x + 1 < n[0]; ++x) {
        const cell = at(x, y, z);
        const middle = middleOf(offsets.map((offset) => values[cell + offset]));
        if (middle)
          vertexOf[cell] =
            positions.push(...middle.map((u, k) => lo[k] + spacing * ([x, y, z][k] + u))) / 3 - 1;
      }
  // A quadrilateral of the four cells around each edge that crosses the surface.
  const indices: number[] = [];
  const step = [1, n[0], n[0] * n[1]];
  for (let z = 1; z + 1 < n[2]; ++z)
    for (let y = 1; y + 1 < n[1]; ++y)
      for (let x = 1; x + 1 < n[0]; ++x)
        for (let k = 0; k < 3; ++k) {
          const i = at(x, y, z);
          const inside = values[i] < 0;
          if (inside === values[i + step[k]] < 0) continue;
          const [u, v] = [step[(k + 1) % 3], step[(k + 2) % 3]];
          const [a, b, c, d] = [i - u - v, i - v, i, i - u].map((cell) => vertexOf[cell]);
          indices.push(...(inside ? [a, b, c, a, c, d] : [a, c, b, a, d, c]));
        }
  return { positions: Float64Array.from(positions), indices: Uint32Array.from(indices) };
}

/// The mean of where the edges of a cell cross the surface, in units of the cell; null if none does.
function middleOf(values: number[]): Point | null {
  const sum: Point = [0, 0, 0];
  let count = 0;
  for (let a = 0; a < 8; ++a)
    for (let k = 0; k < 3; ++k) {
      const b = a | (1 << k);
      if (a === b || values[a] < 0 === values[b] < 0) continue;
      const t = values[a] / (values[a] - values[b]);
      for (let j = 0; j < 3; ++j) sum[j] += ((a >> j) & 1) + (j === k ? t : 0);
      ++count;
    }
  return count === 0 ? null : (sum.map((x) => x / count) as Point);
}
