// The verdict on the frames, in words, with the frame that is worst.
import { showBadge } from './badge';
import { byId, make } from './dom';
import { count, signedText } from './numbers';
import { hasSigns, PlayerData } from './player_data';
import { howSureOfFrames, sayHowSure } from './sure';
import { limitsIn, type Limits } from './verdict';

interface Extreme {
  place: number; ///< among all frames
  distance: number;
  excess: number; ///< beyond the nearest limit; not positive within the tolerance
}

/// The distance of all frames, by the curves of their maps, that exceeds a limit most or comes nearest to one.
function worstFrame({ page }: PlayerData, limits: Limits): Extreme | null {
  let worst: Extreme | null = null;
  for (const { title, curves } of page.panels) {
    if (!title.startsWith('Distance')) continue;
    for (const { values } of curves)
      values.forEach((distance, place) => {
        if (distance === null) return;
        const excess = Math.max(distance - limits.upper, limits.lower - distance);
        if (!worst || excess > worst.excess) worst = { place, distance, excess };
      });
  }
  return worst;
}

/// Fills the header; `show` is called with a place among all frames.
export function showVerdict(data: PlayerData, show: (place: number) => void): void {
  const { page } = data;
  const { verdict, tolerance, verdicts = [] } = page;
  if (!verdict || !tolerance) return;
  showBadge(verdict);
  const of = (word: string) => verdicts.filter((v) => v === word).length;
  const all = count(verdicts.length);
  const unit = page.units ? `\u00a0${page.units}` : '';
  const signed = hasSigns(data);
  const limits = `the tolerance of ${limitsIn(tolerance, unit, signed)}`;
  const words =
    verdict === 'FAIL'
      ? `Out of ${limits} in ${count(of(verdict))} of ${all} frames`
      : verdict === 'PASS'
        ? `Within ${limits} in all ${all} frames`
        : verdict === 'DOUBTFUL'
          ? `Within ${limits}, but in doubt in ${count(of(verdict))} of ${all} frames, as ${page.doubt}`
          : `Not decided in ${count(of(verdict))} of ${all} frames, within ${limits} in the others`;
  const worst = worstFrame(data, tolerance);
  if (!worst) byId('judged').textContent = `${words}.`;
  else
    byId('judged').replaceChildren(
      `${words}; ${worst.excess > 0 ? 'worst' : 'nearest to a limit'} in `,
      make(
        'button',
        { type: 'button', class: 'link', id: 'to-worst-frame', click: () => show(worst.place) },
        `frame ${page.added[worst.place]}`,
      ),
      `: ${signedText(worst.distance, signed, 3)}${unit}.`,
    );
  byId('judged').hidden = false;
  sayHowSure(howSureOfFrames(verdict, page.certified ?? false));
  document.title = `${verdict}: ${document.title}`;
}
