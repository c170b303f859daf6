// The package as users call it: errors, progress, memory.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { ball } from './shapes.mjs';

const { createPool, createWorker, start, SdmError } = await import(pathToFileURL(join(process.env.SDM_PACKAGE, 'node.js')));
const sdm = await start({ threads: 1 });
const full = await start({ threads: 1, full: true });

const isInputError = (message) => (error) => error instanceof SdmError && error.kind === 'input' && message.test(error.message);

test('arrays of any kind are the same points', () => {
  const { positions, indices } = ball(12);
  const distances = [positions, new Float32Array(positions), new Float64Array(positions)].map(
    (array) => new sdm.Sites(array, new Uint16Array(indices)).closestPoints([0, 0, 3]).distances[0]);
  for (const distance of distances) assert.equal(distance, 2);
  const triangle = new sdm.Sites([0, 0, 0, 1, 0, 0, 0, 1, 0]);
  const { faces, barycentric, points } = triangle.closestPoints([0.25, 0.25, 1]);
  assert.deepEqual([faces[0], ...barycentric, ...points], [0, 0.25, 0.25, 0.25, 0.25, 0]);
});

test('signs, rays and maps of a ball', () => {
  const { positions, indices } = ball(40);
  const sites = new sdm.Sites(positions, indices);
  assert.ok(sites.closed && sites.orientable);
  const { distances, sign } = sites.signedDistance([0, 0, 0, 0, 0, 2]);
  assert.equal(sign, 'exact');
  assert.ok(distances[0] < -0.99 && distances[1] === 1);
  assert.equal(sites.firstHits([0, 0, 5], [0, 0, -1]).t[0], 4);
  assert.equal(sites.firstHits([0, 0, 5], [0, 0, 1]).faces[0], 0xffffffff);
  const inner = ball(40, 0.5);
  const map = new sdm.Surface(inner.positions, inner.indices, { resolution: 128 }).map(sites);
  const statistics = map.statistics();
  assert.ok(statistics.max < -0.49 && statistics.min >= -0.5 - 1e-6, JSON.stringify(statistics));
  assert.ok(statistics.p50 <= statistics.p95 && statistics.p95Abs === -statistics.p05 && statistics.negativeAreaFraction === 1);
  // Names come from the library, types from the same declaration.
  const [, type] = /interface DistanceStatistics \{([^}]*)\}/.exec(readFileSync(join(process.env.SDM_PACKAGE, 'declared.d.ts'), 'utf8'));
  assert.deepEqual(Object.keys(statistics), [...type.matchAll(/(\w+): number/g)].map(([, name]) => name));
  const heights = map.transfer(positions.filter((_, i) => i % 3 === 2));
  assert.equal(heights.length, 128 * 128);
  assert.ok(heights.every(Number.isFinite));
});

test('bad input is an error that names the fault', () => {
  assert.throws(() => new sdm.Sites([0, 0, NaN, 1, 0, 0, 0, 1, 0]), isInputError(/vertex 0 has a NaN/));
  assert.throws(() => new sdm.Sites([0, 0]), isInputError(/positions has 2 numbers/));
  assert.throws(() => new sdm.Sites([0, 0, 0, 1, 0, 0, 0, 1, 0], [0, 1, 9]), isInputError(/indices\[2\] is 9/));
  assert.throws(() => new sdm.Sites([0, 0, 0, 1, 0, 0, 0, 1, 0], [0, 1, -1]), isInputError(/indices\[2\] is -1/));
  assert.throws(() => new sdm.Sites([0, 0, 0, 1, 0, 0, 2, 0, 0]), SdmError);
  const { positions, indices } = ball(8);
  assert.throws(() => new sdm.Surface(positions, indices, { resolution: 3 }), isInputError(/resolution/));
  assert.throws(() => new sdm.Surface(positions, indices, { atlas: 'uv' }), SdmError);
  const sites = new sdm.Sites(positions, indices);
  sites.dispose();
  sites.dispose();
  assert.throws(() => sites.closestPoints([0, 0, 0]), isInputError(/disposed/));
});

test('arguments of another kind are errors that name them, and leave the module as it was', async () => {
  const triangle = [0, 0, 0, 1, 0, 0, 0, 1, 0];
  const surface = new full.Surface(triangle, null, { resolution: 16 }), sites = new full.Sites(triangle), map = surface.map(sites);
  const pair = new full.Pair({ positions: triangle }, { positions: triangle });
  const refused = [
    [() => surface.map(surface), 'map needs Sites, but was given a Surface'],
    [() => surface.map(), 'map needs Sites, but was given undefined'],
    [() => surface.emptyMap(map), 'map needs Sites, but was given a DistanceMap'],
    [() => full.match(sites, surface), 'match needs a Surface, but was given Sites'],
    [() => sites.hausdorff(surface), 'hausdorff needs Sites, but was given a Surface'],
    [() => full.match(surface, sites).bake(map), 'bake needs a Look, but was given a DistanceMap'],
    [() => sites.closestPoints('0 0 1'), 'points is "0 0 1": it must be an array of numbers'],
    [() => sites.closestPoints(['0', '0', '1']), 'points[0] is "0": it must be a number'],
    [() => sites.closestPoints(new BigInt64Array(3)), 'points is a BigInt64Array: it must be an array of numbers'],
    [() => sites.closestPoints([0, 0, 1], { maxDistance: '5' }), 'maxDistance is "5": it must be a number greater than 0'],
    [() => sites.closestPoints([0, 0, 1], { maxDistance: NaN }), 'maxDistance is NaN: it must be a number greater than 0'],
    [() => sites.closestPoints([0, 0, 1], { maxdistance: 5 }), 'unknown option maxdistance; did you mean maxDistance?'],
    [() => sites.signedDistance([0, 0, 1], { sign: 'exakt' }), 'sign is "exakt": it must be automatic, none, exact, winding or side'],
    [() => sites.signedDistance([0, 0, 1], { maxDistance: 5 }), 'unknown option maxDistance'],
    [() => map.summary({ tolerance: 'wide' }), 'tolerance is "wide": it must be a number of at least 0, or two, LO:HI, the smaller one first'],
    [() => map.summary({ tolerance: -1 }), 'tolerance is -1: it must be a number of at least 0, or two, LO:HI, the smaller one first'],
    [() => map.summary({ range: [1, 0] }), 'range is 1,0: it must be two numbers, the smaller one first'],
    [() => map.summary({ colormap: 'jet' }), 'colormap is "jet": it must be automatic, viridis, sequential, diverging or paper2006'],
    [() => map.summary({ bands: 'all' }), 'bands is "all": it must be numbers'],
    [() => map.summary({ units: 5 }), 'units is 5: it must be text'],
    [() => map.summary({ acceptDoubts: 1 }), 'acceptDoubts is 1: it must be true or false'],
    [() => map.summary({ up: 'z' }), 'unknown option up'],
    [() => sites.closestPoints([0, 0, 1], 5), 'the last argument of closestPoints is 5: it must be an object of options'],
    [() => new full.Sites(triangle, { resolution: 16 }), 'indices is an object: it must be an array of numbers'],
    [() => new full.Sites(triangle, ['0', '1', '2']), 'indices[0] is "0": it must be a number'],
    [() => new full.Surface(triangle, null, { gutter: -1 }), 'gutter is -1: it must be a whole number from 0 to 8192'],
    [() => new full.Surface(triangle, null, { resolution: '64' }), 'resolution is "64": it must be a whole number from 16 to 32768'],
    [() => new full.Surface(triangle, null, { resolution: 64.5 }), 'resolution is 64.5: it must be a whole number from 16 to 32768'],
    [() => new full.Surface(triangle, null, { resolutoin: 64 }), 'unknown option resolutoin; did you mean resolution?'],
    [() => new full.Surface(triangle, null, { strictUv: 1 }), 'strictUv is 1: it must be true or false'],
    [() => surface.map(sites, { maxDistance: NaN }), 'maxDistance is NaN: it must be a number greater than 0'],
    [() => surface.map(sites, { facing: () => 90 }), 'facing is a function: it must be a number of degrees greater than 0 and at most 180'],
    [() => surface.map(sites, { facing: 90, sign: 'winding' }), 'facing excludes sign winding: distances have the sign of the side of the faces'],
    [() => sites.hausdorff(sites, { precision: 0 }), 'precision is 0: it must be a number greater than 0'],
    [() => map.transfer([0, 1, 2], { components: 0 }), 'components is 0: it must be a whole number from 1 to 4294967295'],
    [() => map.transfer([0, 1, 2], { domain: 'edge' }), 'domain is "edge": it must be vertex, face or corner'],
    [() => map.transfer([0, 1, 2], { fil: true }), 'unknown option fil; did you mean fill?'],
    [() => sites.firstHits([0, 0, 5], [0, 0, 1], { tMin: -1 }), 'tMin is -1: it must be a number of at least 0'],
    [() => sites.firstHits([0, 0, 5], [0, 0, 1], { tMax: '5' }), 'tMax is "5": it must be a number'],
    [() => pair.setPose(2, []), 'body is 2: it must be an integer from 0 to 1'],
    [() => new full.Pair(triangle, triangle), 'positions of the first body is undefined: it must be an array of numbers'],
    [() => full.readMesh('solid', 'a.stl'), 'bytes is "solid": it must be a Uint8Array or an ArrayBuffer'],
  ];
  for (const [call, message] of refused) assert.throws(call, { name: 'SdmError', kind: 'input', message });
  await assert.rejects(map.report({ unit: 'mm' }), { kind: 'input', message: /^unknown option unit; did you mean units\?$/ });
  for (const threads of [1e6, 0, -1, 1.5, '2'])
    for (const begin of [start, createWorker])
      await assert.rejects(begin({ threads }), { kind: 'input', message: /^threads is .*: it must be an integer from 1 to 256$/ });
  await assert.rejects(createPool({ workers: 1e6 }), { kind: 'input', message: /^workers is 1000000: / });
  await assert.rejects(createWorker({ thread: 2 }), { kind: 'input', message: /^createWorker has no option thread; it has threads, / });
  for (const begin of [start, createWorker, createPool])
    await assert.rejects(begin({ modules: { core: new TextEncoder().encode('<!doctype html>') } }),
      { kind: 'input', message: 'modules.core is no WebAssembly: it must be the file sdm_core.wasm of this package' });
  assert.equal(sites.closestPoints([0, 0, 1]).distances[0], 1);
  assert.ok(surface instanceof full.Surface && !(sites instanceof full.Surface));
});

test('options are stated as they were given, large ones with all digits', () => {
  const { positions, indices } = ball(8), map = new full.Surface(positions, indices, { resolution: 16 }).map(new full.Sites(positions, indices));
  for (const maxDistance of [0.1, 2 ** 53 + 2, 2 ** 70, 1e300]) {
    map.compute({ maxDistance });
    assert.equal(map.summary().measured.settings.max_distance, maxDistance);
  }
});

test('closest points of many points are as close as promised, and of few as if each were alone', () => {
  const at = [-0.5, 0.5], vertices = at.flatMap((z) => at.flatMap((y) => at.map((x) => [x, y, z])));
  const faces = [0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5];
  const sites = new sdm.Sites(faces.flatMap((v) => vertices[v]));  // not welded
  let seed = 18;
  const random = () => (seed = (seed * 48271) % 2147483647) / 2147483647 - 0.5;
  const points = Array.from({ length: 60000 }, () => 35 * random());
  const exact = (k) => Math.hypot(...[0, 1, 2].map((i) => Math.max(0, Math.abs(points[3 * k + i]) - 0.5)));
  const { distances } = sites.closestPoints(points), few = sites.closestPoints(points.slice(0, 3 * 8191)).distances;
  for (let k = 0; k < 20000; ++k) {
    if (exact(k) === 0) continue;  // inside
    assert.ok(distances[k] >= exact(k) - 1e-12 && distances[k] <= exact(k) + 1e-6 * 35 * Math.sqrt(3), `point ${k}: ${distances[k]}`);
    if (k < 8191) assert.ok(Math.abs(few[k] - exact(k)) < 1e-12, `point ${k} of few: ${few[k]}`);
  }
  for (let k = 0; k < 8191; k += 97) assert.equal(sites.closestPoints(points.slice(3 * k, 3 * k + 3)).distances[0], few[k]);
});

test('a callback sees progress, and cancels', () => {
  const { positions, indices } = ball(30), sites = new sdm.Sites(positions, indices);
  const surface = new sdm.Surface(positions, indices, { resolution: 256 });
  let last = 0;
  surface.map(sites, { progress: (step, fraction) => void ((last = fraction), assert.equal(typeof step, 'string')) });
  assert.equal(last, 1);
  assert.throws(() => surface.map(sites, { progress: () => false }), (error) => error.kind === 'cancelled');
  const fail = () => {
    throw new RangeError('of the callback');
  };
  assert.throws(() => surface.map(sites, { progress: fail }), RangeError);
  assert.throws(() => surface.map(sites, { progress: () => sites.dispose() }), isInputError(/callback of progress/));
  assert.throws(() => surface.map(sites, { sign: 'exakt' }), isInputError(/sign is "exakt": it must be automatic, none, exact, winding or side/));
  assert.ok(surface.map(sites).statistics().texels > 0);
});

test('with threads, the callback is that of the thread that calls', async () => {
  const shared = await start({ threads: 2 });
  const { positions, indices } = ball(30), sites = new shared.Sites(positions, indices);
  const surface = new shared.Surface(positions, indices, { resolution: 256 });
  for (let i = 0; i < 20; ++i) {
    let last = 0;
    surface.map(sites, { progress: (_, fraction) => void (last = fraction) });
    assert.equal(last, 1);
  }
  assert.throws(() => surface.map(sites, { progress: () => false }), (error) => error.kind === 'cancelled');
  shared.stop();
});

test('10,000 refits take no memory', () => {
  const { positions, indices } = ball(10), sites = new sdm.Sites(positions, indices);
  const pair = new full.Pair({ positions, indices }, { positions, indices });
  const moved = (i) => positions.map((x) => x * (1 + 0.3 * Math.sin(i)));
  for (let i = 0; i < 100; ++i) sites.refit(moved(i)), pair.refit(0, moved(i)), pair.colliding();
  const before = [sdm.memoryBytes, full.memoryBytes];
  for (let i = 0; i < 10000; ++i) {
    sites.refit(moved(i));
    sites.closestPoints([0, 0, 0]);
    if (i % 5 !== 0) continue;
    pair.setPose(1, [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 3 * Math.cos(i), 0, 0, 1]);
    pair.separation();
  }
  assert.deepEqual([sdm.memoryBytes, full.memoryBytes], before);
});

test('parts of a map, in any order, are the map to the bit', () => {
  const { positions, indices } = ball(40), inner = ball(40, 0.7);
  const surface = new sdm.Surface(positions, indices, { resolution: 200 }), sites = new sdm.Sites(inner.positions, inner.indices);
  const whole = surface.map(sites), parts = surface.emptyMap(sites);
  const { samples, grain } = surface.sampleCounts();
  assert.ok(parts.distances.every(Number.isNaN) && grain < samples / 4);
  const firsts = Array.from({ length: Math.ceil(samples / grain) }, (_, i) => i * grain).reverse();
  for (const first of firsts) parts.computeSamples(first, Math.min(grain, samples - first));
  for (const name of ['distances', 'vectors', 'sitesOfTexels', 'siteTypes']) assert.deepEqual(parts[name], whole[name]);
  assert.equal(parts.sign, whole.sign);
  const { texels } = surface.samples(), { distances } = parts.valuesOfSamples(grain, 5);
  assert.deepEqual([...distances], [...texels.slice(grain, grain + 5)].map((texel) => whole.distances[texel]));
  assert.throws(() => parts.computeSamples(1, grain), isInputError(/multiples of/));
  assert.throws(() => parts.computeSamples(0, samples + grain), isInputError(/multiples of/));
  const stored = surface.storedAtlas();
  assert.deepEqual(new sdm.Surface(positions, indices, { resolution: 200, storedAtlas: stored }).atlas(), surface.atlas());
  stored[100] ^= 1;
  assert.throws(() => new sdm.Surface(positions, indices, { resolution: 200, storedAtlas: stored }), isInputError(/atlas/));
});

test('faces without a texel count in statistics, and have no place in arrays', () => {
  const { positions, indices } = ball(80), inner = ball(40, 0.7);
  const surface = new sdm.Surface(positions, indices, { resolution: 32 }), sites = new sdm.Sites(inner.positions, inner.indices);
  const map = surface.map(sites), { texels } = surface.samples(), { texelFaces } = surface.atlas();
  const owned = texelFaces.filter((face) => face !== 0xffffffff).length;
  assert.equal(map.distances.length, 32 * 32);
  assert.equal(map.distances.filter((d) => !Number.isNaN(d)).length, owned);
  assert.equal(texels.length, map.statistics().texels);
  assert.ok(texels.length > owned + 1000);
  assert.ok(Math.abs(map.statistics().mean - 0.3) < 0.01);
});

test('what is computed again takes no more memory', () => {
  const { positions, indices } = ball(20), surface = new sdm.Surface(positions, indices, { resolution: 256 });
  const sites = new sdm.Sites(positions, indices), map = surface.map(sites);
  sites.refit(positions.map((x) => 2 * x));
  map.compute();
  const before = sdm.memoryBytes;
  for (let i = 0; i < 50; ++i) map.compute();
  assert.equal(sdm.memoryBytes, before);
  assert.ok(Math.abs(map.statistics().min + 1) < 0.02);
});

/** The library with a memory that cannot grow beyond so many pages of 64 KiB. */
async function startWithin(maximum) {
  const { Memory } = WebAssembly;
  WebAssembly.Memory = class extends Memory {
    constructor(type) {
      super({ ...type, maximum });
    }
  };
  try {
    return await start({ threads: 1 });
  } finally {
    WebAssembly.Memory = Memory;
  }
}

test('what does not fit into the memory is an error, and takes none', async () => {
  const small = await startWithin(300), [positions, indices] = [[0, 0, 0, 1, 0, 0, 0, 1, 0], [0, 1, 2]];
  const fail = () => assert.throws(() => new small.Surface(positions, indices, { resolution: 2048, atlas: 'triangles' }), (error) => error.kind !== 'internal' && /memory/.test(error.message));
  fail();
  const taken = small.memoryBytes;
  for (let i = 0; i < 3; ++i) fail();
  assert.equal(small.memoryBytes, taken);
  assert.equal(new small.Sites(positions, indices).closestPoints([0, 0, 3]).distances[0], 3);
});
