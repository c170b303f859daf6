// What callers have given: in words, and as the module reads options (module/options.h).

export function shown(value: unknown): string {
  if (typeof value === 'string') return JSON.stringify(value.length > 40 ? `${value.slice(0, 40)}…` : value);
  if (typeof value === 'function') return 'a function';
  if (typeof value !== 'object' || value === null) return String(value);
  const name = (value as object).constructor?.name ?? 'Object';
  if (name === 'Object') return 'an object';
  return name.endsWith('s') ? name : `${/^[AEIOU]/.test(name) ? 'an' : 'a'} ${name}`;
}

/** Options that C++ declares, all but progress: their names with their values in words, how many bytes these are, and the numbers. */
export function declaredOptions(given: object): [Uint8Array, number, Float64Array] {
  const entries = Object.entries(given).filter(
    ([name, value]) => value !== undefined && value !== null && name !== 'progress',
  );
  const lines = entries.map(([name, value]) => `${name.replace(/[=\n]/g, ' ')}=${shown(value)}\n`);
  const bytes = new TextEncoder().encode(lines.join(''));
  const numbers = entries.map(([, value]) => (typeof value === 'number' ? value : Number.NaN));
  return [bytes, bytes.length, Float64Array.from(numbers)];
}
