// Values of the sites' mesh at the points that belong to texels.
import { type Bytes, float32 } from './bytes.js';
import { type Module } from './module.js';
import { type NumberArray, type Progress } from './types.js';

export interface TransferOptions {
  /** Numbers of each vertex, face or corner: 1 by default. */
  components?: number;
  /** What the values are of: vertices, by default, or corners, between which they are interpolated, or faces. */
  domain?: 'vertex' | 'face' | 'corner';
  /** Whether texels that no face owns are filled from their surroundings: by default they are. */
  fill?: boolean;
  progress?: Progress;
}

/** @internal `objects`: surface, sites, and the map or matches, in the module. */
export function transferred(
  module: Module,
  name: 'sdm_transfer' | 'sdm_transfer_matches',
  objects: readonly number[],
  values: ArrayLike<number>,
  options: TransferOptions,
): Float32Array {
  const rows: NumberArray = values instanceof Float32Array ? values : Float32Array.from(values);
  const domain = module.number('domain', options.domain ?? 'vertex');
  const [result] = module.call(
    name,
    [...objects, rows, rows.length, options.components ?? 1, domain, options.fill === false ? 0 : 1],
    options.progress,
  );
  return float32(result as Bytes);
}
