// Whether a part is within a tolerance, by the rule of check_tolerance() in include/sdm/tolerance.h.
import type { Report } from './page_data';
import { text } from './numbers';

export type Verdict = 'PASS' | 'FAIL' | 'NOT DECIDED' | 'MEASURED';

export interface Limits {
  lower: number;
  upper: number;
}

export interface Judgement {
  verdict: Verdict;
  sentence: string;
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

/// How far the limits are from the extremes: negative if one is exceeded. Null if nothing has a value.
function margin(report: Report, { lower, upper }: Limits): number | null {
  const extremes = report.extremes;
  if (!extremes?.min || !extremes.max) return null;
  return Math.min(upper - extremes.max.distance, extremes.min.distance - lower);
}

/// The verdict for any limits. `outside`: the fraction of the area, or of the points, that is out of them.
export function judge(report: Report, limits: Limits, outside: number | null): Judgement {
  const unit = unitOf(report);
  const within = limitsText(limits, report);
  const { accuracy } = report;
  const cloud = isCloud(report);
  const bound = cloud ? 0 : report.error_bound;
  if (accuracy === null || accuracy === undefined || bound === null || bound === undefined)
    return { verdict: 'MEASURED', sentence: 'The accuracy of this map is unknown, so no tolerance can be checked.' };
  if ((report.beyond_max_distance ?? 0) > 0)
    return {
      verdict: 'FAIL',
      sentence: `${cloud ? 'Points of the cloud' : 'Parts of the surface'} are farther than the largest distance that was measured${
        report.max_distance ? ` (${text(report.max_distance)}${unit})` : ''
      }.`,
    };
  const room = margin(report, limits);
  if (room === null) return { verdict: 'MEASURED', sentence: `No point of the ${cloud ? 'cloud' : 'surface'} has a distance.` };
  if (room < -accuracy) {
    const { min, max } = report.extremes!;
    const most = limits.upper - max!.distance < min!.distance - limits.lower ? max! : min!;
    const share =
      outside === null
        ? ''
        : cloud
          ? `, and ${text(100 * outside, 3)}\u00a0% of the points are out of tolerance`
          : `, and about ${text(100 * outside, 3)}\u00a0% of the area is out of tolerance`;
    return {
      verdict: 'FAIL',
      sentence: `A distance of ${text(most.distance)}${unit} was found, which is out of the tolerance of ${within}${share}.`,
    };
  }
  const needsSign = limits.lower < 0 && limits.lower !== -limits.upper;
  if (room >= bound + accuracy && !(needsSign && report.sign?.method === 'winding'))
    return { verdict: 'PASS', sentence: `Every point of the ${cloud ? 'cloud' : 'surface'} is within the tolerance of ${within}.` };
  if (cloud)
    return {
      verdict: 'NOT DECIDED',
      sentence:
        `All points are within the tolerance of ${within}, but ` +
        (room >= accuracy
          ? 'whether they are inside or outside of the reference, which has holes, is an estimate.'
          : 'the largest distance is as close to the limit as numbers can be told apart.'),
    };
  const decides = report.tolerance && sameLimits(limits, limitsOf(report)!) ? report.tolerance.deciding_precision : undefined;
  const precision = decides ?? room - accuracy;
  return {
    verdict: 'NOT DECIDED',
    sentence:
      `All measured points are within the tolerance of ${within}, but points between them may not be: ` +
      (precision > 0
        ? `the distance there is known to ±${text(bound, 3)}${unit}. Measured again with --precision ${roundedDown(
            precision,
          )}, it will be decided, unless a larger distance turns up.`
        : 'the largest distance is as close to the limit as numbers can be told apart, so no precision will decide.'),
  };
}

function sameLimits(a: Limits, b: Limits): boolean {
  return a.lower === b.lower && a.upper === b.upper;
}

/// To two digits, never up: a precision that is still fine enough, to type into a command line.
function roundedDown(value: number): string {
  const unit = 10 ** (Math.floor(Math.log10(value)) - 1);
  return String(Number((Math.floor(value / unit) * unit).toPrecision(2)));
}

/// The verdict of report.json.
export function verdictOf(report: Report): Judgement {
  const limits = limitsOf(report);
  const t = report.tolerance;
  if (!limits || !t)
    return {
      verdict: 'MEASURED',
      sentence: 'No tolerance was given (--tolerance), so nothing was judged. The slider below shows what would be.',
    };
  const judgement = judge(report, limits, t.exceeded_area_fraction ?? t.exceeded_point_fraction ?? null);
  const verdict = (t.verdict as Verdict | undefined) ?? (!t.within ? 'FAIL' : t.certified ? 'PASS' : 'NOT DECIDED');
  return { ...judgement, verdict };
}
