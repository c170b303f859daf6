// The library in a worker: calls return promises, and signals abort them.
import { type ReadAnimationOptions } from './animation.js';
import { type CallOptions, Connection, type Options } from './connection.js';
import { type ProximityOptions } from './declared.js';
import { type Body } from './geometry.js';
import { type MatchOptions } from './matches.js';
import { type MeshFile, type ReadMeshOptions } from './mesh_file.js';
import { type WorkerStart } from './protocol.js';
import { WorkerPair, WorkerSites, WorkerSurface } from './remote.js';
import { WorkerAnimation, WorkerLook, WorkerMatches } from './remote_looks.js';
import { type SurfaceOptions } from './surface.js';
import { type Indices, type Points } from './types.js';
import { type OtherUnit } from './units.js';

/**
 * The library in a worker, with a memory of its own. Calls are answered in their order. An aborted call rejects at once; where memory
 * can be shared, its computation stops at its next poll, and that of a map elsewhere between its parts. A call that goes on, for 2 s
 * if it polls or for 0.2 s otherwise, is stopped with its worker: objects that were made before are then lost (SdmError `ended`), and
 * others can be made.
 */
export class SdmWorker {
  /** @internal */
  constructor(private readonly connection: Connection) {}

  /** @internal */
  static async open(start: WorkerStart): Promise<SdmWorker> {
    return new SdmWorker(await Connection.open(start));
  }

  get threads(): number {
    return this.connection.answer.threads;
  }
  /** Whether aborted calls stop without the worker. */
  get sharesMemory(): boolean {
    return this.connection.answer.flags !== undefined;
  }
  /** How often the worker was ended and replaced: objects that were made before are lost. */
  get restarts(): number {
    return this.connection.generation;
  }
  /** Of Surface: lays out the atlas. */
  async surface(
    positions: Points,
    indices: Indices = null,
    options: Options<SurfaceOptions> = {},
  ): Promise<WorkerSurface> {
    return new WorkerSurface(
      this.connection,
      await this.connection.call(null, 'surface', [positions, indices], { ...options }),
    );
  }
  async sites(positions: Points, indices: Indices = null, options: CallOptions = {}): Promise<WorkerSites> {
    return new WorkerSites(
      this.connection,
      await this.connection.call(null, 'sites', [positions, indices], { ...options }),
    );
  }
  /** Of the module `full` only. */
  async pair(first: Body, second: Body, options: ProximityOptions & CallOptions = {}): Promise<WorkerPair> {
    return new WorkerPair(
      this.connection,
      await this.connection.call(null, 'pair', [first, second], { ...options }),
    );
  }
  /** Reads a mesh file. Of the module `full` only. */
  readMesh(
    bytes: Uint8Array | ArrayBuffer,
    name: string,
    options: Options<ReadMeshOptions> = {},
  ): Promise<MeshFile> {
    return this.connection.call(null, 'readMesh', [bytes, name], { ...options });
  }
  /** As of Sdm. */
  async readLook(
    bytes: Uint8Array | ArrayBuffer,
    name: string,
    options: Options<ReadMeshOptions> = {},
  ): Promise<WorkerLook> {
    return new WorkerLook(
      this.connection,
      await this.connection.call(null, 'readLook', [bytes, name], { ...options }),
    );
  }
  /** As of Sdm: null if the file has no animation. */
  async readAnimation(
    bytes: Uint8Array | ArrayBuffer,
    name: string,
    options: Options<ReadAnimationOptions> = {},
  ): Promise<WorkerAnimation | null> {
    const made = await this.connection.call(null, 'readAnimation', [bytes, name], { ...options });
    return made && new WorkerAnimation(this.connection, made);
  }
  /** As of Sdm. */
  async match(
    surface: WorkerSurface,
    sites: WorkerSites,
    options: Options<MatchOptions> = {},
  ): Promise<WorkerMatches> {
    const made = await this.connection.call(null, 'match', [surface, sites], { ...options });
    return new WorkerMatches(this.connection, made, surface, sites);
  }
  /** As of Sdm: null if the mesh fits in no other unit. */
  unitCheck(body: Body, sites: WorkerSites, options: CallOptions = {}): Promise<OtherUnit | null> {
    return this.connection.call(null, 'unitCheck', [body, sites], { ...options });
  }
  /** What the module has taken from the system. */
  memoryBytes(): Promise<number> {
    return this.connection.call(null, 'memory', []);
  }
  /** Ends the worker. Calls that have not ended reject. */
  terminate(): void {
    this.connection.terminate();
  }
}
