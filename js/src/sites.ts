// Sites (O2), and what is asked of any points.
import { float64, text, uint32 } from './bytes.js';
import type * as declared from './declared.js';
import { boundedLength, coordinates, corners } from './geometry.js';
import { declaredOptions } from './given.js';
import { type Module } from './module.js';
import { Owned } from './owned.js';
import {
  type BoundedLength,
  type Indices,
  type Points,
  type Progress,
  type SignMethod,
  SdmError,
} from './types.js';

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

export interface HausdorffOptions extends declared.HausdorffOptions {
  progress?: Progress;
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

  /** The Hausdorff distance to another mesh, with certified bounds. */
  hausdorff(other: Sites, { progress, ...given }: HausdorffOptions = {}): Hausdorff {
    const result = this.module.call(
      'sdm_hausdorff',
      [this.handle, other.handleIn(this.module), ...declaredOptions(given)],
      progress,
    );
    return {
      from: [boundedLength(this.module, result[0]!), boundedLength(this.module, result[2]!)],
      larger: boundedLength(this.module, result[4]!),
    };
  }
}
