// The measures of maps besides the closest point, and what summaries say of them. Values: agrees.test.mjs.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { ball } from './shapes.mjs';

const { createWorker, start } = await import(pathToFileURL(join(process.env.SDM_PACKAGE, 'node.js')));
const sdm = await start({ threads: 1, full: true });

/** A box of these sizes, closed. */
function box(...sizes) {
  const corners = [0, 1].flatMap((z) => [0, 1].flatMap((y) => [0, 1].map((x) => [x, y, z].map((c, k) => c * sizes[k]))));
  return [corners.flat(), [0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5]];
}
const plate = box(10, 10, 0.5);
const surface = new sdm.Surface(...plate, { resolution: 64 }), itself = new sdm.Sites(...plate);

test('the thickness of a plate has a verdict on its samples', async () => {
  const map = surface.map(itself, { measure: 'thickness', method: 'ray' });
  const { min, max, p50 } = map.statistics();
  assert.deepEqual([min, p50, max].map(Math.fround), [0.5, 0.5, 10].map(Math.fround));
  assert.deepEqual([map.sign, map.signReason], ['none', 'a thickness has no sign']);
  const summary = map.summary({ tolerance: [0.4, 20], units: 'mm' });
  assert.deepEqual(summary.measured.settings, { method: 'ray', angle: 90 });
  assert.equal(summary.tolerance.verdict, 'PASS');
  assert.equal(summary.tolerance.certified, false);
  assert.ok(summary.mesh && !summary.o2);
  assert.equal(map.summary({ tolerance: [0.6, 20] }).tolerance.verdict, 'FAIL');
  const html = await map.report({ tolerance: [0.6, 20], names: ['plate.stl', 'plate.stl'] });
  assert.match(html, /"verdict": ?"FAIL"/);
});

test('the distance of a plate to itself is that to its other side', async () => {
  const map = surface.map(itself, { measure: 'self', maxDistance: 1 });
  assert.equal(map.statistics().min, 0.5);
  const summary = map.summary();
  assert.ok(summary.mesh && summary.max_distance === 1 && summary.distance.min === 0.5);
  assert.throws(() => map.summary({ tolerance: [0.4, 1] }), { kind: 'input', message: /^the distances of a surface to itself jump between faces/ });
  assert.match(await map.report(), /data-|<script/);
});

test('the mesh at rest says what is near along the surface', () => {
  // It was twice as large: what was nearer than 0.8 then is 0.4 now.
  const { positions, indices } = ball(40), rest = positions.map((x) => 2 * x);
  const on = new sdm.Surface(positions, indices, { resolution: 64 }), sites = new sdm.Sites(positions, indices);
  const map = (options) => on.map(sites, { measure: 'self', ...options }).distances, now = map({ geodesic: 0.4 });
  assert.ok(now.some((d) => d > 0.35 && d < 1));
  assert.deepEqual(map({ geodesic: 0.8, rest }), now);
  assert.notDeepEqual(map({ geodesic: 0.8 }), now);
  assert.throws(() => map({ rest: rest.slice(3) }), { kind: 'input', message: `rest has ${positions.length / 3 - 1} vertices, but the mesh has ${positions.length / 3}` });
});

test('distances along lines are those of the lines', () => {
  const [floor, indices] = box(10, 10, 1), lifted = floor.map((x, i) => (i % 3 === 2 ? x + 0.25 * floor[i - 2] : x));
  const above = new sdm.Surface(lifted, indices, { resolution: 64 }), sites = new sdm.Sites(floor, indices);
  const map = above.map(sites, { along: [0, 0, 2] });
  assert.equal(map.sign, 'side');
  const { texels, points } = above.samples(), { distances } = map;
  let compared = 0;
  texels.forEach((texel, i) => {
    if (texel >= distances.length || Number.isNaN(distances[texel])) return;
    const [x, , z] = points.subarray(3 * i), top = z > 0.25 * x + 0.5;
    if (Math.abs(Math.abs(distances[texel]) - 0.25 * x) > 1e-6) assert.fail(`${distances[texel]} at ${points.subarray(3 * i, 3 * i + 3)}`);
    assert.ok(x < 1e-6 || distances[texel] > 0 === top);
    ++compared;
  });
  assert.ok(compared > 500);
  assert.deepEqual(map.summary().measured.settings.along, [0, 0, 2]);
});

test('ranges of samples are the map', () => {
  const { positions, indices } = ball(40), on = new sdm.Surface(positions, indices, { resolution: 200 }), of = new sdm.Sites(positions, indices);
  for (const options of [{ measure: 'self', rings: 3, maxDistance: 0.4 }, { measure: 'thickness', angle: 45 }, { along: 'normal' }, { along: 'normal', maxDistance: 0.01 }]) {
    const whole = on.map(of, options), parts = on.emptyMap(of), { samples, grain } = on.sampleCounts();
    for (let first = 0; first < samples; first += 3 * grain) parts.computeSamples(first, Math.min(3 * grain, samples - first), options);
    for (const name of ['distances', 'vectors', 'sitesOfTexels', 'siteTypes']) assert.deepEqual(parts[name], whole[name], name);
    assert.deepEqual(parts.statistics(), whole.statistics());
    const [{ tool: _, ...summed }, { tool: __, ...known }] = [parts.summary(), whole.summary()];
    assert.deepEqual(summed, known); // with the samples beyond the maximum distance
  }
});

test('wrong options are refused as in all doors', async () => {
  for (const [options, message] of [
    [{ measure: 'walls' }, 'measure is "walls": it must be sites, self or thickness'],
    [{ measure: 'self', rings: 0 }, 'rings is 0: it must be a whole number from 1 to 1048576'],
    [{ measure: 'self', rings: 2, geodesic: 1 }, 'geodesic excludes rings'],
    [{ measure: 'self', facing: 90 }, 'unknown option facing'],
    [{ measure: 'thickness', angle: 180 }, 'angle is 180: it must be a number of degrees greater than 0 and less than 180'],
    [{ measure: 'thickness', method: 'rays' }, 'method is "rays": it must be ball or ray'],
    [{ along: [0, 0, 0] }, 'along is 0,0,0: it must be normal or a direction of three numbers, not all 0'],
    [{ along: 'up' }, 'along is "up": it must be normal or a direction of three numbers, not all 0'],
    [{ along: [0, 1] }, 'along is 0,1: it must be normal or a direction of three numbers, not all 0'],
    [{ along: 'normal', facing: 60 }, 'along excludes facing'],
    [{ along: 'normal', sign: 'winding' }, 'along excludes sign winding'],
    [{ rest: plate[0] }, 'unknown option rest'],
    [{ measure: 'self', rest: 5 }, 'rest is 5: it must be an array of numbers'],
  ])
    assert.throws(() => surface.map(itself, options), { name: 'SdmError', kind: 'input', message });
  const other = new sdm.Sites([0, 0, 0, 1, 0, 0, 0, 1, 0]);
  assert.throws(() => surface.map(other, { measure: 'thickness' }), { kind: 'input', message: /belong to different meshes/ });
  const small = await start({ threads: 1 }), on = new small.Surface(...plate, { resolution: 64 }), to = new small.Sites(...plate);
  assert.throws(() => on.map(to, { measure: 'self' }), { kind: 'input', message: 'measure needs the module of start({ full: true })' });
  assert.throws(() => on.map(to, { along: 'normal' }), { kind: 'input', message: 'along needs the module of start({ full: true })' });
});

test('a mesh in another unit is found', async () => {
  const { positions, indices } = ball(20), sites = new sdm.Sites(positions, indices), worker = await createWorker({ threads: 1, full: true });
  const remote = await worker.sites(positions, indices);
  for (const factor of [1000, 25.4, 0.1]) {
    const body = { positions: positions.map((x) => x / factor), indices };
    const unit = sdm.unitCheck(body, sites);
    assert.ok(Math.abs(unit.factor / factor - 1) < 1e-12 && unit.sameBox && unit.misfit < 1e-3 && unit.misfitAsGiven > 0.5, JSON.stringify(unit));
    assert.match(unit.text, /^O1 has the size and the place of O2 if it is [\d.]+ times as (large|small), as if it were in /);
    assert.deepEqual(await worker.unitCheck(body, remote), unit);
  }
  for (const factor of [1, 1.5, 7]) assert.equal(sdm.unitCheck({ positions: positions.map((x) => x / factor), indices }, sites), null);
  assert.throws(() => sdm.unitCheck({ positions: [] }, sites), { kind: 'input' });
  assert.throws(() => sdm.unitCheck(positions, sites), { kind: 'input', message: /^positions of the mesh body is undefined/ });
  assert.throws(() => sdm.unitCheck({ positions }, positions), { kind: 'input', message: /^unitCheck needs Sites, but was given / });
  const core = await start({ threads: 1 });
  assert.throws(() => core.unitCheck({ positions }, new core.Sites(positions, indices)), { kind: 'input', message: 'unitCheck needs the module of start({ full: true })' });
  worker.terminate();
});
