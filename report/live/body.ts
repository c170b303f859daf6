// Bodies, and how they move: by what an animated file plays, or as a scene has it.
import type { SdmWorker, WorkerAnimation } from 'sdm';
import { Matrix4 } from 'three';
import type { Triangles } from './layout';
import { moved } from './placing';

export const kTimeStep = 1 / 60; // seconds between frames

export interface Moves {
  /// The vertices of both bodies a time step later.
  advance(): [Float64Array, Float64Array] | Promise<[Float64Array, Float64Array]>;
}

export interface Body extends Triangles {
  name: string;
  file?: File; ///< none: the page has made it
  film?: Film; ///< of an animated file
}

/// The frames of a file, read again when the worker has lost them.
export class Film {
  private constructor(
    private readonly worker: SdmWorker,
    private readonly file: File,
    private animation: WorkerAnimation,
    private readonly motion = new Matrix4(),
  ) {}

  /// Null: the file has no animation.
  static async of(worker: SdmWorker, file: File): Promise<Film | null> {
    const animation = await read(worker, file);
    return animation && new Film(worker, file, animation);
  }

  get frames(): number {
    return this.animation.frames;
  }

  mesh(): Promise<{ positions: Float64Array; indices: Uint32Array }> {
    return this.animation.mesh();
  }

  /// Again and again from the first frame.
  async positions(frame: number): Promise<Float64Array> {
    const at = frame % this.frames;
    const positions = await this.animation.positions(at).catch(async (error) => {
      if ((error as { kind?: string }).kind !== 'ended') throw error;
      this.animation = (await read(this.worker, this.file))!;
      return this.animation.positions(at);
    });
    return moved(positions, this.motion);
  }

  /// The same elsewhere.
  movedBy(motion: Matrix4): Film {
    return new Film(this.worker, this.file, this.animation, motion.clone().multiply(this.motion));
  }
}

async function read(worker: SdmWorker, file: File): Promise<WorkerAnimation | null> {
  return worker.readAnimation(new Uint8Array(await file.arrayBuffer()), file.name, {
    rate: 1 / kTimeStep,
    transfer: true,
  });
}

/// The same body elsewhere.
export function movedBody({ film, positions, ...others }: Body, motion: Matrix4): Body {
  const moves = film ? { film: film.movedBy(motion) } : {};
  return { ...others, positions: moved(positions, motion), ...moves };
}

/// How two bodies move whose files are animated; null: neither is.
export function movesOf(bodies: [Body, Body]): Moves | null {
  if (!bodies.some(({ film }) => film)) return null;
  let frame = 0;
  return {
    advance: async () => {
      ++frame;
      return (await Promise.all(
        bodies.map(({ film, positions }) => film?.positions(frame) ?? positions),
      )) as [Float64Array, Float64Array];
    },
  };
}
