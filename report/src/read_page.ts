// Reads the data of the page: arrays of numbers, packed by src/io/page/report.
import { AreaByValue } from './area_by_value';
import {
  Arrays,
  cornersOfCodes,
  floatsOfOrdered,
  guessesOf,
  summed,
  unguessed,
  unguessedBytes,
  unpacked,
  unzigzag,
} from './arrays';
import type { CloudData, Ghost, Model, PageData, PageJson, Placement, TexelMap, Vec } from './page_data';

function textOf(id: string): string {
  return document.getElementById(id)?.textContent ?? '';
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
    if (left && above && chart[i - width - 1] !== 0)
      guess = numbers[i - 1] + numbers[i - width] - numbers[i - width - 1];
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

export function toCentre(steps: Uint32Array, from: Placement, centre: Vec, size: number): Float32Array {
  const result = new Float32Array(steps.length);
  const scale = from.step / size;
  const shift = from.origin.map((x, k) => (x - centre[k]) / size);
  for (let i = 0; i < steps.length; ++i) result[i] = steps[i] * scale + shift[i % 3];
  return result;
}

// Unit vectors folded onto an octahedron, whose lower half lies in the corners of the square.
export function unfoldedNormals(packed: Uint32Array): Int8Array {
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
  const triangle = cornersOfCodes(arrays.get('triangle')!);
  const guesses = guessesOf(triangle);
  const steps = unguessed(arrays.get('position')!, 3, guesses);
  const extent = largestIn(steps).map((x) => x * placement.step);
  const centre = placement.origin.map((x, k) => x + extent[k] / 2) as Vec;
  const size = Math.hypot(...extent) / 2 || 1;
  const places = arrays.get('place');
  const charts = arrays.get('triangle_chart');
  return {
    centre,
    size,
    position: toCentre(steps, placement, centre, size),
    normal: unfoldedNormals(unguessedBytes(arrays.get('normal')!, guesses)),
    distance: floatsOfOrdered(unguessed(arrays.get('vertex_distance')!, 1, guesses)),
    triangle,
    place: places ? Float32Array.from(unguessed(places, 2, guesses), (x) => x / 64) : null,
    chart: charts ? summed(charts) : null,
    names: (placement.names ?? []).map((kind, k) => ({
      ...kind,
      ofTriangle: summed(arrays.get(`triangle_name_${k}`)!),
    })),
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
  const inScene = (corner: number[]) =>
    corner.map((x, k) => (origin[k] + step * x - centre[k]) / size) as Vec;
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

function readGhost(
  page: PageJson,
  arrays: Arrays,
  { centre, size }: { centre: Vec; size: number },
): Ghost | null {
  const ghost = page.ghost;
  if (!ghost) return null;
  const steps = arrays.get('ghost_position');
  if (steps) {
    const triangle = cornersOfCodes(arrays.get('ghost_triangle')!);
    return {
      position: toCentre(unguessed(steps, 3, guessesOf(triangle)), ghost, centre, size),
      triangle,
      covered: arrays.get('ghost_covered') ?? null,
      trianglesOfMesh: ghost.triangles_of_mesh,
      isBox: false,
    };
  }
  const ends = [ghost.box.lo, ghost.box.hi];
  const position = new Float32Array(24);
  for (let corner = 0; corner < 8; ++corner)
    for (let k = 0; k < 3; ++k) position[3 * corner + k] = (ends[(corner >> k) & 1][k] - centre[k]) / size;
  const sides = [0, 1, 3, 2, 4, 5, 7, 6, 0, 1, 5, 4, 2, 3, 7, 6, 0, 2, 6, 4, 1, 3, 7, 5];
  const triangle: number[] = [];
  for (let s = 0; s < sides.length; s += 4)
    triangle.push(sides[s], sides[s + 1], sides[s + 2], sides[s], sides[s + 2], sides[s + 3]);
  return {
    position,
    triangle: Uint32Array.from(triangle),
    covered: null,
    trianglesOfMesh: ghost.triangles_of_mesh,
    isBox: true,
  };
}

function floats(numbers: Uint32Array): Float32Array {
  return new Float32Array(numbers.buffer);
}

export async function readData(): Promise<PageData> {
  const page = JSON.parse(textOf('page')) as PageJson;
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
