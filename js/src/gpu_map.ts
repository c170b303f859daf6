// A map whose faces are found on a device, in blocks of samples, and compared in double precision by the module.
import { type GpuSearch, kListBytes } from './gpu_search.js';
import { type MeasureArguments } from './measures.js';
import { type Module } from './module.js';
import { type SignMethod } from './types.js';

const kFirstPoints = 4096; // of a run on a device
const kMostPoints = 65536;
// Systems end programs that keep a device for long.
const kShortMilliseconds = 10;
const kLongMilliseconds = 30;

/** Of a map: the addresses of it, its surface and its sites, the samples, and its options as the module takes them. */
export interface MapOnGpu {
  module: Module;
  addresses: [map: number, surface: number, sites: number];
  samples: number;
  /** Blocks begin and end at multiples of it. */
  grain: number;
  options: MeasureArguments;
}

/** Computes all values. `poll` is told the fraction that is done, between runs, and throws to end it. */
export async function mapOnGpu(
  gpu: GpuSearch,
  { module, addresses, samples, grain, options }: MapOnGpu,
  poll: (done: number) => void,
): Promise<{ sign: SignMethod; signReason: string }> {
  const [map, surface, sites] = addresses;
  const [lines, numbers] = options;
  const onGpu = await gpu.place(module, sites);
  const most = Math.max(grain, Math.min(kMostPoints, gpu.device.mostBytes / kListBytes));
  let signs: { sign: SignMethod; signReason: string } | undefined;
  let step = grain * Math.max(1, Math.floor(Math.min(kFirstPoints, most) / grain));
  for (let first = 0; !signs || first < samples; ) {
    poll(first / samples);
    const count = Math.min(step, samples - first);
    const given = [surface, sites, lines, numbers, first, count];
    const { points } = module.call<{ points: Uint8Array }>('sdm_gpu_points', given);
    const began = performance.now();
    const lists = await gpu.find(onGpu, points);
    const took = performance.now() - began;
    const found = [lists, onGpu.firsts, onGpu.firsts.length];
    signs = module.call('sdm_gpu_finish', [map, ...given, ...found]);
    first += count;
    if (took < kShortMilliseconds && 2 * step <= most) step *= 2;
    else if (took > kLongMilliseconds) step = grain * Math.max(1, Math.floor(step / grain / 2));
  }
  return signs;
}
