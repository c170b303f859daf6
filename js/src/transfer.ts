// Values of the sites' mesh at the points that belong to texels.
import type * as declared from './declared.js';
import { declaredOptions } from './given.js';
import { type Module } from './module.js';
import { type Progress } from './types.js';

export interface TransferOptions extends declared.TransferOptions {
  progress?: Progress | undefined;
}

/** @internal `objects`: surface, sites, and the map or matches, in the module. */
export function transferred(
  module: Module,
  name: 'sdm_transfer' | 'sdm_transfer_matches',
  objects: readonly number[],
  values: ArrayLike<number>,
  { progress, ...given }: TransferOptions,
): Float32Array {
  const rows = values instanceof Float32Array ? values : Float32Array.from(values);
  const sent = [...objects, rows, rows.length, ...declaredOptions(given)];
  return module.call<{ values: Float32Array }>(name, sent, progress).values;
}
