// The data of the page of `sdm bake`: that of src/io/page/baked.
import { ArrayIndex, Arrays, bytesOfBase85, cornersOfCodes, guessesOf, unguessed, unpacked } from './arrays';
import type { Placement, Vec } from './page_data';
import { toCentre, unfoldedNormals } from './read_page';

interface BakedJson {
  version: string;
  date?: string;
  up: 'y' | 'z';
  place: Placement;
  low: { triangles: number; width: number; height: number };
  high: { triangles: number; triangles_of_mesh: number; divisions: number; fewer: boolean };
  pictures: Record<string, { bytes: number; text: string }>;
  base_color: [number, number, number, number];
  emissive: Vec;
  metallic: number;
  roughness: number;
  alpha_mode: number; ///< 0: opaque, 1: mask, 2: blend
  alpha_cutoff: number;
  arrays: ArrayIndex;
}

interface Input {
  file: string;
  xxh3?: string;
  triangles: number;
  vertices: number;
}

/// What the page reads of report.json.
export interface BakedReport {
  high: Input;
  low: Input;
  units: string;
  atlas: {
    kind: string;
    resolution: number;
    rows: number;
    samples: number;
    charts: number;
    texels: number;
    utilisation: number;
    overlapping_texels: number;
  };
  max_distance: number | null;
  match: 'closest' | 'facing' | 'ray';
  facing: number | null;
  cage: number | null;
  texels: { closest: number; facing: number; ray: number; too_far: number; facing_away: number };
  textures: Record<
    string,
    { file: string; values: string; picture?: { file: string; lower: number; upper: number } }
  >;
  notes: string[];
  time_ms: Record<string, number>;
}

/// Positions are relative to the middle of both meshes, in units of half of their diagonal.
export interface Shape {
  position: Float32Array;
  normal: Int8Array; ///< three a vertex, times 127
  triangle: Uint32Array;
  place: Float32Array | null; ///< in the textures, from 0 to 1, y down
  tangent: Float32Array | null; ///< four a vertex
  color: Uint8Array | null; ///< four a vertex, in sRGB
  surface: Uint8Array | null; ///< four a vertex: roughness in the second, metallic in the third; null: rough, and no metal
}

export interface BakedData {
  page: BakedJson;
  report: BakedReport;
  low: Shape;
  high: Shape;
  lo: Vec; ///< of both
  hi: Vec;
  pictures: Map<string, ImageBitmap>;
}

/// Steps of all positions of a mesh, and what they are guessed from.
function stepsOf(
  arrays: Arrays,
  mesh: string,
): { triangle: Uint32Array; steps: Uint32Array; guesses: Uint32Array } {
  const triangle = cornersOfCodes(arrays.get(`${mesh}_triangle`)!);
  const guesses = guessesOf(triangle);
  return { triangle, guesses, steps: unguessed(arrays.get(`${mesh}_position`)!, 3, guesses) };
}

function tangentsOf(packed: Uint32Array | undefined): Float32Array | null {
  if (!packed) return null;
  const directions = unfoldedNormals(packed.map((x) => x & 0xffff));
  const result = new Float32Array(4 * packed.length);
  for (let i = 0; i < packed.length; ++i) {
    for (let k = 0; k < 3; ++k) result[4 * i + k] = directions[3 * i + k] / 127;
    result[4 * i + 3] = packed[i] >> 16 ? -1 : 1;
  }
  return result;
}

async function picturesOf(json: BakedJson['pictures']): Promise<Map<string, ImageBitmap>> {
  const made = Object.entries(json).map(async ([name, { bytes, text }]): Promise<[string, ImageBitmap]> => {
    const blob = new Blob([bytesOfBase85(text).subarray(0, bytes)], { type: 'image/png' });
    // The numbers of the file: normals are no colours.
    return [name, await createImageBitmap(blob, { colorSpaceConversion: 'none', premultiplyAlpha: 'none' })];
  });
  return new Map(await Promise.all(made));
}

export async function readBaked(): Promise<BakedData> {
  const textOf = (id: string) => document.getElementById(id)!.textContent!;
  const page = JSON.parse(textOf('page')) as BakedJson;
  const [arrays, pictures] = await Promise.all([
    unpacked(page.arrays, textOf('arrays')),
    picturesOf(page.pictures),
  ]);
  const ends: [Vec, Vec] = [
    [Infinity, Infinity, Infinity],
    [0, 0, 0],
  ];
  const steps = (['low', 'high'] as const).map((mesh) => {
    const read = stepsOf(arrays, mesh);
    read.steps.forEach((x, i) => {
      ends[0][i % 3] = Math.min(ends[0][i % 3], x);
      ends[1][i % 3] = Math.max(ends[1][i % 3], x);
    });
    return read;
  });
  const { origin, step } = page.place;
  const centre = origin.map((x, k) => x + (step * (ends[0][k] + ends[1][k])) / 2) as Vec;
  const size = (step * Math.hypot(...ends[0].map((x, k) => ends[1][k] - x))) / 2 || 1;
  const inScene = (corner: Vec) => corner.map((x, k) => (origin[k] + step * x - centre[k]) / size) as Vec;
  const [low, high] = steps;
  const extent = [page.low.width, page.low.height];
  const ofVertices = (name: string) => {
    const packed = arrays.get(name);
    return packed ? new Uint8Array(packed.buffer) : null;
  };
  return {
    page,
    report: JSON.parse(textOf('report')) as BakedReport,
    pictures,
    lo: inScene(ends[0]),
    hi: inScene(ends[1]),
    low: {
      position: toCentre(low.steps, page.place, centre, size),
      normal: unfoldedNormals(arrays.get('low_normal')!),
      triangle: low.triangle,
      place: Float32Array.from(
        unguessed(arrays.get('low_place')!, 2, low.guesses),
        (x, i) => x / extent[i % 2],
      ),
      tangent: tangentsOf(arrays.get('low_tangent')),
      color: null,
      surface: null,
    },
    high: {
      position: toCentre(high.steps, page.place, centre, size),
      normal: unfoldedNormals(arrays.get('high_normal')!),
      triangle: high.triangle,
      place: null,
      tangent: null,
      color: ofVertices('high_color'),
      surface: ofVertices('high_surface'),
    },
  };
}
