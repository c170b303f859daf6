// The types of the package as users compile them, and what publint finds in it. SDM_PACKAGE: the folder of the package;
// SDM_NODE_PACKAGES: that with TypeScript, the oldest that is supported too, publint, three and its types.
import assert from 'node:assert/strict';
import { execFile } from 'node:child_process';
import { mkdirSync, mkdtempSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { ball } from './shapes.mjs';

const { SDM_PACKAGE, SDM_NODE_PACKAGES } = process.env;
const modules = join(SDM_NODE_PACKAGES, 'node_modules');
const { start } = await import(pathToFileURL(join(SDM_PACKAGE, 'node.js')));

const folder = mkdtempSync(join(tmpdir(), 'sdm-types-'));
after(() => rmSync(folder, { recursive: true }));
mkdirSync(join(folder, 'node_modules'));
symlinkSync(SDM_PACKAGE, join(folder, 'node_modules/sdm'));
for (const name of ['three', '@types']) symlinkSync(join(modules, name), join(folder, 'node_modules', name));
writeFileSync(join(folder, 'package.json'), '{ "type": "module" }');

/** Compiles a text as strictly as possible, with ES2022 and the library of browsers alone. Rejects with the errors. */
function compiles(name, text, options) {
  const [file, project] = [join(folder, `${name}.ts`), join(folder, `${name}.json`)];
  const compilerOptions = {
    target: 'ES2022', lib: ['ES2022', 'DOM'], module: 'NodeNext', strict: true, exactOptionalPropertyTypes: true, noUncheckedIndexedAccess: true,
    verbatimModuleSyntax: true, skipLibCheck: false, types: [], noEmit: true, preserveSymlinks: true, ...options.compiler };
  writeFileSync(file, text);
  writeFileSync(project, JSON.stringify({ compilerOptions, files: [file] }));
  return new Promise((resolve, reject) =>
    execFile(process.execPath, [join(modules, options.typescript, 'bin/tsc'), '-p', project], (error, out) => (error ? reject(new Error(out || error.message)) : resolve())));
}

const kApp = `
import { createPool, createWorker, start } from 'sdm';
import type { ClosestPoints, MapSummary, SdmWorker, Verdict } from 'sdm';
import 'sdm/worker.js';
export async function judged(worker: SdmWorker, signal: AbortSignal | undefined, maxDistance: number | undefined): Promise<Verdict> {
  const surface = await worker.surface([0, 0, 0], null, { resolution: undefined, signal });
  using sites = await worker.sites(new Float32Array(9), undefined, { signal, progress: undefined });
  const map = await surface.map(sites, { maxDistance, signal, facing: 90 });
  const summary = await map.summary({ tolerance: [-0.1, 0.1], units: 'mm' });
  const p95: number | null = summary.distance.p95_abs;
  const all: MapSummary = await map.summary();
  // @ts-expect-error: there is none without a tolerance.
  all.tolerance.verdict;
  // @ts-expect-error: the name is wrong.
  await surface.map(sites, { maxdistance: 5 });
  new Blob([await surface.storedAtlas()]);
  const factor: number | undefined = (await worker.unitCheck({ positions: [], indices: undefined }, sites))?.factor;
  if (factor) return 'DOUBTFUL';
  return p95 === null ? 'NOT DECIDED' : summary.tolerance.verdict;
}
export async function closest(points: number[]): Promise<ClosestPoints> {
  const sdm = await start({ threads: undefined, full: false });
  using sites = new sdm.Sites([0, 0, 0, 1, 0, 0, 0, 1, 0]);
  return sites.closestPoints(points, { maxDistance: undefined });
}
export const both = Promise.all([createWorker({ script: undefined }), createPool({ workers: undefined })]);
`;
const kThree = `
import { type ClosestPointTarget, DistanceMaterial, GeometrySites, fromBufferGeometry, withAtlas } from 'sdm/three';
import type { Sdm, SdmWorker } from 'sdm';
import { type BufferGeometry, Mesh, type Vector3 } from 'three';
export async function shown(worker: SdmWorker, geometry: BufferGeometry, range: [number, number] | undefined): Promise<Mesh> {
  const surface = await worker.surface(...fromBufferGeometry(geometry));
  const map = await surface.map(await worker.sites(...fromBufferGeometry(geometry)));
  const atlas = await surface.atlas();
  return new Mesh(withAtlas(geometry, atlas), new DistanceMaterial(await map.arrays('distances'), atlas, { range, roughness: 1 }));
}
export function closest(sdm: Sdm, mesh: Mesh, point: Vector3): ClosestPointTarget | null {
  const sites = new GeometrySites(sdm, mesh.geometry);
  mesh.raycast = (raycaster, hits) => sites.raycast(mesh, raycaster, hits);
  return sites.closestPointToPoint(point);
}
`;

/** Summaries of all kinds of maps, which have no other keys than their type, and no other values. */
async function summaries() {
  const sdm = await start({ full: true, threads: 1 });
  const [part, other] = [ball(10), ball(12, 0.9)];
  const surface = new sdm.Surface(part.positions, part.indices, { resolution: 32 });
  const sites = new sdm.Sites(other.positions, other.indices), itself = new sdm.Sites(part.positions, part.indices);
  const of = (options, to = sites) => surface.map(to, options);
  const [closest, far] = [of({}), of({ maxDistance: 1e-6 })];
  return [
    closest.summary(),
    ...[0.2, [-0.01, Infinity], [0.104, 0.107]].map((tolerance) => closest.summary({ tolerance, units: 'mm', bands: [0, 1] })),
    far.summary(),
    far.summary({ tolerance: 1 }),
    of({ facing: 90 }).summary({ tolerance: 0.2 }),
    of({ along: 'normal' }).summary({ tolerance: 0.2 }),
    of({ measure: 'self', rings: 2 }, itself).summary(),
    of({ measure: 'thickness' }, itself).summary({ tolerance: [0.4, 20] }),
  ].map((summary) => `{ const it: ${summary.tolerance ? 'JudgedSummary' : 'MapSummary'} = ${JSON.stringify(summary)}; void it; }`);
}

test('types', { timeout: 120000 }, async (t) => {
  const shown = `import type { JudgedSummary } from 'sdm';\n${(await summaries()).join('\n')}`;
  await Promise.all([
    t.test('of TypeScript 5.4', () => compiles('old', kApp, { typescript: 'typescript-5.4' })),
    t.test('of three.js', () => compiles('three', kThree, { typescript: 'typescript-5.4', compiler: { skipLibCheck: true } })),
    t.test('of TypeScript 5.9, and of all summaries', () => compiles('new', kApp + shown, { typescript: 'typescript' })),
  ]);
});

test('publint finds nothing', { timeout: 60000 }, async () => {
  const { publint } = await import(pathToFileURL(createRequire(SDM_NODE_PACKAGES + '/').resolve('publint')));
  assert.deepEqual((await publint({ pkgDir: SDM_PACKAGE, strict: true, pack: 'npm' })).messages, []);
});
