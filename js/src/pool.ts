// Maps by several workers that share no memory.
import { anything, checkMethods, mesh, object, ofMap, ofSurface, take, takeDeclared } from './calls.js';
import { type CallOptions, type Options, unlessAborted } from './connection.js';
import { type MapOptions, preparesMuch } from './measures.js';
import { type WorkerMap, type WorkerSites, type WorkerSurface } from './remote.js';
import { type SdmWorker } from './sdm_worker.js';
import { type Atlas, type SurfaceOptions } from './surface.js';
import { type Indices, type MapValues, type Points, SdmError, type SignMethod } from './types.js';

export type PoolMapOptions = Options<MapOptions>;

/** The arrays of a map, as of DistanceMap. */
export interface PoolMap extends MapValues {
  resolution: number;
  rows: number;
  sign: SignMethod;
  signReason: string;
}

// Each worker has about so many ranges of samples, so that none waits long for the last one.
const kRangesPerWorker = 4;

/** Calls one after the other, so that none sees objects that another one is changing. */
class Turns {
  private last: Promise<unknown> = Promise.resolve();

  /** Runs after all calls before, whether these failed or not. */
  take<Value>(run: () => Promise<Value>): Promise<Value> {
    const turn = this.last.then(run);
    this.last = turn.catch(() => {});
    return turn;
  }
}

/** Waits for all, also if one fails, so that nothing goes on afterwards; then throws what the first of them threw. */
async function all<Value>(promises: Promise<Value>[]): Promise<Value[]> {
  const settled = await Promise.allSettled(promises);
  const failed = settled.find((one): one is PromiseRejectedResult => one.status === 'rejected');
  if (failed) throw failed.reason;
  return settled.map((one) => (one as PromiseFulfilledResult<Value>).value);
}

/** Sites in all workers of a pool. */
export class PoolSites {
  /** @internal */
  constructor(
    /** @internal */ readonly each: WorkerSites[],
    private readonly turns: Turns,
  ) {}
  get closed(): boolean {
    return this.each[0]!.closed;
  }
  get orientable(): boolean {
    return this.each[0]!.orientable;
  }
  async refit(positions: Points): Promise<void> {
    const moved = Float64Array.from(positions);
    await this.turns.take(() => all(this.each.map((sites) => sites.refit(moved))));
  }
  /** Frees them once the calls before have ended. */
  dispose(): void {
    void this.turns.take(async () => this.each.forEach((sites) => sites.dispose()));
  }
}

/** A surface in all workers of a pool. */
export class PoolSurface {
  private maps: { sites: PoolSites; each: WorkerMap[] } | undefined;
  private texels: Uint32Array | undefined;

  /** @internal */
  constructor(
    private readonly each: WorkerSurface[],
    private readonly turns: Turns,
  ) {}

  async refit(positions: Points): Promise<void> {
    const moved = Float64Array.from(positions);
    await this.turns.take(() => all(this.each.map((surface) => surface.refit(moved))));
  }
  atlas(): Promise<Atlas> {
    return this.each[0]!.atlas();
  }
  /**
   * The surface distance map: each worker computes ranges of the samples, one after the other. The arrays are those of Surface.map()
   * to the bit. Maps and refits of a pool are done one after the other, in the order of their calls. An aborted call rejects at once;
   * the next one begins once the ranges that were begun have ended, some milliseconds later. All objects stay.
   */
  async map(sites: PoolSites, options: PoolMapOptions = {}): Promise<PoolMap> {
    options.signal?.throwIfAborted();
    // Later, the caller may have changed it.
    const rest = options.measure === 'self' && options.rest && Float64Array.from(options.rest);
    const kept = rest ? { ...options, rest } : options;
    return unlessAborted(
      this.turns.take(() => this.mapNow(sites, kept)),
      options.signal,
    );
  }

  private async mapNow(sites: PoolSites, options: PoolMapOptions): Promise<PoolMap> {
    const { signal, progress, transfer: _, ...measure } = options;
    signal?.throwIfAborted();
    const maps = await this.mapsTo(sites);
    this.texels ??= (await this.each[0]!.samples()).texels;
    const { texels } = this;
    const { samples, grain } = await this.each[0]!.sampleCounts();
    const { resolution, rows } = maps[0]!;
    const result = noValues(resolution, rows);
    const ranges = maps.length * (preparesMuch(measure) ? 1 : kRangesPerWorker);
    const size = grain * Math.max(1, Math.ceil(samples / grain / ranges));
    let next = 0;
    let done = 0;
    let failed = false;
    let signs = {} as { sign: SignMethod; signReason: string };
    const computeRanges = async (map: WorkerMap) => {
      while (next < samples && !failed && !signal?.aborted) {
        const first = next;
        const count = Math.min(size, samples - first);
        next += count;
        const { sign, signReason, ...values } = await map.computeValues(first, count, measure);
        signs = { sign, signReason };
        store(result, texels, first, values);
        done += count;
        if (!signal?.aborted) progress?.('map', done / samples);
      }
    };
    await all(
      maps.map((map) =>
        computeRanges(map).catch((error) => {
          failed = true;
          throw error;
        }),
      ),
    );
    signal?.throwIfAborted();
    return { resolution, rows, ...signs, ...result };
  }
  /** Frees it once the calls before have ended. */
  dispose(): void {
    void this.turns.take(async () => {
      this.maps?.each.forEach((map) => map.dispose());
      this.each.forEach((surface) => surface.dispose());
    });
  }

  /** The maps of the workers to these sites; those to other sites are freed. */
  private async mapsTo(sites: PoolSites): Promise<WorkerMap[]> {
    if (
      this.each.length !== sites.each.length ||
      this.each.some((one, i) => one.connection !== sites.each[i]!.connection)
    )
      throw new SdmError('input', 'the objects belong to different pools');
    if (this.maps?.sites !== sites) {
      const each = await all(this.each.map((surface, i) => surface.emptyMap(sites.each[i]!)));
      this.maps?.each.forEach((map) => map.dispose());
      this.maps = { sites, each };
    }
    return this.maps.each;
  }
}

function noValues(resolution: number, rows: number): MapValues {
  const texels = resolution * rows;
  return {
    distances: new Float32Array(texels).fill(NaN),
    vectors: new Float32Array(3 * texels).fill(NaN),
    sitesOfTexels: new Uint32Array(texels).fill(0xffffffff),
    siteTypes: new Uint8Array(texels).fill(255),
  };
}

function store(into: MapValues, texels: Uint32Array, first: number, values: MapValues): void {
  for (let i = 0; i < values.distances.length; ++i) {
    const texel = texels[first + i]!;
    if (texel >= into.distances.length) continue; // of a face without a texel
    into.distances[texel] = values.distances[i]!;
    for (let k = 0; k < 3; ++k) into.vectors[3 * texel + k] = values.vectors[3 * i + k]!;
    into.sitesOfTexels[texel] = values.sitesOfTexels[i]!;
    into.siteTypes[texel] = values.siteTypes[i]!;
  }
}

/**
 * Workers that compute maps together, each with a memory of its own: for pages where memory cannot be shared. An aborted surface() or
 * sites() can end workers with all objects of the pool (SdmError `ended`), as of SdmWorker; an aborted map ends none.
 */
export class SdmPool {
  private readonly turns = new Turns();

  /** @internal */
  constructor(private readonly each: SdmWorker[]) {}

  get workers(): number {
    return this.each.length;
  }
  /** The atlas is laid out by one worker. */
  async surface(
    positions: Points,
    indices: Indices = null,
    options: Omit<SurfaceOptions, 'progress'> & CallOptions = {},
  ): Promise<PoolSurface> {
    const { transfer: _, ...rest } = options;
    // The others need them later, when the caller may have changed them.
    const at = Float64Array.from(positions);
    const corners = indices && Float64Array.from(indices);
    const first = await this.each[0]!.surface(at, corners, rest);
    const storedAtlas = rest.storedAtlas ?? (await first.storedAtlas());
    const others = await all(
      this.each.slice(1).map((worker) => worker.surface(at, corners, { ...rest, storedAtlas })),
    );
    return new PoolSurface([first, ...others], this.turns);
  }
  async sites(positions: Points, indices: Indices = null, options: CallOptions = {}): Promise<PoolSites> {
    const { transfer: _, ...rest } = options;
    return new PoolSites(
      await all(this.each.map((worker) => worker.sites(positions, indices, rest))),
      this.turns,
    );
  }
  terminate(): void {
    this.each.forEach((worker) => worker.terminate());
  }
}

// Before anything is sent: what the workers get is a copy, in which wrong values are others.
const ofCalls = { signal: anything, transfer: anything };
checkMethods(
  SdmPool,
  { surface: takeDeclared(mesh, { ...ofSurface, ...ofCalls }), sites: take(mesh, ofCalls) },
  ['surface', 'sites'],
);
checkMethods(PoolSites, { refit: take({ positions: mesh.positions }) }, ['refit']);
checkMethods(
  PoolSurface,
  {
    refit: take({ positions: mesh.positions }),
    map: takeDeclared({ sites: object(PoolSites, 'PoolSites') }, { ...ofMap, ...ofCalls }),
  },
  ['refit', 'map'],
);
