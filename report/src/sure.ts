// How sure a verdict is, in a word and a clause.
import type { Report } from './page_data';
import { isCloud, type Verdict } from './verdict';

/// Nothing where nothing is judged.
export function howSure(report: Report, verdict: Verdict): [word: string, why: string] | null {
  const { tolerance, group_tolerances: table } = report;
  const of = [...(tolerance ? [tolerance] : []), ...(table?.groups ?? [])].filter((t) => t.verdict === verdict);
  const certified = of.filter((t) => t.certified).length;
  const cloud = isCloud(report);
  switch (verdict) {
    case 'FAIL':
      // Points of a cloud without a group fail by their number.
      if (certified > 0 || of.length === 0) return ['proven', cloud ? 'a point that is out was found.' : 'a place that is out was found.'];
      return ['an estimate', 'it depends on the sign of a distance, and signs are estimates here.'];
    case 'PASS':
      if (certified < of.length) return ['an estimate', 'it holds at the measured points; between them nothing is proven.'];
      return ['proven', cloud ? 'for every point of the cloud; nothing is said between them.' : 'for every point, also between the measured ones.'];
    case 'NOT DECIDED':
      return ['open', 'neither PASS nor FAIL is proven.'];
    case 'DOUBTFUL':
      return ['in doubt', 'the numbers pass, but what they rest on may be wrong.'];
    default:
      return null;
  }
}
