// What workers of Node run: worker.js, with the interfaces of Node.
import { workerData } from 'node:worker_threads';
import { node } from './node_platform.js';
import { kGlobal } from './platform.js';

Object.assign(globalThis, { [kGlobal]: node });
await import(workerData);
