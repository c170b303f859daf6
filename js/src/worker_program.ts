// worker.js: the program of workers. It is bundled into one file without imports, so that it can come from a Blob; it is that of
// createWorker() and that of the threads of a module.
import { Engines } from './engines.js';
import { Sdm } from './library.js';
import { textOf } from './load.js';
import { type MapOptions, preparesMuch } from './measures.js';
import { Module, canShareMemory } from './module.js';
import { type Port, platform } from './platform.js';
import {
  type Call,
  type FirstMessage,
  type Reply,
  type Request,
  type Started,
  type WorkerStart,
} from './protocol.js';
import { wordNumber } from './bytes.js';
import { Owned } from './owned.js';
import { DistanceMap } from './surface.js';
import { runThread } from './threads.js';
import { type EngineChoice, type Progress, SdmError } from './types.js';

const kProgressMilliseconds = 30;
const kPartMilliseconds = 40;

/** Lets messages that have arrived be received. */
const tick = (() => {
  if (typeof setImmediate === 'function') return () => new Promise<void>((resolve) => setImmediate(resolve));
  const { port1, port2 } = new MessageChannel();
  let next = () => {};
  port2.onmessage = () => next();
  return () =>
    new Promise<void>((resolve) => {
      next = resolve;
      port1.postMessage(0);
    });
})();

/** The buffers of arrays in a result. */
function buffersOf(value: unknown, found = new Set<ArrayBuffer>()): ArrayBuffer[] {
  if (ArrayBuffer.isView(value)) {
    if (value.buffer instanceof ArrayBuffer && value.buffer.byteLength === value.byteLength)
      found.add(value.buffer);
  } else if (Array.isArray(value)) value.forEach((item) => buffersOf(item, found));
  else if (value && typeof value === 'object') Object.values(value).forEach((item) => buffersOf(item, found));
  return [...found];
}

class Server {
  private readonly objects = new Map<number, Owned>();
  private readonly queue: Call[] = [];
  private readonly cancelled = new Set<number>();
  private running = false;
  private readonly engines: Engines;

  constructor(
    private readonly port: Port,
    private readonly library: Sdm,
    private readonly flags: Uint8Array | undefined,
  ) {
    this.engines = new Engines(library.module);
  }

  receive(request: Request): void {
    if ('call' in request) {
      this.queue.push(request.call);
      if (!this.running) void this.run();
    } else if ('cancel' in request) this.cancelled.add(request.cancel);
    else {
      // Calls that were made before still use it.
      this.queue.push({
        id: 0,
        object: request.dispose,
        method: 'dispose',
        values: [],
        options: {},
        wantsProgress: false,
        cancellable: false,
      });
      if (!this.running) void this.run();
    }
  }

  private async run(): Promise<void> {
    this.running = true;
    for (let call = this.queue.shift(); call; call = this.queue.shift()) {
      await this.answer(call);
      this.cancelled.delete(call.id);
      if (this.queue.length > 0) await tick();
    }
    this.running = false;
  }

  private async answer(call: Call): Promise<void> {
    if (call.method === 'dispose') {
      this.objects.get(call.object)?.dispose();
      this.objects.delete(call.object);
      return;
    }
    const flag = call.id % 256;
    if (this.flags) Atomics.store(this.flags, flag, 0);
    this.library.module.obey(flag);
    try {
      if (this.cancelled.has(call.id)) throw new SdmError('cancelled', 'cancelled');
      this.reply(call, await this.compute(call));
    } catch (error) {
      const kind = error instanceof SdmError ? error.kind : 'other';
      const message = error instanceof Error ? error.message : String(error);
      this.post({ id: call.id, error: { kind, message, broken: this.library.module.broken } });
    }
  }

  private reply({ id }: Call, result: unknown): void {
    if (result instanceof Owned) {
      this.objects.set(id, result);
      const fields = Object.entries(result).filter(([, value]) =>
        ['number', 'string', 'boolean'].includes(typeof value),
      );
      this.post({ id, object: id, fields: Object.fromEntries(fields) });
    } else this.post({ id, value: result }, buffersOf(result));
  }

  private post(reply: Reply, transfer: Transferable[] = []): void {
    this.port.post(reply, transfer);
  }

  private object(id: number): Owned {
    const object = this.objects.get(id);
    if (!object) throw new SdmError('input', 'the object was disposed of');
    return object;
  }

  private async compute(call: Call): Promise<unknown> {
    const values = call.values.map((value) =>
      value && typeof value === 'object' && 'sdmObject' in value
        ? this.object(value.sdmObject as number)
        : value,
    );
    const options = { ...call.options, progress: this.progressOf(call) };
    const target = call.object === 0 ? this.library : this.object(call.object);
    if (target instanceof DistanceMap) {
      if (call.method === 'arrays') return this.arrays(target, values as string[]);
      if (call.method === 'update') return this.update(target, call, options);
      if (call.method === 'computeSamples' || call.method === 'computeValues') {
        const [first, count] = values as [number, number];
        target.computeSamples(first, count, options);
        return {
          sign: target.sign,
          signReason: target.signReason,
          ...(call.method === 'computeValues' ? target.valuesOfSamples(first, count) : {}),
        };
      }
    }
    if (call.method === 'map') return this.map(target as never, values[0] as never, call, options);
    const method = (target as unknown as Record<string, (...values: unknown[]) => unknown>)[call.method];
    if (typeof method !== 'function') throw new SdmError('input', `this module has no ${call.method}`);
    return method.apply(target, [...values, options]);
  }

  private arrays(map: DistanceMap, names: string[]): object {
    const known = ['distances', 'vectors', 'sitesOfTexels', 'siteTypes'] as const;
    return Object.fromEntries(names.map((name) => [name, map[known[wordNumber(known, name, 'an array')]!]]));
  }

  private async map(
    surface: InstanceType<Sdm['Surface']>,
    sites: InstanceType<Sdm['Sites']>,
    call: Call,
    options: object,
  ): Promise<DistanceMap> {
    const map = surface.emptyMap(sites);
    try {
      await this.update(map, call, options);
    } catch (error) {
      map.dispose();
      throw error;
    }
    return map;
  }

  /** Where no other thread can set a flag, the samples are computed in parts, between which the message to cancel is received. */
  private async update(
    map: DistanceMap,
    call: Call,
    { engine, ...options }: MapOptions & { engine?: EngineChoice },
  ): Promise<object> {
    const poll = (done: number) => {
      if (options.progress?.('map', done) === false || this.cancelled.has(call.id))
        throw new SdmError('cancelled', 'cancelled');
    };
    await this.engines.compute(map, engine, options, poll, () =>
      this.flags || !call.cancellable || preparesMuch(options)
        ? map.compute(options)
        : this.inParts(map, call, options),
    );
    return { sign: map.sign, signReason: map.signReason, engine: map.engine };
  }

  /** Parts are short, so that a call that was aborted ends soon on machines of any speed, but not so short that they cost much. */
  private async inParts(map: DistanceMap, call: Call, options: MapOptions): Promise<void> {
    const { samples, grain } = map.sampleCounts();
    let step = grain;
    let first = 0;
    while (first < samples) {
      const count = Math.min(step, samples - first);
      const done = first;
      const progress: Progress = (name, fraction) =>
        options.progress?.(name, (done + fraction * count) / samples);
      const since = performance.now();
      map.computeSamples(first, count, { ...options, progress });
      first += count;
      const took = performance.now() - since;
      if (took < kPartMilliseconds / 2) step *= 2;
      else if (took > kPartMilliseconds)
        step = Math.max(grain, grain * Math.floor((step / grain) * (kPartMilliseconds / took)));
      await tick();
      if (this.cancelled.has(call.id)) throw new SdmError('cancelled', 'cancelled');
    }
  }

  private progressOf(call: Call): Progress {
    let last = 0;
    return (step, fraction) => {
      if (this.flags && Atomics.load(this.flags, call.id % 256) !== 0) return false;
      const now = performance.now();
      if (call.wantsProgress && now - last >= kProgressMilliseconds) {
        last = now;
        this.post({ id: call.id, progress: [step, fraction] });
      }
      return true;
    };
  }
}

async function serve(port: Port, { reportPage, ...start }: WorkerStart): Promise<void> {
  const started = await Module.start(start);
  const flags =
    started.sharedFlags() ?? (canShareMemory() ? new Uint8Array(new SharedArrayBuffer(256)) : undefined);
  const server = new Server(port, new Sdm(started, () => textOf(reportPage)), flags);
  port.receive((request) => server.receive(request));
  port.post({ threads: started.threadCount, flags } satisfies Started);
}

const port = platform().port();
port.receive((first: FirstMessage) => {
  const run =
    'thread' in first ? runThread(first.thread, () => port.post({ ready: true })) : serve(port, first.worker);
  run.catch((error: unknown) =>
    port.post({ failed: error instanceof Error ? error.message : String(error) }),
  );
});
