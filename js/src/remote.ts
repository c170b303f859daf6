// The library in a worker: calls return promises, and signals abort them.
import { type AnyWorker, newWorker, started } from './any_worker.js';
import { type ReadAnimationOptions } from './animation.js';
import { type Picture } from './look.js';
import {
  type BakedLook,
  type DrawnModel,
  type MatchArrays,
  type MatchCounts,
  type MatchOptions,
  type NormalOptions,
} from './matches.js';
import { type MeshFile, type ReadMeshOptions } from './mesh_file.js';
import { type Reference, type Reply, type Request, type Started, type WorkerStart } from './protocol.js';
import { type MapSummary, type ReportOptions, type SummaryOptions } from './report.js';
import {
  type Atlas,
  type ClosestPoints,
  type Contacts,
  type Hausdorff,
  type MapOptions,
  type MapStatistics,
  type MapValues,
  type RayHits,
  type SignedDistances,
  type SurfaceOptions,
} from './surface.js';
import { type TransferOptions } from './transfer.js';
import { type BoundedLength, type Indices, type Points, SdmError, type SignMethod } from './types.js';

export interface CallOptions {
  /** Rejects the call with its reason. */
  signal?: AbortSignal;
  /** Called now and then with the current step and the fraction of it that is done. What it throws aborts the call. */
  progress?: (step: string, fraction: number) => void;
  /** Moves the buffers of typed arrays that are all of their buffer, instead of copying them: these are empty afterwards. */
  transfer?: boolean;
}

/** The options of a synchronous call, with those of calls to a worker. */
type Options<Synchronous> = Omit<Synchronous, 'progress'> & CallOptions;
type Body = { positions: Points; indices?: Indices };

// How long an aborted call may go on, once those before it have ended, before the worker is ended: as many periods as these. They are
// counted, so that a page that was busy meanwhile still receives that the call has ended.
const kPeriodMilliseconds = 50;
const kPeriods = 4;
// Of a call that looks whether it was aborted: some 20 ms apart, but not everywhere.
const kPeriodsWithPolls = 40;
const kMethodsInParts: readonly string[] = ['map', 'update'];

interface Pending {
  resolve(value: unknown): void;
  reject(error: unknown): void;
  progress: CallOptions['progress'];
  /** Whether it looks between its parts whether it was aborted, where memory cannot be shared. */
  inParts: boolean;
  /** Once it was aborted: stops waiting for its end. */
  settle: (() => void) | undefined;
  release: () => void;
}

/** A new object in the worker. */
type Made = { object: number; fields: Record<string, unknown>; generation: number };

/** The result of a promise, unless the signal is aborted before. */
export function unlessAborted<T>(promise: Promise<T>, signal: AbortSignal | undefined): Promise<T> {
  if (!signal) return promise;
  return new Promise((resolve, reject) => {
    const abort = () => reject(signal.reason);
    if (signal.aborted) abort();
    signal.addEventListener('abort', abort, { once: true });
    promise.then(resolve, reject).finally(() => signal.removeEventListener('abort', abort));
  });
}

/** What calls have in common; ended workers are replaced. */
class Connection {
  /** Of the worker that is used now. */
  generation = 0;
  answer: Started;
  private readonly pending = new Map<number, Pending>();
  private lastCall = 0;
  /** Until there is another worker, or none any more. */
  private restarting: Promise<void> | undefined;
  private end: SdmError | undefined;
  private readonly terminated = new AbortController();
  private readonly collected = new FinalizationRegistry<Reference & { generation: number }>(
    ({ sdmObject, generation }) => this.dispose(sdmObject, generation),
  );

  private constructor(
    private worker: AnyWorker,
    answer: Started,
    private readonly start: WorkerStart,
  ) {
    this.answer = answer;
    this.listen();
  }

  static async open(start: WorkerStart): Promise<Connection> {
    const worker = await newWorker(start.script);
    return new Connection(worker, await started<Started>(worker, { worker: start }), start);
  }

  private listen(): void {
    this.worker.listen(
      (reply: Reply) => this.receive(reply),
      (error) => this.restart(error),
    );
  }

  terminate(error = new SdmError('ended', 'the worker was terminated')): void {
    this.end ??= error;
    this.worker.terminate();
    this.terminated.abort(this.end);
    this.rejectAll(this.end);
  }

  /** Ends the worker with all of its objects, and starts another one. */
  private restart(reason: SdmError): void {
    if (this.restarting || this.end) return;
    this.worker.terminate();
    ++this.generation;
    this.restarting = this.replace().finally(() => (this.restarting = undefined));
    this.rejectAll(reason);
  }

  private async replace(): Promise<void> {
    try {
      const worker = await newWorker(this.start.script);
      this.answer = await started<Started>(worker, { worker: this.start }, this.terminated.signal);
      if (this.end) return worker.terminate();
      this.worker = worker;
      this.listen();
    } catch (error) {
      this.terminate(error instanceof SdmError ? error : new SdmError('ended', String(error)));
    }
  }

  private rejectAll(error: SdmError): void {
    const all = [...this.pending.values()];
    this.pending.clear();
    for (const call of all) call.settle?.(), call.release(), call.reject(error);
  }

  private remove(id: number): Pending | undefined {
    const call = this.pending.get(id);
    this.pending.delete(id);
    if (this.pending.size === 0) this.worker.hold(false);
    call?.settle?.();
    call?.release();
    return call;
  }

  private receive(reply: Reply): void {
    if ('progress' in reply) return this.tell(reply.id, reply.progress);
    const call = this.remove(reply.id);
    if ('object' in reply) {
      // Nobody waits for the object of a call that was aborted.
      if (!call || call.settle) this.dispose(reply.object, this.generation);
      else
        call.resolve({
          object: reply.object,
          fields: reply.fields,
          generation: this.generation,
        } satisfies Made);
    } else if ('value' in reply) call?.resolve(reply.value);
    else {
      const { kind, message, broken } = reply.error;
      if (broken)
        this.restart(new SdmError('ended', `the worker was ended by a fault of an earlier call: ${message}`));
      call?.reject(kind === 'other' ? new SdmError('internal', message) : new SdmError(kind, message));
    }
  }

  private tell(id: number, progress: [step: string, fraction: number]): void {
    const call = this.pending.get(id);
    if (call?.settle) return;
    try {
      call?.progress?.(...progress);
    } catch (error) {
      this.abort(id, error);
    }
  }

  /** The reference of an object, unless its worker has ended. */
  reference(object: Remote): Reference {
    if (object.connection !== this) throw new SdmError('input', 'the objects belong to different workers');
    if (object.generation !== this.generation)
      throw new SdmError(
        'ended',
        'the object was in a worker that an aborted or failed call has ended; make it again',
      );
    return { sdmObject: object.id };
  }

  async call(
    object: Remote | null,
    method: string,
    values: unknown[],
    options: CallOptions & Record<string, unknown> = {},
  ): Promise<any> {
    const { signal, progress, transfer, ...rest } = options;
    signal?.throwIfAborted();
    const moved = new Set<Transferable>();
    const sent = values.map((value) =>
      value instanceof Remote ? value : plain(value, transfer === true, moved),
    );
    const sentOptions = plain(rest, transfer === true, moved) as Record<string, unknown>;
    // The arrays are copied now, so that the caller may change them while a worker is started again.
    while (this.restarting) await unlessAborted(this.restarting, signal);
    if (this.end) throw this.end;
    signal?.throwIfAborted();
    const id = ++this.lastCall;
    const cancellable = signal !== undefined || progress !== undefined;
    const request: Request = {
      call: {
        id,
        method,
        object: object ? this.reference(object).sdmObject : 0,
        options: sentOptions,
        wantsProgress: progress !== undefined,
        cancellable,
        values: sent.map((value) => (value instanceof Remote ? this.reference(value) : value)),
      },
    };
    const inParts = kMethodsInParts.includes(method) && cancellable;
    return new Promise((resolve, reject) => {
      const abort = () => this.abort(id, signal!.reason);
      const release = () => signal?.removeEventListener('abort', abort);
      this.pending.set(id, { resolve, reject, progress, inParts, settle: undefined, release });
      signal?.addEventListener('abort', abort, { once: true });
      this.worker.hold(true);
      try {
        this.worker.postMessage(request, [...moved]);
      } catch (error) {
        this.remove(id);
        reject(
          new SdmError(
            'input',
            `the arguments of ${method} cannot be sent to the worker: ${error instanceof Error ? error.message : error}`,
          ),
        );
      }
    });
  }

  private abort(id: number, reason: unknown): void {
    const call = this.pending.get(id);
    if (!call || call.settle) return;
    call.reject(reason);
    this.send({ cancel: id });
    const { flags } = this.answer;
    // Calls before it are not at fault, so that they have their time, and perhaps the same flag.
    const isFirst = () => this.pending.keys().next().value === id;
    const patience = flags || call.inParts ? kPeriodsWithPolls : kPeriods;
    let periods = 0;
    const stop = () => {
      if (!isFirst()) return;
      // Again and again, as the worker clears the flag when it begins the call.
      if (flags) Atomics.store(flags, id % flags.length, 1);
      if (++periods > patience)
        this.restart(new SdmError('ended', 'the worker was ended, as a call in it was aborted'));
    };
    const timer = setInterval(stop, kPeriodMilliseconds);
    call.settle = () => clearInterval(timer);
    stop();
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
    const movable = transfer && buffer instanceof ArrayBuffer && buffer.byteLength === value.byteLength;
    const sent = movable ? value : copied(value);
    moved.add(sent instanceof ArrayBuffer ? sent : (sent.buffer as ArrayBuffer));
    return sent;
  }
  if (Array.isArray(value))
    return typeof value[0] === 'object' ? value.map((item) => plain(item, transfer, moved)) : value.slice();
  if (value && typeof value === 'object')
    return Object.fromEntries(
      Object.entries(value).map(([name, item]) => [name, plain(item, transfer, moved)]),
    );
  return value;
}

/** A copy with a buffer of its own. The slice() of Node's Buffer is none: that is another view of the same memory. */
function copied(value: ArrayBuffer | ArrayBufferView): ArrayBuffer | ArrayBufferView {
  if (value instanceof ArrayBuffer) return value.slice(0);
  const bytes = new Uint8Array(value.byteLength);
  bytes.set(new Uint8Array(value.buffer, value.byteOffset, value.byteLength));
  // The type of its elements, such as `Uint8Array` of a Buffer, whose own constructor is another one.
  const type = Object.prototype.toString.call(value).slice(8, -1) as 'Uint8Array';
  return new globalThis[type](bytes.buffer);
}

/** An object in a worker. It is freed when it is collected, by dispose(), or at the end of the block of `using`. */
abstract class Remote {
  /** @internal */
  readonly id: number;
  /** @internal */
  readonly generation: number;
  private disposed = false;

  /** @internal */
  constructor(
    /** @internal */ readonly connection: Connection,
    { object, generation }: Made,
  ) {
    [this.id, this.generation] = [object, generation];
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
  constructor(connection: Connection, made: Made) {
    super(connection, made);
    const { fields } = made;
    [this.closed, this.orientable] = [fields['closed'] as boolean, fields['orientable'] as boolean];
  }
  refit(positions: Points, options?: CallOptions): Promise<void> {
    return this.call('refit', [positions], options);
  }
  /** As of Sites, with the same errors. */
  closestPoints(points: Points, options?: { maxDistance?: number } & CallOptions): Promise<ClosestPoints> {
    return this.call('closestPoints', [points], options);
  }
  signedDistance(points: Points, options?: { sign?: SignMethod } & CallOptions): Promise<SignedDistances> {
    return this.call('signedDistance', [points], options);
  }
  firstHits(
    origins: Points,
    directions: Points,
    options?: { tMin?: number; tMax?: number } & CallOptions,
  ): Promise<RayHits> {
    return this.call('firstHits', [origins, directions], options);
  }
  hausdorff(other: WorkerSites, options?: { precision?: number } & CallOptions): Promise<Hausdorff> {
    return this.call('hausdorff', [other], options);
  }
}

/** A surface in a worker. */
export class WorkerSurface extends Remote {
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
    return new WorkerMap(this.connection, await this.call('map', [sites], options), this, sites);
  }
  /** A map without values, for computeSamples(). */
  async emptyMap(sites: WorkerSites): Promise<WorkerMap> {
    return new WorkerMap(this.connection, await this.call('emptyMap', [sites]), this, sites);
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

  /** @internal Keeps the surface and the sites from being collected before it. */
  constructor(
    connection: Connection,
    made: Made,
    /** @internal */ readonly surface: WorkerSurface,
    /** @internal */ readonly sites: WorkerSites,
  ) {
    super(connection, made);
    const { fields } = made;
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
    first: number,
    count: number,
    options?: Options<MapOptions>,
  ): Promise<{ sign: SignMethod; signReason: string }> {
    const signs = await this.call('computeSamples', [first, count], options);
    Object.assign(this, signs);
    return signs;
  }
  /** @internal computeSamples() and valuesOfSamples() at once, so that no other call comes between. */
  computeValues(
    first: number,
    count: number,
    options: object,
  ): Promise<MapValues & { sign: SignMethod; signReason: string }> {
    return this.call('computeValues', [first, count], options);
  }
  valuesOfSamples(first: number, count: number): Promise<MapValues> {
    return this.call('valuesOfSamples', [first, count]);
  }
  statistics(): Promise<MapStatistics> {
    return this.call('statistics', []);
  }
  transfer(values: ArrayLike<number>, options?: Options<TransferOptions>): Promise<Float32Array> {
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

/** The look of a mesh file in a worker. */
export class WorkerLook extends Remote {
  readonly hasMaterials: boolean;
  readonly hasColors: boolean;
  readonly hasNormals: boolean;

  /** @internal */
  constructor(connection: Connection, made: Made) {
    super(connection, made);
    const { fields } = made;
    [this.hasMaterials, this.hasColors, this.hasNormals] = ['hasMaterials', 'hasColors', 'hasNormals'].map(
      (name) => fields[name],
    ) as [boolean, boolean, boolean];
  }
  textures(): Promise<{ name: string; bytes: Uint8Array<ArrayBuffer> }[]> {
    return this.call('textures', []);
  }
  notes(): Promise<string[]> {
    return this.call('notes', []);
  }
  setPicture(texture: number, picture: Picture, options?: CallOptions): Promise<void> {
    return this.call('setPicture', [texture, picture], options);
  }
}

/** Matches in a worker. */
export class WorkerMatches extends Remote {
  readonly resolution: number;
  readonly rows: number;

  /** @internal Keeps the surface and the sites from being collected before it. */
  constructor(
    connection: Connection,
    made: Made,
    /** @internal */ readonly surface: WorkerSurface,
    /** @internal */ readonly sites: WorkerSites,
  ) {
    super(connection, made);
    const { fields } = made;
    [this.resolution, this.rows] = [fields['resolution'] as number, fields['rows'] as number];
  }
  counts(): Promise<MatchCounts> {
    return this.call('counts', []);
  }
  arrays(): Promise<MatchArrays> {
    return this.call('arrays', []);
  }
  transfer(values: ArrayLike<number>, options?: Options<TransferOptions>): Promise<Float32Array> {
    return this.call('transfer', [values], options);
  }
  bake(look: WorkerLook, options?: CallOptions): Promise<BakedLook> {
    return this.call('bake', [look], options);
  }
  normals(
    options: Options<Omit<NormalOptions, 'look'>> & { look?: WorkerLook | undefined } = {},
  ): Promise<Uint8Array> {
    const { look, ...others } = options;
    return this.call('normalsOf', [look ?? null], others);
  }
  model(options?: { tangents?: boolean } & CallOptions): Promise<DrawnModel> {
    return this.call('model', [], options);
  }
}

/** An animation in a worker. */
export class WorkerAnimation extends Remote {
  readonly frames: number;

  /** @internal */
  constructor(connection: Connection, made: Made) {
    super(connection, made);
    this.frames = made.fields['frames'] as number;
  }
  mesh(): Promise<{ positions: Float64Array; indices: Uint32Array }> {
    return this.call('mesh', []);
  }
  positions(frame: number): Promise<Float64Array> {
    return this.call('positions', [frame]);
  }
}

/** Two bodies in a worker. Of the module `full` only. */
export class WorkerPair extends Remote {
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

/**
 * The library in a worker, with a memory of its own. Calls are answered in their order. An aborted call rejects at once; where memory
 * can be shared, its computation stops at its next poll, and that of a map elsewhere between its parts. A call that goes on, for 2 s
 * if it polls or for 0.2 s otherwise, is stopped with its worker: objects that were made before are then lost (SdmError `ended`), and
 * others can be made.
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
  async surface(
    positions: Points,
    indices: Indices = null,
    options: Options<SurfaceOptions> = {},
  ): Promise<WorkerSurface> {
    return new WorkerSurface(
      this.connection,
      await this.connection.call(null, 'surface', [positions, indices], { ...options }),
    );
  }
  async sites(positions: Points, indices: Indices = null, options: CallOptions = {}): Promise<WorkerSites> {
    return new WorkerSites(
      this.connection,
      await this.connection.call(null, 'sites', [positions, indices], { ...options }),
    );
  }
  /** Of the module `full` only. */
  async pair(
    first: Body,
    second: Body,
    options: { contactMargin?: number } & CallOptions = {},
  ): Promise<WorkerPair> {
    return new WorkerPair(
      this.connection,
      await this.connection.call(null, 'pair', [first, second], { ...options }),
    );
  }
  /** Reads a mesh file. Of the module `full` only. */
  readMesh(
    bytes: Uint8Array | ArrayBuffer,
    name: string,
    options: Options<ReadMeshOptions> = {},
  ): Promise<MeshFile> {
    return this.connection.call(null, 'readMesh', [bytes, name], { ...options });
  }
  /** As of Sdm. */
  async readLook(
    bytes: Uint8Array | ArrayBuffer,
    name: string,
    options: Options<ReadMeshOptions> = {},
  ): Promise<WorkerLook> {
    return new WorkerLook(
      this.connection,
      await this.connection.call(null, 'readLook', [bytes, name], { ...options }),
    );
  }
  /** As of Sdm: null if the file has no animation. */
  async readAnimation(
    bytes: Uint8Array | ArrayBuffer,
    name: string,
    options: Options<ReadAnimationOptions> = {},
  ): Promise<WorkerAnimation | null> {
    const made = await this.connection.call(null, 'readAnimation', [bytes, name], { ...options });
    return made && new WorkerAnimation(this.connection, made);
  }
  /** As of Sdm. */
  async match(
    surface: WorkerSurface,
    sites: WorkerSites,
    options: Options<MatchOptions> = {},
  ): Promise<WorkerMatches> {
    const made = await this.connection.call(null, 'match', [surface, sites], { ...options });
    return new WorkerMatches(this.connection, made, surface, sites);
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
