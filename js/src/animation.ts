// Animations of mesh files.
import { type Bytes, float64, uint32 } from './bytes.js';
import { type ReadMeshOptions, fileArguments } from './mesh_file.js';
import { type Module } from './module.js';
import { Owned } from './owned.js';

export interface ReadAnimationOptions extends ReadMeshOptions {
  /** Frames per second, from the first key to the last; by default one frame for each key. */
  rate?: number;
}

/** The mesh of a file whose vertices move. */
export class Animation extends Owned {
  readonly frames: number;
  private readonly first: { positions: Bytes; indices: Bytes };

  private constructor(module: Module, address: Bytes, frames: Bytes, positions: Bytes, indices: Bytes) {
    super(module, float64(address)[0]!, 'sdm_free_animation');
    this.frames = float64(frames)[0]!;
    this.first = { positions, indices };
  }

  /** @internal Null if the file has no animation. */
  static read(
    module: Module,
    bytes: Uint8Array | ArrayBuffer,
    name: string,
    options: ReadAnimationOptions = {},
  ): Animation | null {
    const values = fileArguments(module, 'readAnimation', bytes, name, options);
    const [, ...parts] = module.call(
      'sdm_read_animation',
      [...values, options.rate ?? NaN],
      options.progress,
    );
    if (parts.length === 0) return null;
    const [address, frames, positions, indices] = parts as [Bytes, Bytes, Bytes, Bytes];
    return new Animation(module, address, frames, positions, indices);
  }

  /** The first frame. All frames have its triangles and as many vertices. */
  mesh(): { positions: Float64Array; indices: Uint32Array } {
    return { positions: float64(this.first.positions).slice(), indices: uint32(this.first.indices).slice() };
  }
  /** Where the vertices are in a frame. Cost: linear. */
  positions(frame: number): Float64Array {
    return float64(this.module.call('sdm_animation_frame', [this.handle, frame])[0]!);
  }
}
