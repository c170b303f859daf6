// One number of decimals for all distances of a report, so that they can be compared by eye.
import { kMinus, signedText } from './numbers';
import type { Report } from './report_json';

const kLeastDigits = 3; // of the largest distance
const kMostDigits = 5;

/// The decimals that distances have: one more than the error bound leaves certain, or the accuracy where nothing
/// bounds what is between the samples. Null if the numbers are so large or small that they need exponents.
function decimalsOf(report: Report): number | null {
  const { min, max } = report.extremes ?? {};
  const largest = Math.max(
    Math.abs(min?.distance ?? 0),
    Math.abs(max?.distance ?? Number(report.distance?.max ?? 0)),
  );
  if (!(largest >= 1e-4 && largest < 1e7)) return null;
  const error = report.error_bound || report.accuracy || 1e-4 * largest;
  const first = Math.floor(Math.log10(largest)); // the place of the first digit
  const wanted = 1 - Math.floor(Math.log10(error));
  return Math.max(0, Math.min(Math.max(wanted, kLeastDigits - 1 - first), kMostDigits - 1 - first));
}

/// A distance as all parts of the page state it, without a unit; what these decimals would round to zero has three digits.
export function distanceText(value: number | null | undefined, report: Report, withSign = false): string {
  const decimals = decimalsOf(report);
  if (value === null || value === undefined || !Number.isFinite(value) || decimals === null)
    return signedText(value ?? Number.NaN, withSign);
  const short = value.toFixed(decimals);
  if (Number(short) === 0) return value === 0 ? short.replace('-', '') : signedText(value, withSign, 3);
  return (withSign && value > 0 ? '+' : '') + short.replace('-', kMinus);
}
