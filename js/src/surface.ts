// Surfaces (O1) and their distance maps.
import { type Bytes, fields, float32, float64, text, uint32 } from './bytes.js';
import { coordinates, corners } from './geometry.js';
import type * as declared from './declared.js';
import { declaredOptions } from './given.js';
import { type Module } from './module.js';
import { Owned } from './owned.js';
import { type MapSummary, type ReportOptions, type SummaryOptions, reportOf, summaryOf } from './report.js';
import { type Sites } from './sites.js';
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
  uvs?: ArrayLike<number>;
  /** What storedAtlas() of a surface of the same mesh and options returned, perhaps in another worker: nothing is laid out again. */
  storedAtlas?: Uint8Array;
  progress?: Progress;
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

export interface MapOptions extends declared.MapOptions {
  progress?: Progress;
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
    const [address] = module.call(
      'sdm_new_surface',
      [...mesh, ...declaredOptions(given), ...stored],
      progress,
    );
    super(module, float64(address!)[0]!, 'sdm_free_surface');
  }

  /** Moves the vertices and keeps the atlas. Cost: linear. */
  refit(positions: Points): void {
    const at = coordinates(positions, 'positions');
    this.module.call('sdm_refit_surface', [this.handle, at, at.length / 3]);
  }

  atlas(): Atlas {
    const [numbers, faces, places] = this.module.call('sdm_surface_atlas', [this.handle]);
    const [resolution, rows, charts, utilisation] = Array.from(float64(numbers!)) as [
      number,
      number,
      number,
      number,
    ];
    return { resolution, rows, charts, utilisation, texelFaces: uint32(faces!), corners: float32(places!) };
  }

  /** The atlas as bytes, for SurfaceOptions.storedAtlas. Of the mesh in its present shape, and for this version of sdm only. */
  storedAtlas(): Uint8Array<ArrayBuffer> {
    return this.module.call('sdm_stored_atlas', [this.handle])[0]!;
  }

  /**
   * The samples: the texels that a face owns and, with indices from resolution · rows on, one point of each face that owns none;
   * and their points. Arrays of a map have no place for the latter, statistics have them.
   */
  samples(): { texels: Uint32Array; points: Float64Array } {
    const [texels, points] = this.module.call('sdm_surface_samples', [this.handle]);
    return { texels: uint32(texels!), points: float64(points!) };
  }
  /** The number of samples, and that of which ranges for DistanceMap.computeSamples() begin and end at multiples. */
  sampleCounts(): { samples: number; grain: number } {
    const [samples, grain] = Array.from(
      float64(this.module.call('sdm_sample_counts', [this.handle])[0]!),
    ) as [number, number];
    return { samples, grain };
  }

  /** The surface distance map: at every texel, the distance to the sites. */
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
 * At every texel of a surface's atlas: the distance to the sites, the vector to the closest point, and the closest site. Arrays
 * are copied out of the module at each call.
 */
export class DistanceMap extends Owned {
  readonly resolution: number;
  readonly rows: number;
  /** Of what was computed last. */
  sign: SignMethod = 'automatic';
  signReason = '';

  /** @internal */
  constructor(
    module: Module,
    private readonly surface: Surface,
    surfaceAddress: number,
    private readonly sites: Sites,
  ) {
    sites.handleIn(module);
    const [address, numbers] = module.call('sdm_new_map', [surfaceAddress]);
    super(module, float64(address!)[0]!, 'sdm_free_map');
    [this.resolution, this.rows] = Array.from(float64(numbers!)) as [number, number];
  }

  /** @internal As of Surface. */
  sampleCounts(): { samples: number; grain: number } {
    return this.surface.sampleCounts();
  }

  /** Computes all values, again after refit() of the surface or the sites; takes no more memory. */
  compute({ progress, ...given }: MapOptions = {}): void {
    this.take(
      this.module.call('sdm_compute_map', [...this.addresses(), ...declaredOptions(given)], progress),
    );
  }
  /**
   * Computes the values of some samples, `first` to `first + count` of Surface.samples(), which must be multiples of
   * sampleCounts().grain or the end. The other texels keep theirs. Ranges that cover all samples, computed in any order and in
   * any number of modules, are the whole map to the bit.
   */
  computeSamples(first: number, count: number, { progress, ...given }: MapOptions = {}): void {
    const values = [...this.addresses(), ...declaredOptions(given), first, count];
    this.take(this.module.call('sdm_compute_samples', values, progress));
  }
  /** The values of samples, in their order, as those of the arrays of the map. */
  valuesOfSamples(first: number, count: number): MapValues {
    const [distances, vectors, sites, types] = this.module.call('sdm_map_samples', [
      this.handle,
      this.surface.handleIn(this.module),
      first,
      count,
    ]) as [Bytes, Bytes, Bytes, Bytes];
    return {
      distances: float32(distances),
      vectors: float32(vectors),
      sitesOfTexels: uint32(sites),
      siteTypes: types,
    };
  }

  private take([used, reason]: Bytes[]): void {
    this.sign = this.module.words('sign')[float64(used!)[0]!] as SignMethod;
    this.signReason = text(reason!);
  }

  /** Distances, negative inside; NaN of texels without a value. */
  get distances(): Float32Array {
    return float32(this.array(0, 4 * this.resolution * this.rows));
  }
  /** Closest point − point of the texel: three numbers each. */
  get vectors(): Float32Array {
    return float32(this.array(1, 12 * this.resolution * this.rows));
  }
  /** The closest vertex, edge or face. */
  get sitesOfTexels(): Uint32Array {
    return uint32(this.array(2, 4 * this.resolution * this.rows));
  }
  /** 0: a vertex, 1: an edge, 2: a face, 255: no value. */
  get siteTypes(): Uint8Array {
    return this.array(3, this.resolution * this.rows);
  }

  /** Statistics of the distances, weighted by area. */
  statistics(): MapStatistics {
    const [names, numbers] = this.module.call('sdm_map_statistics', [
      this.surface.handleIn(this.module),
      this.handle,
    ]);
    return fields(names!, numbers!) as unknown as MapStatistics;
  }

  /** Values of the sites' mesh at the closest point of each texel. */
  transfer(values: ArrayLike<number>, options: TransferOptions = {}): Float32Array {
    const [map, ...bodies] = this.addresses();
    return transferred(this.module, 'sdm_transfer', [...bodies, map], values, options);
  }

  /** The keys of report.json: numbers, verdict, places, colours, histogram. Of the module `full` only. */
  summary(options: SummaryOptions = {}): MapSummary {
    return summaryOf(this.module, this.addresses(), options);
  }
  /** The text of report.html, a page that shows the map and its summary. Of the module `full` only. */
  report(options: ReportOptions = {}): Promise<string> {
    return reportOf(this.module, () => this.addresses(), options);
  }

  private addresses(): [number, number, number] {
    return [this.handle, this.surface.handleIn(this.module), this.sites.handleIn(this.module)];
  }
  private array(which: number, bytes: number): Bytes {
    return this.module.bytes(this.module.plain('sdm_map_array', this.handle, which), bytes);
  }
}
