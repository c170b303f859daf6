// Workers in Node. SDM_PACKAGE: the folder of the package; SDM_REFERENCE: that of js_reference's files.
import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { setFlagsFromString } from 'node:v8';
import { runInNewContext } from 'node:vm';
import { ball } from './shapes.mjs';
import * as checks from './worker_checks.mjs';

const { createPool, createWorker } = await import(pathToFileURL(join(process.env.SDM_PACKAGE, 'node.js')));
const bytes = (name) => readFileSync(join(process.env.SDM_REFERENCE, name));
const read = (Kind, name) => new Kind(Uint8Array.from(bytes(name)).buffer);

for (const threads of [1, 2])
  test(`with ${threads} thread${threads > 1 ? 's' : ''}`, { timeout: 800000 }, async (t) => {
    const worker = await createWorker({ threads });
    assert.equal(worker.threads, threads);
    await t.test('agrees with the library', () => checks.agreesWithTheLibrary(worker, JSON.parse(bytes('pairs.json')), read));
    for (const name of ['namesFaults', 'movesBuffers', 'keepsCallsApart', 'abortsMaps', 'abortsAnything'])
      await t.test(name, () => checks[name](worker));
    await t.test('refitsWithoutMemory', () => checks.refitsWithoutMemory(worker, threads === 1 ? 10000 : 1000));
    await t.test('refusesObjectsOfOthers', () => checks.refusesObjectsOfOthers(worker, () => createWorker({ threads: 1 })));
    const pool = await createPool({ workers: 2 });
    await t.test('dividesMaps', () => checks.dividesMaps(pool, worker));
    pool.terminate();
    const pending = worker.sites([0, 0, 0, 1, 0, 0, 0, 1, 0]);
    worker.terminate();
    await assert.rejects(pending, { kind: 'ended' });
    await assert.rejects(worker.sites([0, 0, 0, 1, 0, 0, 0, 1, 0]), { kind: 'ended' });
  });

test('measures', { timeout: 300000 }, async () => {
  const worker = await createWorker({ threads: 2, full: true }), pool = await createPool({ workers: 3, full: true });
  await checks.measuresAll(worker, pool);
  worker.terminate();
  pool.terminate();
});

test('a worker that cannot be started rejects', { timeout: 120000 }, () =>
  checks.failsToStart(createWorker, { threads: 1 }, ['file:///nowhere/worker.js', 'data:text/javascript,1', 'data:text/javascript,throw 1']));

const triangle = [0, 0, 0, 1, 0, 0, 0, 1, 0];

/** A program that ends or hangs at calls with the option `fault`, and whose threads begin with `ofThread`; otherwise worker.js. */
function faultyScript(t, ofThread = 'f(message)') {
  const folder = mkdtempSync(join(tmpdir(), 'sdm-js-'));
  t.after(() => rmSync(folder, { recursive: true }));
  const file = pathToFileURL(join(folder, 'worker.mjs'));
  writeFileSync(file, `import { parentPort } from 'node:worker_threads';
    const faults = { ends: () => process.exit(1), hangs: () => Atomics.wait(new Int32Array(new SharedArrayBuffer(4)), 0, 0) };
    const on = parentPort.on.bind(parentPort);
    const begin = (message, f) => ${ofThread};
    parentPort.on = (name, f) => on(name, (message) => message.thread ? begin(message, f) : (faults[message.call?.options.fault] ?? f)(message));
    await import(${JSON.stringify(pathToFileURL(join(process.env.SDM_PACKAGE, 'worker.js')).href)});`);
  return file;
}
const pause = (milliseconds) => new Promise((resolve) => setTimeout(resolve, milliseconds));

for (const fault of ['ends', 'hangs'])
  test(`a worker that ${fault} is replaced once`, { timeout: 300000 }, async (t) => {
    const worker = await createWorker({ threads: 1, script: faultyScript(t) });
    const before = await worker.sites(triangle), controller = new AbortController();
    const faulty = assert.rejects(worker.sites(triangle, null, { fault, signal: controller.signal }), fault === 'hangs' ? { name: 'AbortError' } : { kind: 'ended' });
    const next = assert.rejects(before.closestPoints([0, 0, 1]), { kind: 'ended' });
    if (fault === 'hangs') controller.abort();
    await Promise.all([faulty, next]);
    const after = await worker.sites(triangle);
    assert.equal((await after.closestPoints([0, 0, 1])).distances[0], 1);
    await pause(300);
    assert.equal((await after.closestPoints([0, 0, 2])).distances[0], 2);
    assert.equal(worker.restarts, 1);
    await assert.rejects(before.closestPoints([0, 0, 1]), { kind: 'ended' });
    worker.terminate();
  });

// Its stack is where no memory is; its program ends once it waits for functions.
const faultsOfThreads = {
  traps: ['(message.thread.stackTop = 16, f(message))', /a thread has failed: .*out of bounds/],
  ends: ['(Atomics.wait = () => process.exit(1), f(message))', /a thread has failed: the worker has ended/],
};
for (const [fault, [ofThread, message]] of Object.entries(faultsOfThreads))
  test(`a thread that ${fault} is an error of the call that waits for it, or of the next one`, { timeout: 120000 }, async (t) => {
    const worker = await createWorker({ threads: 2, script: faultyScript(t, ofThread) });
    const { positions, indices } = ball(60);
    const untilItFails = async () => {
      for (;;) await (await worker.sites(positions, indices)).closestPoints(positions);
    };
    await assert.rejects(untilItFails(), { kind: 'internal', message });
    assert.equal(worker.restarts, 1);
    worker.terminate();
  });

test('calls that wait for another worker obey their signal and terminate()', { timeout: 300000 }, async (t) => {
  const worker = await createWorker({ threads: 1, script: faultyScript(t) });
  await assert.rejects(worker.sites(triangle, null, { fault: 'ends' }), { kind: 'ended' });
  const order = [], controller = new AbortController();
  const waiting = worker.sites(triangle).then(() => order.push('made'));
  const aborted = worker.sites(triangle, null, { signal: controller.signal }).catch(({ name }) => order.push(name));
  controller.abort();
  await Promise.all([waiting, aborted]);
  assert.deepEqual(order, ['AbortError', 'made']);
  await assert.rejects(worker.sites(triangle, null, { fault: 'ends' }), { kind: 'ended' });
  const last = assert.rejects(worker.sites(triangle), { kind: 'ended', message: /terminated/ });
  worker.terminate();
  await last;
});

test('a Buffer keeps its bytes', { timeout: 120000 }, async () => {
  const worker = await createWorker({ threads: 1 }), { positions, indices } = ball(20);
  const surface = await worker.surface(positions, indices, { resolution: 128 });
  const storedAtlas = Buffer.from(await surface.storedAtlas()), { length } = storedAtlas;
  for (let i = 0; i < 2; ++i) {
    const again = await worker.surface(positions, indices, { resolution: 128, storedAtlas });
    assert.equal(storedAtlas.length, length);
    assert.deepEqual(await again.atlas(), await surface.atlas());
  }
  worker.terminate();
});

test('a map keeps its surface and sites from being collected', { timeout: 120000 }, async () => {
  setFlagsFromString('--expose-gc');
  const collect = runInNewContext('gc');
  const worker = await createWorker({ threads: 1 }), { positions, indices } = ball(20);
  const made = async () => (await worker.surface(positions, indices, { resolution: 128 })).map(await worker.sites(positions, indices));
  const map = await made();
  for (let i = 0; i < 5; ++i) collect(), await pause(20);
  await map.update();
  assert.ok((await map.statistics()).texels > 0);
  worker.terminate();
});
