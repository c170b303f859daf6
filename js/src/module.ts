// A WebAssembly module of the library: its memory, its calls and their results.
import { type NumberArray, SdmError, type Progress } from './types.js';
import { type Threads, startThreads } from './threads.js';

type Address = number;
type Argument = number | NumberArray | null;
type Result = Uint8Array<ArrayBuffer>[];

const kErrors = ['', 'input', 'cancelled', 'memory'] as const;

/** What the module imports (runtime/host.h), and the few functions that its C library names without calling them. */
export function hostImports(
  memory: () => ArrayBufferLike,
  threads: () => Threads | undefined,
  progress: (step: string, fraction: number) => boolean,
) {
  const text = (address: Address, bytes: number) =>
    new TextDecoder().decode(new Uint8Array(memory(), address >>> 0, bytes).slice());
  const unsupported = () => 52; // ENOSYS
  return {
    host: {
      threads: () => threads()?.count ?? 1,
      start_thread: (argument: Address) => (threads()?.start(argument) ? 1 : 0),
      now: () => performance.timeOrigin + performance.now(),
      abort: (message: Address, bytes: number) => {
        throw new SdmError('internal', `sdm: the module cannot go on ${text(message, bytes)}`.trim());
      },
      progress: (step: Address, bytes: number, fraction: number) => (progress(text(step, bytes), fraction) ? 1 : 0),
    },
    wasi_snapshot_preview1: {
      environ_get: unsupported,
      environ_sizes_get: unsupported,
      fd_close: unsupported,
      fd_seek: unsupported,
      fd_write: unsupported,
      proc_exit: () => {
        throw new SdmError('internal', 'sdm: the module has ended');
      },
    },
  };
}

export interface ModuleFiles {
  single: BufferSource | WebAssembly.Module;
  threads?: BufferSource | WebAssembly.Module;
}

/** Threads need memory that is shared, which browsers have only where the page is isolated. */
export function canShareMemory(): boolean {
  const isolated = (globalThis as { crossOriginIsolated?: boolean }).crossOriginIsolated;
  return typeof SharedArrayBuffer === 'function' && isolated !== false;
}

export class Module {
  private readonly functions: Record<string, (...values: number[]) => number>;
  private readonly memory: WebAssembly.Memory;
  private threads: Threads | undefined;
  private progress: Progress | undefined;
  private readonly freed = new FinalizationRegistry<() => void>((free) => free());

  private constructor(
    instance: WebAssembly.Instance,
    memory: WebAssembly.Memory | undefined,
  ) {
    this.functions = instance.exports as typeof this.functions;
    this.memory = memory ?? (instance.exports['memory'] as WebAssembly.Memory);
  }

  /** Compiles and starts the module with threads where memory can be shared and there is more than one, otherwise the other. */
  static async start(files: ModuleFiles, threads: number): Promise<Module> {
    const shared = threads > 1 && files.threads !== undefined && canShareMemory();
    const file = shared ? files.threads! : files.single;
    const compiled = file instanceof WebAssembly.Module ? file : await WebAssembly.compile(file);
    const memory = shared ? new WebAssembly.Memory({ initial: 256, maximum: 65536, shared: true }) : undefined;
    let started: Module | undefined;
    const imports = hostImports(
      () => started!.memory.buffer,
      () => started?.threads,
      (step, fraction) => started?.progress?.(step, fraction) !== false,
    );
    const instance = await WebAssembly.instantiate(compiled, memory ? { ...imports, env: { memory } } : imports);
    started = new Module(instance, memory);
    started.functions['__wasm_call_ctors']!();
    if (memory) started.threads = await startThreads(compiled, memory, threads, (bytes) => started!.allocate(bytes));
    return started;
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

  /** Calls an exported function, with arrays copied into the module and out of it. */
  call(name: string, values: Argument[], progress?: Progress): Result {
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
      const numbers = values.map((value) => {
        if (value === null) return 0;
        if (typeof value === 'number') return value;
        const block = this.allocate(value.byteLength);
        blocks.push(block);
        new (value.constructor as new (buffer: ArrayBufferLike, offset: number, length: number) => NumberArray)(
          this.memory.buffer, block, value.length).set(value);
        return block;
      });
      return this.read(this.functions[name]!(...numbers) >>> 0);
    } catch (error) {
      throw failure ? failure.error : error;
    } finally {
      this.progress = undefined;
      for (const block of blocks) this.functions['sdm_free']!(block);
    }
  }

  /** Calls a function that returns no result. */
  plain(name: string, ...numbers: number[]): number {
    if (this.progress) throw new SdmError('input', 'the library was called by a callback of progress');
    return this.functions[name]!(...numbers) >>> 0;
  }

  /** A copy of bytes of the module. */
  bytes(address: Address, count: number): Uint8Array<ArrayBuffer> {
    return new Uint8Array(this.memory.buffer, address, count).slice() as Uint8Array<ArrayBuffer>;
  }

  /** Frees an object of the module when JavaScript's own is collected, unless it was freed before. */
  watch(object: object, free: () => void): void {
    this.freed.register(object, free, object);
  }
  unwatch(object: object): void {
    this.freed.unregister(object);
  }

  private allocate(bytes: number): Address {
    const block = this.functions['sdm_allocate']!(Math.max(1, bytes)) >>> 0;
    if (block === 0) throw new SdmError('memory', 'sdm: not enough memory');
    return block;
  }

  // Result of module/result.h: error, message {address, bytes}, count, arrays {address, bytes}.
  private read(result: Address): Result {
    try {
      const words = new Uint32Array(this.memory.buffer, result, 28);
      const bytes = (at: number) => this.bytes(words[at]!, words[at + 1]!);
      const error = kErrors[words[0]!];
      if (error) throw new SdmError(error, new TextDecoder().decode(bytes(1)));
      return Array.from({ length: words[3]! }, (_, i) => bytes(4 + 2 * i));
    } finally {
      this.functions['sdm_free_result']!(result);
    }
  }
}
