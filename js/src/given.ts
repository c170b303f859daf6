// What callers have given: in words, and as the module reads options (module/options.h).

export function shown(value: unknown): string {
  if (typeof value === 'string') return JSON.stringify(value.length > 40 ? `${value.slice(0, 40)}…` : value);
  if (typeof value === 'function') return 'a function';
  if (typeof value !== 'object' || value === null) return String(value);
  const name = (value as object).constructor?.name ?? 'Object';
  if (name === 'Object') return 'an object';
  return name.endsWith('s') ? name : `${/^[AEIOU]/.test(name) ? 'an' : 'a'} ${name}`;
}

// More numbers than an option may be are named, not written out.
const kMostNumbers = 1000;
const areNumbers = (value: unknown): value is ArrayLike<number> => {
  if (!Array.isArray(value) && !ArrayBuffer.isView(value)) return false;
  const { length } = value as unknown as ArrayLike<unknown>;
  return (
    length > 0 &&
    length <= kMostNumbers &&
    Array.from(value as unknown as ArrayLike<unknown>).every((one) => typeof one === 'number')
  );
};
/** A string is whole, however long, but without ends of lines, which divide the options. */
function worded(value: unknown): string {
  if (typeof value === 'string') return `"${value.replace(/\n/g, ' ')}"`;
  return areNumbers(value) ? Array.from(value).join() : shown(value);
}

/** Options that C++ declares, all but progress: their names with their values in words, and the numbers. */
export function declaredOptions(given: object): [string, Float64Array] {
  const entries = Object.entries(given).filter(
    ([name, value]) => value !== undefined && value !== null && name !== 'progress',
  );
  const lines = entries.map(([name, value]) => `${name.replace(/[=\n]/g, ' ')}=${worded(value)}\n`);
  const numbers = entries.map(([, value]) => (typeof value === 'number' ? value : Number.NaN));
  return [lines.join(''), Float64Array.from(numbers)];
}
