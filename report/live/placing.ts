// Where bodies are: matrices of motions, in the units of the files.
import { Matrix4, Vector3 } from 'three';

/// Positions moved by a matrix.
export function moved(positions: Float64Array, matrix: Matrix4): Float64Array {
  if (isIdentity(matrix)) return positions.slice();
  const [a, b, c, , d, e, f, , g, h, i, , x, y, z] = matrix.elements;
  const result = new Float64Array(positions.length);
  for (let v = 0; v < positions.length; v += 3) {
    const [px, py, pz] = [positions[v], positions[v + 1], positions[v + 2]];
    result[v] = a * px + d * py + g * pz + x;
    result[v + 1] = b * px + e * py + h * pz + y;
    result[v + 2] = c * px + f * py + i * pz + z;
  }
  return result;
}

/// A motion of the scene in the units of the files: its translation is that of the middle of the scene.
export function inFile(
  motion: Matrix4,
  { centre, size }: { centre: [number, number, number]; size: number },
): Matrix4 {
  const toFile = new Matrix4().makeTranslation(...centre).scale(new Vector3(size, size, size));
  return toFile.clone().multiply(motion).multiply(toFile.clone().invert());
}

export function isIdentity({ elements }: Matrix4): boolean {
  return new Matrix4().elements.every((x, i) => Math.abs(x - elements[i]) < 1e-12);
}
