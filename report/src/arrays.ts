// Unpacks the arrays of src/io/page/report/packed_arrays.h.

export interface ArrayIndex {
  [name: string]: { count: number; bytes: number[] };
}

export type Arrays = Map<string, Uint32Array>;

export function bytesOfBase64(text: string): Uint8Array<ArrayBuffer> {
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

async function inflated(bytes: Uint8Array<ArrayBuffer>): Promise<Uint8Array> {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate-raw'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

export async function unpacked(index: ArrayIndex, text: string): Promise<Arrays> {
  const all = bytesOfBase64(text.trim());
  const arrays: Arrays = new Map();
  const work: Promise<void>[] = [];
  let at = 0;
  for (const [name, { count, bytes }] of Object.entries(index)) {
    const numbers = new Uint32Array(count);
    arrays.set(name, numbers);
    bytes.forEach((length, plane) => {
      if (length === 0) return;
      const part = all.subarray(at, at + length);
      at += length;
      work.push(
        inflated(part).then((values) => {
          const shift = 8 * plane;
          for (let i = 0; i < count; ++i) numbers[i] |= values[i] << shift;
        }),
      );
    });
  }
  await Promise.all(work);
  return arrays;
}

/// The signed difference that a number stands for.
export function unzigzag(x: number): number {
  return (x >>> 1) ^ -(x & 1);
}

/// Sums up differences, in place: number i is its difference plus number i − stride.
export function summed(numbers: Uint32Array, stride = 1): Uint32Array {
  for (let i = 0; i < numbers.length; ++i)
    numbers[i] = unzigzag(numbers[i]) + (i < stride ? 0 : numbers[i - stride]);
  return numbers;
}

const kBits = new Uint32Array(1);
const kFloat = new Float32Array(kBits.buffer);

/// Numbers in the order of floats, as these floats; NaN for 0xFFFFFFFF.
export function floatsOfOrdered(numbers: Uint32Array): Float32Array {
  const bits = new Uint32Array(numbers.length);
  for (let i = 0; i < numbers.length; ++i) {
    const x = numbers[i];
    bits[i] = x === 0xffffffff ? 0x7fc00000 : x & 0x80000000 ? x ^ 0x80000000 : ~x;
  }
  return new Float32Array(bits.buffer);
}

export function floatOfKey(key: number): number {
  const x = (key << 16) >>> 0;
  kBits[0] = x & 0x80000000 ? x ^ 0x80000000 : ~x;
  return kFloat[0];
}

/// Vertex numbers of corners, from how many vertices each was before the first one not yet used.
export function cornersOfCodes(codes: Uint32Array): Uint32Array {
  let next = 0;
  for (let i = 0; i < codes.length; ++i) {
    const code = codes[i];
    codes[i] = next - code;
    if (code === 0) ++next;
  }
  return codes;
}
