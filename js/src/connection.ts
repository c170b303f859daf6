/// <reference lib="esnext.disposable" preserve="true" />
// Calls to a worker, and objects in it; ended workers are replaced.
import { type AnyWorker, newWorker, started } from './any_worker.js';
import { type Reference, type Reply, type Request, type Started, type WorkerStart } from './protocol.js';
import { sendable } from './sendable.js';
import { SdmError } from './types.js';

export interface CallOptions {
  /** Rejects the call with its reason. */
  signal?: AbortSignal | undefined;
  /** Called now and then with the current step and the fraction of it that is done. What it throws aborts the call. */
  progress?: ((step: string, fraction: number) => void) | undefined;
  /** Moves the buffers of typed arrays that are all of their buffer, instead of copying them: these are empty afterwards. */
  transfer?: boolean | undefined;
}

/** The options of a synchronous call, with those of calls to a worker. */
export type Options<Synchronous> = Synchronous extends unknown
  ? Omit<Synchronous, 'progress'> & CallOptions
  : never;
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
export type Made = { object: number; fields: Record<string, unknown>; generation: number };

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
export class Connection {
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
    const worker = newWorker(start.script);
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
      const worker = newWorker(this.start.script);
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
    for (const call of all) {
      call.settle?.();
      call.release();
      call.reject(error);
    }
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
    if ('progress' in reply) {
      this.tell(reply.id, reply.progress);
      return;
    }
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
      value instanceof Remote ? value : sendable(value, transfer === true, moved),
    );
    const sentOptions = sendable(rest, transfer === true, moved) as Record<string, unknown>;
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

/** An object in a worker. It is freed when it is collected, by dispose(), or at the end of the block of `using`. */
export abstract class Remote {
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
