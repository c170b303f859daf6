// Messages between createWorker() and the program of its worker.
import { type ReportPage } from './load.js';
import { type ModuleStart } from './module.js';
import { type ThreadStart } from './threads.js';
import { type ErrorKind } from './types.js';

/** The first message to the program: what it is to be. */
export type FirstMessage = { thread: ThreadStart } | { worker: WorkerStart };

export interface WorkerStart extends ModuleStart {
  reportPage: ReportPage;
}

/** The answer to it. */
export interface Started {
  threads: number;
  /** A flag for each call, by its number modulo their count, that cancels it; where memory can be shared. */
  flags: Uint8Array | undefined;
}

/** Stands for an object of the worker, by its number. */
export interface Reference {
  sdmObject: number;
}

export type Request =
  | { call: Call }
  /** Of a call that has not ended. */
  | { cancel: number }
  | { dispose: number };

export interface Call {
  id: number;
  /** Of the object whose method is called; 0: of the library. */
  object: number;
  method: string;
  /** Typed arrays, plain values and references. */
  values: unknown[];
  /** Of the last argument. */
  options: Record<string, unknown>;
  wantsProgress: boolean;
  /** Whether it may be cancelled. */
  cancellable: boolean;
}

export type Reply = { id: number } & (
  | { value: unknown }
  /** A new object, with the numbers and words that it has. */
  | { object: number; fields: Record<string, unknown> }
  | { progress: [step: string, fraction: number] }
  /** broken: the module cannot be used any more. */
  | { error: { kind: ErrorKind | 'other'; message: string; broken: boolean } }
);
