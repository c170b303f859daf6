// Maps by WebGPU in headless Chromium, whose SwiftShader computes on the processor, against WebAssembly on one thread.
//   node bench/javascript/webgpu.mjs [O1 O2] [--repetitions N] [--resolution N]
// O1 and O2 are mesh files; without any, balls of 70,000 faces. The maps are compared first; both take turns. Medians of the repetitions, in
// milliseconds: of all, and of this the search on the device, and the rest, which is the comparison in double precision by WebAssembly.
// playwright-core is that of the build (build/dev/dev_packages).
import { readFileSync } from 'node:fs';
import { basename, dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';

const { values: options, positionals: files } = parseArgs({
  allowPositionals: true, options: { repetitions: { type: 'string', default: '5' }, resolution: { type: 'string', default: '512' } } });
const root = join(dirname(fileURLToPath(import.meta.url)), '../..');
process.env.SDM_PACKAGE ??= join(root, 'build/wasm/package');
process.env.SDM_NODE_PACKAGES ??= join(root, 'build/dev/dev_packages');
const { launched } = await import('../../tests/js/chromium.mjs');
const { served } = await import('../../tests/js/server.mjs');

async function measure({ meshes, resolution, repetitions }) {
  const { createWorker } = await import('/package/index.js');
  const { ball } = await import('/shapes.mjs');
  // Each wait for results of the device is said.
  const timed = `{
    const map = GPUBuffer.prototype.mapAsync, channel = new BroadcastChannel('searched');
    GPUBuffer.prototype.mapAsync = function (...given) {
      const began = performance.now();
      return map.apply(this, given).then(() => channel.postMessage(performance.now() - began));
    };
  }\n`;
  let searched = 0;
  new BroadcastChannel('searched').onmessage = ({ data }) => (searched += data);
  const script = URL.createObjectURL(new Blob([timed + (await (await fetch('/package/worker.js')).text())], { type: 'text/javascript' }));
  const worker = await createWorker({ full: true, threads: 1, script });
  const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const [part, other] = meshes.length > 0
    ? await Promise.all(meshes.map(([name, text]) => worker.readMesh(bytes(text), name))) : [ball(132), ball(132, 0.97)];
  const surface = await worker.surface(part.positions, part.indices, { resolution });
  const sites = await worker.sites(other.positions, other.indices);
  const maps = { cpu: await surface.map(sites), gpu: await surface.map(sites, { engine: 'gpu' }) };
  const [a, b] = await Promise.all(Object.values(maps).map((map) => map.arrays('distances')));
  let worst = 0;
  a.distances.forEach((d, i) => (worst = Math.max(worst, Math.abs(d - b.distances[i]) || 0)));
  const times = { cpu: [], gpu: [], search: [] };
  for (let i = 0; i < repetitions; ++i)
    for (const engine of ['cpu', 'gpu']) {
      searched = 0;
      const began = performance.now();
      await maps[engine].update({ engine });
      times[engine].push(performance.now() - began);
      await new Promise((resolve) => setTimeout(resolve, 20));
      if (engine === 'gpu') times.search.push(searched);
    }
  worker.terminate();
  return { times, worst };
}

const browser = await launched(['--enable-unsafe-webgpu']), server = await served({});
try {
  const page = await browser.newPage();
  await page.goto(`http://127.0.0.1:${server.address().port}/page.html?shapes.mjs`);
  const meshes = files.map((file) => [basename(file), readFileSync(file).toString('base64')]);
  const { times, worst } = await page.evaluate(measure, { meshes, resolution: Number(options.resolution), repetitions: Number(options.repetitions) });
  const median = (all) => all.sort((x, y) => x - y)[all.length >> 1];
  const [cpu, gpu, search] = [times.cpu, times.gpu, times.search].map(median);
  console.log(`${options.resolution}²: WebAssembly ${cpu.toFixed(0)} ms; WebGPU ${gpu.toFixed(0)} ms (${(gpu / cpu).toFixed(1)} ×), of which the search ${search.toFixed(0)}, the rest ${(gpu - search).toFixed(0)} (${((gpu - search) / cpu).toFixed(2)} ×); the distances differ by ${worst.toExponential(1)} at most`);
} finally {
  await browser.close();
  server.closeAllConnections();
  server.close();
}
