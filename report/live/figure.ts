// A figure, 1 m high, that walks on the spot in a box: the surface around its muscles, which move with their bones.
import { surfaceNet } from './surface_net';
import type { Scene } from './scene';

type Point = [number, number, number];
type Matrix = [Point, Point, Point];

const kBlend = 0.014; // width over which muscles are blended
const kSpacing = 0.0125; // of the grid on which the surface is found
const kFramesPerStride = 66;

interface Bone {
  parent: number;
  joint: Point;
}
interface Muscle {
  bone: number;
  from: Point;
  to: Point;
  radii: [number, number];
}

// Bones: hips, chest, head; then of each side thigh, shin, upper arm and forearm.
const kBonesOfSide = 4;
function skeleton(): { bones: Bone[]; muscles: Muscle[] } {
  const bones: Bone[] = [
    { parent: 0, joint: [0, 0, 0.53] },
    { parent: 0, joint: [0, 0, 0.6] },
    { parent: 1, joint: [0, 0.005, 0.83] },
  ];
  const muscles: Muscle[] = [
    { bone: 1, from: [0, 0.005, 0.82], to: [0, 0, 0.88], radii: [0.035, 0.036] },
    { bone: 2, from: [0, -0.005, 0.91], to: [0, -0.01, 0.945], radii: [0.054, 0.057] },
  ];
  for (const side of [1, -1]) {
    const at = (x: number, y: number, z: number): Point => [side * x, y, z];
    const first = side > 0 ? 3 : 3 + kBonesOfSide;
    bones.push({ parent: 0, joint: at(0.05, 0, 0.5) }, { parent: first, joint: at(0.062, 0, 0.275) });
    bones.push(
      { parent: 1, joint: at(0.115, 0.005, 0.79) },
      { parent: first + 2, joint: at(0.18, 0.01, 0.645) },
    );
    const add = (bone: number, from: Point, to: Point, radii: [number, number]) =>
      muscles.push({ bone, from, to, radii });
    add(0, at(0.035, 0, 0.515), at(0.03, 0, 0.59), [0.06, 0.055]);
    add(1, at(0.03, 0, 0.62), at(0.05, 0.003, 0.74), [0.055, 0.06]);
    add(1, at(0.06, 0.005, 0.785), at(0.105, 0.005, 0.79), [0.042, 0.036]);
    add(first, at(0.05, 0, 0.48), at(0.062, 0, 0.295), [0.058, 0.038]);
    add(first + 1, at(0.063, 0.004, 0.265), at(0.07, 0.01, 0.06), [0.037, 0.024]);
    add(first + 1, at(0.071, 0.015, 0.03), at(0.08, -0.075, 0.022), [0.025, 0.02]);
    add(first + 2, at(0.122, 0.005, 0.775), at(0.176, 0.01, 0.66), [0.034, 0.027]);
    add(first + 3, at(0.183, 0.01, 0.635), at(0.232, 0, 0.525), [0.028, 0.021]);
    add(first + 3, at(0.238, -0.002, 0.5), at(0.255, -0.01, 0.45), [0.022, 0.018]);
  }
  return { bones, muscles };
}

function distanceTo({ from: a, to: b, radii }: Muscle, x: number, y: number, z: number): number {
  const [ux, uy, uz] = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
  const [px, py, pz] = [x - a[0], y - a[1], z - a[2]];
  const t = Math.min(1, Math.max(0, (px * ux + py * uy + pz * uz) / (ux * ux + uy * uy + uz * uz)));
  const [dx, dy, dz] = [px - t * ux, py - t * uy, pz - t * uz];
  return Math.sqrt(dx * dx + dy * dy + dz * dz) - ((1 - t) * radii[0] + t * radii[1]);
}

/// The shares of the bones in a point, by the distances of their muscles.
function shares(muscles: Muscle[], bones: number, at: ArrayLike<number>, i: number): Float64Array {
  const distances = muscles.map((muscle) => distanceTo(muscle, at[i], at[i + 1], at[i + 2]));
  const least = Math.min(...distances);
  const result = new Float64Array(bones);
  distances.forEach((d, m) => (result[muscles[m].bone] += Math.exp((least - d) / kBlend)));
  const sum = result.reduce((a, b) => a + b);
  return result.map((x) => x / sum);
}

/// The smooth minimum −k log Σ exp(−d/k) of the distances of the muscles.
function skinDistance(muscles: Muscle[], x: number, y: number, z: number): number {
  let least = Infinity;
  const distances = muscles.map((muscle) => distanceTo(muscle, x, y, z));
  for (const d of distances) least = Math.min(least, d);
  if (least > 4 * kBlend || least < -4 * kBlend) return least;
  let sum = 0;
  for (const d of distances) sum += Math.exp((least - d) / kBlend);
  return least - kBlend * Math.log(sum);
}

function about(axis: 0 | 1 | 2, angle: number): Matrix {
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  if (axis === 0)
    return [
      [1, 0, 0],
      [0, c, -s],
      [0, s, c],
    ];
  return axis === 1
    ? [
        [c, 0, s],
        [0, 1, 0],
        [-s, 0, c],
      ]
    : [
        [c, -s, 0],
        [s, c, 0],
        [0, 0, 1],
      ];
}
const times = (m: Matrix, p: Point): Point =>
  m.map((row) => row[0] * p[0] + row[1] * p[1] + row[2] * p[2]) as Point;
const product = (a: Matrix, b: Matrix): Matrix =>
  a.map((row) => [0, 1, 2].map((k) => row[0] * b[0][k] + row[1] * b[1][k] + row[2] * b[2][k])) as Matrix;

/// The rotations of the bones: legs and arms swing in opposition, and the chest turns against the hips.
function stride(phase: number): Matrix[] {
  const swing = (angle: number) => about(0, angle);
  const sides = [phase, phase + Math.PI].flatMap((at) => [
    swing(-0.12 - 0.45 * Math.sin(at)),
    swing(0.2 + 0.225 * (1 + Math.cos(at)) ** 2),
    swing(0.1 + 0.5 * Math.sin(at)),
    swing(-0.5 + 0.25 * Math.sin(at)),
  ]);
  return [
    about(2, 0.08 * Math.sin(phase)),
    product(about(2, -0.22 * Math.sin(phase)), swing(0.05)),
    about(2, 0.14 * Math.sin(phase)),
    ...sides,
  ];
}

/// Where the vertices are when the bones are turned.
function moved(
  rest: Float64Array,
  weights: Float64Array[],
  bones: Bone[],
  rotations: Matrix[],
): Float64Array {
  const turns: Matrix[] = [];
  const shifts: Point[] = [];
  bones.forEach(({ parent, joint }, b) => {
    const turned = times(rotations[b], joint);
    const own = joint.map((x, k) => x - turned[k]) as Point;
    turns[b] = b === 0 ? rotations[b] : product(turns[parent], rotations[b]);
    shifts[b] = b === 0 ? own : (times(turns[parent], own).map((x, k) => x + shifts[parent][k]) as Point);
  });
  const result = new Float64Array(rest.length);
  weights.forEach((ofVertex, v) => {
    const [x, y, z] = [rest[3 * v], rest[3 * v + 1], rest[3 * v + 2]];
    for (let b = 0; b < ofVertex.length; ++b) {
      const w = ofVertex[b];
      if (w < 1e-6) continue;
      for (let k = 0; k < 3; ++k)
        result[3 * v + k] +=
          w * (turns[b][k][0] * x + turns[b][k][1] * y + turns[b][k][2] * z + shifts[b][k]);
    }
  });
  return result;
}

function box(lo: Point, hi: Point) {
  const positions = Float64Array.from(
    Array.from({ length: 8 }, (_, corner) =>
      [0, 1, 2].map((k) => (corner & (1 << k) ? hi[k] : lo[k])),
    ).flat(),
  );
  const indices = Uint32Array.of(
    0,
    2,
    3,
    0,
    3,
    1,
    4,
    5,
    7,
    4,
    7,
    6,
    0,
    1,
    5,
    0,
    5,
    4,
    2,
    6,
    7,
    2,
    7,
    3,
    0,
    4,
    6,
    0,
    6,
    2,
    1,
    3,
    7,
    1,
    7,
    5,
  );
  return { positions, indices };
}

export function figureInBox(): Scene {
  const { bones, muscles } = skeleton();
  const { positions: rest, indices } = surfaceNet(
    (x, y, z) => skinDistance(muscles, x, y, z),
    [-0.36, -0.16, -0.06],
    [0.36, 0.16, 1.08],
    kSpacing,
  );
  const weights = Array.from({ length: rest.length / 3 }, (_, v) =>
    shares(muscles, bones.length, rest, 3 * v),
  );
  const reference = box([-0.5, -0.5, -0.15], [0.5, 0.5, 1.15]);
  let frame = 0;
  const at = () => moved(rest, weights, bones, stride((2 * Math.PI * frame) / kFramesPerStride));
  return {
    title: 'Figure in a box',
    words: 'A figure walks on the spot in a box; inside of the box, distances are negative.',
    bodies: [
      { name: 'figure', positions: at(), indices },
      { name: 'box', ...reference },
    ],
    units: 'm',
    advance: () => {
      ++frame;
      return [at(), reference.positions];
    },
  };
}
