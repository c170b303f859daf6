// Whether a part is within a tolerance: as the report says, and for other limits by the rule of judge() in
// include/sdm/tolerance.h, on the same evidence.
import type { Evidence, Report } from './page_data';
import { text } from './numbers';

export type Verdict = 'PASS' | 'FAIL' | 'NOT DECIDED' | 'MEASURED';

export interface Limits {
  lower: number;
  upper: number;
}

export interface Judgement {
  verdict: Verdict;
  reason: string; ///< as name_of(VerdictReason) in include/sdm/summary.h
  nearestIsLower: boolean; ///< the limit that is exceeded most, or approached most closely
  decidingPrecision: number; ///< 0: none decides
}

export function isCloud(report: Report): boolean {
  return report.o1?.points !== undefined;
}

/// What fractions are of.
export function wholeOf(report: Report): 'area' | 'points' {
  return isCloud(report) ? 'points' : 'area';
}

export function isSigned(report: Report): boolean {
  return report.sign !== undefined && report.sign.method !== 'none';
}

export function unitOf(report: Report): string {
  return report.units ? `\u00a0${report.units}` : '';
}

export function limitsOf(report: Report): Limits | null {
  const t = report.tolerance;
  if (!t) return null;
  const value = t.value ?? Number.NaN;
  return { lower: t.lower ?? -value, upper: t.upper ?? value };
}

export function limitsText({ lower, upper }: Limits, report: Report): string {
  const unit = unitOf(report);
  if (lower === -upper) return isSigned(report) ? `±${text(upper)}${unit}` : `${text(upper)}${unit}`;
  return `${text(lower)} to ${text(upper)}${unit}`;
}

/// The judgement of judge(), number by number.
export function judge(evidence: Evidence, { lower, upper }: Limits): Judgement {
  const { complete, estimated_signs: estimated } = evidence;
  const lowest = evidence.lowest ?? Infinity;
  const highest = evidence.highest ?? -Infinity;
  const accuracy = evidence.accuracy ?? Infinity;
  const bound = evidence.error_bound ?? Infinity;
  const marginOf = (least: number, most: number) => Math.min(upper - most, least - lower) - accuracy;
  const farthest = Math.max(-lowest, highest);
  const measured = marginOf(lowest, highest);
  const margin = estimated ? marginOf(-farthest, farthest) : measured;
  const result = { nearestIsLower: lower - lowest > highest - upper, decidingPrecision: 0 };
  // The sign of a distance that rounding does not tell from zero is not certain.
  const isZero = (d: number) => Math.abs(d) <= accuracy;
  const below = (isZero(lowest) ? Math.abs(lowest) : lowest) < lower - accuracy;
  const above = (isZero(highest) ? -Math.abs(highest) : highest) > upper + accuracy;
  if (!complete) return { ...result, verdict: 'FAIL', reason: 'beyond max distance' };
  if (below || above) return { ...result, verdict: 'FAIL', reason: 'exceeded' };
  if (!(lowest <= highest)) return { ...result, verdict: 'NOT DECIDED', reason: 'nothing measured' };
  if (bound <= margin) return { ...result, verdict: 'PASS', reason: 'all within' };
  const decidingPrecision = Math.max(0, margin / 2);
  const reason = !Number.isFinite(accuracy)
    ? 'unknown accuracy'
    : bound <= measured || (margin <= 0 && measured > 0)
      ? 'estimated signs'
      : margin > 0
        ? 'between samples'
        : 'within rounding';
  return { verdict: 'NOT DECIDED', reason, nearestIsLower: result.nearestIsLower, decidingPrecision };
}

/// The judgement of the report, for the limits in it.
export function judgementOf({ tolerance: t, evidence }: Report): Judgement | null {
  if (!t || !evidence) return null;
  return {
    verdict: t.verdict as Verdict,
    reason: t.reason ?? '',
    nearestIsLower: t.nearest_limit === 'lower',
    decidingPrecision: t.deciding_precision ?? 0,
  };
}

/// A judgement in words. `outside`: the fraction of the area, or of the points, that is out of the limits.
export function sentenceOf(report: Report, limits: Limits, judgement: Judgement, outside: number | null): string {
  const unit = unitOf(report);
  const within = limitsText(limits, report);
  const cloud = isCloud(report);
  switch (judgement.reason) {
    case 'all within':
      return `Every point of the ${cloud ? 'cloud' : 'surface'} is within the tolerance of ${within}.`;
    case 'beyond max distance':
      return `${cloud ? 'Points of the cloud' : 'Parts of the surface'} are farther than the largest distance that was measured${
        report.max_distance ? ` (${text(report.max_distance)}${unit})` : ''
      }.`;
    case 'exceeded': {
      const most = judgement.nearestIsLower ? report.evidence!.lowest : report.evidence!.highest;
      const share = outside === null ? '' : `, and ${cloud ? '' : 'about '}${text(100 * outside, 3)}\u00a0% of the ${cloud ? 'points are' : 'area is'} out of tolerance`;
      return `A distance of ${text(most)}${unit} was found, which is out of the tolerance of ${within}${share}.`;
    }
    case 'nothing measured':
      return `No point of the ${cloud ? 'cloud' : 'surface'} has a distance.`;
    case 'unknown accuracy':
      return 'The accuracy of this map is unknown, so no tolerance can be checked.';
    case 'estimated signs':
      return `All ${cloud ? '' : 'measured '}points are within the tolerance of ${within}, but whether they are inside or outside of the reference, which has holes, is an estimate.`;
    case 'between samples':
      return (
        `All measured points are within the tolerance of ${within}, but points between them may not be: ` +
        `the distance there is known to ±${text(report.error_bound, 3)}${unit}. Measured again with --precision ${roundedDown(
          judgement.decidingPrecision,
        )}, it will be decided, unless a larger distance turns up.`
      );
    default:
      return `All ${cloud ? '' : 'measured '}points are within the tolerance of ${within}, but the largest distance is as close to the limit as numbers can be told apart${cloud ? '' : ', so no precision will decide'}.`;
  }
}

/// Rounds to two digits, never up: a precision that is still fine enough, to type into a command line.
function roundedDown(value: number): string {
  const unit = 10 ** (Math.floor(Math.log10(value)) - 1);
  return String(Number((Math.floor(value / unit) * unit).toPrecision(2)));
}

/// The verdict of the report, in words.
export function verdictOf(report: Report): { verdict: Verdict; sentence: string } {
  const limits = limitsOf(report);
  const judgement = judgementOf(report);
  if (!limits || !judgement)
    return {
      verdict: 'MEASURED',
      sentence: 'No tolerance was given (--tolerance), so nothing was judged. The slider below shows what would be.',
    };
  const t = report.tolerance!;
  const outside = t.exceeded_area_fraction ?? t.exceeded_point_fraction ?? null;
  return { verdict: judgement.verdict, sentence: sentenceOf(report, limits, judgement, outside) };
}
