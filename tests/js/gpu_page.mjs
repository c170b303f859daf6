// Maps by WebGPU in a worker, for a page. Each check throws what is wrong, or returns what was seen.
import { createWorker } from '/package/index.js';
import { ball } from './shapes.mjs';

const script = await (await fetch('/package/worker.js')).text();
/** A worker whose WebGPU is changed by a program before its own. */
const workerWith = (patch) =>
  createWorker({ full: true, threads: 1, script: URL.createObjectURL(new Blob([patch, '\n', script], { type: 'text/javascript' })) });

const hardware = `Object.defineProperty(GPUAdapterInfo.prototype, 'isFallbackAdapter', { get: () => false });`;
const limit = (bytes) => `for (const name of ['maxStorageBufferBindingSize', 'maxBufferSize'])
  Object.defineProperty(GPUSupportedLimits.prototype, name, { get: () => ${bytes} });`;
/** The first device is lost at its second search. */
const losing = `{
  let device, runs = 0;
  const request = GPUAdapter.prototype.requestDevice, submit = GPUQueue.prototype.submit;
  GPUAdapter.prototype.requestDevice = async function (...given) { const made = await request.apply(this, given); device ??= made; return made; };
  GPUQueue.prototype.submit = function (...given) { if (++runs === 2) { device.destroy(); new BroadcastChannel('lost').postMessage(0); } return submit.apply(this, given); };
}`;
const without = `Object.defineProperty(navigator, 'gpu', { value: undefined });`;
const withoutAdapter = `GPU.prototype.requestAdapter = async () => null;`;

function assert(condition, message) {
  if (!condition) throw new Error(message);
}
async function rejection(promise) {
  return promise.then(() => assert(false, 'the call should have failed'), (error) => error);
}
const sameBits = (a, b) => a.length === b.length && new Uint32Array(a.buffer).every((x, i) => x === new Uint32Array(b.buffer)[i]);

const kNames = ['distances', 'vectors', 'sitesOfTexels', 'siteTypes'];
let pair;
/** Two bodies of which one is in the other, in part, in a worker. */
async function bodies(worker, resolution = 320) {
  pair ??= [ball(60), ball(50, 0.9)];
  const [part, other] = pair, moved = other.positions.map((x, i) => x + (i % 3 === 0 ? 0.3 : 0));
  return { surface: await worker.surface(part.positions, part.indices, { resolution }), sites: await worker.sites(moved, other.indices) };
}

/** Computes a map by `auto`, until something has happened. */
async function untilBy(map, happened) {
  do {
    await map.update({ engine: 'auto' });
    await new Promise((resolve) => setTimeout(resolve, 10));
  } while (!happened());
}

window.checks = {
  /** Whether there is a device. */
  hasDevice: async () => Boolean(await navigator.gpu?.requestAdapter()),

  /** Distances of pairs, equal to those of the native engines but for the rounding of WebAssembly: one texel in 10⁵ within 10⁻⁷. */
  async agrees(pairs, files) {
    const worker = await createWorker({ full: true, threads: 1 });
    const read = (Kind, name) => new Kind(Uint8Array.from(atob(files[name]), (c) => c.charCodeAt(0)).buffer);
    let texels = 0, different = 0;
    for (const [i, { name }] of pairs.entries()) {
      const mesh = (of) => [read(Float64Array, `${i}.${of}.positions`), read(Uint32Array, `${i}.${of}.indices`)];
      const apart = mesh('apart'), size = Math.max(...apart[0].map(Math.abs));
      const surface = await worker.surface(...apart, { resolution: 128, atlas: 'uv', uvs: read(Float64Array, `${i}.apart.uvs`) });
      const sites = await worker.sites(...mesh('o2'));
      const map = await surface.map(sites, { engine: 'gpu' });
      assert(map.engine === 'gpu', `${name}: by ${map.engine}`);
      const { distances } = await map.arrays('distances'), expected = read(Float32Array, `${i}.reference.distances`);
      assert(distances.length === expected.length, `${name}: ${distances.length} texels`);
      for (let texel = 0; texel < expected.length; ++texel) {
        if (Number.isNaN(expected[texel]) && Number.isNaN(distances[texel])) continue;
        ++texels;
        if (distances[texel] === expected[texel]) continue;
        ++different;
        assert(Math.abs(distances[texel] - expected[texel]) <= 1e-7 * size, `${name}, texel ${texel}: ${distances[texel]}, not ${expected[texel]}`);
      }
      const sign = map.sign;
      await map.update();
      assert(map.engine === 'cpu' && map.sign === sign, `${name}: ${map.sign} and ${sign}`);
    }
    worker.terminate();
    assert(texels > 1e5 && different <= 1e-5 * texels + 1, `${different} of ${texels} texels differ`);
  },

  /** A map in several blocks beside that of the processor, also with options, after a refit, and of a tree in parts. */
  async blocks() {
    const worker = await createWorker({ full: true, threads: 1 }), parts = await workerWith(limit(300000));
    const [{ surface, sites }, divided] = [await bodies(worker), await bodies(parts)];
    let counts = 0;
    for (const options of [{}, { maxDistance: 0.1 }, { facing: 60 }]) {
      const maps = [await surface.map(sites, { ...options, engine: 'gpu' }), await surface.map(sites, options), await divided.surface.map(divided.sites, { ...options, engine: 'gpu' })];
      assert(maps[0].engine === 'gpu' && maps[1].engine === 'cpu' && maps[2].engine === 'gpu', 'engines');
      const [ours, cpu, byParts] = await Promise.all(maps.map((map) => map.arrays(...kNames)));
      for (const name of ['distances', 'vectors', 'sitesOfTexels']) assert(sameBits(ours[name], byParts[name]), `${name} of parts differ, ${JSON.stringify(options)}`);
      ours.distances.forEach((d, i) => {
        const close = Math.abs(d - cpu.distances[i]) <= 4e-6 || (Number.isNaN(d) && Number.isNaN(cpu.distances[i]));
        // At the limit, either may have no value.
        const atLimit = options.maxDistance && Math.abs((Number.isNaN(d) ? cpu.distances[i] : d) - 0.1) < 4e-6;
        assert(close || atLimit, `texel ${i}: ${d}, not ${cpu.distances[i]}, ${JSON.stringify(options)}`);
      });
      const [a, b] = await Promise.all(maps.slice(0, 2).map((map) => map.summary()));
      assert(a.sign.method === b.sign.method && Math.abs(a.distance.mean - b.distance.mean) < 1e-5, 'summaries');
      counts += ours.distances.filter((d) => d < 0).length;
    }
    assert(counts > 1000, 'no texel is inside');
    const map = await surface.map(sites, { engine: 'gpu' }), other = await surface.map(sites);
    await sites.refit(pair[1].positions);
    await Promise.all([map.update({ engine: 'gpu' }), other.update()]);
    const [ours, cpu] = await Promise.all([map.arrays('distances'), other.arrays('distances')]);
    assert(ours.distances.every((d, i) => Number.isNaN(d) || Math.abs(d - cpu.distances[i]) <= 4e-6), 'after a refit');
    worker.terminate(), parts.terminate();
  },

  /** What cannot be computed is refused by `gpu` in one sentence, and computed by the processor with `auto`. */
  async refuses() {
    for (const [patch, pattern, kind] of [
      [without, /^the engine gpu needs WebGPU, which is missing here: /, 'input'],
      [withoutAdapter, /^the engine gpu finds no device that WebGPU can use here: /, 'input'],
      [hardware + limit(2000), /^the engine gpu needs a buffer of 1 MB for .*, and the device permits 1 MB: /, 'memory'],
      [hardware + losing, /^the engine gpu lost its device when it searched: /, 'internal'],
    ]) {
      const worker = await workerWith(patch), { surface, sites } = await bodies(worker);
      const error = await rejection(surface.map(sites, { engine: 'gpu' }));
      assert(error.name === 'SdmError' && error.kind === kind && pattern.test(error.message), `${kind}: ${error.kind}: ${error}`);
      // A device that was lost is opened anew.
      if (patch.includes('destroy')) assert((await surface.map(sites, { engine: 'gpu' })).engine === 'gpu', 'a new device');
      worker.terminate();
      const again = await workerWith(patch), on = await bodies(again), map = await on.surface.map(on.sites);
      const expected = await map.arrays(...kNames);
      let lost = !patch.includes('destroy');
      new BroadcastChannel('lost').onmessage = () => (lost = true);
      await untilBy(map, () => lost);
      const ours = await map.arrays(...kNames);
      assert(map.engine === 'cpu' && kNames.slice(0, 3).every((name) => sameBits(ours[name], expected[name])), `auto: by ${map.engine}`);
      again.terminate();
    }
    const worker = await workerWith(hardware), { surface, sites } = await bodies(worker), small = await bodies(worker, 64);
    const map = await surface.map(sites, { engine: 'auto' }), few = await small.surface.map(small.sites, { engine: 'auto' });
    assert(map.engine === 'cpu', 'auto begins with the processor');
    await untilBy(map, () => map.engine === 'gpu');
    await few.update({ engine: 'auto' });
    assert(few.engine === 'cpu', 'for few samples, auto takes the processor');
    await map.update({ engine: 'auto', along: 'normal' });
    assert(map.engine === 'cpu', 'and for other measures');
    for (const [options, pattern] of [
      [{ engine: 'gpu', along: 'normal' }, /^the engine gpu has distances to the closest point only: use the engine 'cpu' for along$/],
      [{ engine: 'gpu', measure: 'self' }, /use the engine 'cpu' for self$/],
      [{ engine: 'fast' }, /^engine is "fast": it must be one of auto, cpu, gpu$/],
      [{ engine: 'gpu', maxdistance: 1 }, /^unknown option maxdistance; did you mean maxDistance\?$/],
    ]) {
      const error = await rejection(surface.map(sites, options));
      assert(error.kind === 'input' && pattern.test(error.message), `${error}`);
    }
    worker.terminate();
    const core = await createWorker({ threads: 1 }), on = await bodies(core, 64);
    assert(/^the engine gpu needs the module of createWorker\(\{ full: true \}\)$/.test((await rejection(on.surface.map(on.sites, { engine: 'gpu' }))).message), 'the small module');
    core.terminate();
  },

  /** An aborted map rejects, and the next one is computed. */
  async aborts() {
    const worker = await createWorker({ full: true, threads: 1 }), { surface, sites } = await bodies(worker);
    const controller = new AbortController();
    const error = await rejection(surface.map(sites, { engine: 'gpu', signal: controller.signal, progress: () => controller.abort() }));
    assert(error.name === 'AbortError', `${error}`);
    const on = await bodies(worker);
    assert((await on.surface.map(on.sites, { engine: 'gpu' })).engine === 'gpu', 'the next map');
    worker.terminate();
  },
};
