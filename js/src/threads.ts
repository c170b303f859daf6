// The workers of a module with threads. Each has an instance of the module, in the memory that all share, and waits until it is
// given a function to run.
import { hostImports } from './module.js';
import { SdmError } from './types.js';

const kStackBytes = 1 << 20;

export interface Threads {
  /** Of the module: the workers, and the thread that calls it. */
  count: number;
  /** Lets an idle worker run a function. False if all are busy. */
  start(argument: number): boolean;
  stop(): void;
}

/** What a worker is started with. A slot is 0 while its worker is idle, otherwise the argument of its function. */
export interface ThreadStart {
  module: WebAssembly.Module;
  memory: WebAssembly.Memory;
  slots: Int32Array<SharedArrayBuffer>;
  slot: number;
  count: number;
  stackTop: number;
  threadLocal: number;
}

interface AnyWorker {
  postMessage(message: unknown): void;
  terminate(): unknown;
  onReady(ready: () => void, failed: (reason: unknown) => void): void;
}

async function newWorker(url: URL): Promise<AnyWorker> {
  if (typeof Worker === 'function') {
    const worker = new Worker(url, { type: 'module' });
    return {
      postMessage: (message) => worker.postMessage(message),
      terminate: () => worker.terminate(),
      onReady: (ready, failed) => {
        worker.onmessage = ready;
        worker.onerror = failed;
      },
    };
  }
  const { Worker: NodeWorker } = await import('node:worker_threads');
  const worker = new NodeWorker(url);
  worker.unref();
  return {
    postMessage: (message) => worker.postMessage(message),
    terminate: () => worker.terminate(),
    onReady: (ready, failed) => {
      worker.once('message', ready);
      worker.once('error', failed);
    },
  };
}

export async function startThreads(
  module: WebAssembly.Module,
  memory: WebAssembly.Memory,
  count: number,
  allocate: (bytes: number) => number,
): Promise<Threads> {
  const slots = new Int32Array(new SharedArrayBuffer(4 * count));
  const workers = await Promise.all(
    Array.from({ length: count - 1 }, async (_, slot) => {
      const worker = await newWorker(new URL('./thread.js', import.meta.url));
      const stackTop = (allocate(kStackBytes) + kStackBytes) & ~15;
      const start: ThreadStart = { module, memory, slots, slot, count, stackTop, threadLocal: allocate(1024) };
      await new Promise<void>((ready, failed) => {
        worker.onReady(ready, failed);
        worker.postMessage(start);
      });
      return worker;
    }),
  );
  return {
    count,
    start: (argument) => startIn(slots, workers.length, argument),
    stop: () => workers.forEach((worker) => worker.terminate()),
  };
}

function startIn(slots: Int32Array, workers: number, argument: number): boolean {
  for (let slot = 0; slot < workers; ++slot)
    if (Atomics.compareExchange(slots, slot, 0, argument) === 0) {
      Atomics.notify(slots, slot);
      return true;
    }
  return false;
}

/** Runs functions for ever. */
export async function runThread(start: ThreadStart, ready: () => void): Promise<never> {
  const { slots, slot, count } = start;
  const threads: Threads = { count, start: (argument) => startIn(slots, count - 1, argument), stop: () => {} };
  const imports = hostImports(
    () => start.memory.buffer,
    () => threads,
    // Progress is of the call, whose thread alone has its callback.
    () => true,
  );
  const instance = await WebAssembly.instantiate(start.module, { ...imports, env: { memory: start.memory } });
  const exports = instance.exports as Record<string, any>;
  exports['__stack_pointer'].value = start.stackTop;
  if (exports['__tls_size'].value > 1024) throw new SdmError('internal', 'sdm: threads have too much of their own');
  exports['__wasm_init_tls'](start.threadLocal);
  ready();
  for (;;) {
    Atomics.wait(slots, slot, 0);
    const argument = Atomics.load(slots, slot);
    if (argument === 0) continue;
    exports['sdm_run_thread'](argument);
    Atomics.store(slots, slot, 0);
  }
}
