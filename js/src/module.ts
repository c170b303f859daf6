// A WebAssembly module of the library: its memory, its calls and their results.
import { type Bytes, text } from './bytes.js';
import { type Threads, hostImports } from './host.js';
import { readResult } from './results.js';
import { startThreads } from './threads.js';
import { type NumberArray, SdmError, type Progress } from './types.js';

type Address = number;
/** A text is passed by its address and its length. */
type Argument = number | string | NumberArray | null;

const kErrors = ['', 'input', 'cancelled', 'memory'] as const;

export type ModuleFile = BufferSource | WebAssembly.Module;
/** `full` has bodies that move, files and reports, too. */
export interface ModuleFiles {
  core?: ModuleFile | undefined;
  full?: ModuleFile | undefined;
}

/** What a module is started with. */
export interface ModuleStart {
  /** With a memory that is shared if there are several threads. */
  module: WebAssembly.Module;
  threads: number;
  /** The address of worker.js, the program of threads. */
  script: string;
}

/** Pages of 64 KiB: what the module declares (js/CMakeLists.txt). */
const kMemory = { initial: 64, maximum: 65536 };

/** Memory can be shared in Node, and in browsers where the page is isolated. */
export function canShareMemory(): boolean {
  const isolated = (globalThis as { crossOriginIsolated?: boolean }).crossOriginIsolated;
  return typeof SharedArrayBuffer === 'function' && isolated !== false;
}
/** The main thread of a page may not wait for other threads. */
export function mayWait(): boolean {
  return typeof document === 'undefined';
}

export class Module {
  private readonly functions: Record<string, (...values: number[]) => number>;
  private threads: Threads | undefined;
  private progress: Progress | undefined;
  private lastWords = '';
  private fault: SdmError | undefined;
  /** The page that reports are written into. */
  reportPage: (() => Promise<string>) | undefined;
  private readonly freed = new FinalizationRegistry<() => void>((free) => free());

  private constructor(
    instance: WebAssembly.Instance,
    private readonly memory: WebAssembly.Memory,
  ) {
    this.functions = instance.exports as typeof this.functions;
  }

  static async start({ module, threads, script }: ModuleStart): Promise<Module> {
    const memory = new WebAssembly.Memory({ ...kMemory, shared: threads > 1 });
    let started: Module | undefined;
    const imports = hostImports(
      () => memory.buffer,
      () => started?.threads,
      (step, fraction) => started?.progress?.(step, fraction) !== false,
      (text) => {
        if (started) started.lastWords = (started.lastWords + text).slice(-1000);
      },
    );
    const instance = await WebAssembly.instantiate(module, { ...imports, env: { memory } });
    started = new Module(instance, memory);
    started.functions['__wasm_call_ctors']!();
    if (threads > 1)
      started.threads = await startThreads(module, memory, threads, script, (bytes) =>
        started!.allocate(bytes),
      );
    return started;
  }

  /** The flags of sdm_cancel_flags(), if other threads can set them. */
  sharedFlags(): Uint8Array | undefined {
    const { buffer } = this.memory;
    if (typeof SharedArrayBuffer !== 'function' || !(buffer instanceof SharedArrayBuffer)) return undefined;
    return new Uint8Array(buffer, this.functions['sdm_cancel_flags']!() >>> 0, 256);
  }
  /** Lets the next calls be cancelled by a flag. */
  obey(flag: number): void {
    this.functions['sdm_obey']!(flag);
  }

  get threadCount(): number {
    return this.threads?.count ?? 1;
  }

  /** The number of bytes that the module has taken from the system. */
  get memoryBytes(): number {
    return this.memory.buffer.byteLength;
  }

  stop(): void {
    this.threads?.stop();
  }
  /** Whether a function is exported: whether the module is `full`. */
  has(name: string): boolean {
    return name in this.functions;
  }

  /** Whether a call or a thread has stopped half-way, so that the state of the memory is unknown: nothing can be called any more. */
  get broken(): boolean {
    return this.fault !== undefined || this.threads?.failure.reason !== undefined;
  }

  private run(name: string, numbers: number[]): number {
    if (this.broken) throw this.fail('');
    try {
      return this.functions[name]!(...numbers) >>> 0;
    } catch (error) {
      throw this.fail(this.lastWords.trim() || (error as Error).message);
    }
  }

  /** What calls throw from now on: why a thread has failed, as this one then ends only because it waits for it, or the reason. */
  private fail(reason: string): SdmError {
    const ofThread = this.threads?.failure.reason;
    const why = ofThread === undefined ? reason : `a thread has failed: ${ofThread}`;
    this.fault ??= new SdmError('internal', `sdm: the module cannot go on: ${why}`);
    this.stop();
    return this.fault;
  }

  /** Calls an exported function, with arrays copied into the module and out of it. Returns the values that it names. */
  call<Result = Record<string, never>>(name: string, values: Argument[], progress?: Progress): Result {
    if (this.progress) throw new SdmError('input', 'the library was called by a callback of progress');
    const blocks: Address[] = [];
    // An exception of the callback must not pass through the module: the call is cancelled, and then it is thrown.
    let failure: { error: unknown } | undefined;
    this.progress = (step, fraction) => {
      try {
        return progress?.(step, fraction) !== false;
      } catch (error) {
        failure ??= { error };
        return false;
      }
    };
    try {
      const copied = ({ buffer, byteOffset, byteLength }: NumberArray) => {
        const block = this.allocate(byteLength);
        blocks.push(block);
        const from = new Uint8Array(buffer, byteOffset, byteLength);
        new Uint8Array(this.memory.buffer, block, byteLength).set(from);
        return block;
      };
      const numbers = values.flatMap((value) => {
        if (value === null) return 0;
        if (typeof value === 'number') return value;
        if (typeof value !== 'string') return copied(value);
        const words = new TextEncoder().encode(value);
        return [copied(words), words.length];
      });
      return this.read(this.run(name, numbers)) as Result;
    } catch (error) {
      throw failure ? failure.error : error;
    } finally {
      this.progress = undefined;
      for (const block of blocks) this.free('sdm_free', block);
    }
  }

  /** Frees what is at an address, unless the module is broken. */
  free(name: string, address: Address): void {
    if (this.progress) throw new SdmError('input', 'the library was called by a callback of progress');
    if (!this.broken) this.run(name, [address]);
  }

  /** A copy of bytes of the module. */
  bytes(address: Address, count: number): Bytes {
    const shown = new Uint8Array(this.memory.buffer, address, count);
    try {
      return shown.slice() as Bytes;
    } catch {
      throw new SdmError('memory', `sdm: there is no memory for a result of ${count} bytes`);
    }
  }

  /** Frees an object of the module when JavaScript's own is collected, unless it was freed before. */
  watch(object: object, free: () => void): void {
    this.freed.register(object, free, object);
  }
  unwatch(object: object): void {
    this.freed.unregister(object);
  }

  private allocate(bytes: number): Address {
    const block = this.run('sdm_allocate', [Math.max(1, bytes)]);
    if (block === 0) throw new SdmError('memory', 'sdm: not enough memory');
    return block;
  }

  // Result of module/result.h: error, message, names, numbers {address, bytes}, count, arrays {address, bytes}.
  private read(result: Address): Record<string, unknown> {
    try {
      const words = new Uint32Array(this.memory.buffer, result, 32);
      const bytes = (at: number) => this.bytes(words[at]!, words[at + 1]!);
      const error = kErrors[words[0]!];
      if (error) throw new SdmError(error, text(bytes(1)));
      return readResult(text(bytes(3)), new Float64Array(bytes(5).buffer), (i) => bytes(8 + 2 * i));
    } finally {
      this.run('sdm_free_result', [result]);
    }
  }
}
