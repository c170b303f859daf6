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

/// The buffers and accessors of a GLB. Members return the index of what they add.
class Glb {
  constructor() {
    [this.views, this.accessors, this.chunks, this.length] = [[], [], [], 0];
  }
  view(data) {
    const bytes = Buffer.from(data.buffer, data.byteOffset, data.byteLength);
    const padded = Buffer.concat([bytes, Buffer.alloc((4 - (bytes.length % 4)) % 4)]);
    this.chunks.push(padded);
    this.length += padded.length;
    return this.views.push({ buffer: 0, byteOffset: this.length - padded.length, byteLength: bytes.length }) - 1;
  }
  add(data, type, size) {
    const ends = type === 'VEC3' || type === 'SCALAR' ? { min: [], max: [] } : {};
    for (let k = 0; ends.min && k < size; ++k) {
      const values = [...data].filter((_, i) => i % size === k);
      ends.min.push(values.reduce((a, b) => Math.min(a, b)));
      ends.max.push(values.reduce((a, b) => Math.max(a, b)));
    }
    const componentType = data instanceof Uint32Array ? 5125 : data instanceof Uint8Array ? 5121 : 5126;
    return this.accessors.push({ bufferView: this.view(data), componentType, count: data.length / size, type, ...ends }) - 1;
  }
  floats(values, type, size) { return this.add(Float32Array.from(values), type, size); }
  vec3(values) { return this.floats(values, 'VEC3', 3); }
  primitive({ positions, indices }) {
    return { attributes: { POSITION: this.vec3(positions) }, indices: this.add(Uint32Array.from(indices), 'SCALAR', 1) };
  }
  /// `channels`: [node, path, times, values, interpolation] each.
  animation(channels) {
    const columns = { rotation: ['VEC4', 4], weights: ['SCALAR', 1] };
    const samplers = channels.map(([, path, times, values, interpolation = 'LINEAR']) => ({
      input: this.floats(times, 'SCALAR', 1), output: this.floats(values, ...(columns[path] ?? ['VEC3', 3])), interpolation,
    }));
    return { samplers, channels: channels.map(([node, path], sampler) => ({ sampler, target: { node, path } })) };
  }
  bytes(json) {
    const { views, accessors, chunks, length } = this;
    const text = Buffer.from(JSON.stringify({ asset: { version: '2.0' }, ...json, buffers: [{ byteLength: length }], bufferViews: views, accessors }));
    const padded = Buffer.concat([text, Buffer.alloc((4 - (text.length % 4)) % 4, ' ')]);
    const head = Buffer.from(Uint32Array.of(0x46546c67, 2, 28 + padded.length + length, padded.length, 0x4e4f534a).buffer);
    return Buffer.concat([head, padded, Buffer.from(Uint32Array.of(length, 0x004e4942).buffer), ...chunks]);
  }
}

/// GLB. `colors`: three numbers a vertex, in linear light. `uvs` with `png`: a texture. `targets`: displacements of morph targets, which
/// an animation adds one after the other, a second each; `channels`: of an animation of node 0 in its place, see Glb.
function glbOf({ positions, indices, colors, uvs, png, targets = [], channels = [] }) {
  const glb = new Glb();
  const primitive = glb.primitive({ positions, indices });
  if (colors) primitive.attributes.COLOR_0 = glb.vec3(colors);
  if (uvs) primitive.attributes.TEXCOORD_0 = glb.floats(uvs, 'VEC2', 2);
  const json = { scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0 }], meshes: [{ primitives: [primitive] }] };
  if (png) {
    primitive.material = 0;
    json.materials = [{ pbrMetallicRoughness: { baseColorTexture: { index: 0 } } }];
    json.textures = [{ source: 0 }];
    json.images = [{ bufferView: glb.view(png), mimeType: 'image/png' }];
  }
  if (targets.length > 0) {
    primitive.targets = targets.map((displacements) => ({ POSITION: glb.vec3(displacements) }));
    const keys = targets.length + 1;
    channels = [[0, 'weights', Array.from({ length: keys }, (_, k) => k), Array.from({ length: keys * targets.length }, (_, i) => (Math.floor(i / targets.length) > i % targets.length ? 1 : 0))]];
  }
  if (channels.length > 0) json.animations = [glb.animation(channels)];
  return glb.bytes(json);
}

/// A closed bar along x from 0 to `length`, in n pieces.
function bar(n, length) {
  const positions = [];
  const indices = [];
  const quad = (a, b, c, d) => indices.push(a, b, c, a, c, d);
  for (let i = 0; i <= n; ++i) for (const [y, z] of [[0, 0], [0.5, 0], [0.5, 0.5], [0, 0.5]]) positions.push((i * length) / n, y, z);
  quad(3, 2, 1, 0);
  for (let i = 0; i < 4 * n; i += 4) for (let k = 0; k < 4; ++k) quad(i + k, i + ((k + 1) % 4), i + 4 + ((k + 1) % 4), i + 4 + k);
  quad(4 * n, 4 * n + 1, 4 * n + 2, 4 * n + 3);
  return { positions, indices };
}

/// GLB of a skeleton of two joints that move in every way, with a bar as its skin, which has a morph target, and a ball in its hand.
function skeletonOf(ball) {
  const glb = new Glb();
  const skin = bar(8, 2);
  const primitive = glb.primitive(skin);
  const ofVertices = (numbers) => Array.from({ length: skin.positions.length / 3 }, (_, v) => numbers(skin.positions[3 * v] / 2)).flat();
  primitive.attributes.JOINTS_0 = glb.add(Uint8Array.from(ofVertices(() => [0, 1, 0, 0])), 'VEC4', 4);
  primitive.attributes.WEIGHTS_0 = glb.floats(ofVertices((x) => [1 - x, x, 0, 0]), 'VEC4', 4);
  primitive.targets = [{ POSITION: glb.vec3(skin.positions.map((x, i) => (i % 3 === 1 ? x : 0))) }];
  const bind = (x) => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -x, 0, 0, 1];
  const inverseBindMatrices = glb.floats([...bind(0), ...bind(1)], 'MAT4', 16);
  const turn = (x, y, z, angle) => [...[x, y, z].map((k) => (k * Math.sin(angle / 2)) / Math.hypot(x, y, z)), Math.cos(angle / 2)];
  const none = [0, 0, 0, 0];
  const channels = [
    [0, 'translation', [0, 1], [5, 5, 5, 6, 6, 6]], // which does not move the skin
    [0, 'weights', [0.2, 0.9], [0, 1]],
    [1, 'translation', [0, 1, 2], [0, 0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0.5, 0, 0, 0, -1, 1, 0, 0, 1, 1, 1, 1, 0, 0, 0], 'CUBICSPLINE'],
    [1, 'scale', [0, 0.7, 2], [1, 1, 1, 1.5, 1, 0.8, 0.5, 2, 1], 'STEP'],
    [2, 'rotation', [0, 0.5, 1.5, 2], [...turn(0, 0, 1, 0), ...turn(0, 1, 1, 2), ...turn(0, 1, 1, 2.5).map((q) => -q), ...turn(1, 0, 0, 1)]],
    [3, 'rotation', [0, 2], [...none, ...turn(0, 1, 0, 0), 0.3, 0, 0.1, 0, 0, 0.4, 0, -0.2, ...turn(1, 1, 0, 2), ...none], 'CUBICSPLINE'],
    [3, 'scale', [0.5, 1.5], [1, 1, 1, 2, 2, 0.5]],
  ];
  const animation = glb.animation(channels);
  return glb.bytes({
    scene: 0, scenes: [{ nodes: [0, 1] }],
    nodes: [{ mesh: 0, skin: 0 }, { children: [2], rotation: turn(0, 0, 1, 0.4) }, { children: [3], translation: [1, 0, 0] }, { mesh: 1, translation: [1.2, 0.2, 0] }],
    meshes: [{ primitives: [primitive] }, { primitives: [glb.primitive(ball)] }],
    skins: [{ joints: [1, 2], inverseBindMatrices }],
    animations: [animation],
  });
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

module.exports = { areaOf, ball, glbOf, grid, objOf, pngOf, skeletonOf, stlOf };
