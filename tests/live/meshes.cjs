// Meshes for tests, as arrays and as the bytes of files.
const { deflateSync } = require('zlib');

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

/// GLB. `colors`: three numbers a vertex, in linear light. `uvs` with `png`: a texture. `targets`: displacements of morph targets, which
/// an animation adds one after the other, a second each; `turns`: one that moves the node instead.
function glbOf({ positions, indices, colors, uvs, png, targets = [], turns = false }) {
  const views = [];
  const accessors = [];
  const chunks = [];
  let length = 0;
  const addView = (data) => {
    const bytes = Buffer.from(data.buffer, data.byteOffset, data.byteLength);
    const padded = Buffer.concat([bytes, Buffer.alloc((4 - (bytes.length % 4)) % 4)]);
    chunks.push(padded);
    length += padded.length;
    return views.push({ buffer: 0, byteOffset: length - padded.length, byteLength: bytes.length }) - 1;
  };
  const add = (data, type, size) => {
    const ends = type === 'VEC3' || type === 'SCALAR' ? { min: [], max: [] } : {};
    for (let k = 0; ends.min && k < size; ++k) {
      const values = [...data].filter((_, i) => i % size === k);
      ends.min.push(values.reduce((a, b) => Math.min(a, b)));
      ends.max.push(values.reduce((a, b) => Math.max(a, b)));
    }
    return accessors.push({ bufferView: addView(data), componentType: data instanceof Uint32Array ? 5125 : 5126, count: data.length / size, type, ...ends }) - 1;
  };
  const vec3 = (values) => add(Float32Array.from(values), 'VEC3', 3);
  const primitive = { attributes: { POSITION: vec3(positions) }, indices: add(Uint32Array.from(indices), 'SCALAR', 1) };
  if (colors) primitive.attributes.COLOR_0 = vec3(colors);
  if (uvs) primitive.attributes.TEXCOORD_0 = add(Float32Array.from(uvs), 'VEC2', 2);
  const json = { asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0 }], meshes: [{ primitives: [primitive] }] };
  if (png) {
    primitive.material = 0;
    json.materials = [{ pbrMetallicRoughness: { baseColorTexture: { index: 0 } } }];
    json.textures = [{ source: 0 }];
    json.images = [{ bufferView: addView(png), mimeType: 'image/png' }];
  }
  const animate = (path, times, values, type, size) =>
    (json.animations = [{ samplers: [{ input: add(Float32Array.from(times), 'SCALAR', 1), output: add(Float32Array.from(values), type, size) }], channels: [{ sampler: 0, target: { node: 0, path } }] }]);
  if (targets.length > 0) {
    primitive.targets = targets.map((displacements) => ({ POSITION: vec3(displacements) }));
    const keys = targets.length + 1;
    animate('weights', Array.from({ length: keys }, (_, k) => k), Array.from({ length: keys * targets.length }, (_, i) => (Math.floor(i / targets.length) > i % targets.length ? 1 : 0)), 'SCALAR', 1);
  }
  if (turns) animate('translation', [0, 1], [0, 0, 0, 1, 0, 0], 'VEC3', 3);
  Object.assign(json, { buffers: [{ byteLength: length }], bufferViews: views, accessors });
  const text = Buffer.from(JSON.stringify(json));
  const padded = Buffer.concat([text, Buffer.alloc((4 - (text.length % 4)) % 4, ' ')]);
  const head = Buffer.from(Uint32Array.of(0x46546c67, 2, 28 + padded.length + length, padded.length, 0x4e4f534a).buffer);
  return Buffer.concat([head, padded, Buffer.from(Uint32Array.of(length, 0x004e4942).buffer), ...chunks]);
}

/// PNG of red, green and blue of each pixel, by a function of its place from 0 to 1.
function pngOf(width, height, color) {
  const rows = Buffer.alloc(height * (1 + 3 * width));
  for (let y = 0; y < height; ++y)
    for (let x = 0; x < width; ++x) color((x + 0.5) / width, (y + 0.5) / height).forEach((c, k) => (rows[y * (1 + 3 * width) + 1 + 3 * x + k] = c));
  const crcOf = (bytes) => {
    let crc = -1;
    for (const byte of bytes) {
      crc ^= byte;
      for (let k = 0; k < 8; ++k) crc = (crc >>> 1) ^ (crc & 1 ? 0xedb88320 : 0);
    }
    return ~crc >>> 0;
  };
  const chunk = (type, data) => {
    const bytes = Buffer.concat([Buffer.from(type), data]);
    const ends = Buffer.alloc(8);
    ends.writeUInt32BE(data.length, 0);
    ends.writeUInt32BE(crcOf(bytes), 4);
    return Buffer.concat([ends.subarray(0, 4), bytes, ends.subarray(4)]);
  };
  const header = Buffer.from([0, 0, 0, 0, 0, 0, 0, 0, 8, 2, 0, 0, 0]);
  header.writeUInt32BE(width, 0);
  header.writeUInt32BE(height, 4);
  return Buffer.concat([Buffer.from([0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]), chunk('IHDR', header), chunk('IDAT', deflateSync(rows)), chunk('IEND', Buffer.alloc(0))]);
}

module.exports = { areaOf, ball, glbOf, grid, objOf, pngOf, stlOf };
