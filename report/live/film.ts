// What an animated file plays.
import type { SdmWorker, WorkerAnimation } from 'sdm';
import { Matrix4 } from 'three';
import { moved } from './engine';
import { kTimeStep, type Moves } from './scene';
import type { Body } from './engine';

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
