// Workers in Node. SDM_PACKAGE: the folder of the package; SDM_REFERENCE: that of js_reference's files.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { pathToFileURL } from 'node:url';
import * as checks from './worker_checks.mjs';

const { createPool, createWorker } = await import(pathToFileURL(join(process.env.SDM_PACKAGE, 'index.js')));
const bytes = (name) => readFileSync(join(process.env.SDM_REFERENCE, name));
const read = (Kind, name) => new Kind(Uint8Array.from(bytes(name)).buffer);

for (const threads of [1, 2])
  test(`with ${threads} thread${threads > 1 ? 's' : ''}`, { timeout: 240000 }, async (t) => {
    const worker = await createWorker({ threads });
    assert.equal(worker.threads, threads);
    await t.test('agrees with the library', () => checks.agreesWithTheLibrary(worker, JSON.parse(bytes('pairs.json')), read));
    for (const name of ['namesFaults', 'movesBuffers', 'abortsMaps', 'abortsAnything', 'refitsWithoutMemory'])
      await t.test(name, () => checks[name](worker));
    const pool = await createPool({ workers: 2 });
    await t.test('dividesMaps', () => checks.dividesMaps(pool, worker));
    pool.terminate();
    const pending = worker.sites([0, 0, 0, 1, 0, 0, 0, 1, 0]);
    worker.terminate();
    await assert.rejects(pending, { kind: 'ended' });
    await assert.rejects(worker.sites([0, 0, 0, 1, 0, 0, 0, 1, 0]), { kind: 'ended' });
  });

test('a worker that cannot be started rejects', { timeout: 120000 }, () =>
  checks.failsToStart(createWorker, { threads: 1 }, ['file:///nowhere/worker.js', 'data:text/javascript,1', 'data:text/javascript,throw 1']));
