// The data of player.html: that of src/io/page/player/player_page.cpp.
import { ArrayIndex, Arrays, summed, unpacked } from './arrays';
import type { Scale } from './color_scale';
import type { Vec } from './page_data';
import type { Verdict } from './verdict';

export interface Curve {
  name: string;
  values: (number | null)[];
}

export interface Panel {
  title: string;
  curves: Curve[];
}

interface PlayerJson {
  version: string;
  date?: string;
  up: 'y' | 'z';
  units: string;
  names: [string, string];
  xxh3?: [string, string]; ///< of the files; empty: unknown
  origin: Vec;
  step: number;
  reach: number; ///< distances are from −reach to reach
  added: number[]; ///< the numbers of all frames, one for each value of the curves
  stride: number;
  shown: number[]; ///< of the frames in the page: places in `added`
  bodies: { vertices: number; moves: boolean; coloured: boolean }[];
  panels: Panel[];
  scale: Scale;
  verdict?: Verdict; ///< on all frames, if there is a tolerance
  certified?: boolean; ///< the verdict is proven
  doubt?: string; ///< a clause: why a verdict is DOUBTFUL
  tolerance?: { lower: number; upper: number };
  verdicts?: Verdict[]; ///< on each of them
  arrays: ArrayIndex;
}

export interface PlayerBody {
  vertices: number;
  triangles: Uint32Array;
  positions: Uint32Array; ///< of all frames, or of one for a body at rest, in steps
  distances: Uint32Array | null; ///< of all frames
  moves: boolean;
}

export interface PlayerData {
  page: PlayerJson;
  bodies: PlayerBody[];
}

/// Whether a distance of the curves is negative: otherwise numbers have no signs.
export function hasSigns({ page }: PlayerData): boolean {
  return page.panels.some(({ curves }) =>
    curves.some(({ values }) => values.some((x) => x !== null && x < 0)),
  );
}

const kNoDistance = 65535;

function body(arrays: Arrays, which: number, json: PlayerJson['bodies'][0]): PlayerBody {
  const { vertices, moves, coloured } = json;
  return {
    vertices,
    moves,
    triangles: summed(arrays.get(`triangle${which}`)!),
    positions: summed(arrays.get(`position${which}`)!, 3 * vertices),
    distances: coloured ? summed(arrays.get(`distance${which}`)!, vertices) : null,
  };
}

export async function readPlayer(): Promise<PlayerData> {
  const page = JSON.parse(document.getElementById('page')!.textContent!) as PlayerJson;
  const arrays = await unpacked(page.arrays, document.getElementById('arrays')!.textContent!);
  return { page, bodies: page.bodies.map((json, which) => body(arrays, which, json)) };
}

/// The positions of a frame, relative to `middle` and divided by `size`.
export function placeFrame(
  data: PlayerData,
  which: number,
  frame: number,
  middle: Vec,
  size: number,
  to: Float32Array,
): void {
  const { positions, vertices, moves } = data.bodies[which];
  const { origin, step } = data.page;
  const first = moves ? 3 * vertices * frame : 0;
  for (let i = 0; i < 3 * vertices; ++i)
    to[i] = (origin[i % 3] + step * positions[first + i] - middle[i % 3]) / size;
}

/// The distances of a frame; NaN for none.
export function distancesOf(data: PlayerData, which: number, frame: number, to: Float32Array): void {
  const { distances, vertices } = data.bodies[which];
  if (!distances) return;
  for (let i = 0; i < vertices; ++i) {
    const number = distances[vertices * frame + i];
    to[i] = number === kNoDistance ? NaN : ((2 * number) / (kNoDistance - 1) - 1) * data.page.reach;
  }
}
