// Numbers as text.
import type { Vec } from './page_data';

const kMinus = '\u2212';

/// A number to some digits, without a long tail of zeros: 0.0123, 1.5, 12300, 1.2e-7.
export function text(value: number | null | undefined, digits = 4): string {
  if (value === null || value === undefined || Number.isNaN(value)) return 'none';
  if (!Number.isFinite(value)) return value > 0 ? 'infinite' : `${kMinus}infinite`;
  if (value === 0) return '0';
  const size = Math.abs(value);
  const short =
    size < 1e-4 || size >= 1e7
      ? trimmed(value.toExponential(digits - 1))
      : trimmed(value.toFixed(Math.min(100, Math.max(0, digits - 1 - Math.floor(Math.log10(size))))));
  return short.replace('-', kMinus).replace('e-', `e${kMinus}`);
}

function trimmed(number: string): string {
  const [mantissa, exponent] = number.split('e');
  const short = mantissa.includes('.') ? mantissa.replace(/\.?0+$/, '') : mantissa;
  return exponent === undefined ? short : `${short}e${exponent}`;
}

/// The shortest decimal number that is this float and no other.
export function exactText(value: number): string {
  if (!Number.isFinite(value)) return text(value);
  for (let digits = 1; digits < 9; ++digits) {
    const short = Number(value.toPrecision(digits));
    if (Math.fround(short) === value) return String(short).replace(/-/g, kMinus);
  }
  return String(Number(value.toPrecision(9))).replace(/-/g, kMinus);
}

/// A number with its sign, plus included, where distances have signs.
export function signedText(value: number, isSigned: boolean, digits = 4): string {
  return (isSigned && value > 0 ? '+' : '') + text(value, digits);
}

export function percent(fraction: number): string {
  if (fraction <= 0) return '0 %';
  if (fraction < 1e-4) return '< 0.01 %';
  if (fraction > 0.9999 && fraction < 1) return '> 99.99 %';
  return `${text(100 * fraction, fraction > 0.1 ? 4 : 3)} %`;
}

/// A point of something of that size: to 1e-5 of it or better, however far from the origin it is.
export function place(point: Vec, size: number): string {
  const digits = (x: number) => {
    const needed = Math.floor(Math.log10(Math.abs(x))) + 1 - Math.floor(Math.log10(1e-5 * size));
    return Number.isFinite(needed) ? Math.min(15, Math.max(6, needed)) : 6;
  };
  return point.map((x) => text(x, digits(x))).join(', ');
}

export function count(value: number): string {
  return value.toLocaleString('en-US').replace(/,/g, '\u202f');
}

/// Positions of round numbers between lo and hi, about as many as asked for.
export function ticks(lo: number, hi: number, about: number): number[] {
  const raw = (hi - lo) / about;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = power * ([1, 2, 5, 10].find((s) => s * power >= raw) ?? 10);
  const result: number[] = [];
  for (let i = Math.ceil(lo / step - 1e-9); i * step <= hi + 1e-9 * step; ++i) result.push(i * step);
  return result;
}

/// A tick's label, to the digits of the step between ticks.
export function tickText(value: number, step: number): string {
  if (Math.abs(value) < step * 1e-6) return '0';
  return text(value, Math.max(1, Math.ceil(Math.log10(Math.abs(value) / step) + 1.01)));
}
