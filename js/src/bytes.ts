// Bytes of the module as text, and words as numbers.
import { SdmError } from './types.js';

/** Uint8Array<ArrayBuffer>, where TypeScript has it: from 5.7 on. */
export type Bytes = ReturnType<typeof Uint8Array.of>;
export const text = (bytes: Bytes) => new TextDecoder().decode(bytes);

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
