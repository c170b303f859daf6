// The package sdm: exact distances between triangle meshes.
import { Module } from './module.js';
import * as bound from './surface.js';
import { type Indices, type Points } from './types.js';

export * from './types.js';
export type {
  Atlas, ClosestPoints, Contacts, Hausdorff, MapOptions, MapStatistics, RayHits, SignedDistances, SurfaceOptions,
} from './surface.js';

export interface StartOptions {
  /**
   * The number of threads, where memory can be shared: in Node, and in pages that are isolated from other origins. By default
   * as many as there are cores, at most 8.
   */
  threads?: number;
  /** The modules, where they are not found beside this file. */
  modules?: { single: BufferSource | WebAssembly.Module; threads?: BufferSource | WebAssembly.Module };
}

/** The library, with a memory of its own. Its calls are synchronous: in a page, call them in a worker. */
export interface Sdm {
  Surface: new (positions: Points, indices?: Indices, options?: bound.SurfaceOptions) => bound.Surface;
  Sites: new (positions: Points, indices?: Indices) => bound.Sites;
  Pair: new (...bodies: ConstructorParameters<typeof bound.Pair> extends [Module, ...infer Rest] ? Rest : never) => bound.Pair;
  readonly threads: number;
  /** What the module has taken from the system. */
  readonly memoryBytes: number;
  /** Ends its threads. Its objects cannot be used any more. */
  stop(): void;
}

async function load(name: string): Promise<BufferSource> {
  const url = new URL(name, import.meta.url);
  if (url.protocol === 'file:' && typeof process === 'object') {
    const { readFile } = await import('node:fs/promises');
    return (await readFile(url)) as BufferSource;
  }
  const response = await fetch(url);
  if (!response.ok) throw new Error(`${url}: ${response.status}`);
  return response.arrayBuffer();
}

/** Starts the library. */
export async function start(options: StartOptions = {}): Promise<Sdm> {
  const cores = typeof navigator === 'object' ? navigator.hardwareConcurrency : (await import('node:os')).availableParallelism();
  const threads = options.threads ?? Math.min(8, cores);
  const { canShareMemory } = await import('./module.js');
  const name = threads > 1 && canShareMemory() ? 'threads' : 'single';
  const files = options.modules ?? ({ [name]: await load(`./sdm_${name}.wasm`) } as { single: BufferSource });
  const module = await Module.start(files, threads);
  return {
    Surface: bound.Surface.bind(null, module) as unknown as Sdm['Surface'],
    Sites: bound.Sites.bind(null, module) as unknown as Sdm['Sites'],
    Pair: bound.Pair.bind(null, module) as unknown as Sdm['Pair'],
    get threads() {
      return module.threadCount;
    },
    get memoryBytes() {
      return module.memoryBytes;
    },
    stop: () => module.stop(),
  };
}

export type { Surface, Sites, DistanceMap, Pair } from './surface.js';
