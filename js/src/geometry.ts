// Points and triangles, as the module takes them.
import { type Indices, type NumberArray, type Points, SdmError } from './types.js';

/** Coordinates as doubles, three for each point. */
export function coordinates(points: Points, name: string): Float64Array {
  if (points.length % 3 !== 0)
    throw new SdmError('input', `${name} has ${points.length} numbers, but three are needed for each point`);
  return points instanceof Float64Array ? points : Float64Array.from(points);
}

/** Indices of corners, three for each triangle. */
export function corners(indices: Indices, vertices: number): Uint32Array {
  if (!indices) return Uint32Array.from({ length: vertices - (vertices % 3) }, (_, i) => i);
  if (indices.length % 3 !== 0)
    throw new SdmError(
      'input',
      `indices has ${indices.length} numbers, but three are needed for each triangle`,
    );
  for (let i = 0; i < indices.length; ++i) {
    const index = indices[i]!;
    if (!(index >= 0 && index < vertices && Number.isInteger(index)))
      throw new SdmError('input', `indices[${i}] is ${index}, but there are ${vertices} vertices`);
  }
  return indices instanceof Uint32Array ? indices : Uint32Array.from(indices);
}

export type Body = { positions: Points; indices?: Indices | undefined };

/** Positions, their count, triangles and theirs. `name`: of the positions. */
export function meshArguments({ positions, indices = null }: Body, name: string): (number | NumberArray)[] {
  const at = coordinates(positions, name);
  const triangles = corners(indices, at.length / 3);
  return [at, at.length / 3, triangles, triangles.length / 3];
}
