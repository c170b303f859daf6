// Meshes for tests, as arrays and as the bytes of files.

/// A closed ball about the origin, of 4n(n − 1) triangles.
function ball(n, radius) {
  const positions = [0, 0, radius];
  const indices = [];
  for (let i = 1; i < n; ++i)
    for (let j = 0; j < 2 * n; ++j) {
      const [a, b] = [(Math.PI * i) / n, (Math.PI * j) / n];
      positions.push(radius * Math.sin(a) * Math.cos(b), radius * Math.sin(a) * Math.sin(b), radius * Math.cos(a));
    }
  positions.push(0, 0, -radius);
  const at = (i, j) => 1 + (i - 1) * 2 * n + (j % (2 * n));
  const last = positions.length / 3 - 1;
  for (let j = 0; j < 2 * n; ++j) {
    indices.push(0, at(1, j), at(1, j + 1), last, at(n - 1, j + 1), at(n - 1, j));
    for (let i = 1; i + 1 < n; ++i) indices.push(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i, j + 1));
  }
  return { positions, indices };
}

/// An open square of side 1 above the plane z = 2.
function grid(n) {
  const positions = [];
  const indices = [];
  for (let y = 0; y <= n; ++y) for (let x = 0; x <= n; ++x) positions.push(x / n, y / n, 2 + 0.1 * Math.sin((6 * x) / n));
  for (let y = 0; y < n; ++y)
    for (let x = 0; x < n; ++x) {
      const a = y * (n + 1) + x;
      indices.push(a, a + 1, a + n + 2, a, a + n + 2, a + n + 1);
    }
  return { positions, indices };
}

function objOf({ positions, indices }) {
  const lines = [];
  for (let i = 0; i < positions.length; i += 3) lines.push(`v ${positions[i]} ${positions[i + 1]} ${positions[i + 2]}`);
  for (let i = 0; i < indices.length; i += 3) lines.push(`f ${indices[i] + 1} ${indices[i + 1] + 1} ${indices[i + 2] + 1}`);
  return `${lines.join('\n')}\n`;
}

/// Binary STL.
function stlOf({ positions, indices }) {
  const bytes = Buffer.alloc(84 + (50 * indices.length) / 3);
  bytes.writeUInt32LE(indices.length / 3, 80);
  for (let f = 0; f < indices.length / 3; ++f)
    for (let corner = 0; corner < 3; ++corner)
      for (let k = 0; k < 3; ++k) bytes.writeFloatLE(positions[3 * indices[3 * f + corner] + k], 84 + 50 * f + 12 + 12 * corner + 4 * k);
  return bytes;
}

function areaOf({ positions, indices }) {
  let area = 0;
  for (let i = 0; i < indices.length; i += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => positions.slice(3 * indices[i + k], 3 * indices[i + k] + 3));
    const [u, v] = [b, c].map((p) => p.map((x, k) => x - a[k]));
    area += Math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]) / 2;
  }
  return area;
}

module.exports = { areaOf, ball, grid, objOf, stlOf };
