// What the page contains beside the text of report.json: the part with its values.
import type { AreaByValue } from './area_by_value';
import type { ArrayIndex } from './arrays';
import type { Place, Vec } from './report_json';

export * from './report_json';

export interface Placement {
  origin: Vec;
  step: number;
}

/// A channel beside the distance and the site: of src/io/page/report/page_channels.h.
interface ChannelJson {
  name: string;
  components: number;
  whole: boolean; ///< whole numbers, 0xFFFFFFFF without one; otherwise floats
  length: boolean; ///< in the units of the files
}

export interface PageJson {
  version: string;
  up: 'y' | 'z';
  map?: { width: number; height: number; step: number; channels?: ChannelJson[] };
  model?: Placement & { triangles_of_mesh: number; names?: { kind: string; names: string[] }[] };
  cloud?: Placement & { points: number; picked: number; normals: boolean }; ///< in place of map and model
  ghost?: Placement & { box: { lo: Vec; hi: Vec }; triangles_of_mesh: number };
  thinnest?: Pick<Place, 'distance' | 'point' | 'at'>[]; ///< of wall thickness and of the distance to itself, in place of the report's places
  thickest?: Pick<Place, 'distance' | 'point' | 'at'>[]; ///< the same with an upper limit only
  area: { lo: number; hi: number; without_value: number };
  arrays: ArrayIndex;
}

/// The texels of the page: all of the map, or of a larger map one of each square of step² texels.
export interface TexelMap {
  width: number;
  height: number;
  step: number;
  chart: Uint32Array; ///< of each texel, 0 without an owner
  distance: Float32Array; ///< of each texel; NaN without a value or an owner
  site: Uint32Array | null; ///< 4 · number + type of each texel, 0xFFFFFFFF without one
  channels: Channel[]; ///< the others
}

/// A channel that the page shows as numbers, for the texel under the cursor.
export interface Channel extends ChannelJson {
  values: (Float32Array | Uint32Array)[]; ///< of each component, for each texel
}

/// Names of one kind, such as groups.
interface NamedTriangles {
  kind: string;
  names: string[];
  ofTriangle: Uint32Array; ///< 1 + the number of its name, 0 without one
}

/// The triangles of the part. Positions are relative to `centre` in units of `size`, so that they fit single
/// precision for parts of any size and place.
export interface Model {
  centre: Vec;
  size: number;
  position: Float32Array;
  normal: Int8Array; ///< three a vertex, times 127
  distance: Float32Array; ///< of each vertex
  triangle: Uint32Array;
  place: Float32Array | null; ///< in texels of the page; null: a coarser copy, with values at its vertices
  chart: Uint32Array | null; ///< of each triangle
  names: NamedTriangles[]; ///< for each kind of names
  trianglesOfMesh: number;
}

export interface Ghost {
  position: Float32Array;
  triangle: Uint32Array;
  covered: Uint32Array | null; ///< of each triangle, 1 if it is covered; null: unknown
  trianglesOfMesh: number;
  isBox: boolean;
}

/// The points of the page. Positions are relative to `centre` in units of `size`: those of the box of most of
/// them, as outliers may be far away.
export interface CloudData {
  centre: Vec;
  size: number;
  lo: Vec; ///< of that box
  hi: Vec;
  position: Float32Array;
  normal: Int8Array; ///< three a point, times 127; 0 without one
  distance: Float32Array; ///< NaN without one
  face: Uint32Array; ///< 0xFFFFFFFF without one
  number: Float64Array; ///< in the file
}

export interface PageData {
  page: PageJson;
  surface: { map: TexelMap; model: Model } | null;
  cloud: CloudData | null; ///< in place of a surface
  ghost: Ghost | null;
  area: AreaByValue;
}
