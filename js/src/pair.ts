// Two bodies that move.
import type * as declared from './declared.js';
import { type Body, coordinates, meshArguments } from './geometry.js';
import { declaredOptions } from './given.js';
import { type Module } from './module.js';
import { Owned } from './owned.js';
import { type BoundedLength, type Points, SdmError } from './types.js';

export interface Contacts {
  /** Points on the first and on the second body, three numbers each. */
  points1: Float64Array;
  points2: Float64Array;
  /** Along which moving the first body separates them. */
  normals: Float64Array;
  depths: Float64Array;
  patches: Uint32Array;
  ids: BigUint64Array;
}

/** Two bodies that move and deform. Of the module `full` only. */
export class Pair extends Owned {
  constructor(module: Module, first: Body, second: Body, options: declared.ProximityOptions = {}) {
    if (!module.has('sdm_new_pair'))
      throw new SdmError('input', 'Pair needs the module of start({ full: true })');
    const bodies = [first, second].flatMap((body, i) => meshArguments(body, `positions of body ${i}`));
    const values = [...bodies, ...declaredOptions(options)];
    super(module, module.call<{ address: number }>('sdm_new_pair', values).address, 'sdm_free_pair');
  }

  /** Moves a body, 0 or 1. `matrix`: 16 numbers, column after column, as three.js has them (Matrix4.elements). */
  setPose(body: 0 | 1, matrix: ArrayLike<number>): void {
    if (matrix.length !== 16)
      throw new SdmError('input', `a pose is a matrix of 16 numbers, not ${matrix.length}`);
    const rows = Float64Array.from({ length: 12 }, (_, i) => matrix[(i % 4) * 4 + (i >> 2)]!);
    this.module.call('sdm_set_pose', [this.handle, body, rows]);
  }
  /** Moves the vertices of a body. */
  refit(body: 0 | 1, positions: Points): void {
    const at = coordinates(positions, 'positions');
    this.module.call('sdm_refit_pair', [this.handle, body, at, at.length / 3]);
  }
  /** The smallest distance between both surfaces; 0 if they intersect. */
  separation(): BoundedLength {
    return this.module.call<BoundedLength>('sdm_separation', [this.handle]);
  }
  /** Whether the surfaces intersect, or a solid contains part of the other body. */
  colliding(): boolean {
    return this.module.call<{ colliding: boolean }>('sdm_colliding', [this.handle]).colliding;
  }
  /** How deep a point of one body is inside the other; null if neither is a solid. */
  penetrationDepth(): BoundedLength | null {
    const values = [this.handle];
    return this.module.call<{ depth?: BoundedLength }>('sdm_penetration_depth', values).depth ?? null;
  }
  contacts(): Contacts {
    return this.module.call<Contacts>('sdm_contacts', [this.handle]);
  }
}
