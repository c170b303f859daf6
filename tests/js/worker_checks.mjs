// What workers have to do, in Node and in pages. Each check throws what is wrong.
import { ball } from './shapes.mjs';

function assert(condition, message) {
  if (!condition) throw new Error(message);
}
async function rejection(promise) {
  try {
    await promise;
  } catch (error) {
    return error;
  }
  throw new Error('the call should have failed');
}
const extent = (positions) => {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  positions.forEach((x, i) => ((low[i % 3] = Math.min(low[i % 3], x)), (high[i % 3] = Math.max(high[i % 3], x))));
  return Math.hypot(...low.map((x, k) => high[k] - x));
};
/** Arrays as one number, which differs if a bit does. */
function sameBits(a, b) {
  const [x, y] = [a, b].map((array) => new Uint8Array(array.buffer, array.byteOffset, array.byteLength));
  return x.length === y.length && x.every((byte, i) => byte === y[i]);
}

/**
 * Compares pairs with the C++ library. `read(Kind, name)`: an array of js_reference's. Maps are bit-equal but for one texel in 10⁵
 * within 10⁻⁷; closest points and signed distances agree to 10⁻¹².
 */
export async function agreesWithTheLibrary(worker, pairs, read) {
  let texels = 0, different = 0;
  for (const [i, { name }] of pairs.entries()) {
    const mesh = (of) => [read(Float64Array, `${i}.${of}.positions`), read(Uint32Array, `${i}.${of}.indices`)];
    const o1 = mesh('o1'), o2 = mesh('o2'), size = extent(o1[0]) + extent(o2[0]);
    const surface = await worker.surface(...mesh('apart'), { resolution: 128, atlas: 'uv', uvs: read(Float64Array, `${i}.apart.uvs`) });
    const sites = await worker.sites(...o2);
    const map = await surface.map(sites);
    const { distances } = await map.arrays('distances');
    const expected = read(Float32Array, `${i}.distances`);
    assert(distances.length === expected.length, `${name}: ${distances.length} texels`);
    for (let texel = 0; texel < expected.length; ++texel) {
      if (Number.isNaN(expected[texel]) && Number.isNaN(distances[texel])) continue;
      ++texels;
      if (distances[texel] === expected[texel]) continue;
      ++different;
      assert(Math.abs(distances[texel] - expected[texel]) <= 1e-7 * size, `${name}, texel ${texel}: ${distances[texel]}, not ${expected[texel]}`);
    }
    const points = read(Float64Array, `${i}.points`), signed = read(Float64Array, `${i}.signed`);
    const [closest, result] = await Promise.all([sites.closestPoints(points), sites.signedDistance(points)]);
    for (let k = 0; k < signed.length; ++k) {
      assert(Math.abs(closest.distances[k] - Math.abs(signed[k])) <= 1e-12 * size, `${name}: closest point ${k}`);
      assert(Math.abs(result.distances[k] - signed[k]) <= 1e-12 * size, `${name}: signed distance ${k}`);
      const foot = [0, 1, 2].map((c) => closest.points[3 * k + c] - points[3 * k + c]);
      assert(Math.abs(Math.hypot(...foot) - closest.distances[k]) <= 1e-12 * size, `${name}: point ${k} is not where its distance says`);
    }
    for (const object of [map, surface, sites]) object.dispose();
  }
  assert(pairs.length === 20 && texels > 100000, `${pairs.length} pairs, ${texels} texels`);
  assert(different <= 1e-5 * texels + 1, `${different} of ${texels} texels differ`);
}

/** Aborts a map that has begun, and one that waits. The worker and all objects go on. */
export async function abortsMaps(worker) {
  const { positions, indices } = ball(120), other = ball(120, 0.9);
  const surface = await worker.surface(positions, indices, { resolution: 1024 });
  const sites = await worker.sites(other.positions, other.indices);
  for (const options of [{}, { facing: 60 }]) await abortsMapsOf(worker, surface, sites, options);
}

async function abortsMapsOf(worker, surface, sites, options) {
  const before = worker.restarts;
  const controller = new AbortController();
  let seen = 0;
  const running = rejection(surface.map(sites, { ...options, signal: controller.signal, progress: (_, fraction) => {
    seen = fraction;
    controller.abort();
  } }));
  const waiting = rejection(surface.map(sites, { ...options, signal: controller.signal }));
  const later = surface.map(sites, options);
  for (const error of await Promise.all([running, waiting])) assert(error.name === 'AbortError', `aborted with ${error}`);
  assert(seen > 0 && seen < 1, `aborted at ${seen}`);
  const { distances } = await (await later).arrays('distances');
  const values = distances.filter((d) => !Number.isNaN(d));
  assert(values.length > 100000 && values.every((d) => d > 0.09 && d < 0.11), 'the map after that has distances');
  assert(worker.restarts === before, 'the worker has not been replaced');
  const late = AbortSignal.abort(new RangeError('of the caller'));
  assert((await rejection(surface.map(sites, { signal: late }))) instanceof RangeError, 'the reason is that of the signal');
}

/** Aborts a call that does not look for signals where memory is not shared. */
export async function abortsAnything(worker) {
  const { positions, indices } = ball(400);
  const earlier = await worker.sites(positions.slice(0, 9), [0, 1, 2]);
  const controller = new AbortController();
  const layout = rejection(worker.surface(positions, indices, { resolution: 2048, signal: controller.signal }));
  setTimeout(() => controller.abort(), 50);
  assert((await layout).name === 'AbortError', 'the layout is aborted');
  const small = ball(8);
  const sites = await worker.sites(small.positions, small.indices).catch((error) => error);
  if (worker.sharesMemory) {
    assert((await earlier.closestPoints([0, 0, 0])).distances.length === 1, 'objects stay');
    return;
  }
  // The next call may still have been ended with the worker; the one after that goes to another worker.
  assert(!(sites instanceof Error) || sites.kind === 'ended', `the next call: ${sites}`);
  const again = await worker.sites(small.positions, small.indices);
  assert((await again.closestPoints([0, 0, 3])).distances[0] === 2, 'the new worker computes');
  const lost = await rejection(earlier.closestPoints([0, 0, 0]));
  assert(lost.kind === 'ended', `objects of the ended worker: ${lost}`);
}

/** What a callback throws is that of its call alone, and so is the flag of an aborted one. */
export async function keepsCallsApart(worker) {
  const { positions, indices } = ball(60);
  const surface = await worker.surface(positions, indices, { resolution: 512 }), sites = await worker.sites(positions, indices);
  const before = worker.restarts;
  const fail = () => {
    throw new RangeError('of the callback');
  };
  assert((await rejection(surface.map(sites, { progress: fail }))) instanceof RangeError, 'the error of a callback is that of its call');
  const unsendable = await rejection(sites.closestPoints([0, 0, 0], { maxDistance: () => 1 }));
  assert(unsendable.kind === 'input' && /cannot be sent/.test(unsendable.message), `what cannot be sent: ${unsendable}`);
  // Workers have 256 flags: the call that is aborted has that of the map.
  const map = surface.map(sites), controller = new AbortController();
  const calls = Array.from({ length: 255 }, () => sites.closestPoints([0, 0, 3]));
  const aborted = rejection(sites.closestPoints([0, 0, 3], { signal: controller.signal }));
  controller.abort();
  assert((await aborted).name === 'AbortError', 'a waiting call is aborted');
  assert((await (await map).statistics()).texels > 0, 'the call before it is not');
  for (const call of calls) assert((await call).distances[0] === 2, 'nor are others');
  assert(worker.restarts === before, 'the worker has not been replaced');
}

/** Objects of another worker have the same numbers. */
export async function refusesObjectsOfOthers(worker, createOther) {
  const other = await createOther(), { positions, indices } = ball(8);
  const [sites, foreign] = await Promise.all([worker, other].map((one) => one.sites(positions, indices)));
  const surface = await worker.surface(positions, indices, { resolution: 64 });
  for (const call of [surface.map(foreign), surface.emptyMap(foreign), sites.hausdorff(foreign)]) {
    const error = await rejection(call);
    assert(error.kind === 'input' && /different workers/.test(error.message), `an object of another worker: ${error}`);
  }
  other.terminate();
}

export async function namesFaults(worker) {
  const error = await rejection(worker.sites([0, 0, NaN, 1, 0, 0, 0, 1, 0]));
  assert(error.name === 'SdmError' && error.kind === 'input' && /vertex 0 has a NaN/.test(error.message), `${error.kind}: ${error}`);
  const sites = await worker.sites([0, 0, 0, 1, 0, 0, 0, 1, 0]);
  assert(/sign is "exakt"/.test((await rejection(sites.signedDistance([0, 0, 0], { sign: 'exakt' }))).message), 'words are checked');
  const triangle = [0, 0, 0, 1, 0, 0, 0, 1, 0], surface = await worker.surface(triangle, null, { resolution: 16 });
  const { restarts } = worker, map = await surface.map(sites);
  const refused = [
    [surface.map(surface), /^map needs Sites, but was given a Surface$/],
    [surface.map({}), /^map needs Sites, but was given an object$/],
    [sites.hausdorff(surface), /^hausdorff needs Sites, but was given a Surface$/],
    [sites.closestPoints(['0', '0', '1']), /^points\[0\] is "0": it must be a number$/],
    [sites.closestPoints([0, 0, 1], { maxDistance: '5' }), /^maxDistance is "5": it must be a number greater than 0$/],
    [sites.closestPoints([0, 0, 1], { maxdistance: 5 }), /^unknown option maxdistance; did you mean maxDistance\?$/],
    [worker.surface(triangle, null, { gutter: -1 }), /^gutter is -1: it must be a whole number from 0 to 8192$/],
    [worker.sites(triangle, null, { resolution: 16 }), /^sites has no option resolution$/],
    [map.arrays('distance'), /^an array is "distance": it must be one of distances, /],
  ];
  for (const [call, message] of refused) {
    const refusal = await rejection(call);
    assert(refusal.kind === 'input' && message.test(refusal.message), `${message}: ${refusal}`);
  }
  assert(worker.restarts === restarts && (await sites.closestPoints([0, 0, 1])).distances[0] === 1, 'objects stay');
  sites.dispose();
  assert(/disposed/.test((await rejection(sites.closestPoints([0, 0, 0]))).message), 'disposed objects are refused');
}

export async function movesBuffers(worker) {
  const { positions, indices } = ball(20), copy = positions.slice();
  const sites = await worker.sites(positions, indices, { transfer: true });
  assert(positions.length === 0 && indices.length === 0, 'buffers are moved');
  const points = Float64Array.of(0, 0, 3);
  assert((await sites.closestPoints(points)).distances[0] === 2 && points.length === 3, 'others are copied');
  const refitted = sites.refit(copy);
  copy.fill(NaN);
  await refitted;
  assert((await sites.closestPoints([0, 0, 3])).distances[0] === 2, 'arrays are copied when the call is made');
}

/** Refits bodies many times, without more memory. */
export async function refitsWithoutMemory(worker, times) {
  const { positions, indices } = ball(10);
  const sites = await worker.sites(positions, indices), surface = await worker.surface(positions, indices, { resolution: 64 });
  const map = await surface.map(sites);
  const step = async (i) => {
    const moved = positions.map((x) => x * (1 + 0.3 * Math.sin(i)));
    await Promise.all([sites.refit(moved), i % 10 === 0 ? map.update() : surface.refit(moved)]);
  };
  for (let i = 0; i < 100; ++i) await step(i);
  const before = await worker.memoryBytes();
  for (let i = 0; i < times; ++i) await step(i);
  const after = await worker.memoryBytes();
  assert(after === before, `memory grew from ${before} to ${after} bytes`);
}

/** A pool's maps are those of one worker. */
export async function dividesMaps(pool, worker) {
  const part = ball(50), other = ball(30, 0.8);
  const surfaces = [await pool.surface(part.positions, part.indices, { resolution: 300 }), await worker.surface(part.positions, part.indices, { resolution: 300 })];
  const sites = [await pool.sites(other.positions, other.indices), await worker.sites(other.positions, other.indices)];
  for (const [scale, options] of [[1, {}], [1.1, {}], [1.2, { facing: 1, maxDistance: 0.2 }]]) {
    const moved = other.positions.map((x) => scale * x);
    await Promise.all(sites.map((one) => one.refit(moved)));
    const ours = await surfaces[0].map(sites[0], options), map = await surfaces[1].map(sites[1], options);
    const whole = await map.arrays('distances', 'vectors', 'sitesOfTexels', 'siteTypes');
    for (const name of Object.keys(whole)) assert(sameBits(ours[name], whole[name]), `${name} of the pool differ`);
    assert(ours.sign === map.sign && ours.signReason === map.signReason, `sign ${ours.sign}`);
  }
  await mapsInTurns(pool, worker, part);
  const controller = new AbortController();
  const aborted = rejection(surfaces[0].map(sites[0], { signal: controller.signal, progress: () => controller.abort() }));
  assert((await aborted).name === 'AbortError', 'a map of a pool is aborted');
  assert((await surfaces[0].map(sites[0])).distances.length === 300 * 300, 'and computed again');
}

/** Maps of each measure by a worker and by a pool, which are the same, with what they say of a ball of radius 1 and one of 0.8. */
export async function measuresAll(worker, pool) {
  const part = ball(40), other = ball(30, 0.8), rest = part.positions.map((x) => 2 * x);
  const [onPool, on] = await Promise.all([pool, worker].map((one) => one.surface(part.positions, part.indices, { resolution: 200 })));
  const [ofPool, itself] = await Promise.all([pool, worker].map((one) => one.sites(part.positions, part.indices)));
  const [toPool, to] = await Promise.all([pool, worker].map((one) => one.sites(other.positions, other.indices)));
  const controller = new AbortController();
  for (const [options, least, most, own = true] of [
    [{ along: 'normal' }, 0.19, 0.21, false],
    [{ along: [0, 0, 1], maxDistance: 0.3 }, 0.19, 0.3, false],
    [{ measure: 'self', rings: 2 }, 0.01, 0.2],
    [{ measure: 'self', geodesic: 0.5, rest }, 0.1, 2],
    [{ measure: 'thickness', angle: 60 }, 1.4, 2],
    [{ measure: 'thickness', method: 'ray' }, 1.9, 2],
  ]) {
    const name = JSON.stringify({ ...options, rest: undefined });
    const ours = await onPool.map(own ? ofPool : toPool, options);
    const map = await on.map(own ? itself : to, { ...options, signal: controller.signal });
    const whole = await map.arrays('distances', 'vectors', 'sitesOfTexels', 'siteTypes');
    for (const array of Object.keys(whole)) assert(sameBits(ours[array], whole[array]), `${array} of the pool differ, ${name}`);
    assert(ours.sign === map.sign && ours.signReason === map.signReason, `sign ${ours.sign}, ${name}`);
    const values = whole.distances.filter((d) => !Number.isNaN(d));
    assert(values.length > 5000, `${values.length} values, ${name}`);
    assert(values.every((d) => d >= least && d <= most), `from ${Math.min(...values)} to ${Math.max(...values)}, ${name}`);
    const { measured } = await map.summary();
    assert(own && options.measure === 'self' ? measured === undefined : measured.kind === (options.measure ?? 'along'), `measured ${measured?.kind}, ${name}`);
  }
  const refused = await rejection(onPool.map(ofPool, { measure: 'self', ring: 2 }));
  assert(refused.kind === 'input' && refused.message === 'unknown option ring; did you mean rings?', `${refused}`);
}

/** Maps and refits of a pool that are called at once are done in the order of their calls. */
async function mapsInTurns(pool, worker, part) {
  const bodies = [ball(30, 0.8), ball(30, 0.6)], moved = bodies[0].positions.map((x) => 1.1 * x);
  const results = async (of) => {
    const surface = await of.surface(part.positions, part.indices, { resolution: 300 });
    const [a, b] = await Promise.all(bodies.map(({ positions, indices }) => of.sites(positions, indices)));
    const [first, second, , third] = await Promise.all([surface.map(a), surface.map(b), a.refit(moved), surface.map(a)]);
    return Promise.all([first, second, third].map(async (map) => (map.arrays ? map.arrays('distances', 'vectors') : map)));
  };
  const [ours, whole] = [await results(pool), await results(worker)];
  whole.forEach((map, i) => {
    for (const name of Object.keys(map)) assert(sameBits(ours[i][name], map[name]), `${name} of map ${i} of those at once differ`);
  });
}

export async function failsToStart(createWorker, options, scripts) {
  for (const script of scripts) {
    const error = await rejection(createWorker({ ...options, script }));
    assert(error.name === 'SdmError', `${script}: ${error}`);
  }
}
