// The values as a texture for the shader.
import type { Model, TexelMap } from './page_data';

/// Stands for "no value": shaders cannot rely on NaN.
export const kNoValue = 3e38;
const kRings = 4;

/// The values of the texels, extended around the charts, whose corners are not covered by texels of their own.
/// Free texels at a corner get the vertex's own distance, the others the value of a neighbour.
export function filledValues(map: TexelMap, model: Model): Float32Array {
  const { width, height, chart, distance } = map;
  const values = new Float32Array(width * height);
  const filled = new Uint8Array(width * height);
  for (let i = 0; i < values.length; ++i) {
    if (chart[i] === 0) continue;
    filled[i] = 1;
    values[i] = Number.isNaN(distance[i]) ? kNoValue : distance[i];
  }
  const { place } = model;
  if (place)
    for (let v = 0; v < model.distance.length; ++v)
      for (let k = 0; k < 4; ++k) {
        const x = Math.floor(place[2 * v] + (k & 1) - 0.5);
        const y = Math.floor(place[2 * v + 1] + (k >> 1) - 0.5);
        if (x < 0 || y < 0 || x >= width || y >= height) continue;
        const i = y * width + x;
        if (filled[i]) continue;
        filled[i] = 1;
        values[i] = Number.isNaN(model.distance[v]) ? kNoValue : model.distance[v];
      }
  // Ring by ring; the texels of a ring are filled only after all of them were found.
  let border: number[] = [];
  for (let i = 0; i < filled.length; ++i) if (filled[i]) border.push(i);
  for (let ring = 0; ring < kRings; ++ring) {
    const next: number[] = [];
    for (const i of border) {
      const x = i % width;
      const add = (j: number) => {
        if (filled[j]) return;
        filled[j] = 1;
        values[j] = values[i];
        next.push(j);
      };
      if (x > 0) add(i - 1);
      if (x + 1 < width) add(i + 1);
      if (i >= width) add(i - width);
      if (i + width < filled.length) add(i + width);
    }
    border = next;
  }
  for (let i = 0; i < filled.length; ++i) if (!filled[i]) values[i] = kNoValue;
  return values;
}
