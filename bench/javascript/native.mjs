// WebAssembly against the library itself, both on one thread and with vectors of 128 bits (the library compiled for SSE4 only).
//   node bench/javascript/native.mjs [O1 O2]... [--repetitions N] [--resolution N]
// Builds the library in build/sse4. O1 and O2 are mesh files; without any, balls of several sizes. Both take turns on the same
// arrays and the same atlas; medians of the repetitions, in milliseconds. Results are compared first.
import { execFileSync, spawn } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, dirname, join } from 'node:path';
import { createInterface } from 'node:readline';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { parseArgs } from 'node:util';

const { values: options, positionals: files } = parseArgs({
  allowPositionals: true, options: { repetitions: { type: 'string', default: '15' }, resolution: { type: 'string', default: '512' } } });
const repetitions = Number(options.repetitions), resolution = Number(options.resolution);
if (files.length % 2 !== 0) throw new Error('an O1 has no O2');
const root = join(dirname(fileURLToPath(import.meta.url)), '../..'), pkg = join(root, 'build/wasm/package');
if (!existsSync(join(pkg, 'index.js'))) throw new Error(`${pkg} has no package: run ./build-wasm`);
const { start } = await import(pathToFileURL(join(pkg, 'node.js')).href);
const { ball } = await import(pathToFileURL(join(root, 'tests/js/shapes.mjs')).href);

const build = join(root, 'build/sse4'), quiet = { stdio: ['ignore', 'ignore', 'inherit'] };
execFileSync('cmake', ['-S', join(root, 'bench/javascript'), '-B', build, '-G', 'Ninja', '-DCMAKE_BUILD_TYPE=Release'], quiet);
execFileSync('cmake', ['--build', build, '--target', 'native'], quiet);

function wavy(faces, radius) {
  const mesh = ball(Math.round(Math.sqrt(faces / 4)), radius);
  for (let i = 0; i < mesh.positions.length; i += 3) {
    const [x, y, z] = mesh.positions.subarray(i, i + 3), r = 1 + 0.05 * Math.sin(9 * x) * Math.cos(7 * y + 5 * z);
    for (let k = 0; k < 3; ++k) mesh.positions[i + k] *= r;
  }
  return mesh;
}
async function pairs() {
  if (files.length === 0) return [5000, 20000, 70000].map((faces) => [`balls of ${faces}`, wavy(faces, 1), wavy(faces, 0.9)]);
  const reader = await start({ full: true });
  const meshes = files.map((file) => reader.readMesh(readFileSync(file), basename(file)));
  return meshes.flatMap((mesh, i) => (i % 2 === 0 ? [[`${basename(files[i])} ${basename(files[i + 1])}`, mesh, meshes[i + 1]]] : []));
}

let state = 1;
const random = () => (state = (state * 48271) % 2147483647) / 2147483647;
/** In the box of a mesh, enlarged by half of its size. */
function randomPoints({ positions }, count) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  positions.forEach((x, i) => ((low[i % 3] = Math.min(low[i % 3], x)), (high[i % 3] = Math.max(high[i % 3], x))));
  return Float64Array.from({ length: 3 * count }, (_, i) => low[i % 3] + (2 * random() - 0.5) * (high[i % 3] - low[i % 3]));
}

/** The library itself: a call by its name, and its time. */
function native(folder) {
  const process_ = spawn(join(build, 'native'), [folder, String(resolution)], { stdio: ['pipe', 'pipe', 'inherit'] });
  const lines = createInterface({ input: process_.stdout })[Symbol.asyncIterator]();
  const call = async (name) => {
    process_.stdin.write(`${name}\n`);
    const { value, done } = await lines.next();
    if (done) throw new Error('the native program has ended');
    return value;
  };
  return { call, end: () => process_.stdin.end() };
}

function compare(name, ours, folder, Kind, tolerance) {
  const bytes = readFileSync(join(folder, `${name}.native`)), theirs = new Kind(Uint8Array.from(bytes).buffer);
  if (theirs.length !== ours.length) throw new Error(`${name}: ${ours.length} values, not ${theirs.length}`);
  const differs = ours.findIndex((x, i) => !(Math.abs(x - theirs[i]) <= tolerance || (Number.isNaN(x) && Number.isNaN(theirs[i]))));
  if (differs >= 0) throw new Error(`${name} ${differs}: ${ours[differs]}, not ${theirs[differs]}`);
}

const median = (times) => times.sort((a, b) => a - b)[times.length >> 1];

async function measure(name, o1, o2) {
  const sdm = await start({ threads: 1 }), folder = mkdtempSync(join(tmpdir(), 'sdm-bench-'));
  try {
    const surface = new sdm.Surface(o1.positions, o1.indices, { resolution }), sites = new sdm.Sites(o2.positions, o2.indices);
    const points = randomPoints(o2, 20000), map = surface.emptyMap(sites);
    const arrays = {
      'o1.positions': Float64Array.from(o1.positions), 'o1.indices': Uint32Array.from(o1.indices),
      'o2.positions': Float64Array.from(o2.positions), 'o2.indices': Uint32Array.from(o2.indices), points, atlas: surface.storedAtlas() };
    for (const [file, array] of Object.entries(arrays)) writeFileSync(join(folder, file), new Uint8Array(array.buffer, array.byteOffset, array.byteLength));
    let closest;
    const calls = {
      sites: () => new sdm.Sites(o2.positions, o2.indices).dispose(),
      map: () => map.compute(),
      points: () => (closest = sites.closestPoints(points)),
    };
    const other = native(folder), times = Object.fromEntries(Object.keys(calls).map((call) => [call, [[], []]]));
    for (let i = 0; i <= repetitions; ++i)
      for (const [call, run] of Object.entries(calls)) {
        const begin = performance.now();
        run();
        const pair = [performance.now() - begin, Number(await other.call(call))];
        if (i > 0) pair.forEach((time, which) => times[call][which].push(time));
      }
    await other.call('write');
    other.end();
    const size = Math.hypot(...[0, 1, 2].map((k) => o2.positions.reduce((most, x, i) => (i % 3 === k ? Math.max(most, Math.abs(x)) : most), 0)));
    compare('map', map.distances, folder, Float32Array, 1e-7 * size);
    compare('points', closest.distances, folder, Float64Array, 1e-12 * size);
    for (const [call, [wasm, sse4]] of Object.entries(times)) {
      const [a, b] = [median(wasm), median(sse4)];
      console.log(`${name.padEnd(28)}${call.padEnd(8)}${a.toFixed(2).padStart(10)}${b.toFixed(2).padStart(10)}${(a / b).toFixed(2).padStart(8)}`);
    }
  } finally {
    rmSync(folder, { recursive: true });
  }
}

console.log(`${'pair'.padEnd(36)}${'wasm'.padStart(10)}${'SSE4'.padStart(10)}${'ratio'.padStart(8)}`);
for (const [name, o1, o2] of await pairs()) await measure(name, o1, o2);
