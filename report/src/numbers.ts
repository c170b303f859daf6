// Numbers as text.
import { stepDigit, stepExponent, stepMultiple } from 'sdm-rules';
import type { Vec } from './page_data';

export const kMinus = '\u2212';

/// The number that a person typed, with a point or a comma as its decimal mark; NaN for what is no number. Fields of
/// type number drop a comma, so that 0,05 would be 5.
export function typedNumber(typed: string): number {
  const plain = typed.trim().replace(kMinus, '-').replace(',', '.');
  return /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i.test(plain) ? Number(plain) : Number.NaN;
}

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

/// Round numbers between lo and hi, at most one more than `steps`.
export function ticks(lo: number, hi: number, steps: number): number[] {
  const [digit, exponent] = [stepDigit((hi - lo) / steps), stepExponent((hi - lo) / steps)];
  const multiple = (n: number) => stepMultiple(n, digit, exponent);
  const step = multiple(1);
  const first = Math.ceil(lo / step - 1e-9);
  const result: number[] = [];
  for (let i = 0; i <= 2 * steps && multiple(first + i) <= hi + 1e-9 * step; ++i)
    result.push(multiple(first + i) || 0);
  return result;
}

/// The label of a tick: short, but distinct from those of its neighbours, `step` away. That of pictures, by tick_label()
/// of src/io/image/pictures/legend.h.
export function tickText(value: number, step: number): string {
  const size = Math.max(Math.abs(value), step);
  const short =
    size >= 1e6 || size < 1e-4
      ? value.toExponential(
          Math.min(15, Math.max(0, Math.floor(Math.log10(size)) - Math.floor(Math.log10(step)))),
        )
      : value.toFixed(Math.min(15, Math.max(0, -Math.floor(Math.log10(step) + 1e-9))));
  return asPrinted(short);
}

/// A number with four significant digits, as value_label() of that file.
export function valueLabel(value: number): string {
  if (value === 0) return '0';
  const scientific = value.toExponential(3);
  const exponent = Number(scientific.split('e')[1]);
  return asPrinted(trimmed(exponent < -4 || exponent >= 4 ? scientific : value.toFixed(3 - exponent)));
}

/// As C++ prints it, with a minus sign: exponents have a sign and two digits.
function asPrinted(number: string): string {
  return number.replace(/^-/, kMinus).replace(/e([+-])(\d)$/, 'e$10$2');
}
