// Unpacks the arrays of src/io/page/report/packed_arrays.h.

export interface ArrayIndex {
  [name: string]: { count: number; bytes: number[] };
}

export type Arrays = Map<string, Uint32Array>;

/// The bytes of base85() of packed_arrays.h, with zeros up to a multiple of four.
export function bytesOfBase85(text: string): Uint8Array<ArrayBuffer> {
  const bytes = new Uint8Array((text.length / 5) * 4);
  const view = new DataView(bytes.buffer);
  for (let i = 0, at = 0; i < text.length; i += 5, at += 4) {
    let group = 0;
    for (let k = 0; k < 5; ++k) {
      const code = text.charCodeAt(i + k);
      group = group * 85 + code - (code > 60 ? 36 : 35);
    }
    view.setUint32(at, group);
  }
  return bytes;
}

/// What was packed by deflate without a header.
export async function inflated(bytes: Uint8Array<ArrayBuffer>): Promise<Uint8Array> {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate-raw'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

export async function unpacked(index: ArrayIndex, text: string): Promise<Arrays> {
  const all = bytesOfBase85(text.trim());
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

/// The upper 16 bits of a number in the order of floats, and the least float that has them.
export function keyOfFloat(value: number): number {
  kFloat[0] = value;
  return (kBits[0] & 0x80000000 ? ~kBits[0] >>> 0 : (kBits[0] ^ 0x80000000) >>> 0) >>> 16;
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

const kNone = 0xffffffff;

/// The vertices from which the numbers of each one are guessed, three each: guesses_of() of face_walk.h.
export function guessesOf(triangle: Uint32Array): Uint32Array {
  let vertices = 0;
  for (const v of triangle) vertices = Math.max(vertices, v + 1);
  const guesses = new Uint32Array(3 * vertices);
  const last = new Uint32Array(vertices).fill(kNone); // the first corner of the last triangle before this one
  const opposite = (first: number, a: number, b: number): number => {
    let other = kNone;
    let found = 0;
    for (let k = first; k < first + 3; ++k)
      if (triangle[k] === a || triangle[k] === b) ++found;
      else other = triangle[k];
    return found === 2 ? other : kNone;
  };
  let next = 0;
  for (let f = 0; f < triangle.length; f += 3) {
    for (let k = f; k < f + 3; ++k) {
      const v = triangle[k];
      if (v !== next) continue;
      ++next;
      const others = [triangle[f], triangle[f + 1], triangle[f + 2]].filter((u) => u < v);
      let guess = others.length === 0 ? [v - 1, v - 1, v - 1] : [others[0], others[0], others[0]];
      if (others.length === 2)
        for (const u of others) {
          const c = last[u] === kNone ? kNone : opposite(last[u], others[0], others[1]);
          if (c === kNone) continue;
          guess = [others[0], others[1], c];
          break;
        }
      guesses.set(guess, 3 * v); // -1 becomes kNone
    }
    for (let k = f; k < f + 3; ++k) last[triangle[k]] = f;
  }
  return guesses;
}

/// The numbers at vertices, `stride` each, from what is left of them after the guesses, in place.
export function unguessed(numbers: Uint32Array, stride: number, guesses: Uint32Array): Uint32Array {
  for (let i = 0; i < numbers.length; ++i) {
    const k = i % stride;
    const g = 3 * ((i - k) / stride);
    const guess =
      guesses[g] === kNone
        ? 0
        : numbers[guesses[g] * stride + k] +
          numbers[guesses[g + 1] * stride + k] -
          numbers[guesses[g + 2] * stride + k];
    numbers[i] = unzigzag(numbers[i]) + guess;
  }
  return numbers;
}

/// The same of numbers of two bytes, of which each is guessed from that of one vertex.
export function unguessedBytes(numbers: Uint32Array, guesses: Uint32Array): Uint32Array {
  for (let v = 0; v < numbers.length; ++v) {
    const from = guesses[3 * v] === kNone ? 0 : numbers[guesses[3 * v]];
    numbers[v] = ((numbers[v] + from) & 255) | ((((numbers[v] >> 8) + (from >> 8)) & 255) << 8);
  }
  return numbers;
}
