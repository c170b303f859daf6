// The points of O2 that belong to the texels of O1, and what O2 has there.
import type * as declared from './declared.js';
import { declaredOptions } from './given.js';
import { type Look } from './look.js';
import { type Module } from './module.js';
import { Owned } from './owned.js';
import { type Sites } from './sites.js';
import { type Surface } from './surface.js';
import { type TransferOptions, transferred } from './transfer.js';
import { type MatchCounts, type Progress, SdmError } from './types.js';

export interface MatchOptions extends declared.MatchOptions {
  progress?: Progress | undefined;
}

/** The kinds of texels in MatchArrays. */
export const kMatchKinds = ['none', 'closest', 'facing', 'ray', 'tooFar', 'facingAway'] as const;

export interface MatchArrays {
  /** Of each texel, a number of kMatchKinds; `none`: no face of O1 owns the texel. */
  kinds: Uint8Array;
  /** Of O2; 4294967295: no point. */
  faces: Uint32Array;
  /** The shares of the second and the third corner of the face. */
  barycentric: Float32Array;
}

export type BakeChannel = 'base_color' | 'metallic_roughness' | 'occlusion' | 'emissive';

/** A texture, as glTF has it: colours in sRGB, roughness in green and metallic in blue, occlusion in grey. */
export interface BakedTexture {
  channel: BakeChannel;
  /** Of a texel: 1, 3 or 4. */
  components: number;
  /** Row after row from the top. */
  data: Uint8Array;
}

/** Textures, and the material of what is not in them. */
export interface BakedLook {
  textures: BakedTexture[];
  material: {
    baseColor: [number, number, number, number];
    emissive: [number, number, number];
    metallic: number;
    roughness: number;
    alphaMode: 'opaque' | 'mask' | 'blend';
    alphaCutoff: number;
  };
}

export interface NormalOptions {
  /** As glTF has it, for the model with tangents; otherwise (1 + x) / 2 and so on of the coordinates of the meshes. */
  tangentSpace?: boolean | undefined;
  /** Whose normals are taken, if its file has some; without it, smooth ones of O2's mesh, up to a crease of 40°. */
  look?: Look | undefined;
  /** The pose of O2 by which the normals of `look` are turned: 16 numbers, column after column. */
  pose?: ArrayLike<number> | undefined;
  progress?: Progress | undefined;
}

/** The vertices that O1 is drawn with: one for each normal and each place in the atlas of each vertex of the mesh. */
export interface DrawnModel {
  /** Relative to `origin`. */
  positions: Float32Array;
  normals: Float32Array;
  /** From 0 to 1, v down, as glTF has it. */
  uvs: Float32Array;
  /** Four numbers each, by MikkTSpace; null: they were not asked for. */
  tangents: Float32Array | null;
  indices: Uint32Array;
  origin: [number, number, number];
}

/** For each texel of a surface, the point of O2 whose colours, normals and numbers belong there. Of the module `full` only. */
export class Matches extends Owned {
  readonly resolution: number;
  readonly rows: number;
  private readonly numbers: MatchCounts;

  constructor(
    module: Module,
    private readonly surface: Surface,
    private readonly sites: Sites,
    options: MatchOptions = {},
  ) {
    if (!module.has('sdm_match'))
      throw new SdmError('input', 'matches need the module of start({ full: true })');
    const { progress, ...given } = options;
    const values = [surface.handleIn(module), sites.handleIn(module), ...declaredOptions(given)];
    const made = module.call<{ address: number; resolution: number; rows: number; counts: MatchCounts }>(
      'sdm_match',
      values,
      progress,
    );
    super(module, made.address, 'sdm_free_matches');
    this.resolution = made.resolution;
    this.rows = made.rows;
    this.numbers = made.counts;
  }

  counts(): MatchCounts {
    return { ...this.numbers };
  }
  arrays(): MatchArrays {
    return this.module.call<MatchArrays>('sdm_match_arrays', [this.handle]);
  }

  /** Values of the sites' mesh at the points; NaN where a texel of a face has none. */
  transfer(values: ArrayLike<number>, options: TransferOptions = {}): Float32Array {
    return transferred(this.module, 'sdm_transfer_matches', this.addresses(), values, options);
  }

  /** The textures of a look at the points: base colours, and what else differs between them. Texels without a point are filled. */
  bake(look: Look, options: { progress?: Progress | undefined } = {}): BakedLook {
    const values = [...this.addresses(), look.handleIn(this.module)];
    const baked = this.module.call<Partial<BakedLook>>('sdm_bake', values, options.progress);
    return { textures: baked.textures ?? [], material: baked.material! };
  }

  /** The normals of O2 at the points as a picture: red, green and blue of each texel. Texels without a point are filled. */
  normals(options: NormalOptions = {}): Uint8Array {
    const { look, pose } = options;
    if (pose && pose.length !== 16)
      throw new SdmError('input', `a pose is a matrix of 16 numbers, not ${pose.length}`);
    const rotation = Float64Array.from({ length: 9 }, (_, i) =>
      pose ? pose[(i % 3) * 4 + Math.floor(i / 3)]! : i % 4 === 0 ? 1 : 0,
    );
    const shape = [look ? look.handleIn(this.module) : 0, rotation, options.tangentSpace ? 1 : 0];
    return this.module.call<{ picture: Uint8Array }>(
      'sdm_bake_normals',
      [...this.addresses(), ...shape],
      options.progress,
    ).picture;
  }

  /** @internal As a worker calls it: references are no options. */
  normalsOf(look: Look | null, options: NormalOptions): Uint8Array {
    return this.normals({ ...options, ...(look ? { look } : {}) });
  }

  /** What the textures are drawn on. */
  model(options: { tangents?: boolean | undefined } = {}): DrawnModel {
    const values = [this.surface.handleIn(this.module), options.tangents ? 1 : 0];
    return this.module.call<DrawnModel>('sdm_drawn_model', values);
  }

  private addresses(): [number, number, number] {
    return [this.surface.handleIn(this.module), this.sites.handleIn(this.module), this.handle];
  }
}
