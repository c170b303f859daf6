// What is baked in a worker: looks, matches and animations.
import { type Bytes } from './bytes.js';
import { type CallOptions, type Connection, type Made, type Options, Remote } from './connection.js';
import { type Picture } from './look.js';
import { type BakedLook, type DrawnModel, type MatchArrays, type NormalOptions } from './matches.js';
import { type WorkerSites, type WorkerSurface } from './remote.js';
import { type TransferOptions } from './transfer.js';
import { type MatchCounts } from './types.js';

/** The look of a mesh file in a worker. */
export class WorkerLook extends Remote {
  readonly hasMaterials: boolean;
  readonly hasColors: boolean;
  readonly hasNormals: boolean;

  /** @internal */
  constructor(connection: Connection, made: Made) {
    super(connection, made);
    const { fields } = made;
    [this.hasMaterials, this.hasColors, this.hasNormals] = ['hasMaterials', 'hasColors', 'hasNormals'].map(
      (name) => fields[name],
    ) as [boolean, boolean, boolean];
  }
  textures(): Promise<{ name: string; bytes: Bytes }[]> {
    return this.call('textures', []);
  }
  notes(): Promise<string[]> {
    return this.call('notes', []);
  }
  setPicture(texture: number, picture: Picture, options?: CallOptions): Promise<void> {
    return this.call('setPicture', [texture, picture], options);
  }
}

/** Matches in a worker. */
export class WorkerMatches extends Remote {
  readonly resolution: number;
  readonly rows: number;

  /** @internal Keeps the surface and the sites from being collected before it. */
  constructor(
    connection: Connection,
    made: Made,
    /** @internal */ readonly surface: WorkerSurface,
    /** @internal */ readonly sites: WorkerSites,
  ) {
    super(connection, made);
    const { fields } = made;
    [this.resolution, this.rows] = [fields['resolution'] as number, fields['rows'] as number];
  }
  counts(): Promise<MatchCounts> {
    return this.call('counts', []);
  }
  arrays(): Promise<MatchArrays> {
    return this.call('arrays', []);
  }
  transfer(values: ArrayLike<number>, options?: Options<TransferOptions>): Promise<Float32Array> {
    return this.call('transfer', [values], options);
  }
  bake(look: WorkerLook, options?: CallOptions): Promise<BakedLook> {
    return this.call('bake', [look], options);
  }
  normals(
    options: Options<Omit<NormalOptions, 'look'>> & { look?: WorkerLook | undefined } = {},
  ): Promise<Uint8Array> {
    const { look, ...others } = options;
    return this.call('normalsOf', [look ?? null], others);
  }
  model(options?: { tangents?: boolean | undefined } & CallOptions): Promise<DrawnModel> {
    return this.call('model', [], options);
  }
}

/** An animation in a worker. */
export class WorkerAnimation extends Remote {
  readonly frames: number;

  /** @internal */
  constructor(connection: Connection, made: Made) {
    super(connection, made);
    this.frames = made.fields['frames'] as number;
  }
  mesh(): Promise<{ positions: Float64Array; indices: Uint32Array }> {
    return this.call('mesh', []);
  }
  positions(frame: number): Promise<Float64Array> {
    return this.call('positions', [frame]);
  }
}
