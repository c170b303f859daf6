// The package as users call it: errors, progress, memory.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { test } from 'node:test';
import { pathToFileURL } from 'node:url';

const { start, SdmError } = await import(pathToFileURL(join(process.env.SDM_PACKAGE, 'index.js')));
const sdm = await start({ threads: 1 });

/// A closed grid on a sphere about the origin.
function ball(n, radius = 1) {
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
  return { positions, indices };
}
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
  assert.throws(() => surface.map(sites, { sign: 'exakt' }), isInputError(/sign is "exakt": it must be one of automatic, none/));
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
  const pair = new sdm.Pair({ positions, indices }, { positions, indices });
  const moved = (i) => Float64Array.from(positions, (x) => x * (1 + 0.3 * Math.sin(i)));
  for (let i = 0; i < 100; ++i) sites.refit(moved(i)), pair.refit(0, moved(i)), pair.colliding();
  const before = sdm.memoryBytes;
  for (let i = 0; i < 10000; ++i) {
    sites.refit(moved(i));
    sites.closestPoints([0, 0, 0]);
    pair.setPose(1, [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 3 * Math.cos(i), 0, 0, 1]);
    pair.separation();
  }
  assert.equal(sdm.memoryBytes, before);
});
