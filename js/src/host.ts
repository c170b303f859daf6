// What a module asks of JavaScript.
import { type Failure } from './failure.js';
import { SdmError } from './types.js';

export interface Threads {
  /** Of the module: the workers, and the thread that calls it. */
  count: number;
  /** Lets an idle worker run a function. False if all are busy. */
  start(argument: number): boolean;
  /** Of one of the threads, after which those that wait for it end, too. */
  failure: Failure;
  stop(): void;
}

type Address = number;

/** What the module imports (runtime/host.h), and the few functions that its C library names without calling them. */
export function hostImports(
  memory: () => ArrayBufferLike,
  threads: () => Threads | undefined,
  progress: (step: string, fraction: number) => boolean,
  said: (text: string) => void,
) {
  const text = (address: Address, bytes: number) =>
    new TextDecoder().decode(new Uint8Array(memory(), address >>> 0, bytes).slice());
  const unsupported = () => 52; // ENOSYS
  return {
    host: {
      threads: () => threads()?.count ?? 1,
      start_thread: (argument: Address) => (threads()?.start(argument) ? 1 : 0),
      thread_failed: () => (threads()?.failure.reason === undefined ? 0 : 1),
      now: () => performance.timeOrigin + performance.now(),
      progress: (step: Address, bytes: number, fraction: number) =>
        progress(text(step, bytes), fraction) ? 1 : 0,
    },
    wasi_snapshot_preview1: {
      // There are no variables of the environment.
      environ_get: () => 0,
      environ_sizes_get: (count: Address, bytes: Address) => {
        const view = new DataView(memory());
        for (const at of [count, bytes]) view.setUint32(at >>> 0, 0, true);
        return 0;
      },
      fd_close: unsupported,
      fd_seek: unsupported,
      // Why the module ends.
      fd_write: (_file: number, parts: Address, count: number, written: Address) => {
        const view = new DataView(memory());
        let sum = 0;
        for (let at = parts >>> 0, i = 0; i < count; ++i, at += 8) {
          const bytes = view.getUint32(at + 4, true);
          said(text(view.getUint32(at, true), bytes));
          sum += bytes;
        }
        view.setUint32(written >>> 0, sum, true);
        return 0;
      },
      random_get: (address: Address, bytes: number) => {
        // Not into the memory itself, which may be shared. Node 18 has no `crypto`.
        const random = Uint8Array.from({ length: bytes }, () => 256 * Math.random());
        new Uint8Array(memory(), address >>> 0, bytes).set(
          globalThis.crypto?.getRandomValues(random) ?? random,
        );
        return 0;
      },
      proc_exit: () => {
        throw new SdmError('internal', 'sdm: the module has ended');
      },
    },
  };
}
