// Maps by several workers that share no memory.
import { type CallOptions, type SdmWorker, type WorkerMap, type WorkerSites, type WorkerSurface } from './remote.js';
import { type Atlas, type MapOptions, type MapValues, type SurfaceOptions } from './surface.js';
import { type Indices, type Points, SdmError, type SignMethod } from './types.js';

export type PoolMapOptions = Omit<MapOptions, 'progress' | 'facing'> & CallOptions;

/** The arrays of a map, as of DistanceMap. */
export interface PoolMap extends MapValues {
  resolution: number;
  rows: number;
  sign: SignMethod;
  signReason: string;
}

// Each worker has about so many ranges of samples, so that none waits long for the last one.
const kRangesPerWorker = 4;

/** Sites in all workers of a pool. */
export class PoolSites {
  /** @internal */
  constructor(/** @internal */ readonly each: WorkerSites[]) {}
  get closed(): boolean {
    return this.each[0]!.closed;
  }
  get orientable(): boolean {
    return this.each[0]!.orientable;
  }
  async refit(positions: Points): Promise<void> {
    await Promise.all(this.each.map((sites) => sites.refit(positions)));
  }
  dispose(): void {
    this.each.forEach((sites) => sites.dispose());
  }
}

/** A surface in all workers of a pool. */
export class PoolSurface {
  private maps: { sites: PoolSites; each: WorkerMap[] } | undefined;
  private texels: Promise<Uint32Array> | undefined;

  /** @internal */
  constructor(private readonly each: WorkerSurface[]) {}

  async refit(positions: Points): Promise<void> {
    await Promise.all(this.each.map((surface) => surface.refit(positions)));
  }
  atlas(): Promise<Atlas> {
    return this.each[0]!.atlas();
  }
  /**
   * The surface distance map: each worker computes ranges of the samples, one after the other. The arrays are those of Surface.map()
   * to the bit. An aborted call ends once the ranges that were begun have ended, some milliseconds later, and keeps all objects.
   */
  async map(sites: PoolSites, options: PoolMapOptions = {}): Promise<PoolMap> {
    const { signal, progress, ...rest } = options;
    signal?.throwIfAborted();
    const maps = await this.mapsTo(sites);
    this.texels ??= this.each[0]!.samples().then(({ texels }) => texels);
    const [texels, { samples, grain }] = await Promise.all([this.texels, this.each[0]!.sampleCounts()]);
    const { resolution, rows } = maps[0]!;
    const result = noValues(resolution, rows);
    const size = grain * Math.max(1, Math.floor(samples / grain / (kRangesPerWorker * maps.length)));
    let next = 0, done = 0;
    let signs = {} as { sign: SignMethod; signReason: string };
    await Promise.all(maps.map(async (map) => {
      while (next < samples) {
        const first = next, count = Math.min(size, samples - first);
        next += count;
        signal?.throwIfAborted();
        signs = await map.computeSamples(first, count, rest);
        store(result, texels, first, await map.valuesOfSamples(first, count));
        progress?.('map', (done += count) / samples);
      }
    }));
    signal?.throwIfAborted();
    return { resolution, rows, ...signs, ...result };
  }
  dispose(): void {
    this.maps?.each.forEach((map) => map.dispose());
    this.each.forEach((surface) => surface.dispose());
  }

  /** The maps of the workers to these sites; those to other sites are freed. */
  private async mapsTo(sites: PoolSites): Promise<WorkerMap[]> {
    if (sites.each.length !== this.each.length) throw new SdmError('input', 'the objects belong to different pools');
    if (this.maps?.sites !== sites) {
      const each = await Promise.all(this.each.map((surface, i) => surface.emptyMap(sites.each[i]!)));
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
    into.distances[texel] = values.distances[i]!;
    for (let k = 0; k < 3; ++k) into.vectors[3 * texel + k] = values.vectors[3 * i + k]!;
    into.sitesOfTexels[texel] = values.sitesOfTexels[i]!;
    into.siteTypes[texel] = values.siteTypes[i]!;
  }
}

/** Workers that compute maps together, each with a memory of its own: for pages where memory cannot be shared. */
export class SdmPool {
  /** @internal */
  constructor(private readonly each: SdmWorker[]) {}

  get workers(): number {
    return this.each.length;
  }
  /** The atlas is laid out by one worker. */
  async surface(positions: Points, indices: Indices = null, options: Omit<SurfaceOptions, 'progress'> & CallOptions = {}): Promise<PoolSurface> {
    const { transfer: _, ...rest } = options;
    const first = await this.each[0]!.surface(positions, indices, rest);
    const storedAtlas = rest.storedAtlas ?? (await first.storedAtlas());
    const others = await Promise.all(this.each.slice(1).map((worker) => worker.surface(positions, indices, { ...rest, storedAtlas })));
    return new PoolSurface([first, ...others]);
  }
  async sites(positions: Points, indices: Indices = null, options: CallOptions = {}): Promise<PoolSites> {
    const { transfer: _, ...rest } = options;
    return new PoolSites(await Promise.all(this.each.map((worker) => worker.sites(positions, indices, rest))));
  }
  terminate(): void {
    this.each.forEach((worker) => worker.terminate());
  }
}
