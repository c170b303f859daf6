// Closest points in headless Chromium, on one thread: the package for npm (./build-wasm) against three-mesh-bvh, on the same points.
//   node bench/javascript/three_mesh_bvh.mjs [PACKAGE] [--repetitions N]
// Packages come from npm, into a temporary folder. Contenders take turns; medians of the repetitions, in microseconds a point. The
// distances are compared first: three-mesh-bvh measures in double precision what it stores in single precision.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { delimiter, dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

const given = process.argv.slice(2), at = given.indexOf('--repetitions');
const repetitions = at < 0 ? 9 : Number(given.splice(at, 2)[1]);
const root = join(dirname(fileURLToPath(import.meta.url)), '../..');
const pkg = resolve(given[0] ?? join(root, 'build/wasm/package'));
if (!existsSync(join(pkg, 'sdm_core.wasm'))) throw new Error(`${pkg} has no package: run ./build-wasm`);

const page = `
import { BufferAttribute, BufferGeometry, Vector3 } from 'three';
import { MeshBVH } from 'three-mesh-bvh';
import { start } from ${JSON.stringify(join(pkg, 'index.js'))};
import { ball } from ${JSON.stringify(join(root, 'tests/js/shapes.mjs'))};

const median = (times) => times.sort((a, b) => a - b)[times.length >> 1];
let state = 1;
const random = () => (state = (state * 48271) % 2147483647) / 2147483647;

window.measure = async (core, faces, kind, count, repetitions) => {
  const sdm = await start({ modules: { core: Uint8Array.from(atob(core), (c) => c.charCodeAt(0)) } });
  const mesh = ball(Math.round(Math.sqrt(faces / 4)));
  for (let i = 0; i < mesh.positions.length; ++i) mesh.positions[i] = Math.fround(mesh.positions[i] * (1 + 0.02 * Math.sin(9 * i)));
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(Float32Array.from(mesh.positions), 3));
  geometry.setIndex(new BufferAttribute(mesh.indices.slice(), 1));
  const bvh = new MeshBVH(geometry), sites = new sdm.Sites(mesh.positions, mesh.indices);
  const points = new Float64Array(3 * count);
  for (let i = 0; i < count; ++i) {
    const from = 3 * Math.floor(random() * (mesh.positions.length / 3));
    for (let k = 0; k < 3; ++k)
      points[3 * i + k] = Math.fround(kind === 'near' ? mesh.positions[from + k] * (1 + 0.05 * (random() - 0.5)) : 3 * (random() - 0.5));
  }
  const theirs = new Float64Array(count), point = new Vector3(), found = { point: new Vector3(), distance: 0, faceIndex: -1 };
  const run = {
    sdm: () => sites.closestPoints(points).distances,
    bvh: () => {
      for (let i = 0; i < count; ++i) theirs[i] = bvh.closestPointToPoint(point.fromArray(points, 3 * i), found).distance;
      return theirs;
    },
  };
  const [a, b] = [run.sdm(), run.bvh()];
  let worst = 0;
  for (let i = 0; i < count; ++i) worst = Math.max(worst, Math.abs(a[i] - b[i]));
  if (!(worst < 1e-5)) throw new Error('the distances differ by ' + worst);
  const times = { sdm: [], bvh: [] };
  for (let i = 0; i < repetitions; ++i)
    for (const name of Object.keys(run)) {
      const begin = performance.now();
      run[name]();
      times[name].push((1000 * (performance.now() - begin)) / count);
    }
  return { sdm: median(times.sdm), bvh: median(times.bvh), worst };
};
`;

const folder = mkdtempSync(join(tmpdir(), 'sdm-bench-'));
try {
  writeFileSync(join(folder, 'package.json'), '{"private":true}');
  execFileSync('npm', ['install', '--silent', '--ignore-scripts', 'three@0.187.0', 'three-mesh-bvh@0.9.1', 'esbuild@0.28.2', 'playwright-core@1.56.1'],
    { cwd: folder, stdio: 'inherit' });
  const require = createRequire(folder + '/');
  const { outputFiles } = require('esbuild').buildSync({
    stdin: { contents: page, resolveDir: folder }, bundle: true, format: 'iife', write: false, target: 'es2022',
    nodePaths: [join(folder, 'node_modules')], logLevel: 'error', logOverride: { 'empty-import-meta': 'silent' },
  });
  const executablePath = process.env.PATH.split(delimiter).map((path) => join(path, 'chromium-headless-shell')).find(existsSync);
  const browser = await require('playwright-core').chromium.launch({ executablePath, args: ['--no-sandbox'] });
  try {
    const tab = await browser.newPage();
    await tab.setContent('');
    await tab.addScriptTag({ content: outputFiles[0].text });
    const core = readFileSync(join(pkg, 'sdm_core.wasm')).toString('base64');
    console.log('faces    points        sdm      three-mesh-bvh   ratio');
    // A call with more points near the surface has more neighbours among them, which share a search.
    for (const faces of [5000, 70000, 300000])
      for (const [kind, count] of [['near', 20000], ['near', 200000], ['box', 20000]]) {
        const run = ([a, b, c, d, e]) => window.measure(a, b, c, d, e);
        const { sdm, bvh } = await tab.evaluate(run, [core, faces, kind, count, repetitions]);
        const points = `${kind} ${count}`;
        console.log(`${String(faces).padEnd(9)}${points.padEnd(14)}${sdm.toFixed(3).padEnd(9)}${bvh.toFixed(3).padEnd(17)}${(bvh / sdm).toFixed(1)}`);
      }
  } finally {
    await browser.close();
  }
} finally {
  rmSync(folder, { recursive: true });
}
