// Modules with threads are the same as those without, but for the type of the memory that they import.
import { type Bytes } from './bytes.js';
import { SdmError } from './types.js';

/** The import `env.memory`: both names with their lengths, and the kind `memory`. The flags of its limits follow. */
const kImport = [3, ...new TextEncoder().encode('env'), 6, ...new TextEncoder().encode('memory'), 2];
/** There is a maximum; and it is shared. */
const [kMaximum, kShared] = [1, 2];

const bytesOf = (file: BufferSource) =>
  ArrayBuffer.isView(file)
    ? new Uint8Array(file.buffer, file.byteOffset, file.byteLength)
    : new Uint8Array(file);

export function isWebAssembly(file: BufferSource): boolean {
  const bytes = bytesOf(file);
  return [0, 0x61, 0x73, 0x6d].every((byte, i) => bytes[i] === byte);
}

/** A module as bytes, with a memory that is shared or not. */
export function withMemory(file: BufferSource, shared: boolean): Bytes {
  const bytes = Uint8Array.from(bytesOf(file));
  const at = bytes.findIndex((_, i) => kImport.every((byte, k) => bytes[i + k] === byte));
  const flags = at + kImport.length;
  if (at < 0 || (bytes[flags]! & ~kShared) !== kMaximum)
    throw new SdmError('input', 'the module is not one of this package');
  bytes[flags] = kMaximum | (shared ? kShared : 0);
  return bytes;
}
