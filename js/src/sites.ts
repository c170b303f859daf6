// Sites (O2), and what is asked of any points.
import type * as declared from './declared.js';
import { coordinates, corners } from './geometry.js';
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

export interface ClosestPointOptions extends declared.ClosestPointOptions {
  progress?: Progress | undefined;
}

export interface SignedDistanceOptions extends declared.SignedDistanceOptions {
  progress?: Progress | undefined;
}

export interface HausdorffOptions extends declared.HausdorffOptions {
  progress?: Progress | undefined;
}

export interface RayOptions extends declared.RayOptions {
  progress?: Progress | undefined;
}

/** What distances are measured to (O2): the vertices, edges and faces of a mesh, in a tree. */
export class Sites extends Owned {
  readonly closed: boolean;
  readonly orientable: boolean;

  /** Throws SdmError if the mesh is unusable. Cost: O(n log n). */
  constructor(module: Module, positions: Points, indices: Indices = null) {
    const at = coordinates(positions, 'positions');
    const triangles = corners(indices, at.length / 3);
    const values = [at, at.length / 3, triangles, triangles.length / 3];
    const made = module.call<{ address: number; closed: boolean; orientable: boolean }>(
      'sdm_new_sites',
      values,
    );
    super(module, made.address, 'sdm_free_sites');
    this.closed = made.closed;
    this.orientable = made.orientable;
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
  closestPoints(points: Points, { progress, ...given }: ClosestPointOptions = {}): ClosestPoints {
    const at = coordinates(points, 'points');
    const values = [this.handle, at, at.length / 3, ...declaredOptions(given)];
    return this.module.call<ClosestPoints>('sdm_closest_points', values, progress);
  }

  /** Distances that are negative inside, of closestPoints(). Of an open mesh, `automatic` gives none a sign. */
  signedDistance(points: Points, { progress, ...given }: SignedDistanceOptions = {}): SignedDistances {
    const at = coordinates(points, 'points');
    const values = [this.handle, at, at.length / 3, ...declaredOptions(given)];
    return this.module.call<SignedDistances>('sdm_signed_distance', values, progress);
  }

  /** The first point on each ray from an origin along a direction, at origin + t · direction. */
  firstHits(origins: Points, directions: Points, { progress, ...given }: RayOptions = {}): RayHits {
    const from = coordinates(origins, 'origins');
    const along = coordinates(directions, 'directions');
    if (from.length !== along.length)
      throw new SdmError('input', `there are ${from.length / 3} origins, but ${along.length / 3} directions`);
    const values = [this.handle, from, along, from.length / 3, ...declaredOptions(given)];
    return this.module.call<RayHits>('sdm_first_hits', values, progress);
  }

  /** The Hausdorff distance to another mesh, with certified bounds. */
  hausdorff(other: Sites, { progress, ...given }: HausdorffOptions = {}): Hausdorff {
    const values = [this.handle, other.handleIn(this.module), ...declaredOptions(given)];
    return this.module.call<Hausdorff>('sdm_hausdorff', values, progress);
  }
}
