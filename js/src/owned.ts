/// <reference lib="esnext.disposable" preserve="true" />
// Objects in the memory of a module.
import { type Module } from './module.js';
import { SdmError } from './types.js';

/** An object in the memory of a module. It is freed when it is collected, by dispose(), or at the end of the block of `using`. */
export abstract class Owned {
  private address: number;

  protected constructor(
    protected readonly module: Module,
    address: number,
    private readonly free: string,
  ) {
    this.address = address;
    module.watch(this, () => module.free(free, address));
  }

  /** Frees the memory of the object, which cannot be used any more. */
  dispose(): void {
    if (this.address === 0) return;
    this.module.unwatch(this);
    this.module.free(this.free, this.address);
    this.address = 0;
  }
  [Symbol.dispose](): void {
    this.dispose();
  }

  protected get handle(): number {
    if (this.address === 0) throw new SdmError('input', `this ${this.constructor.name} was disposed of`);
    return this.address;
  }
  /** @internal The object, for another one, which must be of the same module. */
  handleIn(module: Module): number {
    if (module !== this.module) throw new SdmError('input', 'the objects belong to different modules');
    return this.handle;
  }
}
