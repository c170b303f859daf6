// Mesh files, summaries and reports: the module `full`. SDM_PACKAGE: the folder of the package.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { ball } from './shapes.mjs';

const package_ = (file) => import(pathToFileURL(join(process.env.SDM_PACKAGE, file)));
const { createWorker, start } = await package_('node.js');
const sdm = await start({ full: true });
const text = (lines) => new TextEncoder().encode(lines);

const cube = { positions: [], indices: [0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5] };
for (let i = 0; i < 8; ++i) cube.positions.push(i & 1, (i >> 1) & 1, i >> 2);
const point = (i) => cube.positions.slice(3 * i, 3 * i + 3);
const faces = Array.from({ length: 12 }, (_, f) => cube.indices.slice(3 * f, 3 * f + 3));

function binaryStl() {
  const view = new DataView(new ArrayBuffer(84 + 50 * 12));
  view.setUint32(80, 12, true);
  faces.forEach((face, f) => face.flatMap(point).forEach((x, k) => view.setFloat32(84 + 50 * f + 12 + 4 * k, x, true)));
  return new Uint8Array(view.buffer);
}
const buffer = () => new Uint8Array([...new Uint8Array(Float32Array.from(cube.positions).buffer), ...new Uint8Array(Uint16Array.from(cube.indices).buffer)]);
const gltf = (uri) => ({
  asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0 }],
  meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 1 }] }],
  buffers: [{ byteLength: 168, ...(uri ? { uri } : {}) }],
  bufferViews: [{ buffer: 0, byteLength: 96 }, { buffer: 0, byteOffset: 96, byteLength: 72 }],
  accessors: [
    { bufferView: 0, componentType: 5126, count: 8, type: 'VEC3', min: [0, 0, 0], max: [1, 1, 1] },
    { bufferView: 1, componentType: 5123, count: 36, type: 'SCALAR' },
  ],
});
function glb() {
  let json = JSON.stringify(gltf());
  json += ' '.repeat((4 - (json.length % 4)) % 4);
  const head = new Uint32Array([0x46546c67, 2, 28 + json.length + 168, json.length, 0x4e4f534a]), chunk = new Uint32Array([168, 0x004e4942]);
  return new Uint8Array([...new Uint8Array(head.buffer), ...text(json), ...new Uint8Array(chunk.buffer), ...buffer()]);
}
const vertices = Array.from({ length: 8 }, (_, i) => point(i).join(' '));
const files = {
  'a.stl': binaryStl(),
  'text.stl': text(`solid\n${faces.map((f) => `facet normal 0 0 0 outer loop ${f.map((i) => `vertex ${vertices[i]}`).join(' ')} endloop endfacet`).join('\n')}\nendsolid\n`),
  'a.ply': text(`ply\nformat ascii 1.0\nelement vertex 8\nproperty double x\nproperty double y\nproperty double z\nelement face 12\nproperty list uchar int vertex_indices\nend_header\n${vertices.join('\n')}\n${faces.map((f) => `3 ${f.join(' ')}`).join('\n')}\n`),
  'a.obj': text(`${vertices.map((v) => `v ${v}`).join('\n')}\n${faces.map((f, i) => `${i % 6 === 0 ? `g part${i / 6}\n` : ''}f ${f.map((v) => v + 1).join(' ')}`).join('\n')}\n`),
  'a.off': text(`OFF\n8 12 0\n${vertices.join('\n')}\n${faces.map((f) => `3 ${f.join(' ')}`).join('\n')}\n`),
  'a.glb': glb(),
  'a.gltf': text(JSON.stringify(gltf('parts/a.bin'))),
};

// Regression: Node warned of `new Buffer()`.
test('a Buffer of Node is read as its bytes', async () => {
  const warnings = [];
  const note = (warning) => warnings.push(warning.message);
  process.on('warning', note);
  const { positions } = sdm.readMesh(Buffer.from(binaryStl()), 'cube.stl');
  await new Promise((resolve) => setImmediate(resolve));
  process.off('warning', note);
  assert.deepEqual([positions.length, warnings], [24, []]);
});

for (const [name, bytes] of Object.entries(files))
  test(`reads ${name}`, () => {
    const mesh = sdm.readMesh(bytes, name, name === 'a.gltf' ? { files: { 'parts/a.bin': buffer() } } : {});
    assert.deepEqual([mesh.positions.length, mesh.indices.length], [24, 36]);
    const sites = new sdm.Sites(mesh.positions, mesh.indices);
    assert.ok(sites.closed && sites.orientable);
    assert.deepEqual([...sites.signedDistance([0.5, 0.5, 0.5, 3, 0.5, 0.5]).distances], [-0.5, 2]);
    assert.match(mesh.xxh3, /^[0-9a-f]{16}$/);
    assert.deepEqual(mesh.notes, []);
    if (name !== 'a.obj') return;
    assert.deepEqual(mesh.names.map(({ kind, names }) => [kind, names]), [['group', ['part0', 'part1']]]);
    assert.deepEqual([...mesh.names[0].ofFace], [0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1]);
  });

test('a damaged file is one sentence that names it', () => {
  const fails = (bytes, name, message) => assert.throws(() => sdm.readMesh(bytes, name), (error) =>
    error.kind === 'input' && error.message.startsWith(`${name}: `) && message.test(error.message) && !error.message.includes('\n'));
  fails(new Uint8Array(), 'empty.stl', /empty/);
  fails(binaryStl().slice(0, 300), 'cut.stl', /truncated|triangles/);
  fails(glb().slice(0, 400), 'cut.glb', /truncated|bytes/);
  fails(files['a.gltf'], 'a.gltf', /give it with the option `files`/);
  fails(text(JSON.stringify(gltf('../a.bin'))), 'b.gltf', /refused/);
  fails(text('hello'), 'hello.txt', /unknown format; glTF, GLB, STL, PLY, OFF, OBJ, 3DS are supported/);
  fails(text('ISO-10303-21;\nEND-ISO-10303-21;'), 'a.step', /command and the Python package/);
  fails(text('v 0 0 0\nf 1 2 3\n'), 'a.obj', /vertex/);
  // After faults, all others are read as before.
  assert.equal(sdm.readMesh(files['a.off'], 'a.off').indices.length, 36);
});

test('other modules say what is needed', async () => {
  const core = await start({ threads: 1 });
  const body = { positions: cube.positions, indices: cube.indices }, message = /full: true/;
  assert.throws(() => core.readMesh(files['a.off'], 'a.off'), { kind: 'input', message });
  assert.throws(() => new core.Pair(body, body), { kind: 'input', message });
});

test('summaries and reports have the verdict', { timeout: 120000 }, async () => {
  const worker = await createWorker({ full: true });
  const part = ball(30), other = ball(30, 0.9);
  const surface = await worker.surface(part.positions, part.indices, { resolution: 256 });
  const map = await surface.map(await worker.sites(other.positions, other.indices));
  const options = { units: 'mm', names: ['part <1>.stl', 'nominal.stl'], xxh3: ['0123456789abcdef', ''] };
  const summary = await map.summary({ ...options, tolerance: [-0.2, 0.2] });
  assert.equal(summary.tolerance.verdict, 'PASS');
  assert.equal(summary.o1.file, 'part <1>.stl');
  assert.ok(summary.distance.min > 0.09 && summary.distance.max < 0.11);
  assert.equal((await map.summary({ tolerance: [-0.05, 0.05] })).tolerance.verdict, 'FAIL');
  assert.deepEqual((await map.summary({ tolerance: 0.05 })).tolerance, (await map.summary({ tolerance: [-0.05, 0.05] })).tolerance);
  assert.deepEqual((await map.summary({ tolerance: '-0.05:0.05' })).tolerance, (await map.summary({ tolerance: 0.05 })).tolerance);
  assert.equal((await map.summary({ tolerance: [0.05, Infinity] })).tolerance.verdict, 'PASS');
  assert.ok((await map.summary({ bands: [0, 0.05, 0.2] })).bands.some(({ upper }) => upper === 0.05));
  await assert.rejects(map.summary({ tolerance: [1, -1] }), { kind: 'input' });
  await assert.rejects(map.summary({ tolerance: [NaN, 1] }), { kind: 'input', message: /tolerance is/ });
  await assert.rejects(map.summary({ tolerance: [1] }), { kind: 'input', message: /^tolerance is 1: it must be / });
  await assert.rejects(map.summary({ names: ['one'] }), { kind: 'input', message: /two strings/ });
  const html = await map.report({ ...options, tolerance: [-0.2, 0.2] });
  const json = (id) => JSON.parse(html.match(new RegExp(`<script type="application/json" id="${id}">(.*?)</script>`, 's'))[1]);
  assert.deepEqual(json('report').tolerance, summary.tolerance);
  worker.terminate();
});

test('objects that are disposed of while a report waits for its page are refused', { timeout: 120000 }, async () => {
  const { positions, indices } = ball(20);
  const surface = new sdm.Surface(positions, indices, { resolution: 128 }), sites = new sdm.Sites(positions, indices);
  const map = surface.map(sites), report = map.report();
  map.dispose();
  await assert.rejects(report, { kind: 'input', message: /disposed/ });
});

test('a page that is none is refused', { timeout: 120000 }, async () => {
  const other = await start({ full: true, reportPage: '<html></html>' }), { positions, indices } = ball(8);
  const map = new other.Surface(positions, indices, { resolution: 64 }).map(new other.Sites(positions, indices));
  await assert.rejects(map.report(), { kind: 'input', message: /reportPage/ });
});

test('a mesh file in a Buffer is read, and stays', { timeout: 120000 }, async () => {
  const worker = await createWorker({ full: true }), stl = Buffer.from(files['a.stl']), parts = { 'parts/a.bin': Buffer.from(buffer()) };
  for (let i = 0; i < 2; ++i) {
    assert.equal((await worker.readMesh(stl, 'a.stl')).indices.length, 36);
    assert.equal((await worker.readMesh(Buffer.from(files['a.gltf']), 'a.gltf', { files: parts })).indices.length, 36);
  }
  assert.deepEqual([stl.length, parts['parts/a.bin'].length], [files['a.stl'].length, 168]);
  worker.terminate();
});

test('a note on the sizes of the meshes is given once', async () => {
  const small = ball(12, 1);
  const surface = new sdm.Surface(small.positions.map((x) => 1000 * x), small.indices, { resolution: 64 });
  const map = surface.map(new sdm.Sites(small.positions, small.indices));
  const { notes } = await map.summary();
  assert.equal(notes.filter((note) => /millimetres and metres/.test(note)).length, 1, notes.join('; '));
});
