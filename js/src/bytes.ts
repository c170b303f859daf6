// Results of the module, as typed arrays and text, and words as numbers.
import { SdmError } from './types.js';

export type Bytes = Uint8Array<ArrayBuffer>;
export const float64 = (bytes: Bytes) => new Float64Array(bytes.buffer);
export const float32 = (bytes: Bytes) => new Float32Array(bytes.buffer);
export const uint32 = (bytes: Bytes) => new Uint32Array(bytes.buffer);
export const text = (bytes: Bytes) => new TextDecoder().decode(bytes);

/** The fields of a result by their names, in camel case. */
export function fields(names: Bytes, numbers: Bytes): Record<string, number> {
  const camel = (name: string) => name.replace(/_(.)/g, (_, letter: string) => letter.toUpperCase());
  const values = float64(numbers);
  return Object.fromEntries(
    text(names)
      .split(' ')
      .map((name, i) => [camel(name), values[i]!]),
  );
}

/** The number of a word among those that an option may have. */
export function wordNumber(words: readonly string[], word: string, option: string): number {
  const number = words.indexOf(word);
  if (number < 0)
    throw new SdmError(
      'input',
      `${option} is ${JSON.stringify(word)}: it must be one of ${words.join(', ')}`,
    );
  return number;
}
