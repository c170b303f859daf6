// The library in one module, for those who may wait.
import { Animation, type ReadAnimationOptions } from './animation.js';
import { checkMethods, constructorIn, kLibraryCalls } from './calls.js';
import { type ProximityOptions } from './declared.js';
import { type Body } from './geometry.js';
import { Look } from './look.js';
import { type MatchOptions, Matches } from './matches.js';
import { type MeshFile, type ReadMeshOptions, readMesh } from './mesh_file.js';
import { type Module } from './module.js';
import { Pair } from './pair.js';
import { Sites } from './sites.js';
import { Surface, type SurfaceOptions } from './surface.js';
import { type Indices, type Points } from './types.js';
import { type OtherUnit, unitCheck } from './units.js';

/** The library, with a memory of its own. Its calls are synchronous: in a page, call them in a worker (createWorker()). */
export class Sdm {
  readonly Surface: new (
    positions: Points,
    indices?: Indices,
    options?: SurfaceOptions,
  ) => Surface;
  readonly Sites: new (
    positions: Points,
    indices?: Indices,
  ) => Sites;
  /** Of the module `full` only. */
  readonly Pair: new (
    first: Body,
    second: Body,
    options?: ProximityOptions,
  ) => Pair;

  /** @internal */
  constructor(
    /** @internal */ readonly module: Module,
    reportPage: () => Promise<string>,
  ) {
    module.reportPage = reportPage;
    this.Surface = constructorIn(module, 'Surface', Surface);
    this.Sites = constructorIn(module, 'Sites', Sites);
    this.Pair = constructorIn(module, 'Pair', Pair);
  }

  get threads(): number {
    return this.module.threadCount;
  }
  /** What the module has taken from the system. */
  get memoryBytes(): number {
    return this.module.memoryBytes;
  }
  /**
   * Reads a mesh file: STL, PLY, OBJ, OFF, glTF or 3DS, recognised by its content, then by its name. Polygons are triangulated, all
   * meshes of the file merged, and equal positions welded. Of the module `full` only.
   */
  readMesh(bytes: Uint8Array | ArrayBuffer, name: string, options: ReadMeshOptions = {}): MeshFile {
    return readMesh(this.module, bytes, name, options);
  }
  /** How the faces of a mesh file look, as readMesh() numbers them. Of the module `full` only. */
  readLook(bytes: Uint8Array | ArrayBuffer, name: string, options: ReadMeshOptions = {}): Look {
    return new Look(this.module, bytes, name, options);
  }
  /** The animation of the morph targets of a glTF file; null if the file has no animation. Of the module `full` only. */
  readAnimation(
    bytes: Uint8Array | ArrayBuffer,
    name: string,
    options: ReadAnimationOptions = {},
  ): Animation | null {
    return Animation.read(this.module, bytes, name, options);
  }
  /** Finds, for each texel of a surface, the point of the sites that belongs to it. Of the module `full` only. */
  match(surface: Surface, sites: Sites, options: MatchOptions = {}): Matches {
    return new Matches(this.module, surface, sites, options);
  }
  /**
   * Whether a mesh, where it is, fits sites far better in another unit of length: its factor; null if it does not. Of the module `full`
   * only.
   */
  unitCheck(body: Body, sites: Sites): OtherUnit | null {
    return unitCheck(this.module, body, sites);
  }
  /** Ends its threads. Its objects cannot be used any more. */
  stop(): void {
    this.module.stop();
  }

  /** @internal What a worker is asked for. */
  surface(positions: Points, indices: Indices, options: SurfaceOptions): Surface {
    return new this.Surface(positions, indices, options);
  }
  /** @internal */
  sites(positions: Points, indices: Indices): Sites {
    return new this.Sites(positions, indices);
  }
  /** @internal */
  pair(first: Body, second: Body, options: ProximityOptions): Pair {
    return new this.Pair(first, second, options);
  }
  /** @internal */
  memory(): number {
    return this.memoryBytes;
  }
}
checkMethods(Sdm, kLibraryCalls);
