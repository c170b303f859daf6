// Animations of mesh files.
import { type ReadMeshOptions, fileArguments } from './mesh_file.js';
import { type Module } from './module.js';
import { Owned } from './owned.js';

export interface ReadAnimationOptions extends ReadMeshOptions {
  /** Frames per second, from the first key to the last; by default one frame for each key. */
  rate?: number | undefined;
}

type FirstFrame = { frames: number; positions: Float64Array; indices: Uint32Array };

/** The mesh of a file whose vertices move. */
export class Animation extends Owned {
  readonly frames: number;

  private constructor(
    module: Module,
    address: number,
    private readonly first: FirstFrame,
  ) {
    super(module, address, 'sdm_free_animation');
    this.frames = first.frames;
  }

  /** @internal Null if the file has no animation. */
  static read(
    module: Module,
    bytes: Uint8Array | ArrayBuffer,
    name: string,
    options: ReadAnimationOptions = {},
  ): Animation | null {
    const values = [...fileArguments(module, 'readAnimation', bytes, name, options), options.rate ?? NaN];
    const { address, ...first } = module.call<{ address?: number } & FirstFrame>(
      'sdm_read_animation',
      values,
      options.progress,
    );
    return address === undefined ? null : new Animation(module, address, first);
  }

  /** The first frame. All frames have its triangles and as many vertices. */
  mesh(): { positions: Float64Array; indices: Uint32Array } {
    return { positions: this.first.positions.slice(), indices: this.first.indices.slice() };
  }
  /** Where the vertices are in a frame. Cost: linear. */
  positions(frame: number): Float64Array {
    const values = [this.handle, frame];
    return this.module.call<{ positions: Float64Array }>('sdm_animation_frame', values).positions;
  }
}
