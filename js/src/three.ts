// sdm/three: distance maps on meshes of three.js.
import {
  DataTexture,
  FloatType,
  MeshStandardMaterial,
  type MeshStandardMaterialParameters,
  NearestFilter,
  RedFormat,
  type WebGLProgramParametersWithUniforms,
} from 'three';
import { kBands, kEndToEnd } from './rules.js';
import { type Atlas } from './surface.js';
import { colorTexture, colorsOf, kDeclarations, kModes } from './three_colors.js';
import { type Colormap, SdmError } from './types.js';

export { fromBufferGeometry, withAtlas } from './three_geometry.js';
export { type ClosestPointTarget, GeometrySites } from './three_sites.js';

export interface DistanceMaterialOptions extends MeshStandardMaterialParameters {
  /** The distances at the ends of the colours; by default as in all pictures: round numbers around 99 % of the texels, and the tolerance. */
  range?: [number, number] | undefined;
  /** Distances allowed: green within, warm above, blue below. One of them may be infinite: no limit. */
  tolerance?: [least: number, largest: number] | undefined;
  /** The error of the distances: those that exceed the tolerance, or 0, by less are within it. */
  accuracy?: number | undefined;
  /**
   * By default as in all pictures: `viridis` if no distance is negative, `sequential` (viridis from 0 to the longer side, reds for the other one)
   * if few are on one side of 0, or else `diverging`.
   */
  colormap?: Exclude<Colormap, 'automatic'> | undefined;
}

const kNone = 1e38; // stands for NaN and for no limit: drivers treat NaN and infinity in different ways

/** Shows the distances of a map on a geometry of withAtlas(). */
export class DistanceMaterial extends MeshStandardMaterial {
  private readonly texture: DataTexture;
  private readonly texelFaces: Uint32Array;
  private readonly colormap: keyof typeof kModes;
  private limits: [number, number] | null = null;
  private readonly uniformsOfDistances = {
    sdmDistances: { value: null as DataTexture | null },
    sdmColors: { value: null as DataTexture | null },
    sdmMode: { value: kEndToEnd },
    sdmRange: { value: [0, 1] as [number, number] },
    sdmLimits: { value: [-kNone, kNone] as [number, number] },
    sdmAccuracy: { value: 0 },
  };

  constructor(
    map: { distances: Float32Array },
    atlas: Pick<Atlas, 'resolution' | 'rows' | 'texelFaces'>,
    options: DistanceMaterialOptions = {},
  ) {
    const { range, tolerance, accuracy, colormap, ...parameters } = options;
    super({ roughness: 0.7, metalness: 0, ...parameters });
    this.texelFaces = atlas.texelFaces;
    this.texture = new DataTexture(
      new Float32Array(atlas.resolution * atlas.rows),
      atlas.resolution,
      atlas.rows,
      RedFormat,
      FloatType,
    );
    [this.texture.minFilter, this.texture.magFilter] = [NearestFilter, NearestFilter];
    this.uniformsOfDistances.sdmDistances.value = this.texture;
    this.setDistances(map.distances);
    const colors = colorsOf(map.distances, { range, tolerance, accuracy, colormap });
    this.range = colors.range;
    this.colormap = colors.colormap;
    this.tolerance = tolerance ?? null;
    this.accuracy = accuracy ?? 0;
    this.uniformsOfDistances.sdmColors.value = colorTexture(this.colormap);
    this.defines = { ...this.defines, USE_UV: '' };
  }

  get range(): [number, number] {
    return this.uniformsOfDistances.sdmRange.value;
  }
  set range(range: [number, number]) {
    if (!(range[0] < range[1]))
      throw new SdmError('input', `the range ${range.join(' to ')} is not increasing`);
    this.uniformsOfDistances.sdmRange.value = range;
  }
  get tolerance(): [number, number] | null {
    return this.limits;
  }
  set tolerance(limits: [number, number] | null) {
    if (limits && !(limits[0] <= limits[1] && limits.some(Number.isFinite)))
      throw new SdmError(
        'input',
        `the tolerance is ${limits.join(' to ')}: it must be two numbers, the smaller one first, one of them finite`,
      );
    this.limits = limits;
    this.uniformsOfDistances.sdmMode.value = limits ? kBands : kModes[this.colormap];
    if (limits)
      this.uniformsOfDistances.sdmLimits.value = limits.map((limit) =>
        Math.min(kNone, Math.max(-kNone, limit)),
      ) as [number, number];
  }
  get accuracy(): number {
    return this.uniformsOfDistances.sdmAccuracy.value;
  }
  set accuracy(accuracy: number) {
    if (!(accuracy >= 0)) throw new SdmError('input', `the accuracy is ${accuracy}: it must be at least 0`);
    this.uniformsOfDistances.sdmAccuracy.value = Math.min(kNone, accuracy);
  }

  /** Shows other distances, of the same atlas: of the next frame. */
  setDistances(distances: Float32Array): void {
    const data = this.texture.image.data as Float32Array;
    if (distances.length !== data.length)
      throw new SdmError('input', `there are ${distances.length} distances, but ${data.length} texels`);
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
    const { data, width, height } = this.texture.image as {
      data: Float32Array;
      width: number;
      height: number;
    };
    const atlas = { resolution: width, rows: height, texelFaces: this.texelFaces };
    const options = {
      range: [...this.range] as [number, number],
      colormap: this.colormap,
      accuracy: this.accuracy,
    };
    const copy = new DistanceMaterial({ distances: data }, atlas, options).copy(this);
    copy.tolerance = this.tolerance && [...this.tolerance];
    copy.defines = { ...this.defines }; // copy() of three.js resets these
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

/** Texels beside those of faces get a value of these: a face reaches into texels whose centres are outside of it. */
function fillBorders(data: Float32Array, texelFaces: Uint32Array, width: number): void {
  const free = 0xffffffff;
  const height = data.length / width;
  for (let y = 0; y < height; ++y)
    for (let x = 0; x < width; ++x) {
      if (texelFaces[y * width + x] !== free) continue;
      for (let n = 0; n < 9; ++n) {
        const u = x + (n % 3) - 1;
        const v = y + Math.floor(n / 3) - 1;
        if (u < 0 || v < 0 || u >= width || v >= height || texelFaces[v * width + u] === free) continue;
        data[y * width + x] = data[v * width + u]!;
        break;
      }
    }
}
