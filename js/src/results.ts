// Results of the module (module/result.h), by the names that C++ gives their values.
import { type Bytes, text } from './bytes.js';

const kArrays = {
  f64: Float64Array,
  f32: Float32Array,
  u64: BigUint64Array,
  u32: Uint32Array,
  u8: Uint8Array,
} as const;

/** The next numbers, as arrays of these sizes in each other: "2x3" are two points. */
function nested(sizes: string, next: () => number): unknown {
  const [count, inner] = sizes.split(/x(.*)/s);
  return Array.from({ length: Number(count) }, () => (inner ? nested(inner, next) : next()));
}

const camel = (name: string) => name.replace(/_(.)/g, (_, letter: string) => letter.toUpperCase());

/** Puts a value to the end of a path of names, between which a number leads into a list. */
function put(into: Record<string, any>, path: string, value: unknown): void {
  const names = path.split('/').map(camel);
  const last = names.pop()!;
  names.forEach((name, i) => {
    into = into[name] ??= /^\d/.test(names[i + 1] ?? last) ? [] : {};
  });
  into[last] = value;
}

/** `lines`: of each value its name, a blank, and how it is read: from the words after "=", the next numbers or the next array. */
export function readResult(
  lines: string,
  numbers: Float64Array,
  array: (index: number) => Bytes,
): Record<string, unknown> {
  const result = {};
  let number = 0;
  let arrays = 0;
  const next = () => numbers[number++]!;
  const read = (kind: string): unknown => {
    if (kind.startsWith('=')) return kind.slice(1);
    if (kind === 'number') return next();
    if (kind === 'flag') return next() !== 0;
    if (kind === 'null') return null;
    if (kind === 'text') return text(array(arrays++));
    if (kind in kArrays) return new kArrays[kind as keyof typeof kArrays](array(arrays++).buffer);
    return nested(kind, next);
  };
  for (const line of lines.split('\n').slice(0, -1)) {
    const blank = line.indexOf(' ');
    put(result, line.slice(0, blank), read(line.slice(blank + 1)));
  }
  return result;
}
