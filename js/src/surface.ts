// Surfaces (O1), sites (O2), and what is computed of them.
import { type Bytes, fields, float32, float64, text, uint32 } from './bytes.js';
import { type Module } from './module.js';
import { type MapSummary, type ReportOptions, type SummaryOptions, reportOf, summaryOf } from './report.js';
import { type TransferOptions, transferred } from './transfer.js';
import {
  type AtlasKind,
  type BoundedLength,
  type Certainty,
  type Indices,
  type Point,
  type Points,
  type Progress,
  type SignMethod,
  type SiteType,
  SdmError,
} from './types.js';

const kNone = 0xffffffff;
const kSiteTypes: Record<number, SiteType> = { 0: 'vertex', 1: 'edge', 2: 'face' };

/** Coordinates as doubles, three for each point. */
export function coordinates(points: Points, name: string): Float64Array {
  if (points.length % 3 !== 0)
    throw new SdmError('input', `${name} has ${points.length} numbers, but three are needed for each point`);
  return points instanceof Float64Array ? points : Float64Array.from(points);
}

/** Indices of corners, three for each triangle. */
export function corners(indices: Indices, vertices: number): Uint32Array {
  if (!indices) return Uint32Array.from({ length: vertices - (vertices % 3) }, (_, i) => i);
  if (indices.length % 3 !== 0)
    throw new SdmError(
      'input',
      `indices has ${indices.length} numbers, but three are needed for each triangle`,
    );
  for (let i = 0; i < indices.length; ++i) {
    const index = indices[i]!;
    if (!(index >= 0 && index < vertices && Number.isInteger(index)))
      throw new SdmError('input', `indices[${i}] is ${index}, but there are ${vertices} vertices`);
  }
  return indices instanceof Uint32Array ? indices : Uint32Array.from(indices);
}

function boundedLength(module: Module, bytes: Bytes): BoundedLength {
  const [value, lower, upper, certainty, ...witness] = Array.from(float64(bytes)) as [
    number,
    number,
    number,
    number,
    ...number[],
  ];
  const points: [Point, Point] = [witness.slice(0, 3) as Point, witness.slice(3, 6) as Point];
  return {
    value,
    lower,
    upper,
    certainty: module.words('certainty')[certainty] as Certainty,
    witness: Number.isNaN(witness[0]!) ? null : points,
  };
}

/** An object in the memory of a module. It is freed when it is collected, by dispose(), or at the end of the block of `using`. */
export abstract class Owned {
  private address: number;

  protected constructor(
    protected readonly module: Module,
    address: number,
    private readonly free: string,
  ) {
    this.address = address;
    module.watch(this, () => module.free(free, address));
  }

  /** Frees the memory of the object, which cannot be used any more. */
  dispose(): void {
    if (this.address === 0) return;
    this.module.unwatch(this);
    this.module.free(this.free, this.address);
    this.address = 0;
  }
  [Symbol.dispose](): void {
    this.dispose();
  }

  protected get handle(): number {
    if (this.address === 0) throw new SdmError('input', `this ${this.constructor.name} was disposed of`);
    return this.address;
  }
  /** @internal The object, for another one, which must be of the same module. */
  handleIn(module: Module): number {
    if (module !== this.module) throw new SdmError('input', 'the objects belong to different modules');
    return this.handle;
  }
}

export interface ClosestPoints {
  /** Three coordinates each; NaN where nothing is within maxDistance. */
  points: Float64Array;
  distances: Float64Array;
  /** 4294967295: none. */
  faces: Uint32Array;
  /** The shares of the second and the third corner of the face. */
  barycentric: Float64Array;
}

export interface SignedDistances {
  /** Negative inside. */
  distances: Float64Array;
  sign: SignMethod;
  /** Why this method was used. */
  reason: string;
}

export interface RayHits {
  /** Infinity: no hit. */
  t: Float64Array;
  faces: Uint32Array;
  barycentric: Float64Array;
}

/** The distance from every point of one surface to the other, at most. */
export interface Hausdorff {
  /** From the first to the second, and from the second to the first. */
  from: [BoundedLength, BoundedLength];
  /** The larger of both. */
  larger: BoundedLength;
}

/** What distances are measured to (O2): the vertices, edges and faces of a mesh, in a tree. */
export class Sites extends Owned {
  readonly closed: boolean;
  readonly orientable: boolean;

  /** Throws SdmError if the mesh is unusable. Cost: O(n log n). */
  constructor(module: Module, positions: Points, indices: Indices = null) {
    const at = coordinates(positions, 'positions');
    const triangles = corners(indices, at.length / 3);
    const [address, flags] = module.call('sdm_new_sites', [
      at,
      at.length / 3,
      triangles,
      triangles.length / 3,
    ]);
    super(module, float64(address!)[0]!, 'sdm_free_sites');
    [this.closed, this.orientable] = Array.from(float64(flags!), (flag) => flag !== 0) as [boolean, boolean];
  }

  /** Moves the vertices. Cost: linear. */
  refit(positions: Points): void {
    const at = coordinates(positions, 'positions');
    this.module.call('sdm_refit_sites', [this.handle, at, at.length / 3]);
  }

  /**
   * The closest point to each point. Of fewer than 8,192 points, to rounding in double precision, and each as if it were alone; of
   * more, where they lie close together, the distance may be larger than the least one by at most 10⁻⁶ of the diagonal of the mesh
   * and the points, and depends on the others by as much.
   */
  closestPoints(points: Points, options: { maxDistance?: number; progress?: Progress } = {}): ClosestPoints {
    const at = coordinates(points, 'points');
    const [found, distances, faces, barycentric] = this.module.call(
      'sdm_closest_points',
      [this.handle, at, at.length / 3, options.maxDistance ?? Infinity],
      options.progress,
    );
    return {
      points: float64(found!),
      distances: float64(distances!),
      faces: uint32(faces!),
      barycentric: float64(barycentric!),
    };
  }

  /** Distances that are negative inside, of closestPoints(). Of an open mesh, `automatic` gives none a sign. */
  signedDistance(points: Points, options: { sign?: SignMethod; progress?: Progress } = {}): SignedDistances {
    const at = coordinates(points, 'points');
    const method = this.module.number('sign', options.sign ?? 'automatic');
    const [distances, used, reason] = this.module.call(
      'sdm_signed_distance',
      [this.handle, at, at.length / 3, method],
      options.progress,
    );
    return {
      distances: float64(distances!),
      sign: this.module.words('sign')[float64(used!)[0]!] as SignMethod,
      reason: text(reason!),
    };
  }

  /** The first point on each ray from an origin along a direction, at origin + t · direction. */
  firstHits(
    origins: Points,
    directions: Points,
    options: { tMin?: number; tMax?: number; progress?: Progress } = {},
  ): RayHits {
    const from = coordinates(origins, 'origins');
    const along = coordinates(directions, 'directions');
    if (from.length !== along.length)
      throw new SdmError('input', `there are ${from.length / 3} origins, but ${along.length / 3} directions`);
    const [t, faces, barycentric] = this.module.call(
      'sdm_first_hits',
      [this.handle, from, along, from.length / 3, options.tMin ?? 0, options.tMax ?? Infinity],
      options.progress,
    );
    return { t: float64(t!), faces: uint32(faces!), barycentric: float64(barycentric!) };
  }

  /**
   * The Hausdorff distance to another mesh, with certified bounds. `precision`: how far they are apart at most, by default
   * 10⁻⁶ of the diagonal of both meshes.
   */
  hausdorff(other: Sites, options: { precision?: number; progress?: Progress } = {}): Hausdorff {
    const result = this.module.call(
      'sdm_hausdorff',
      [this.handle, other.handleIn(this.module), options.precision ?? 0],
      options.progress,
    );
    return {
      from: [boundedLength(this.module, result[0]!), boundedLength(this.module, result[2]!)],
      larger: boundedLength(this.module, result[4]!),
    };
  }
}

export interface SurfaceOptions {
  /** Texels per row of the atlas, 16 to 32768; 1024 by default. */
  resolution?: number;
  /**
   * `charts`: of similar normals (the default). `triangles`: pairs of triangles, without distortion. `uv`: the texture
   * coordinates of the mesh.
   */
  atlas?: AtlasKind;
  /** Free texels around charts. */
  gutter?: number;
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

export interface MapOptions {
  sign?: SignMethod;
  /** Texels farther away have no value. */
  maxDistance?: number;
  /** Degrees: to the closest of the faces whose normal is within this angle of that of the sample's face. */
  facing?: number;
  progress?: Progress;
}

/** The surface on which distances are measured (O1): a mesh with a texture atlas. */
export class Surface extends Owned {
  /** Lays out the atlas. Throws SdmError if the mesh is unusable. */
  constructor(module: Module, positions: Points, indices: Indices = null, options: SurfaceOptions = {}) {
    const at = coordinates(positions, 'positions');
    const triangles = corners(indices, at.length / 3);
    let uvs: Float64Array | null = null;
    if (options.uvs) {
      const of = options.uvs;
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
    const kind = module.number('atlas', options.atlas ?? 'charts');
    const [address] = module.call(
      'sdm_new_surface',
      [
        at,
        at.length / 3,
        triangles,
        triangles.length / 3,
        uvs,
        kind,
        options.resolution ?? 1024,
        options.gutter ?? 1,
        options.storedAtlas ?? null,
        options.storedAtlas?.length ?? 0,
      ],
      options.progress,
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

/** Statistics of the texels that have a value, each weighted by its area; NaN if there are none. */
export interface MapStatistics {
  texels: number;
  negativeTexels: number;
  min: number;
  max: number;
  mean: number;
  rms: number;
  stddev: number;
  p01: number;
  p05: number;
  p50: number;
  p95: number;
  p99: number;
  meanAbs: number;
  maxAbs: number;
  p50Abs: number;
  p95Abs: number;
  p99Abs: number;
  negativeAreaFraction: number;
}

/** Values of texels, or of samples. */
export interface MapValues {
  /** Negative inside; NaN without a value. */
  distances: Float32Array;
  /** Closest point − point of the texel: three numbers each. */
  vectors: Float32Array;
  /** The closest vertex, edge or face. */
  sitesOfTexels: Uint32Array;
  /** 0: a vertex, 1: an edge, 2: a face, 255: no value. */
  siteTypes: Uint8Array;
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
  compute(options: MapOptions = {}): void {
    this.take(this.module.call('sdm_compute_map', this.arguments(options), options.progress));
  }
  /**
   * Computes the values of some samples, `first` to `first + count` of Surface.samples(), which must be multiples of
   * sampleCounts().grain or the end. The other texels keep theirs. Ranges that cover all samples, computed in any order and in
   * any number of modules, are the whole map to the bit.
   */
  computeSamples(first: number, count: number, options: MapOptions = {}): void {
    this.take(
      this.module.call('sdm_compute_samples', [...this.arguments(options), first, count], options.progress),
    );
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

  private arguments(options: MapOptions): number[] {
    const method = this.module.number('sign', options.sign ?? 'automatic');
    return [...this.addresses(), method, options.maxDistance ?? Infinity, options.facing ?? NaN];
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

export interface Contacts {
  /** Points on the first and on the second body, three numbers each. */
  points1: Float64Array;
  points2: Float64Array;
  /** Along which moving the first body separates them. */
  normals: Float64Array;
  depths: Float64Array;
  patches: Uint32Array;
  ids: BigUint64Array;
}

/** Two bodies that move and deform. Of the module `full` only. */
export class Pair extends Owned {
  constructor(
    module: Module,
    first: { positions: Points; indices?: Indices },
    second: { positions: Points; indices?: Indices },
    options: { contactMargin?: number } = {},
  ) {
    if (!module.has('sdm_new_pair'))
      throw new SdmError('input', 'Pair needs the module of start({ full: true })');
    const bodies = [first, second].flatMap(({ positions, indices }, body) => {
      const at = coordinates(positions, `positions of body ${body}`);
      const triangles = corners(indices ?? null, at.length / 3);
      return [at, at.length / 3, triangles, triangles.length / 3];
    });
    const [address] = module.call('sdm_new_pair', [...bodies, options.contactMargin ?? 0]);
    super(module, float64(address!)[0]!, 'sdm_free_pair');
  }

  /** Moves a body, 0 or 1. `matrix`: 16 numbers, column after column, as three.js has them (Matrix4.elements). */
  setPose(body: 0 | 1, matrix: ArrayLike<number>): void {
    if (matrix.length !== 16)
      throw new SdmError('input', `a pose is a matrix of 16 numbers, not ${matrix.length}`);
    const rows = Float64Array.from({ length: 12 }, (_, i) => matrix[(i % 4) * 4 + (i >> 2)]!);
    this.module.call('sdm_set_pose', [this.handle, body, rows]);
  }
  /** Moves the vertices of a body. */
  refit(body: 0 | 1, positions: Points): void {
    const at = coordinates(positions, 'positions');
    this.module.call('sdm_refit_pair', [this.handle, body, at, at.length / 3]);
  }
  /** The smallest distance between both surfaces; 0 if they intersect. */
  separation(): BoundedLength {
    return boundedLength(this.module, this.module.call('sdm_separation', [this.handle])[0]!);
  }
  /** Whether the surfaces intersect, or a solid contains part of the other body. */
  colliding(): boolean {
    return float64(this.module.call('sdm_colliding', [this.handle])[0]!)[0] !== 0;
  }
  /** How deep a point of one body is inside the other; null if neither is a solid. */
  penetrationDepth(): BoundedLength | null {
    const [depth] = this.module.call('sdm_penetration_depth', [this.handle]);
    return depth ? boundedLength(this.module, depth) : null;
  }
  contacts(): Contacts {
    const [points1, points2, normals, depths, patches, ids] = this.module.call('sdm_contacts', [
      this.handle,
    ]) as Bytes[];
    return {
      points1: float64(points1!),
      points2: float64(points2!),
      normals: float64(normals!),
      depths: float64(depths!),
      patches: uint32(patches!),
      ids: new BigUint64Array(ids!.buffer),
    };
  }
}

export { kNone, kSiteTypes };
