// Whether a part is within a tolerance: as the report says, where a proof may have decided, and for other limits by
// the rule of judge() in include/sdm/tolerance.h, on the evidence of the samples.
import {
  kAtLeast,
  kBetween,
  kLimitDigits,
  kLimitWords,
  kReasonNames,
  kVerdictNames,
  limitsForm,
  lowerOf,
  reasonOf,
  verdictOf as ruledVerdict,
} from 'sdm-rules';
import type { Evidence, Report } from './page_data';
import { percent, text } from './numbers';
import { distanceText } from './precision';
import type { AreaByValue } from './area_by_value';
import { capital, isSigned, isThickness, quantityOf } from './words';

export type Verdict = (typeof kVerdictNames)[number] | 'MEASURED';

export interface Limits {
  lower: number; ///< -infinite without one
  upper: number; ///< infinite without one
}

export interface Judgement {
  verdict: Verdict;
  reason: string; ///< as name_of(VerdictReason) in include/sdm/summary.h
  nearestIsLower: boolean; ///< the limit that is exceeded most, or approached most closely
}

export function isCloud(report: Report): boolean {
  return report.o1?.points !== undefined;
}

/// What fractions are of.
export function wholeOf(report: Report): 'area' | 'points' {
  return isCloud(report) ? 'points' : 'area';
}

export function unitOf(report: Report): string {
  return report.units ? `\u00a0${report.units}` : '';
}

export function limitsOf(report: Report): Limits | null {
  const t = report.tolerance;
  if (!t) return null;
  const value = t.value ?? Infinity;
  return { lower: t.lower ?? -value, upper: t.upper ?? value };
}

/// Whether there is a limit.
export function isLimited({ lower, upper }: Limits): boolean {
  return Number.isFinite(lower) || Number.isFinite(upper);
}

export function limitsText(limits: Limits, report: Report): string {
  return limitsIn(limits, unitOf(report), isSigned(report));
}

/// `unit`: with the space before it.
export function limitsIn({ lower, upper }: Limits, unit: string, signed: boolean): string {
  const form = limitsForm(lower, upper, signed);
  const number = (limit: number) => text(limit, kLimitDigits);
  if (form === kBetween) return `${number(lower)} to ${number(upper)}${unit}`;
  return `${kLimitWords[form]}${number(form === kAtLeast ? lower : upper)}${unit}`;
}

/// The limits that a distance can exceed, infinite for none: not a negative one of what is never negative.
export function realLimits({ lower, upper }: Limits, report: Report): Limits {
  return { lower: lowerOf(lower, isSigned(report) && report.thickness === undefined), upper };
}

/// The judgement of judge(), number by number.
export function judge(evidence: Evidence, { lower: least, upper }: Limits): Judgement {
  const lower = lowerOf(least, evidence.signed ?? true);
  const [lowest, highest] = [evidence.lowest ?? Infinity, evidence.highest ?? -Infinity];
  const reason = reasonOf(
    lowest,
    highest,
    lower,
    upper,
    evidence.accuracy ?? Infinity,
    evidence.guard ?? 0,
    evidence.error_bound ?? Infinity,
    evidence.thin_walls ?? Infinity,
    evidence.complete,
    evidence.unmatched ?? false,
    evidence.estimated_signs,
    evidence.samples_only ?? false,
  );
  return {
    verdict: kVerdictNames[ruledVerdict(reason)],
    reason: kReasonNames[reason],
    nearestIsLower: lower - lowest > highest - upper,
  };
}

/// Whether limits can be judged.
export function canJudge({ evidence }: Report): boolean {
  return evidence !== undefined && evidence.accuracy !== null;
}

/// Whether the limits are those that the report judges.
function isJudged(report: Report, { lower, upper }: Limits): boolean {
  const judged = limitsOf(report);
  return judged !== null && judged.lower === lower && judged.upper === upper;
}

/// The verdict with these limits: that of the report for the limits in it, otherwise by the rule.
export function verdictFor(report: Report, limits: Limits): Verdict | null {
  const { tolerance, evidence } = report;
  if (!evidence || !canJudge(report)) return null;
  return tolerance?.verdict && isJudged(report, limits)
    ? (tolerance.verdict as Verdict)
    : judge(evidence, limits).verdict;
}

/// The fraction of the area, or of the points, that is out of limits: as the report says, and for other limits by the
/// distribution, whose bins make it an estimate.
export function outsideOf(report: Report, limits: Limits & { accuracy: number }, area: AreaByValue): number {
  const stated = report.tolerance?.exceeded_area_fraction ?? report.tolerance?.exceeded_point_fraction;
  if (stated !== undefined && isJudged(report, limits)) return stated;
  return Math.max(0, 1 - area.within(limits.lower - limits.accuracy, limits.upper + limits.accuracy));
}

/// What the sliders ask: the verdict with their limits, of which `outside` is out, as words before it, itself, and words
/// after it.
export function whatIf(report: Report, limits: Limits, outside: number): [string, string, string] {
  if (!isLimited(limits)) return ['Set a tolerance to see what its verdict would be.', '', ''];
  const verdict = verdictFor(report, limits);
  const given = isJudged(report, limits);
  const text = limitsText(limits, report);
  if (verdict === null)
    return [`With ${text}: `, '', 'The accuracy of this map is unknown, so no tolerance can be checked.'];
  const cloud = isCloud(report);
  const share =
    outside <= 0 || (verdict !== 'FAIL' && !report.tolerance?.by_places)
      ? `No ${cloud ? 'point' : 'sample'} is out of it.`
      : cloud
        ? `${percent(outside)} of the points are out of it.`
        : `About ${percent(outside)} of the area is out of it.`;
  const open =
    verdict === 'NOT DECIDED' && !given
      ? ` Samples alone do not decide this: ${report.live ? 'a proof follows' : 'the command does, with this tolerance'}.`
      : '';
  return given
    ? [`With ${text}: `, verdict, `. ${share}${open}`]
    : [
        'Would be ',
        verdict,
        ` with ${text}${report.tolerance?.by_places ? ' if single points decide' : ''}. ${share}${open}`,
      ];
}

/// A clause as a sentence, with the minus sign that all numbers of the page have.
function sentence(clause: string): string {
  return `${capital(clause).replace(/(^|[ (])-(?=\d)/g, '$1−')}.`;
}

/// What is said where nothing is judged.
function unjudged(report: Report): string {
  if (isThickness(report)) return 'No limits were given (--min, --max), so nothing was judged.';
  if (!report.evidence) return 'Nothing was judged.';
  if (report.live) return 'No tolerance is set, so nothing is judged.';
  return 'No tolerance was given (--tolerance), so nothing was judged.';
}

/// Why the verdict is FAIL: what the report says, with numbers.
function failure(report: Report): string {
  const unit = unitOf(report);
  const t = report.tolerance!;
  if (t.by_places) return t.text ?? '';
  const outside = t.exceeded_area_fraction ?? t.exceeded_point_fraction ?? null;
  const whole = isCloud(report) ? 'points are' : 'area is';
  const faces = t.proof?.faces_without_match ?? 0;
  if (t.reason === 'without match' && faces > 0)
    return `${t.text}: ${faces === 1 ? 'a face' : `${faces} faces`} between the measured points ${faces === 1 ? 'has' : 'have'} no value`;
  if (t.reason === 'without match' || t.reason === 'beyond max distance') {
    const most =
      t.reason === 'beyond max distance' && report.max_distance
        ? ` (${text(report.max_distance)}${unit})`
        : '';
    return `${t.text}${most}${outside === null ? '' : `: ${percent(outside)} of the ${whole} out of tolerance or without a value`}`;
  }
  const between = t.proof?.witness;
  if (t.by_facing && !between) return t.text ?? '';
  const most = between
    ? between.distance
    : t.nearest_limit === 'lower'
      ? report.evidence!.lowest
      : report.evidence!.highest;
  const share =
    outside === null || between
      ? ''
      : `, and ${isCloud(report) ? '' : 'about '}${percent(outside)} of the ${whole} out of tolerance`;
  return `${t.text}: a ${quantityOf(report)} of ${distanceText(most, report)}${unit} was found${between ? ' between the measured points' : ''}${share}`;
}

interface Stated {
  verdict: Verdict;
  sentence: string;
}

/// The verdict by the tolerance for the whole part, in the words of the report.
function ofPart(report: Report): Stated | null {
  const t = report.tolerance;
  if (!t?.verdict || !report.evidence) return null;
  const verdict = t.verdict as Verdict;
  return { verdict, sentence: sentence(verdict === 'FAIL' ? failure(report) : (t.text ?? '')) };
}

/// The verdict by the table of tolerances, in the words of the report.
function ofGroups({ group_tolerances: table }: Report): Stated | null {
  return table ? { verdict: table.verdict as Verdict, sentence: sentence(table.text) } : null;
}

const kFromBestToWorst: Verdict[] = ['MEASURED', 'PASS', 'DOUBTFUL', 'NOT DECIDED', 'FAIL'];

/// The verdict of the report, in words: the worse one of those of the part and of its groups, as the exit code is.
export function verdictOf(report: Report): Stated {
  const stated = [ofPart(report), ofGroups(report)].filter((s): s is Stated => s !== null);
  if (stated.length === 0)
    return {
      verdict: 'MEASURED',
      sentence: unjudged(report),
    };
  const rank = ({ verdict }: Stated) => kFromBestToWorst.indexOf(verdict);
  const worst = Math.max(...stated.map(rank));
  const decisive = stated.filter((s) => rank(s) === worst);
  return { verdict: decisive[0].verdict, sentence: decisive.map((s) => s.sentence).join(' ') };
}
