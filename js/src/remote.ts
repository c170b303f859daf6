// The library in a worker: calls return promises, and signals abort them.
import { type AnyWorker, newWorker, started } from './any_worker.js';
import { type MeshFile, type ReadMeshOptions } from './mesh_file.js';
import { type ModuleName } from './module.js';
import { type Reference, type Reply, type Request, type Started, type WorkerStart } from './protocol.js';
import { type MapSummary, type ReportOptions, type SummaryOptions } from './report.js';
import {
  type Atlas, type ClosestPoints, type Contacts, type Hausdorff, type MapOptions, type MapStatistics, type MapValues, type RayHits,
  type SignedDistances, type SurfaceOptions,
} from './surface.js';
import { type BoundedLength, type Indices, type NumberArray, type Points, SdmError, type SignMethod } from './types.js';

export interface CallOptions {
  /** Rejects the call with its reason. */
  signal?: AbortSignal;
  /** Called now and then with the current step and the fraction of it that is done. */
  progress?: (step: string, fraction: number) => void;
  /** Moves the buffers of typed arrays to the worker instead of copying them: they are empty afterwards. */
  transfer?: boolean;
}

/** The options of a synchronous call, with those of calls to a worker. */
type Options<Synchronous> = Omit<Synchronous, 'progress'> & CallOptions;
type Body = { positions: Points; indices?: Indices };

// How long a call that was aborted may go on before the worker is ended: polls are some 20 ms apart, but not everywhere.
const kPatienceWithFlags = 2000;
const kPatience = 200;
const kFlagMilliseconds = 20;

interface Pending {
  resolve(value: unknown): void;
  reject(error: unknown): void;
  progress: CallOptions['progress'];
  /** Once it was aborted: stops waiting for its end. */
  settle: (() => void) | undefined;
  release: () => void;
}

/** What calls have in common; ended workers are replaced. */
class Connection {
  /** Of the worker that is used now. */
  generation = 0;
  answer: Started;
  private readonly pending = new Map<number, Pending>();
  private lastCall = 0;
  private restarting: Promise<void> | undefined;
  private end: SdmError | undefined;
  private readonly collected = new FinalizationRegistry<Reference & { generation: number }>(
    ({ sdmObject, generation }) => this.dispose(sdmObject, generation));

  private constructor(private worker: AnyWorker, answer: Started, private readonly start: WorkerStart) {
    this.answer = answer;
    this.listen();
  }

  static async open(start: WorkerStart): Promise<Connection> {
    const worker = await newWorker(start.script);
    return new Connection(worker, await started<Started>(worker, { worker: start }), start);
  }

  private listen(): void {
    const { worker } = this;
    worker.listen((reply: Reply) => this.receive(reply), (error) => {
      if (worker === this.worker && !this.end) this.restart(error);
    });
  }

  terminate(error = new SdmError('ended', 'the worker was terminated')): void {
    this.end ??= error;
    this.worker.terminate();
    this.rejectAll(this.end);
  }

  /** Ends the worker with all of its objects, and starts another one. */
  private restart(reason: SdmError): void {
    this.worker.terminate();
    ++this.generation;
    this.rejectAll(reason);
    this.restarting = (async () => {
      try {
        const worker = await newWorker(this.start.script);
        this.answer = await started<Started>(worker, { worker: this.start });
        if (this.end) return worker.terminate();
        this.worker = worker;
        this.listen();
      } catch (error) {
        this.terminate(error instanceof SdmError ? error : new SdmError('ended', String(error)));
      } finally {
        this.restarting = undefined;
      }
    })();
  }

  private rejectAll(error: SdmError): void {
    const all = [...this.pending.values()];
    this.pending.clear();
    for (const call of all) call.settle?.(), call.release(), call.reject(error);
  }

  private receive(reply: Reply): void {
    const call = this.pending.get(reply.id);
    if ('progress' in reply) return call?.settle ? undefined : call?.progress?.(...reply.progress);
    this.pending.delete(reply.id);
    if (this.pending.size === 0) this.worker.hold(false);
    call?.settle?.();
    call?.release();
    if ('object' in reply) {
      // Nobody waits for the object of a call that was aborted.
      if (!call || call.settle) this.dispose(reply.object, this.generation);
      else call.resolve(reply);
    } else if ('value' in reply) call?.resolve(reply.value);
    else {
      const { kind, message, broken } = reply.error;
      if (broken) this.restart(new SdmError('ended', `the worker was ended by a fault of an earlier call: ${message}`));
      call?.reject(kind === 'other' ? new SdmError('internal', message) : new SdmError(kind, message));
    }
  }

  /** The reference of an object, unless its worker has ended. */
  reference(object: Remote): Reference {
    if (object.generation !== this.generation)
      throw new SdmError('ended', 'the object was in a worker that an aborted or failed call has ended; make it again');
    return { sdmObject: object.id };
  }

  async call(object: Remote | null, method: string, values: unknown[], options: CallOptions & Record<string, unknown> = {}): Promise<any> {
    const { signal, progress, transfer, ...rest } = options;
    signal?.throwIfAborted();
    const moved = new Set<Transferable>();
    const sent = values.map((value) => (value instanceof Remote ? value : plain(value, transfer === true, moved)));
    const sentOptions = plain(rest, transfer === true, moved) as Record<string, unknown>;
    // The arrays are copied now, so that the caller may change them while a worker is started again.
    while (this.restarting) await this.restarting;
    if (this.end) throw this.end;
    signal?.throwIfAborted();
    const id = ++this.lastCall;
    const request: Request = { call: {
      id, method, object: object ? this.reference(object).sdmObject : 0, options: sentOptions, wantsProgress: progress !== undefined,
      cancellable: signal !== undefined, values: sent.map((value) => (value instanceof Remote ? this.reference(value) : value)) } };
    return new Promise((resolve, reject) => {
      const abort = () => this.abort(id, signal!.reason);
      const release = () => signal?.removeEventListener('abort', abort);
      this.pending.set(id, { resolve, reject, progress, settle: undefined, release });
      signal?.addEventListener('abort', abort, { once: true });
      this.worker.hold(true);
      this.worker.postMessage(request, [...moved]);
    });
  }

  private abort(id: number, reason: unknown): void {
    const call = this.pending.get(id);
    if (!call) return;
    call.reject(reason);
    this.send({ cancel: id });
    const { flags } = this.answer;
    // Again and again, as the worker clears the flag when it begins the call.
    const set = () => {
      if (flags) Atomics.store(flags, id % flags.length, 1);
    };
    set();
    const again = setInterval(set, kFlagMilliseconds);
    const since = performance.now();
    const patience = setInterval(() => {
      // Calls before it are not at fault, so that they have their time.
      if (this.pending.keys().next().value === id && performance.now() - since > (flags ? kPatienceWithFlags : kPatience))
        this.restart(new SdmError('ended', 'the worker was ended, as a call in it was aborted'));
    }, kPatience / 4);
    call.settle = () => (clearInterval(again), clearInterval(patience));
  }

  private send(request: Request): void {
    if (!this.end && !this.restarting) this.worker.postMessage(request);
  }

  watch(object: Remote): void {
    this.collected.register(object, { sdmObject: object.id, generation: object.generation }, object);
  }
  dispose(id: number, generation: number): void {
    if (generation === this.generation) this.send({ dispose: id });
  }
}

/** Copies arrays, or lets them be moved; everything else that can be sent stays. */
function plain(value: unknown, transfer: boolean, moved: Set<Transferable>): unknown {
  if (ArrayBuffer.isView(value) || value instanceof ArrayBuffer) {
    const buffer = value instanceof ArrayBuffer ? value : value.buffer;
    if (transfer && buffer instanceof ArrayBuffer) return moved.add(buffer), value;
    const copy = value instanceof ArrayBuffer ? value.slice(0) : (value as NumberArray).slice();
    moved.add(copy instanceof ArrayBuffer ? copy : (copy.buffer as ArrayBuffer));
    return copy;
  }
  if (Array.isArray(value)) return typeof value[0] === 'object' ? value.map((item) => plain(item, transfer, moved)) : value.slice();
  if (value && typeof value === 'object')
    return Object.fromEntries(Object.entries(value).map(([name, item]) => [name, plain(item, transfer, moved)]));
  return value;
}

/** An object in a worker. It is freed when it is collected, by dispose(), or at the end of the block of `using`. */
abstract class Remote {
  /** @internal */
  readonly generation: number;
  private disposed = false;

  /** @internal */
  constructor(
    /** @internal */ readonly connection: Connection,
    /** @internal */ readonly id: number,
  ) {
    this.generation = connection.generation;
    connection.watch(this);
  }

  /** @internal */
  protected async call(method: string, values: unknown[], options?: object): Promise<any> {
    if (this.disposed) throw new SdmError('input', `this ${this.constructor.name} was disposed of`);
    return this.connection.call(this, method, values, options as CallOptions & Record<string, unknown>);
  }
  /** Frees the object once the calls before have ended. */
  dispose(): void {
    if (!this.disposed) this.connection.dispose(this.id, this.generation);
    this.disposed = true;
  }
  [Symbol.dispose](): void {
    this.dispose();
  }
}

/** Sites in a worker. */
export class WorkerSites extends Remote {
  readonly closed: boolean;
  readonly orientable: boolean;

  /** @internal */
  constructor(connection: Connection, { object, fields }: Made) {
    super(connection, object);
    [this.closed, this.orientable] = [fields['closed'] as boolean, fields['orientable'] as boolean];
  }
  refit(positions: Points, options?: CallOptions): Promise<void> {
    return this.call('refit', [positions], options);
  }
  closestPoints(points: Points, options?: { maxDistance?: number } & CallOptions): Promise<ClosestPoints> {
    return this.call('closestPoints', [points], options);
  }
  signedDistance(points: Points, options?: { sign?: SignMethod } & CallOptions): Promise<SignedDistances> {
    return this.call('signedDistance', [points], options);
  }
  firstHits(origins: Points, directions: Points, options?: { tMin?: number; tMax?: number } & CallOptions): Promise<RayHits> {
    return this.call('firstHits', [origins, directions], options);
  }
  hausdorff(other: WorkerSites, options?: { precision?: number } & CallOptions): Promise<Hausdorff> {
    return this.call('hausdorff', [other], options);
  }
}

/** A surface in a worker. */
export class WorkerSurface extends Remote {
  /** @internal */
  constructor(connection: Connection, { object }: Made) {
    super(connection, object);
  }
  refit(positions: Points, options?: CallOptions): Promise<void> {
    return this.call('refit', [positions], options);
  }
  atlas(): Promise<Atlas> {
    return this.call('atlas', []);
  }
  storedAtlas(): Promise<Uint8Array<ArrayBuffer>> {
    return this.call('storedAtlas', []);
  }
  samples(): Promise<{ texels: Uint32Array; points: Float64Array }> {
    return this.call('samples', []);
  }
  sampleCounts(): Promise<{ samples: number; grain: number }> {
    return this.call('sampleCounts', []);
  }
  /** The surface distance map. It stays in the worker, until its arrays() are asked for. */
  async map(sites: WorkerSites, options?: Options<MapOptions>): Promise<WorkerMap> {
    const map = new WorkerMap(this.connection, await this.call('map', [sites], options));
    return map;
  }
  /** A map without values, for computeSamples(). */
  async emptyMap(sites: WorkerSites): Promise<WorkerMap> {
    return new WorkerMap(this.connection, await this.call('emptyMap', [sites]));
  }
}

type ArrayName = keyof MapValues;

/** A map in a worker. */
export class WorkerMap extends Remote {
  readonly resolution: number;
  readonly rows: number;
  /** Of what was computed last. */
  sign: SignMethod;
  signReason: string;

  /** @internal */
  constructor(connection: Connection, { object, fields }: Made) {
    super(connection, object);
    [this.resolution, this.rows] = [fields['resolution'] as number, fields['rows'] as number];
    [this.sign, this.signReason] = [fields['sign'] as SignMethod, fields['signReason'] as string];
  }
  /** Copies of the arrays that are named, as of DistanceMap. */
  arrays<Name extends ArrayName>(...names: Name[]): Promise<Pick<MapValues, Name>> {
    return this.call('arrays', names);
  }
  /** Computes it again, after refit() of the surface or the sites; takes no more memory. */
  async update(options?: Options<MapOptions>): Promise<void> {
    Object.assign(this, await this.call('update', [], options));
  }
  /** As of DistanceMap. Returns what `sign` and `signReason` then are. */
  async computeSamples(
    first: number, count: number, options?: Options<Omit<MapOptions, 'facing'>>,
  ): Promise<{ sign: SignMethod; signReason: string }> {
    const signs = await this.call('computeSamples', [first, count], options);
    Object.assign(this, signs);
    return signs;
  }
  valuesOfSamples(first: number, count: number): Promise<MapValues> {
    return this.call('valuesOfSamples', [first, count]);
  }
  statistics(): Promise<MapStatistics> {
    return this.call('statistics', []);
  }
  transfer(
    values: ArrayLike<number>, options?: { components?: number; domain?: 'vertex' | 'face' | 'corner'; fill?: boolean } & CallOptions,
  ): Promise<Float32Array> {
    return this.call('transfer', [values], options);
  }
  /** The keys of report.json. Of the module `full` only. */
  summary(options?: Options<SummaryOptions>): Promise<MapSummary> {
    return this.call('summary', [], options);
  }
  /** The text of report.html. Of the module `full` only. */
  report(options?: Options<ReportOptions>): Promise<string> {
    return this.call('report', [], options);
  }
}

/** Two bodies in a worker. */
export class WorkerPair extends Remote {
  /** @internal */
  constructor(connection: Connection, { object }: Made) {
    super(connection, object);
  }
  setPose(body: 0 | 1, matrix: ArrayLike<number>): Promise<void> {
    return this.call('setPose', [body, matrix]);
  }
  refit(body: 0 | 1, positions: Points, options?: CallOptions): Promise<void> {
    return this.call('refit', [body, positions], options);
  }
  separation(): Promise<BoundedLength> {
    return this.call('separation', []);
  }
  colliding(): Promise<boolean> {
    return this.call('colliding', []);
  }
  penetrationDepth(): Promise<BoundedLength | null> {
    return this.call('penetrationDepth', []);
  }
  contacts(): Promise<Contacts> {
    return this.call('contacts', []);
  }
}

type Made = { object: number; fields: Record<string, unknown> };

/**
 * The library in a worker, with a memory of its own. Calls are answered in their order. An aborted call rejects at once; where memory
 * can be shared, its computation stops at its next poll, and so does that of a map elsewhere. Another one that goes on for 0.2 s
 * longer is stopped with its worker: objects that were made before are then lost (SdmError `ended`), and others can be made.
 */
export class SdmWorker {
  /** @internal */
  constructor(private readonly connection: Connection) {}

  /** @internal */
  static async open(start: WorkerStart): Promise<SdmWorker> {
    return new SdmWorker(await Connection.open(start));
  }

  get threads(): number {
    return this.connection.answer.threads;
  }
  /** Whether aborted calls stop without the worker. */
  get sharesMemory(): boolean {
    return this.connection.answer.flags !== undefined;
  }
  /** How often the worker was ended and replaced: objects that were made before are lost. */
  get restarts(): number {
    return this.connection.generation;
  }
  /** Of Surface: lays out the atlas. */
  async surface(positions: Points, indices: Indices = null, options: Options<SurfaceOptions> = {}): Promise<WorkerSurface> {
    return new WorkerSurface(this.connection, await this.connection.call(null, 'surface', [positions, indices], { ...options }));
  }
  async sites(positions: Points, indices: Indices = null, options: CallOptions = {}): Promise<WorkerSites> {
    return new WorkerSites(this.connection, await this.connection.call(null, 'sites', [positions, indices], { ...options }));
  }
  async pair(first: Body, second: Body, options: { contactMargin?: number } & CallOptions = {}): Promise<WorkerPair> {
    return new WorkerPair(this.connection, await this.connection.call(null, 'pair', [first, second], { ...options }));
  }
  /** Reads a mesh file. Of the module `full` only. */
  readMesh(bytes: Uint8Array | ArrayBuffer, name: string, options: Options<ReadMeshOptions> = {}): Promise<MeshFile> {
    return this.connection.call(null, 'readMesh', [bytes, name], { ...options });
  }
  /** What the module has taken from the system. */
  memoryBytes(): Promise<number> {
    return this.connection.call(null, 'memory', []);
  }
  /** Ends the worker. Calls that have not ended reject. */
  terminate(): void {
    this.connection.terminate();
  }
}

export type { ModuleName };
