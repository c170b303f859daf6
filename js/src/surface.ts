// Surfaces (O1) and their distance maps.
import { type Bytes } from './bytes.js';
import { coordinates, corners } from './geometry.js';
import type * as declared from './declared.js';
import { declaredOptions } from './given.js';
import { type MapOnGpu } from './gpu_map.js';
import { type MapOptions, type MeasureArguments, measureArguments } from './measures.js';
import { type Module } from './module.js';
import { Owned } from './owned.js';
import {
  type Computed,
  type JudgedOptions,
  type ReportOptions,
  type SummaryOptions,
  reportOf,
  summaryOf,
} from './report.js';
import { type Sites } from './sites.js';
import { type JudgedSummary, type MapSummary } from './summary.js';
import { type TransferOptions, transferred } from './transfer.js';
import {
  type Indices,
  type MapStatistics,
  type MapValues,
  type Points,
  type Progress,
  SdmError,
  type SignMethod,
} from './types.js';

export interface SurfaceOptions extends declared.AtlasOptions {
  /** Texture coordinates of the vertices, two each, for `uv`; (0, 0) is the lower left of the texture. */
  uvs?: ArrayLike<number> | undefined;
  /** What storedAtlas() of a surface of the same mesh and options returned, perhaps in another worker: nothing is laid out again. */
  storedAtlas?: Uint8Array | undefined;
  progress?: Progress | undefined;
}

export interface Atlas {
  resolution: number;
  rows: number;
  charts: number;
  /** The share of texels that a face owns. */
  utilisation: number;
  /** The face that owns each texel, row after row from the top; 4294967295: none. */
  texelFaces: Uint32Array;
  /**
   * Texture coordinates of the corners of each face, in texels from the upper left corner: six numbers each, NaN of faces
   * without area.
   */
  corners: Float32Array;
}

/** The surface on which distances are measured (O1): a mesh with a texture atlas. */
export class Surface extends Owned {
  /** Lays out the atlas. Throws SdmError if the mesh is unusable. */
  constructor(module: Module, positions: Points, indices: Indices = null, options: SurfaceOptions = {}) {
    const at = coordinates(positions, 'positions');
    const triangles = corners(indices, at.length / 3);
    const { uvs: of, storedAtlas, progress, ...given } = options;
    let uvs: Float64Array | null = null;
    if (of) {
      if (of.length * 3 !== at.length * 2)
        throw new SdmError(
          'input',
          `uvs has ${of.length} numbers, but two are needed for each of ${at.length / 3} vertices`,
        );
      uvs = Float64Array.from(
        { length: triangles.length * 2 },
        (_, i) => of[triangles[i >> 1]! * 2 + (i & 1)]!,
      );
    }
    const mesh = [at, at.length / 3, triangles, triangles.length / 3, uvs];
    const stored = [storedAtlas ?? null, storedAtlas?.length ?? 0];
    const values = [...mesh, ...declaredOptions(given), ...stored];
    super(
      module,
      module.call<{ address: number }>('sdm_new_surface', values, progress).address,
      'sdm_free_surface',
    );
  }

  /** Moves the vertices and keeps the atlas. Cost: linear. */
  refit(positions: Points): void {
    const at = coordinates(positions, 'positions');
    this.module.call('sdm_refit_surface', [this.handle, at, at.length / 3]);
  }

  atlas(): Atlas {
    return this.module.call<Atlas>('sdm_surface_atlas', [this.handle]);
  }

  /** The atlas as bytes, for SurfaceOptions.storedAtlas. Of the mesh in its present shape, and for this version of sdm only. */
  storedAtlas(): Bytes {
    return this.module.call<{ atlas: Bytes }>('sdm_stored_atlas', [this.handle]).atlas;
  }

  /**
   * The samples: the texels that a face owns and, with indices from resolution · rows on, one point of each face that owns none;
   * and their points. Arrays of a map have no place for the latter, statistics have them.
   */
  samples(): { texels: Uint32Array; points: Float64Array } {
    return this.module.call('sdm_surface_samples', [this.handle]);
  }
  /** The number of samples, and that of which ranges for DistanceMap.computeSamples() begin and end at multiples. */
  sampleCounts(): { samples: number; grain: number } {
    return this.module.call('sdm_sample_counts', [this.handle]);
  }

  /** The surface distance map: at every texel, the distance to the sites, or another measure. */
  map(sites: Sites, options: MapOptions = {}): DistanceMap {
    const map = this.emptyMap(sites);
    try {
      map.compute(options);
    } catch (error) {
      map.dispose();
      throw error;
    }
    return map;
  }
  /** A map without values, for compute() and computeSamples(). */
  emptyMap(sites: Sites): DistanceMap {
    return new DistanceMap(this.module, this, this.handle, sites);
  }
}

/**
 * At every texel of a surface's atlas: the distance to the sites, the vector to the closest point, and the closest site, or those of
 * another measure. Arrays are copied out of the module at each call.
 */
export class DistanceMap extends Owned {
  readonly resolution: number;
  readonly rows: number;
  /** Of what was computed last. */
  sign: SignMethod = 'automatic';
  signReason = '';
  /** By which it was computed: the values are those of the processor with `cpu`, to the errors that both have. */
  engine: 'cpu' | 'gpu' = 'cpu';
  private measure: MeasureArguments = measureArguments({});

  /** @internal */
  constructor(
    module: Module,
    private readonly surface: Surface,
    surfaceAddress: number,
    private readonly sites: Sites,
  ) {
    sites.handleIn(module);
    const made = module.call<{ address: number; resolution: number; rows: number }>('sdm_new_map', [
      surfaceAddress,
    ]);
    super(module, made.address, 'sdm_free_map');
    this.resolution = made.resolution;
    this.rows = made.rows;
  }

  /** @internal As of Surface. */
  sampleCounts(): { samples: number; grain: number } {
    return this.surface.sampleCounts();
  }

  /** Computes all values, again after refit() of the surface or the sites; of distances to the sites, it takes no more memory. */
  compute(options: MapOptions = {}): void {
    this.computeBy('sdm_compute_map', options, []);
  }
  /**
   * Computes the values of some samples, `first` to `first + count` of Surface.samples(), which must be multiples of
   * sampleCounts().grain or the end. The other texels keep theirs. Ranges that cover all samples, computed in any order and in
   * any number of modules, are the whole map to the bit.
   */
  computeSamples(first: number, count: number, options: MapOptions = {}): void {
    this.computeBy('sdm_compute_samples', options, [first, count]);
  }
  /** The values of samples, in their order, as those of the arrays of the map. */
  valuesOfSamples(first: number, count: number): MapValues {
    const values = [this.handle, this.surface.handleIn(this.module), first, count];
    return this.module.call<MapValues>('sdm_map_samples', values);
  }

  /** @internal As compute(), by a device: `compute` has the module compute the values. */
  async computeOn(
    { progress: _, ...options }: MapOptions,
    compute: (map: MapOnGpu) => Promise<{ sign: SignMethod; signReason: string }>,
  ): Promise<void> {
    const measure = measureArguments(options);
    const given = { module: this.module, addresses: this.addresses(), options: measure };
    Object.assign(this, await compute({ ...given, ...this.sampleCounts() }));
    [this.measure, this.engine] = [measure, 'gpu'];
  }

  private computeBy(name: string, { progress, ...options }: MapOptions, range: number[]): void {
    const measure = measureArguments(options);
    const values = [...this.addresses(), ...measure, ...range];
    Object.assign(this, this.module.call<{ sign: SignMethod; signReason: string }>(name, values, progress));
    [this.measure, this.engine] = [measure, 'cpu'];
  }

  /** Distances, negative inside; NaN of texels without a value. */
  get distances(): Float32Array {
    return this.array('distances');
  }
  /** Closest point − point of the texel: three numbers each. */
  get vectors(): Float32Array {
    return this.array('vectors');
  }
  /** The closest vertex, edge or face. */
  get sitesOfTexels(): Uint32Array {
    return this.array('sitesOfTexels');
  }
  /** 0: a vertex, 1: an edge, 2: a face, 255: no value. */
  get siteTypes(): Uint8Array {
    return this.array('siteTypes');
  }

  /** Statistics of the distances, weighted by area. */
  statistics(): MapStatistics {
    const values = [this.surface.handleIn(this.module), this.handle];
    return this.module.call<MapStatistics>('sdm_map_statistics', values);
  }

  /** Values of the sites' mesh at the closest point of each texel. */
  transfer(values: ArrayLike<number>, options: TransferOptions = {}): Float32Array {
    const [map, ...bodies] = this.addresses();
    return transferred(this.module, 'sdm_transfer', [...bodies, map], values, options);
  }

  /** The keys of report.json: numbers, verdict, places, colours, histogram. Of the module `full` only. */
  summary(options: JudgedOptions): JudgedSummary;
  summary(options?: SummaryOptions): MapSummary;
  summary(options: SummaryOptions = {}): MapSummary {
    return summaryOf(this.module, this.computed(), options);
  }
  /** The text of report.html, a page that shows the map and its summary. Of the module `full` only. */
  report(options: ReportOptions = {}): Promise<string> {
    return reportOf(this.module, () => this.computed(), options);
  }

  private addresses(): [number, number, number] {
    return [this.handle, this.surface.handleIn(this.module), this.sites.handleIn(this.module)];
  }
  private computed(): Computed {
    return [...this.addresses(), ...this.measure];
  }
  private array<Name extends keyof MapValues>(name: Name): MapValues[Name] {
    return this.module.call<{ values: MapValues[Name] }>('sdm_map_array', [this.handle, name]).values;
  }
}
