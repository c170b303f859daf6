// The checks of workers, for a page. With window.embedded, the files of the package are in the page.
import * as sdm from '/package/index.js';
import * as checks from './worker_checks.mjs';
import { ball } from './shapes.mjs';

const bytesOf = (base64) => Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
const { embedded } = window;
const blob = (text) => URL.createObjectURL(new Blob([text], { type: 'text/javascript' }));
const options = embedded ? { modules: { core: bytesOf(embedded.core), full: bytesOf(embedded.full) }, script: blob(embedded.script) } : {};

let files, worker;
const read = (Kind, name) => new Kind(bytesOf(files[name]).buffer);

const all = {
  agrees: () => checks.agreesWithTheLibrary(worker, JSON.parse(new TextDecoder().decode(bytesOf(files['pairs.json']))), read),
  namesFaults: () => checks.namesFaults(worker),
  movesBuffers: () => checks.movesBuffers(worker),
  abortsMaps: () => checks.abortsMaps(worker),
  abortsAnything: () => checks.abortsAnything(worker),
  apart: () => checks.keepsCallsApart(worker),
  others: () => checks.refusesObjectsOfOthers(worker, () => sdm.createWorker({ ...options, threads: 1 })),
  refits: () => checks.refitsWithoutMemory(worker, embedded ? 10000 : 1000),
  async divides() {
    const pool = await sdm.createPool({ ...options, workers: 3 });
    await checks.dividesMaps(pool, worker);
    pool.terminate();
  },
  async measures() {
    const full = await sdm.createWorker({ ...options, full: true, threads: 1 });
    const pool = await sdm.createPool({ ...options, full: true, workers: 2 });
    await checks.measuresAll(full, pool);
    full.terminate();
    pool.terminate();
  },
};

window.checks = {
  setReference: (given) => void (files = given),
  async begin() {
    worker = await sdm.createWorker({ ...options, threads: 2 });
    return { sharesMemory: worker.sharesMemory, threads: worker.threads };
  },
  run: (name) => all[name](),
  failsToStart: (script) => checks.failsToStart(sdm.createWorker, options, [script === 'broken blob' ? blob('not a program') : script]),
  async synchronous() {
    const library = await sdm.start(options);
    const { positions, indices } = ball(10);
    if (library.threads !== 1 || new library.Sites(positions, indices).closestPoints([0, 0, 3]).distances[0] !== 2) throw new Error('wrong');
  },
};
