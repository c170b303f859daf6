// The package sdm: exact distances between triangle meshes.
import { checkStart } from './calls.js';
import { Sdm } from './library.js';
import { type ReportPage, load, textOf } from './load.js';
import { Module, type ModuleFile, type ModuleFiles, canShareMemory, mayWait } from './module.js';
import { platform } from './platform.js';
import { SdmPool } from './pool.js';
import { SdmWorker } from './sdm_worker.js';
import { isWebAssembly, withMemory } from './shared_memory.js';
import { SdmError } from './types.js';

export * from './types.js';
export type { Animation, ReadAnimationOptions } from './animation.js';
export type { Sdm } from './library.js';
export type { Look, Picture } from './look.js';
export { kMatchKinds } from './matches.js';
export type {
  BakeChannel,
  BakedLook,
  BakedTexture,
  DrawnModel,
  MatchArrays,
  MatchOptions,
  Matches,
  NormalOptions,
} from './matches.js';
export type { FaceNames, MeshFile, ReadMeshOptions } from './mesh_file.js';
export type { PoolMap, PoolMapOptions, PoolSites, PoolSurface, SdmPool } from './pool.js';
export type { JudgedOptions, ReportOptions, SummaryOptions } from './report.js';
export type {
  AreaFractions,
  JudgedSummary,
  MapSummary,
  SummaryEvidence,
  SummaryExtreme,
  SummaryMesh,
  SummaryPart,
  SummaryParts,
  SummaryPlace,
  SummaryPlaces,
  SummaryProof,
  SummaryShare,
  SummaryStatistics,
  SummaryTolerance,
} from './summary.js';
export type { Contacts, Pair } from './pair.js';
export type {
  ClosestPointOptions,
  ClosestPoints,
  Hausdorff,
  HausdorffOptions,
  RayHits,
  RayOptions,
  SignedDistanceOptions,
  SignedDistances,
  Sites,
} from './sites.js';
export type { MapOptions } from './measures.js';
export type { Atlas, DistanceMap, Surface, SurfaceOptions } from './surface.js';
export type { CallOptions } from './connection.js';
export type { WorkerMap, WorkerMapOptions, WorkerPair, WorkerSites, WorkerSurface } from './remote.js';
export type { WorkerAnimation, WorkerLook, WorkerMatches } from './remote_looks.js';
export type { SdmWorker } from './sdm_worker.js';
export type { TransferOptions } from './transfer.js';
export type { OtherUnit } from './units.js';

export interface StartOptions {
  /**
   * The number of threads, where memory can be shared: in Node, and in workers of pages that are isolated from other origins. By
   * default as many as there are cores, at most 8.
   */
  threads?: number | undefined;
  /** The module that also has bodies that move (Pair), mesh files and reports (readMesh, summary, report). */
  full?: boolean | undefined;
  /** The modules, where they are not found beside this file. Those that are compiled already have one thread. */
  modules?: ModuleFiles | undefined;
  /** The address of worker.js, the program of workers and threads. To be one of a Blob, it must not be revoked. */
  script?: string | URL | undefined;
  /** The text of report_page.txt, for reports. */
  reportPage?: string | undefined;
}

/** Bundlers copy what these name. The page is none of theirs, which they would minify, but a text. */
const urls = {
  core: () => new URL('./sdm_core.wasm', import.meta.url),
  full: () => new URL('./sdm_full.wasm', import.meta.url),
  worker: () => new URL('./worker.js', import.meta.url),
  page: () => new URL('./report_page.txt', import.meta.url),
};

const coreCount = () => Math.min(8, platform().cores());
const threadsOf = (options: StartOptions) => (canShareMemory() ? (options.threads ?? coreCount()) : 1);

/** The module that the options ask for, compiled, and the number of its threads. */
async function compiled(
  options: StartOptions,
  threads: number,
): Promise<{ module: WebAssembly.Module; threads: number }> {
  const name = options.full ? 'full' : 'core';
  const url = urls[name];
  const file: ModuleFile = options.modules?.[name] ?? (await (await load(url())).arrayBuffer());
  if (file instanceof WebAssembly.Module) return { module: file, threads: 1 };
  // Some servers have a page in place of what they do not find.
  if (!isWebAssembly(file)) {
    const what = options.modules?.[name] ? `modules.${name}` : `what the server has at ${url()}`;
    throw new SdmError(
      'input',
      `${what} is no WebAssembly: it must be the file sdm_${name}.wasm of this package`,
    );
  }
  return { module: await WebAssembly.compile(threads > 1 ? withMemory(file, true) : file), threads };
}

const scriptOf = (options: StartOptions) => String(options.script ?? urls.worker());
/** Loaded when the first report is made. In a bundle of one file there is no address. */
function pageOf(options: StartOptions): ReportPage {
  if (options.reportPage !== undefined || !import.meta.url)
    return { text: options.reportPage, url: undefined };
  return { text: undefined, url: String(urls.page()) };
}

/** Starts the library in this thread, which waits for its calls. On the main thread of a page, it does without other threads. */
export async function start(options: StartOptions = {}): Promise<Sdm> {
  checkStart('start', options);
  const { module, threads } = await compiled(options, mayWait() ? threadsOf(options) : 1);
  const script = threads > 1 ? scriptOf(options) : '';
  return new Sdm(await Module.start({ module, threads, script }), () => textOf(pageOf(options)));
}

/** Starts the library in a worker. Throws SdmError if the worker cannot be started. */
export async function createWorker(options: StartOptions = {}): Promise<SdmWorker> {
  checkStart('createWorker', options);
  const { module, threads } = await compiled(options, threadsOf(options));
  return SdmWorker.open({ module, threads, script: scriptOf(options), reportPage: pageOf(options) });
}

/** Starts the library in several workers of one thread each, by default as many as there are cores, at most 8. */
export async function createPool(
  options: StartOptions & { workers?: number | undefined } = {},
): Promise<SdmPool> {
  checkStart('createPool', options);
  const count = options.workers ?? coreCount();
  const { module } = await compiled(options, 1);
  const script = scriptOf(options);
  const reportPage = pageOf(options);
  const starts = Array.from({ length: count }, () =>
    SdmWorker.open({ module, threads: 1, script, reportPage }),
  );
  const opened = await Promise.allSettled(starts);
  const workers = opened.flatMap((one) => (one.status === 'fulfilled' ? [one.value] : []));
  const failed = opened.find((one): one is PromiseRejectedResult => one.status === 'rejected');
  if (failed) {
    workers.forEach((worker) => worker.terminate());
    throw failed.reason;
  }
  return new SdmPool(workers);
}
