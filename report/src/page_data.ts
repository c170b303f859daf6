// What the page contains: the text of report.json, and the part with its values.
import { AreaByValue } from './area_by_value';
import { Arrays, ArrayIndex, cornersOfCodes, floatsOfOrdered, summed, unpacked, unzigzag } from './arrays';

export type Vec = [number, number, number];
type Color = Vec;

export interface Extreme {
  distance: number;
  point: Vec;
  at: 'texel' | 'vertex' | 'point';
}
/// All that a verdict depends on besides the tolerance.
export interface Evidence {
  lowest: number | null; ///< null: nothing has a distance
  highest: number | null;
  complete: boolean;
  estimated_signs: boolean;
  accuracy: number | null; ///< null: unknown
  error_bound: number | null;
  unmatched?: boolean; ///< a sample has no match
  samples_only?: boolean; ///< nothing bounds the distances between samples
  signed?: boolean; ///< false: no distance is negative
}
/// A mesh, or a cloud, which has points.
export interface Input {
  file: string;
  transform: string;
  vertices?: number;
  triangles?: number;
  closed?: boolean;
  degenerate_faces?: number;
  duplicate_faces?: number;
  points?: number;
  invalid_points?: number;
  normals?: boolean;
}

/// report.json, as far as the page knows it. Any key may be missing: reports of `sdm self` have fewer.
export interface Report {
  version?: string;
  o1?: Input;
  o2?: Input;
  mesh?: Input;
  thickness?: { method: string; text: string; min?: number | null; max?: number | null };
  measured_on?: 'o1' | 'o2';
  units?: string;
  alignment?: { text: string };
  fields?: Record<string, string>; ///< as the author of the report named them
  atlas?: { kind: string; resolution: number; rows?: number; udim?: number | null; charts: number; texels: number };
  engine?: string;
  max_distance?: number | null;
  colors?: { map: string; range: [number, number]; range_from: string };
  measured?: { kind: string; text: string };
  sign?: { method: string; reason: string };
  distance?: Record<string, number | string | null>;
  extremes?: { min: Extreme | null; max: Extreme | null };
  texels_with_value?: number;
  points_with_value?: number;
  beyond_max_distance?: number;
  without_match?: number;
  boundary_texels?: number;
  accuracy?: number | null;
  error_bound?: number | null;
  precision?: number | null;
  evidence?: Evidence;
  tolerance?: {
    value?: number | null;
    lower?: number;
    upper?: number;
    verdict?: string;
    within: boolean;
    certified?: boolean;
    reason?: string;
    nearest_limit?: 'lower' | 'upper';
    text?: string; ///< the verdict as a clause
    proof?: { witness: { distance: number; point: Vec } | null; faces_without_match?: number } | null;
    exceeded_area_fraction?: number;
    exceeded_point_fraction?: number;
  };
  group_tolerances?: {
    verdict: string;
    beyond_max_distance?: number; ///< points of a cloud that are of no group
    without_match?: number; ///< the same
    groups: {
      kind: string;
      group: string;
      lower: number | null; ///< null: no limit
      upper: number | null;
      verdict: string;
      certified?: boolean;
      lowest: number | null;
      highest: number | null;
      exceeded_area_fraction?: number;
      exceeded_point_fraction?: number; ///< of a cloud
      undecided_by?: number | null;
      witness?: { distance: number; point: Vec } | null;
    }[];
  };
  coverage?: { value: number; lower: number; upper: number; reach: number };
  places?: Places | null;
  doubts?: { reason: string; text: string; remedy: string }[];
  notes?: string[];
  time_ms?: Record<string, number | null>;
  [key: string]: unknown;
}

/// A region that deviates, by its sample that is farthest beyond the limit.
export interface Place {
  distance: number | null; ///< null: no value, although a tolerance asks for one
  point: Vec;
  at: 'texel' | 'vertex' | 'point';
  index?: number; ///< of a point of a cloud
  area?: number;
  points?: number; ///< of a cloud
  group: string | null;
  small: boolean;
}

interface PlaceTotals {
  count: number;
  points?: number;
  area?: number;
  area_fraction?: number;
  point_fraction?: number;
}

export interface Places {
  lower: number | null;
  upper: number | null;
  limits_from: 'tolerance' | 'p99_abs';
  least_area_fraction?: number;
  least_point_fraction?: number;
  large: PlaceTotals;
  small: PlaceTotals;
  largest: Place[];
}

interface Placement {
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

interface PageJson {
  version: string;
  up: 'y' | 'z';
  colors: Record<'viridis' | 'diverging' | 'paper2006' | 'within' | 'above' | 'below' | 'no_value', Color[]>;
  map?: { width: number; height: number; step: number; channels?: ChannelJson[] };
  model?: Placement & { triangles_of_mesh: number; names?: { kind: string; names: string[] }[] };
  cloud?: Placement & { points: number; picked: number; normals: boolean }; ///< in place of map and model
  ghost?: Placement & { box: { lo: Vec; hi: Vec }; triangles_of_mesh: number };
  thinnest?: Pick<Place, 'distance' | 'point' | 'at'>[]; ///< of wall thickness, in place of the report's places
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

function textOf(id: string): string {
  return document.getElementById(id)?.textContent ?? '';
}

export function readReport(): Report {
  return JSON.parse(textOf('report')) as Report;
}
export function reportText(): string {
  return textOf('report');
}
export function readPage(): PageJson {
  return JSON.parse(textOf('page')) as PageJson;
}

// The numbers of all texels, 0xFFFFFFFF without an owner, from what is left of them after a guess from the texels
// to the left and above.
function guessed(chart: Uint32Array, width: number, differences: Uint32Array): Uint32Array {
  const numbers = new Uint32Array(chart.length).fill(0xffffffff);
  let last = 0;
  for (let i = 0, owned = 0; i < chart.length; ++i) {
    if (chart[i] === 0) continue;
    const left = i % width > 0 && chart[i - 1] !== 0;
    const above = i >= width && chart[i - width] !== 0;
    let guess = last;
    if (left && above && chart[i - width - 1] !== 0) guess = numbers[i - 1] + numbers[i - width] - numbers[i - width - 1];
    else if (left) guess = numbers[i - 1];
    else if (above) guess = numbers[i - width];
    last = numbers[i] = unzigzag(differences[owned++]) + guess;
  }
  return numbers;
}

// One number for each texel with an owner, for all texels.
function spread(chart: Uint32Array, ofOwned: Uint32Array): Uint32Array {
  let owned = 0;
  return chart.map((c) => (c === 0 ? 0xffffffff : ofOwned[owned++]));
}

function texelMap(page: PageJson, arrays: Arrays): TexelMap {
  const { width, height, step, channels = [] } = page.map!;
  const chart = summed(arrays.get('chart')!);
  const numbers = (name: string) => guessed(chart, width, arrays.get(name)!);
  const sites = arrays.get('site');
  return {
    width,
    height,
    step,
    chart,
    distance: floatsOfOrdered(numbers('distance')),
    site: sites ? spread(chart, summed(sites)) : null,
    channels: channels.map((channel) => ({
      ...channel,
      values: Array.from({ length: channel.components }, (_, k) => {
        const values = numbers(`texel_${channel.name}_${k}`);
        return channel.whole ? values : floatsOfOrdered(values);
      }),
    })),
  };
}

function toCentre(steps: Uint32Array, from: Placement, centre: Vec, size: number): Float32Array {
  const result = new Float32Array(steps.length);
  const scale = from.step / size;
  const shift = from.origin.map((x, k) => (x - centre[k]) / size);
  for (let i = 0; i < steps.length; ++i) result[i] = steps[i] * scale + shift[i % 3];
  return result;
}

// Unit vectors folded onto an octahedron, whose lower half lies in the corners of the square.
function unfoldedNormals(packed: Uint32Array): Int8Array {
  const result = new Int8Array(3 * packed.length);
  for (let i = 0; i < packed.length; ++i) {
    let x = ((packed[i] & 255) - 127.5) / 127.5;
    let y = ((packed[i] >> 8) - 127.5) / 127.5;
    const z = 1 - Math.abs(x) - Math.abs(y);
    if (z < 0) [x, y] = [(1 - Math.abs(y)) * Math.sign(x), (1 - Math.abs(x)) * Math.sign(y)];
    const scale = 127 / Math.hypot(x, y, z);
    result[3 * i] = Math.round(x * scale);
    result[3 * i + 1] = Math.round(y * scale);
    result[3 * i + 2] = Math.round(z * scale);
  }
  return result;
}

function largestIn(steps: Uint32Array): Vec {
  const largest: Vec = [0, 0, 0];
  for (let i = 0; i < steps.length; ++i) if (steps[i] > largest[i % 3]) largest[i % 3] = steps[i];
  return largest;
}

function readModel(page: PageJson, arrays: Arrays): Model {
  const placement = page.model!;
  const steps = summed(arrays.get('position')!, 3);
  const extent = largestIn(steps).map((x) => x * placement.step);
  const centre = placement.origin.map((x, k) => x + extent[k] / 2) as Vec;
  const size = Math.hypot(...extent) / 2 || 1;
  const places = arrays.get('place');
  const charts = arrays.get('triangle_chart');
  return {
    centre,
    size,
    position: toCentre(steps, placement, centre, size),
    normal: unfoldedNormals(arrays.get('normal')!),
    distance: floatsOfOrdered(summed(arrays.get('vertex_distance')!)),
    triangle: cornersOfCodes(arrays.get('triangle')!),
    place: places ? Float32Array.from(summed(places, 2), (x) => x / 64) : null,
    chart: charts ? summed(charts) : null,
    names: (placement.names ?? []).map((kind, k) => ({ ...kind, ofTriangle: summed(arrays.get(`triangle_name_${k}`)!) })),
    trianglesOfMesh: placement.triangles_of_mesh,
  };
}

// The box of all but the outermost 1 % of the points along each axis, and what is near it.
function usualBox(steps: Uint32Array): { lo: Vec; hi: Vec } {
  const lo: Vec = [0, 0, 0];
  const hi: Vec = [0, 0, 0];
  const points = steps.length / 3;
  for (let k = 0; k < 3; ++k) {
    const along = new Uint32Array(points);
    for (let i = 0; i < points; ++i) along[i] = steps[3 * i + k];
    along.sort();
    const least = along[Math.floor(0.005 * (points - 1))];
    const most = along[Math.ceil(0.995 * (points - 1))];
    const margin = 0.1 * (most - least);
    lo[k] = Math.max(along[0], least - margin);
    hi[k] = Math.min(along[points - 1], most + margin);
  }
  return { lo, hi };
}

function readCloud(page: PageJson, arrays: Arrays): CloudData {
  const { origin, step } = page.cloud!;
  const steps = summed(arrays.get('position')!, 3);
  const usual = steps.length > 0 ? usualBox(steps) : { lo: [0, 0, 0], hi: [1, 1, 1] };
  const centre = origin.map((x, k) => x + (step * (usual.lo[k] + usual.hi[k])) / 2) as Vec;
  const size = (step * Math.hypot(...usual.lo.map((x, k) => usual.hi[k] - x))) / 2 || 1;
  const inScene = (corner: number[]) => corner.map((x, k) => (origin[k] + step * x - centre[k]) / size) as Vec;
  const low = summed(arrays.get('number')!);
  const high = arrays.get('number_high');
  const octahedral = arrays.get('normal')!;
  const normal = unfoldedNormals(octahedral.map((n) => Math.max(1, n) - 1));
  octahedral.forEach((n, i) => n === 0 && normal.fill(0, 3 * i, 3 * i + 3));
  return {
    centre,
    size,
    lo: inScene(usual.lo),
    hi: inScene(usual.hi),
    position: toCentre(steps, { origin, step }, centre, size),
    normal,
    distance: floatsOfOrdered(arrays.get('distance')!),
    face: summed(arrays.get('face')!),
    number: Float64Array.from(low, (x, i) => x + (high ? high[i] * 2 ** 32 : 0)),
  };
}

function readGhost(page: PageJson, arrays: Arrays, { centre, size }: { centre: Vec; size: number }): Ghost | null {
  const ghost = page.ghost;
  if (!ghost) return null;
  const steps = arrays.get('ghost_position');
  if (steps)
    return {
      position: toCentre(summed(steps, 3), ghost, centre, size),
      triangle: cornersOfCodes(arrays.get('ghost_triangle')!),
      covered: arrays.get('ghost_covered') ?? null,
      trianglesOfMesh: ghost.triangles_of_mesh,
      isBox: false,
    };
  const ends = [ghost.box.lo, ghost.box.hi];
  const position = new Float32Array(24);
  for (let corner = 0; corner < 8; ++corner)
    for (let k = 0; k < 3; ++k) position[3 * corner + k] = (ends[(corner >> k) & 1][k] - centre[k]) / size;
  const sides = [0, 1, 3, 2, 4, 5, 7, 6, 0, 1, 5, 4, 2, 3, 7, 6, 0, 2, 6, 4, 1, 3, 7, 5];
  const triangle: number[] = [];
  for (let s = 0; s < sides.length; s += 4)
    triangle.push(sides[s], sides[s + 1], sides[s + 2], sides[s], sides[s + 2], sides[s + 3]);
  return { position, triangle: Uint32Array.from(triangle), covered: null, trianglesOfMesh: ghost.triangles_of_mesh, isBox: true };
}

function floats(numbers: Uint32Array): Float32Array {
  return new Float32Array(numbers.buffer);
}

export async function readData(): Promise<PageData> {
  const page = readPage();
  const arrays = await unpacked(page.arrays, textOf('arrays'));
  const surface = page.model ? { map: texelMap(page, arrays), model: readModel(page, arrays) } : null;
  const cloud = page.cloud ? readCloud(page, arrays) : null;
  const area = new AreaByValue(
    page.area.lo,
    page.area.hi,
    arrays.get('area_key')!,
    floats(arrays.get('area_of_key')!),
    floats(arrays.get('area_of_bin')!),
    page.area.without_value,
  );
  return { page, surface, cloud, ghost: readGhost(page, arrays, surface?.model ?? cloud!), area };
}
