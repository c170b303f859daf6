// Closest points and rays of a geometry of three.js, by the calls of three-mesh-bvh.
import {
  type BufferGeometry,
  type Intersection,
  Matrix3,
  Mesh,
  type Raycaster,
  SkinnedMesh,
  Vector3,
} from 'three';
import { type Sdm } from './library.js';
import { type Sites } from './sites.js';
import { fromBufferGeometry } from './three_geometry.js';
import { SdmError } from './types.js';

export interface ClosestPointTarget {
  point: Vector3;
  distance: number;
  faceIndex: number;
}

/**
 * The faces that a geometry draws, as sites of the library that start() returns: `new GeometrySites(await start(), geometry)`. Its calls
 * are synchronous, in the coordinates of the geometry.
 */
export class GeometrySites {
  readonly sites: Sites;
  private readonly firstFace: number;

  /** Throws SdmError if the mesh is unusable. Cost: O(n log n). */
  constructor(
    sdm: Sdm,
    readonly geometry: BufferGeometry,
  ) {
    const [positions, indices] = fromBufferGeometry(geometry);
    const { start, count } = geometry.drawRange;
    this.firstFace = Math.floor(start / 3);
    const drawn = indices.subarray(3 * this.firstFace, 3 * Math.floor((start + count) / 3));
    this.sites = new sdm.Sites(positions, drawn);
  }

  /**
   * The closest point to a point, in the target; null if none is within `maxThreshold`. `minThreshold`, a distance that suffices
   * three-mesh-bvh, does not matter.
   */
  closestPointToPoint(
    point: Vector3,
    target: ClosestPointTarget = { point: new Vector3(), distance: Infinity, faceIndex: -1 },
    _minThreshold = 0,
    maxThreshold = Infinity,
  ): ClosestPointTarget | null {
    const { points, distances, faces } = this.sites.closestPoints(point.toArray(), {
      maxDistance: maxThreshold,
    });
    if (distances[0] === Infinity) return null;
    target.point.fromArray(points);
    target.distance = distances[0]!;
    target.faceIndex = this.firstFace + faces[0]!;
    return target;
  }

  /**
   * As Mesh.raycast() of three.js, but adds the first hit only: `mesh.raycast = (raycaster, hits) => sites.raycast(mesh, raycaster, hits)`.
   * Cost: O(log n) as a rule; O(n) where the material hides the first face on the ray. Throws SdmError for a mesh that is skinned or
   * morphed.
   */
  raycast(mesh: Mesh, raycaster: Raycaster, intersects: Intersection[]): void {
    if (mesh.geometry !== this.geometry)
      throw new SdmError('input', 'raycast needs a mesh of the geometry of these sites');
    if (mesh instanceof SkinnedMesh || mesh.morphTargetInfluences?.some((weight) => weight !== 0))
      throw new SdmError('input', 'raycast needs a mesh that is neither skinned nor morphed');
    const { origin, direction } = raycaster.ray;
    const inverse = mesh.matrixWorld.clone().invert();
    const from = origin.clone().applyMatrix4(inverse);
    // Not normalised, so that t is the distance in the world.
    const along = direction.clone().applyMatrix3(new Matrix3().setFromMatrix4(inverse));
    const { near: tMin, far: tMax } = raycaster;
    const { t, faces } = this.sites.firstHits(from.toArray(), along.toArray(), { tMin, tMax });
    if (t[0] === Infinity) return;
    const hits: Intersection[] = [];
    const { drawRange } = this.geometry;
    // three.js decides about the sides and groups of the material, and says what the face has there.
    try {
      this.geometry.drawRange = { start: 3 * (this.firstFace + faces[0]!), count: 3 };
      Mesh.prototype.raycast.call(mesh, raycaster, hits);
    } finally {
      this.geometry.drawRange = drawRange;
    }
    // The first one that it shows may be behind, or at the same place.
    if (hits.length === 0) Mesh.prototype.raycast.call(mesh, raycaster, hits);
    hits.sort((a, b) => a.distance - b.distance);
    if (hits[0]) intersects.push(hits[0]);
  }

  /** After the positions of the geometry have changed. Cost: linear. */
  refit(): void {
    this.sites.refit(fromBufferGeometry(this.geometry)[0]);
  }
  dispose(): void {
    this.sites.dispose();
  }
}
