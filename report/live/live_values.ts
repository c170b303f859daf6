// The numbers below the picture, which follow a motion.
import { byId } from '../src/dom';
import { text } from '../src/numbers';
import type { Layout } from './layout';
import type { Rate } from './rate';
import type { Session } from './session';

export function showSeparation(session: Session, separation: number): void {
  byId('separation').textContent =
    separation === 0 ? '0, they touch or intersect' : session.lengthText(separation);
}

export function showMean(session: Session, mean: number): void {
  byId('live-mean').textContent = session.signedText(mean);
}

export function showRate(rate: Rate): void {
  byId('rate').textContent = rate.text;
}

export function showTime(resolution: number, milliseconds: number): void {
  byId('rate').textContent = `map of ${resolution} × ${resolution} in ${text(milliseconds, 3)} ms`;
}

export function meanOf({ map, areas }: Layout): number {
  let [sum, total] = [0, 0];
  for (let i = 0; i < areas.length; ++i)
    if (areas[i] > 0 && Number.isFinite(map.distance[i])) {
      sum += areas[i] * map.distance[i];
      total += areas[i];
    }
  return total > 0 ? sum / total : Number.NaN;
}
