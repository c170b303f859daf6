// A cloth that falls on a ball: M. Macklin, M. Müller and N. Chentanez, "XPBD: Position-Based Simulation of Compliant
// Constrained Dynamics" (2016).
import { type Scene } from './scene';
import { kTimeStep } from './body';

const kSide = 64; // vertices
const kSteps = 8; // in a frame
const kRadius = 0.3; // of the ball, whose middle is the origin
const kThickness = 0.012; // that the cloth keeps from the ball
const kFloor = -0.45;
const kFriction = 0.25;
const kSeconds = 5; // after which it starts again

function sheet(): { positions: Float64Array; indices: Uint32Array } {
  const positions = new Float64Array(3 * kSide * kSide);
  const indices: number[] = [];
  for (let y = 0; y < kSide; ++y)
    for (let x = 0; x < kSide; ++x) {
      const [u, v] = [x / (kSide - 1) - 0.5, y / (kSide - 1) - 0.5];
      // Turned, so that the folds differ, and beside the middle of the ball.
      positions.set(
        [0.92 * u - 0.39 * v + 0.05, 0.39 * u + 0.92 * v + 0.02, 0.36 + 0.05 * u],
        3 * (y * kSide + x),
      );
      if (x + 1 === kSide || y + 1 === kSide) continue;
      const a = y * kSide + x;
      const [b, c, d] = [a + 1, a + kSide + 1, a + kSide];
      indices.push(...((x + y) % 2 ? [a, b, d, b, c, d] : [a, b, c, a, c, d]));
    }
  return { positions, indices: Uint32Array.from(indices) };
}

/// An octahedron divided four times into smaller triangles, on a sphere.
function ball(): { positions: Float64Array; indices: Uint32Array } {
  const points: number[][] = [
    [1, 0, 0],
    [-1, 0, 0],
    [0, 1, 0],
    [0, -1, 0],
    [0, 0, 1],
    [0, 0, -1],
  ];
  let faces: number[][] = [
    [0, 2, 4],
    [2, 1, 4],
    [1, 3, 4],
    [3, 0, 4],
    [2, 0, 5],
    [1, 2, 5],
    [3, 1, 5],
    [0, 3, 5],
  ];
  for (let level = 0; level < 5; ++level) {
    const middles = new Map<string, number>();
    const middle = (a: number, b: number) => {
      const key = a < b ? `${a},${b}` : `${b},${a}`;
      let number = middles.get(key);
      if (number === undefined) {
        const sum = points[a].map((x, k) => x + points[b][k]);
        number = points.push(sum.map((x) => x / Math.hypot(...sum))) - 1;
        middles.set(key, number);
      }
      return number;
    };
    faces = faces.flatMap(([a, b, c]) => {
      const [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
      return [
        [a, ab, ca],
        [ab, b, bc],
        [ca, bc, c],
        [ab, bc, ca],
      ];
    });
  }
  return {
    positions: Float64Array.from(points.flat(), (x) => kRadius * x),
    indices: Uint32Array.from(faces.flat()),
  };
}

/// Pairs of vertices: along rows, columns and diagonals, and of every second one against bending.
function springsOf(): Uint32Array {
  const springs: number[] = [];
  for (const [dx, dy] of [
    [1, 0],
    [0, 1],
    [1, 1],
    [1, -1],
    [2, 0],
    [0, 2],
  ])
    for (let y = 0; y < kSide; ++y)
      for (let x = 0; x < kSide; ++x)
        if (x + dx < kSide && y + dy < kSide && y + dy >= 0)
          springs.push(y * kSide + x, (y + dy) * kSide + x + dx);
  return Uint32Array.from(springs);
}

class Cloth {
  private position: Float64Array;
  private previous: Float64Array;
  private readonly springs = springsOf();
  private readonly lengths: Float64Array;

  constructor(private readonly rest: Float64Array) {
    this.position = rest.slice();
    this.previous = rest.slice();
    this.lengths = new Float64Array(this.springs.length / 2);
    for (let s = 0; s < this.lengths.length; ++s) {
      const [a, b] = [3 * this.springs[2 * s], 3 * this.springs[2 * s + 1]];
      this.lengths[s] = Math.hypot(rest[b] - rest[a], rest[b + 1] - rest[a + 1], rest[b + 2] - rest[a + 2]);
    }
  }

  restart(): void {
    this.position.set(this.rest);
    this.previous.set(this.rest);
  }

  advance(): Float64Array {
    for (let step = 0; step < kSteps; ++step) this.step(kTimeStep / kSteps);
    return this.position.slice();
  }

  private step(dt: number): void {
    const { position: p, previous: q } = this;
    for (let i = 0; i < p.length; ++i) {
      const speed = (0.9995 * (p[i] - q[i])) / dt - (i % 3 === 2 ? 9.81 * dt : 0);
      q[i] = p[i];
      p[i] += speed * dt;
    }
    this.pull(dt);
    for (let i = 0; i < p.length; i += 3) this.push(i);
  }

  private pull(dt: number): void {
    const { position: p, springs, lengths } = this;
    const soft = 2e-7 / (dt * dt); // of what resists bending and shear
    const firm = 2 * (kSide - 1) * kSide;
    for (let s = 0; s < lengths.length; ++s) {
      const [a, b] = [3 * springs[2 * s], 3 * springs[2 * s + 1]];
      const [x, y, z] = [p[b] - p[a], p[b + 1] - p[a + 1], p[b + 2] - p[a + 2]];
      const length = Math.sqrt(x * x + y * y + z * z) || 1;
      const shift = (length - lengths[s]) / length / (2 + (s < firm ? 0 : soft));
      p[a] += shift * x;
      p[a + 1] += shift * y;
      p[a + 2] += shift * z;
      p[b] -= shift * x;
      p[b + 1] -= shift * y;
      p[b + 2] -= shift * z;
    }
  }

  // Out of the ball and the floor, which take away part of the motion along them.
  private push(i: number): void {
    const { position: p, previous: q } = this;
    const away = Math.sqrt(p[i] * p[i] + p[i + 1] * p[i + 1] + p[i + 2] * p[i + 2]);
    const touches = away < kRadius + kThickness;
    const out = touches ? (kRadius + kThickness) / away : 1;
    if (touches) for (let k = 0; k < 3; ++k) p[i + k] *= out;
    const lies = p[i + 2] < kFloor;
    if (lies) p[i + 2] = kFloor;
    if (touches || lies) for (let k = 0; k < 3; ++k) p[i + k] -= kFriction * (p[i + k] - q[i + k]);
  }
}

export function clothOnBall(): Scene {
  const cloth = sheet();
  const solid = ball();
  const simulation = new Cloth(cloth.positions);
  let frame = 0;
  return {
    title: 'Cloth on a ball',
    words: 'A cloth falls on a ball and over its side.',
    bodies: [
      { name: 'cloth', ...cloth, positions: cloth.positions.slice() },
      { name: 'ball', ...solid },
    ],
    units: 'm',
    advance: () => {
      if (++frame > kSeconds / kTimeStep) {
        simulation.restart();
        frame = 0;
      }
      return [simulation.advance(), solid.positions];
    },
  };
}
