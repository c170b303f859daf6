// How the reference looks: read of its file when that is first asked for, and again when the worker has lost it.
import type { SdmWorker, WorkerLook } from 'sdm';
import type { Body } from './body';
import { decoded } from './pictures';

export class Looks {
  private of: Body | null = null;
  private restarts = -1; // of the worker, when it was read
  private look: WorkerLook | null = null;

  constructor(private readonly worker: SdmWorker) {}

  /// Null: a body that the page has made has none.
  async lookOf(body: Body): Promise<WorkerLook | null> {
    if (this.of === body && this.restarts === this.worker.restarts) return this.look;
    this.forget();
    if (!body.file) return null;
    const { restarts } = this.worker;
    const look = await this.worker.readLook(new Uint8Array(await body.file.arrayBuffer()), body.name, {
      transfer: true,
    });
    for (const [i, { name, bytes }] of (await look.textures()).entries()) {
      const picture = await decoded(bytes).catch((error: Error) => {
        throw new Error(`${body.name}: its picture ${name || i} cannot be decoded (${error.message}).`);
      });
      await look.setPicture(i, picture, { transfer: true });
    }
    [this.of, this.restarts, this.look] = [body, restarts, look];
    return look;
  }

  forget(): void {
    this.look?.dispose();
    [this.of, this.look] = [null, null];
  }
}
