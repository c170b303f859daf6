// How sure a verdict is, in a word and a clause.
import { byId, make } from './dom';
import { text } from './numbers';
import type { Report } from './page_data';
import { isCloud, verdictOf, type Verdict } from './verdict';

type Sure = [word: string, why: string];

const kInDoubt: Sure = ['in doubt', 'the numbers pass, but what they rest on may be wrong.'];

export function sayHowSure([word, why]: Sure, more = ''): void {
  byId('sure').replaceChildren('How sure: ', make('b', {}, word), ` – ${why}${more}`);
  byId('sure').hidden = false;
}

/// Nothing where nothing is judged.
function howSure(report: Report, verdict: Verdict): Sure | null {
  const { tolerance, group_tolerances: table } = report;
  const of = [...(tolerance ? [tolerance] : []), ...(table?.groups ?? [])].filter(
    (t) => t.verdict === verdict,
  );
  const certified = of.filter((t) => t.certified).length;
  const cloud = isCloud(report);
  if (tolerance?.by_places && (verdict === 'PASS' || verdict === 'FAIL'))
    return ['an estimate', 'the areas of connected places are those of their samples.'];
  switch (verdict) {
    case 'FAIL':
      // Points of a cloud without a group fail by their number.
      if (certified > 0 || of.length === 0)
        return ['proven', cloud ? 'a point that is out was found.' : 'a place that is out was found.'];
      return ['an estimate', 'it depends on the sign of a distance, and signs are estimates here.'];
    case 'PASS':
      if (certified < of.length)
        return ['an estimate', 'it holds at the measured points; between them nothing is proven.'];
      return [
        'proven',
        cloud
          ? 'for every point of the cloud; nothing is said between them.'
          : `for every point${tolerance ? '' : ' that has a limit'}, also between the measured ones.`,
      ];
    case 'NOT DECIDED':
      return ['open', 'neither PASS nor FAIL is proven.'];
    case 'DOUBTFUL':
      return kInDoubt;
    default:
      return null;
  }
}

/// `unjudged`: the share of the area that no limit is for, once it is known.
export function showSure(report: Report, unjudged = 0): void {
  const sure = howSure(report, verdictOf(report).verdict);
  byId('sure').hidden = !sure;
  if (!sure) byId('sure').replaceChildren();
  const rest =
    unjudged > 0 && !report.tolerance
      ? ` About ${text(100 * unjudged, 2)}\u00a0% of the area has no limits and is not judged.`
      : '';
  if (sure) sayHowSure(sure, rest);
}

/// How sure the verdict of a player is, which is one on all frames.
export function howSureOfFrames(verdict: Verdict, certified: boolean): Sure {
  if (verdict === 'NOT DECIDED') return ['open', 'in some frame neither PASS nor FAIL is proven.'];
  if (verdict === 'DOUBTFUL') return kInDoubt;
  if (!certified)
    return ['an estimate', 'it depends on the sign of a distance, and signs are estimates here.'];
  return [
    'proven',
    verdict === 'FAIL'
      ? 'a frame with a place that is out was found.'
      : 'for every point in every frame; nothing is said between frames.',
  ];
}
