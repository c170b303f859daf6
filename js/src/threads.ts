// The workers of a module with threads. Each has an instance of the module, in the memory that all share, and waits until it is
// given a function to run.
import { type AnyWorker, newWorker, started } from './any_worker.js';
import { Failure } from './failure.js';
import { type Threads, hostImports } from './host.js';
import { SdmError } from './types.js';

/** What thread_local objects of a thread take, at most. */
const kThreadLocalBytes = 4096;

const kStackBytes = 1 << 20;

/** What a worker is started with. A slot is 0 while its worker is idle, otherwise the argument of its function. */
export interface ThreadStart {
  module: WebAssembly.Module;
  memory: WebAssembly.Memory;
  slots: Int32Array;
  failure: SharedArrayBuffer;
  slot: number;
  count: number;
  stackTop: number;
  threadLocal: number;
}

export async function startThreads(
  module: WebAssembly.Module,
  memory: WebAssembly.Memory,
  count: number,
  script: string,
  allocate: (bytes: number) => number,
): Promise<Threads> {
  const slots = new Int32Array(new SharedArrayBuffer(4 * count));
  const failure = new Failure();
  const workers: AnyWorker[] = [];
  const startOne = async (slot: number) => {
    const worker = newWorker(script);
    workers.push(worker);
    const stackTop = (allocate(kStackBytes) + kStackBytes) & ~15;
    const threadLocal = allocate(kThreadLocalBytes);
    const thread: ThreadStart = {
      module,
      memory,
      slots,
      failure: failure.memory,
      slot,
      count,
      stackTop,
      threadLocal,
    };
    await started(worker, { thread });
    worker.listen(
      () => {},
      (error) => failure.set(error.message),
    );
  };
  try {
    await Promise.all(Array.from({ length: count - 1 }, (_, slot) => startOne(slot)));
  } catch (error) {
    workers.forEach((worker) => worker.terminate());
    throw error;
  }
  return {
    count,
    start: (argument) => startIn(slots, workers.length, argument),
    failure,
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

/** Runs functions in a worker, until one of them fails. */
export async function runThread(start: ThreadStart, ready: () => void): Promise<void> {
  const { slots, slot, count } = start;
  const failure = new Failure(start.failure);
  const threads: Threads = {
    count,
    start: (argument) => startIn(slots, count - 1, argument),
    failure,
    stop: () => {},
  };
  let lastWords = '';
  const imports = hostImports(
    () => start.memory.buffer,
    () => threads,
    // Progress is of the call, whose thread alone has its callback.
    () => true,
    (text) => (lastWords += text),
  );
  const instance = await WebAssembly.instantiate(start.module, { ...imports, env: { memory: start.memory } });
  const exports = instance.exports as Record<string, any>;
  exports['__stack_pointer'].value = start.stackTop;
  if (exports['__tls_size'].value > kThreadLocalBytes)
    throw new SdmError('internal', 'sdm: threads have too much of their own');
  exports['__wasm_init_tls'](start.threadLocal);
  ready();
  try {
    for (;;) {
      Atomics.wait(slots, slot, 0);
      const argument = Atomics.load(slots, slot);
      if (argument === 0) continue;
      exports['sdm_run_thread'](argument);
      Atomics.store(slots, slot, 0);
    }
  } catch (error) {
    failure.set(lastWords.trim() || (error as Error).message);
  }
}
