// How many frames a second are computed, by the time that each of them takes.
import { text } from '../src/numbers';

const kShare = 0.1; // of a frame in the average

export class Rate {
  private average = Number.NaN;

  begin(): void {
    this.average = Number.NaN;
  }

  add(milliseconds: number): void {
    this.average = Number.isNaN(this.average)
      ? milliseconds
      : (1 - kShare) * this.average + kShare * milliseconds;
  }

  /// Frames a second, by the average frame.
  get perSecond(): number {
    return 1000 / this.average;
  }

  get text(): string {
    return `${Math.round(this.perSecond)} frames/s, ${text(this.average, 3)} ms`;
  }
}
