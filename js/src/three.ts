// sdm/three: distance maps on meshes of three.js.
import {
  BufferAttribute, BufferGeometry, DataTexture, FloatType, LinearFilter, MeshStandardMaterial, type MeshStandardMaterialParameters,
  NearestFilter, RedFormat, SRGBColorSpace, type WebGLProgramParametersWithUniforms,
} from 'three';
import { type Rgb, kAbove, kBelow, kColormaps, kNoValue, kWithin } from './colors.js';
import { type Atlas } from './surface.js';
import { SdmError } from './types.js';

/**
 * The positions and indices of a geometry, as surface(), sites() and their constructors take them: `...fromBufferGeometry(geometry)`.
 * Vertices stay apart where normals or texture coordinates differ, so that the mesh is open there: for signs, merge them first by
 * `mergeVertices` of three.js, without these attributes.
 */
export function fromBufferGeometry(geometry: BufferGeometry): [positions: Float64Array, indices: Uint32Array] {
  const position = geometry.getAttribute('position');
  if (!position) throw new SdmError('input', 'the geometry has no positions');
  const positions = new Float64Array(3 * position.count);
  for (let i = 0; i < position.count; ++i)
    positions.set([position.getX(i), position.getY(i), position.getZ(i)], 3 * i);
  const { index } = geometry;
  const count = index?.count ?? position.count;
  return [positions, Uint32Array.from({ length: count - (count % 3) }, (_, i) => (index ? index.getX(i) : i))];
}

/**
 * A copy of a geometry whose texture coordinates are those of an atlas, for DistanceMaterial: every corner is a vertex, as the faces of
 * different charts do not share texture coordinates.
 */
export function withAtlas(geometry: BufferGeometry, atlas: Atlas): BufferGeometry {
  const copy = geometry.index ? geometry.toNonIndexed() : geometry.clone();
  const corners = atlas.corners.length / 2, { count } = copy.getAttribute('position');
  if (count - (count % 3) !== corners) throw new SdmError('input', 'the atlas is of another geometry');
  const uvs = new Float32Array(2 * count);
  for (let i = 0; i < corners; ++i) {
    // NaN, of faces without area, would be an error of some drivers.
    uvs[2 * i] = (atlas.corners[2 * i]! || 0) / atlas.resolution;
    uvs[2 * i + 1] = (atlas.corners[2 * i + 1]! || 0) / atlas.rows;
  }
  copy.setAttribute('uv', new BufferAttribute(uvs, 2));
  if (!copy.getAttribute('normal')) copy.computeVertexNormals();
  return copy;
}

export interface DistanceMaterialOptions extends MeshStandardMaterialParameters {
  /** The distances at the ends of the colours; by default the 99th percentile, symmetric if some are negative. */
  range?: [number, number];
  /** Distances allowed: green within, warm above, blue below. */
  tolerance?: [least: number, largest: number];
  colormap?: keyof typeof kColormaps;
}

const kLut = 256;
const kNone = 1e38;  // stands for NaN, which drivers treat in different ways

/** Shows the distances of a map on a geometry of withAtlas(). */
export class DistanceMaterial extends MeshStandardMaterial {
  private readonly texture: DataTexture;
  private readonly texelFaces: Uint32Array;
  private readonly colormap: keyof typeof kColormaps;
  private readonly uniformsOfDistances = {
    sdmDistances: { value: null as DataTexture | null },
    sdmColors: { value: null as DataTexture | null },
    sdmRange: { value: [0, 1] as [number, number] },
    sdmTolerance: { value: [-kNone, kNone] as [number, number] },
    sdmHasTolerance: { value: false },
  };

  constructor(map: { distances: Float32Array }, atlas: Pick<Atlas, 'resolution' | 'rows' | 'texelFaces'>, options: DistanceMaterialOptions = {}) {
    const { range, tolerance, colormap, ...parameters } = options;
    super({ roughness: 0.7, metalness: 0, ...parameters });
    this.texelFaces = atlas.texelFaces;
    this.texture = new DataTexture(new Float32Array(atlas.resolution * atlas.rows), atlas.resolution, atlas.rows, RedFormat, FloatType);
    [this.texture.minFilter, this.texture.magFilter] = [NearestFilter, NearestFilter];
    this.uniformsOfDistances.sdmDistances.value = this.texture;
    this.setDistances(map.distances);
    const shown = range ?? defaultRange(map.distances);
    this.range = shown;
    if (tolerance) this.tolerance = tolerance;
    this.colormap = colormap ?? (shown[0] < 0 ? 'diverging' : 'viridis');
    this.uniformsOfDistances.sdmColors.value = colorTexture(kColormaps[this.colormap]);
    this.defines = { ...this.defines, USE_UV: '' };
  }

  get range(): [number, number] {
    return this.uniformsOfDistances.sdmRange.value;
  }
  set range(range: [number, number]) {
    if (!(range[0] < range[1])) throw new SdmError('input', `the range ${range.join(' to ')} is not increasing`);
    this.uniformsOfDistances.sdmRange.value = range;
  }
  get tolerance(): [number, number] | null {
    return this.uniformsOfDistances.sdmHasTolerance.value ? this.uniformsOfDistances.sdmTolerance.value : null;
  }
  set tolerance(limits: [number, number] | null) {
    if (limits && !(limits[0] < limits[1])) throw new SdmError('input', `the tolerance ${limits.join(' to ')} is not increasing`);
    this.uniformsOfDistances.sdmHasTolerance.value = limits !== null;
    if (limits) this.uniformsOfDistances.sdmTolerance.value = limits;
  }

  /** Shows other distances, of the same atlas: of the next frame. */
  setDistances(distances: Float32Array): void {
    const data = this.texture.image.data as Float32Array;
    if (distances.length !== data.length) throw new SdmError('input', `there are ${distances.length} distances, but ${data.length} texels`);
    for (let i = 0; i < data.length; ++i) data[i] = Number.isNaN(distances[i]) ? kNone : distances[i]!;
    fillBorders(data, this.texelFaces, this.texture.image.width);
    this.texture.needsUpdate = true;
  }

  override onBeforeCompile(shader: WebGLProgramParametersWithUniforms): void {
    Object.assign(shader.uniforms, this.uniformsOfDistances);
    shader.fragmentShader = shader.fragmentShader
      .replace('#include <common>', `#include <common>\n${kDeclarations}`)
      .replace('#include <map_fragment>', 'diffuseColor.rgb *= sdmColor(texture2D(sdmDistances, vUv).r);');
  }
  override clone(): this {
    const { data, width, height } = this.texture.image as { data: Float32Array; width: number; height: number };
    const atlas = { resolution: width, rows: height, texelFaces: this.texelFaces };
    const options = { range: [...this.range] as [number, number], colormap: this.colormap };
    const copy = new DistanceMaterial({ distances: data }, atlas, options).copy(this);
    copy.tolerance = this.tolerance && [...this.tolerance];
    copy.defines = { ...this.defines };  // copy() of three.js resets these
    return copy as this;
  }
  override customProgramCacheKey(): string {
    return 'sdm.DistanceMaterial';
  }
  override dispose(): void {
    this.texture.dispose();
    this.uniformsOfDistances.sdmColors.value?.dispose();
    super.dispose();
  }
}

// Rows of the texture of colours: the colormap; within, above and below the tolerance.
const kDeclarations = `
uniform sampler2D sdmDistances;
uniform sampler2D sdmColors;
uniform vec2 sdmRange;
uniform vec2 sdmTolerance;
uniform bool sdmHasTolerance;
vec3 sdmRow(float t, float row) {
  return texture2D(sdmColors, vec2((clamp(t, 0.0, 1.0) * ${kLut - 1}.0 + 0.5) / ${kLut}.0, (row + 0.5) / 5.0)).rgb;
}
vec3 sdmColor(float d) {
  if (d > 1e37) return sdmRow(0.0, 4.0);
  if (!sdmHasTolerance) return sdmRow((d - sdmRange.x) / (sdmRange.y - sdmRange.x), 0.0);
  if (d > sdmTolerance.y) return sdmRow((d - sdmTolerance.y) / max(sdmRange.y - sdmTolerance.y, 1e-30), 2.0);
  if (d < sdmTolerance.x) return sdmRow((sdmTolerance.x - d) / max(sdmTolerance.x - sdmRange.x, 1e-30), 3.0);
  bool zero = sdmTolerance.x <= 0.0 && sdmTolerance.y >= 0.0;
  float middle = zero ? 0.0 : 0.5 * (sdmTolerance.x + sdmTolerance.y);
  float room = d > middle ? sdmTolerance.y - middle : middle - sdmTolerance.x;
  return sdmRow(abs(d - middle) / max(room, 1e-30), 1.0);
}`;

function colorTexture(colormap: readonly Rgb[]): DataTexture {
  const data = new Uint8Array(4 * kLut * 5);
  const put = (row: number, i: number, [r, g, b]: Rgb) => data.set([r, g, b, 255], 4 * (row * kLut + i));
  for (let i = 0; i < kLut; ++i) {
    const t = i / (kLut - 1);
    put(0, i, gradient(colormap, t));
    put(1, i, kWithin[Math.min(kWithin.length - 1, Math.floor(t * kWithin.length))]!);
    put(2, i, gradient(kAbove, t));
    put(3, i, gradient(kBelow, t));
    put(4, i, kNoValue);
  }
  const texture = new DataTexture(data, kLut, 5);
  [texture.minFilter, texture.magFilter] = [LinearFilter, LinearFilter];
  texture.colorSpace = SRGBColorSpace;
  texture.needsUpdate = true;
  return texture;
}

function gradient(colors: readonly Rgb[], t: number): Rgb {
  const at = Math.min(colors.length - 2, Math.floor(t * (colors.length - 1))), f = t * (colors.length - 1) - at;
  return [0, 1, 2].map((k) => Math.round(colors[at]![k]! * (1 - f) + colors[at + 1]![k]! * f)) as unknown as Rgb;
}

/** Texels beside those of faces get a value of these: a face reaches into texels whose centres are outside of it. */
function fillBorders(data: Float32Array, texelFaces: Uint32Array, width: number): void {
  const free = 0xffffffff, height = data.length / width;
  for (let y = 0; y < height; ++y)
    for (let x = 0; x < width; ++x) {
      if (texelFaces[y * width + x] !== free) continue;
      for (let n = 0; n < 9; ++n) {
        const u = x + (n % 3) - 1, v = y + Math.floor(n / 3) - 1;
        if (u < 0 || v < 0 || u >= width || v >= height || texelFaces[v * width + u] === free) continue;
        data[y * width + x] = data[v * width + u]!;
        break;
      }
    }
}

function defaultRange(distances: Float32Array): [number, number] {
  const step = Math.max(1, Math.floor(distances.length / 65536));
  const sizes: number[] = [];
  let negative = false;
  for (let i = 0; i < distances.length; i += step) {
    if (Number.isNaN(distances[i])) continue;
    sizes.push(Math.abs(distances[i]!));
    negative ||= distances[i]! < 0;
  }
  const p99 = sizes.sort((a, b) => a - b)[Math.floor(0.99 * (sizes.length - 1))] || 1;
  return [negative ? -p99 : 0, p99];
}
