// Which engine computes a map of a worker: the processor, or a GPU.
import { wordNumber } from './bytes.js';
import { GpuDevice } from './gpu_device.js';
import { mapOnGpu } from './gpu_map.js';
import { GpuSearch } from './gpu_search.js';
import { type MapOptions } from './measures.js';
import { type Module } from './module.js';
import { type DistanceMap } from './surface.js';
import { SdmError } from './types.js';

const kLeastSamples = 32768; // below, `auto` leaves it to the processor: latencies would count

/** Why the engine gpu does not have this; undefined: it does. */
function refusal(
  module: Module,
  { measure, along }: { measure?: string; along?: unknown },
): string | undefined {
  if (!module.has('sdm_gpu_finish')) return 'needs the module of createWorker({ full: true })';
  const other = measure && measure !== 'sites' ? measure : along !== undefined && along !== null && 'along';
  return other ? `has distances to the closest point only: use the engine 'cpu' for ${other}` : undefined;
}

/** The engines of a worker. */
export class Engines {
  /** Opened by the first map that asks for it, and again after it has failed. */
  private gpu: Promise<GpuSearch> | undefined;
  /** Milliseconds that the last map took for a sample. */
  private readonly cost = { cpu: NaN, gpu: NaN };
  /** Whether there is a device that is no processor. */
  private usable = false;

  constructor(private readonly module: Module) {}

  /** Computes a map by the engine of choice. `poll` is told the fraction that is done on a GPU, and throws to end the call. */
  async compute(
    map: DistanceMap,
    choice: unknown,
    options: MapOptions,
    poll: (done: number) => void,
    byProcessor: () => void | Promise<void>,
  ): Promise<void> {
    const { samples } = map.sampleCounts();
    const engine = this.chosen(choice, options, samples);
    let began = performance.now();
    try {
      if (engine === 'cpu') await byProcessor();
      else {
        const gpu = await this.opened();
        began = performance.now();
        await map.computeOn(options, (given) => mapOnGpu(gpu, given, poll));
      }
    } catch (error) {
      if (engine === 'cpu' || (error instanceof SdmError && error.kind === 'cancelled')) throw error;
      this.close();
      if (choice !== 'auto') throw error;
      await byProcessor();
      return;
    }
    if (samples >= kLeastSamples && !refusal(this.module, options as object))
      this.cost[engine] = (performance.now() - began) / samples;
  }

  private chosen(choice: unknown, options: object, samples: number): 'cpu' | 'gpu' {
    if (choice === undefined || choice === null) return 'cpu';
    const word = ['auto', 'cpu', 'gpu'][wordNumber(['auto', 'cpu', 'gpu'], choice as string, 'engine')];
    if (word === 'cpu') return 'cpu';
    const refused = refusal(this.module, options);
    if (word === 'gpu') {
      if (refused) throw new SdmError('input', `the engine gpu ${refused}`);
      return samples > 0 ? 'gpu' : 'cpu';
    }
    if (refused || samples < kLeastSamples || this.cost.gpu === Infinity) return 'cpu';
    // Nobody waits for it to be opened.
    this.opened().catch(() => {});
    const { cpu, gpu } = this.cost;
    return this.usable && cpu > 0 && !(gpu >= cpu) ? 'gpu' : 'cpu';
  }

  private opened(): Promise<GpuSearch> {
    this.gpu ??= GpuDevice.open().then(async (device) => {
      const search = await GpuSearch.on(device);
      this.usable = !device.software;
      return search;
    });
    return this.gpu;
  }

  /** After a failure: the next map that asks for a GPU begins anew, and `auto` asks no more. */
  private close(): void {
    void this.gpu?.then(
      ({ device }) => device.destroy(),
      () => {},
    );
    this.gpu = undefined;
    this.cost.gpu = Infinity;
  }
}
