// The values as a texture for the shader.
import type { Model, TexelMap } from './page_data';

/// Stands for "no value": shaders cannot rely on NaN.
export const kNoValue = 3e38;
const kRings = 4;

const kNone = -1;

/// Where the value of each texel comes from: the number of a texel, the number of texels plus that of a vertex, or -1. The
/// charts are extended around their texels, which do not cover their corners: free texels at a corner get the vertex's own
/// distance, the others the value of a neighbour.
export function sourcesOf(
  { width, height, chart }: Pick<TexelMap, 'width' | 'height' | 'chart'>,
  place: Float32Array | null,
): Int32Array {
  const sources = new Int32Array(width * height).fill(kNone);
  for (let i = 0; i < sources.length; ++i) if (chart[i] !== 0) sources[i] = i;
  for (let v = 0; v < (place?.length ?? 0) / 2; ++v)
    for (let k = 0; k < 4; ++k) {
      const x = Math.floor(place![2 * v] + (k & 1) - 0.5);
      const y = Math.floor(place![2 * v + 1] + (k >> 1) - 0.5);
      if (x < 0 || y < 0 || x >= width || y >= height) continue;
      const i = y * width + x;
      if (sources[i] === kNone) sources[i] = sources.length + v;
    }
  // Ring by ring; the texels of a ring are filled only after all of them were found.
  let border: number[] = [];
  for (let i = 0; i < sources.length; ++i) if (sources[i] !== kNone) border.push(i);
  for (let ring = 0; ring < kRings; ++ring) {
    const next: number[] = [];
    for (const i of border) {
      const x = i % width;
      const add = (j: number) => {
        if (sources[j] !== kNone) return;
        sources[j] = sources[i];
        next.push(j);
      };
      if (x > 0) add(i - 1);
      if (x + 1 < width) add(i + 1);
      if (i >= width) add(i - width);
      if (i + width < sources.length) add(i + width);
    }
    border = next;
  }
  return sources;
}

/// The values of the texels of a map and of the vertices of a model, by their sources.
export function filledValues(
  map: TexelMap,
  model: Model,
  sources = sourcesOf(map, model.place),
  values: Float32Array = new Float32Array(sources.length),
): Float32Array {
  for (let i = 0; i < values.length; ++i) {
    const source = sources[i];
    const value =
      source === kNone
        ? Number.NaN
        : source < values.length
          ? map.distance[source]
          : model.distance[source - values.length];
    values[i] = Number.isNaN(value) ? kNoValue : value;
  }
  return values;
}
