// What the parts of the live page share: what is compared, and what is known of it.
import type { SdmWorker } from 'sdm';
import type { AreaByValue } from '../src/area_by_value';
import { signedText } from '../src/numbers';
import type { Report } from '../src/page_data';
import { distanceText } from '../src/precision';
import { unitOf } from '../src/verdict';
import { isSigned } from '../src/words';
import { Engine } from './engine';
import { Body, type Moves } from './body';
import type { Pair } from './pair';
import { sayFault } from './status';

export const kRest = 220; // milliseconds without a motion, after which the map is fine

/// Two bodies, as they are chosen.
export interface Choice {
  name: string; ///< in the list of pairs
  bodies: [Body, Body];
  scene: Moves | null; ///< how the bodies move; null: only as they are moved
  units: string;
}

export class Session {
  readonly engine: Engine;
  choice: Choice | null = null; // that is shown
  pair: Pair | null = null;
  units = '';
  resolution = 1024; // of the map at rest
  report: Report | null = null; // of the last rest
  area: AreaByValue | null = null;
  tolerance: [number, number] | null = null;
  loading = false;
  moving = false; // since the last rest
  version = 0; // of the places of the bodies
  fault = sayFault; // what is done about an error
  private work: Promise<unknown> = Promise.resolve(); // of the worker, in order

  constructor(readonly worker: SdmWorker) {
    this.engine = new Engine(worker);
  }

  get bodies(): [Body, Body] | null {
    return this.choice?.bodies ?? null;
  }
  get scene(): Moves | null {
    return this.choice?.scene ?? null;
  }

  /// Calls of the worker, one after the other.
  inOrder<T>(call: () => Promise<T>): Promise<T> {
    const result = this.work.then(call, call);
    this.work = result.catch(() => {});
    return result;
  }

  private get signs(): boolean {
    return this.report !== null && isSigned(this.report);
  }
  /// The unit with the space before it; empty without one.
  get unitText(): string {
    return this.units && `\u00a0${this.units}`;
  }
  valueText(distance: number): string {
    return distanceText(distance, this.report!, this.signs) + unitOf(this.report!);
  }
  /// The text of a distance has its sign, as in the table of numbers; that of a length has none.
  signedText(distance: number): string {
    return signedText(distance, this.signs, 3) + this.unitText;
  }
  lengthText(length: number): string {
    return signedText(length, false, 3) + this.unitText;
  }
}
