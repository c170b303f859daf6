// The letters E and G, which approach each other, bend and part again.
import type { SdmWorker } from 'sdm';
import letterE from '../../scenes/meshes/letter_e.ply';
import letterG from '../../scenes/meshes/letter_g.ply';
import { type Scene } from './scene';
import { kTimeStep } from './body';

const kPeriod = 4; // seconds
const kApart = 0.75; // of the middle of each letter from that of both
const kWay = 0.3; // that each of them goes

/// Upright, seen from −y, turned about the vertical axis by degrees.
function upright(positions: Float64Array, degrees: number): Float64Array {
  const [c, s] = [Math.cos((degrees * Math.PI) / 180), Math.sin((degrees * Math.PI) / 180)];
  const result = new Float64Array(positions.length);
  for (let i = 0; i < positions.length; i += 3) {
    const [x, y, z] = [positions[i], -positions[i + 2], positions[i + 1]];
    result.set([c * x - s * y, s * x + c * y, z], i);
  }
  return result;
}

/// A letter at rest as it is when it is `near` the other one, 0 to 1: at `middle`, twisted about the vertical axis, leaning
/// away by its upper end and flattened.
function bent(
  rest: Float64Array,
  middle: number,
  near: number,
  swing: number,
  out: Float64Array,
): Float64Array {
  const away = Math.sign(middle);
  for (let i = 0; i < rest.length; i += 3) {
    const [x, y, z] = [rest[i], rest[i + 1], rest[i + 2]];
    const angle = 0.5 * swing * z;
    const [c, s] = [Math.cos(angle), Math.sin(angle)];
    const flat = 1 - 0.18 * near;
    out[i] = middle + flat * (c * x - s * y) + away * 0.25 * near * z * z;
    out[i + 1] = s * x + c * y;
    out[i + 2] = z * (1 + 0.08 * near) + 0.05 * swing;
  }
  return out;
}

export async function letters(worker: SdmWorker): Promise<Scene> {
  const [e, g] = await Promise.all([
    worker.readMesh(letterE, 'letter_e.ply'),
    worker.readMesh(letterG, 'letter_g.ply'),
  ]);
  const rest = [upright(e.positions, 0), upright(g.positions, 20)];
  let time = 0;
  const at = (): [Float64Array, Float64Array] => {
    const phase = (2 * Math.PI * time) / kPeriod;
    const near = (1 - Math.cos(phase)) / 2;
    const place = (which: number) => (which === 0 ? -1 : 1) * (kApart - kWay * near);
    return [0, 1].map((which) =>
      bent(rest[which], place(which), near, Math.sin(phase), new Float64Array(rest[which].length)),
    ) as [Float64Array, Float64Array];
  };
  const [first, second] = at();
  return {
    title: 'Letters E and G',
    words: 'Two letters approach each other, bend and part again.',
    bodies: [
      { name: 'E', positions: first, indices: e.indices },
      { name: 'G', positions: second, indices: g.indices },
    ],
    units: '',
    advance: () => {
      time += kTimeStep;
      return at();
    },
  };
}
