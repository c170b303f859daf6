// Copies with few triangles, for pictures while something moves.
import { BufferAttribute, BufferGeometry } from 'three';

const kCells = 96; // along the diagonal, at most

// Cells of a grid that the vertices are in.
function cellsOf(position: ArrayLike<number>, cells: number): Float64Array {
  const lo = [Infinity, Infinity, Infinity];
  const hi = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < position.length; ++i) {
    const k = i % 3;
    if (position[i] < lo[k]) lo[k] = position[i];
    if (position[i] > hi[k]) hi[k] = position[i];
  }
  const size = Math.hypot(...lo.map((x, k) => hi[k] - x)) / cells || 1;
  const result = new Float64Array(position.length / 3);
  for (let v = 0; v < result.length; ++v)
    for (let k = 0; k < 3; ++k)
      result[v] = result[v] * 128 + Math.floor((position[3 * v + k] - lo[k]) / size);
  return result;
}

// Which vertex stands for each: the first of those in its cell, and in its cell with about its normal.
function representatives(cell: Float64Array, normal: ArrayLike<number> | null) {
  const place = new Uint32Array(cell.length); // that of the position: the same for all of a cell, so that nothing gapes
  const like = new Uint32Array(cell.length); // that of the other attributes: both sides of a thin wall keep their values
  const ofCell = new Map<number, number>();
  const ofSide = new Map<number, number>();
  const first = (map: Map<number, number>, key: number, v: number) => {
    const known = map.get(key);
    if (known !== undefined) return known;
    map.set(key, v);
    return v;
  };
  for (let v = 0; v < cell.length; ++v) {
    let side = 0;
    if (normal) for (let k = 0; k < 3; ++k) side = 2 * side + (normal[3 * v + k] < 0 ? 1 : 0);
    place[v] = first(ofCell, cell[v], v);
    like[v] = first(ofSide, cell[v] * 8 + side, v);
  }
  return { place, like };
}

function copied(geometry: BufferGeometry, cells: number): BufferGeometry {
  const position = geometry.getAttribute('position').array;
  const triangle = geometry.getIndex()!.array;
  const { place, like } = representatives(
    cellsOf(position, cells),
    geometry.getAttribute('normal')?.array ?? null,
  );
  const groups =
    geometry.groups.length > 0 ? geometry.groups : [{ start: 0, count: triangle.length, materialIndex: 0 }];
  const copy = new BufferGeometry();
  const used: number[] = []; // vertices of the geometry, one for each of the copy
  const number = new Map<number, number>();
  const corners: number[] = [];
  for (const { start, count, materialIndex } of groups) {
    const first = corners.length;
    for (let i = start; i < start + count; i += 3) {
      const [a, b, c] = [triangle[i], triangle[i + 1], triangle[i + 2]];
      if (place[a] === place[b] || place[b] === place[c] || place[c] === place[a]) continue;
      for (const corner of [a, b, c]) {
        let n = number.get(like[corner]);
        if (n === undefined) {
          n = used.push(like[corner]) - 1;
          number.set(like[corner], n);
        }
        corners.push(n);
      }
    }
    copy.addGroup(first, corners.length - first, materialIndex);
  }
  for (const [name, { array, itemSize, normalized }] of Object.entries(geometry.attributes)) {
    const values = new (array.constructor as Float32ArrayConstructor)(used.length * itemSize);
    used.forEach((v, n) => {
      const from = name === 'position' ? place[v] : v;
      for (let k = 0; k < itemSize; ++k) values[n * itemSize + k] = array[from * itemSize + k];
    });
    copy.setAttribute(name, new BufferAttribute(values, itemSize, normalized));
  }
  copy.setIndex(new BufferAttribute(Uint32Array.from(corners), 1));
  return copy;
}

/// A copy with at most `most` triangles, whose vertices are some of those of the geometry; itself if it has no more.
/// Cost: linear; some 0.1 s for 300,000 triangles.
export function coarseCopy(geometry: BufferGeometry, most: number): BufferGeometry {
  const triangles = (g: BufferGeometry) => g.getIndex()!.count / 3;
  if (triangles(geometry) <= most) return geometry;
  let cells = kCells;
  let copy = copied(geometry, cells);
  while (triangles(copy) > most && cells > 4) {
    cells *= Math.max(0.5, 0.95 * Math.sqrt(most / triangles(copy)));
    copy = copied(geometry, cells);
  }
  return copy;
}

/// A mesh that is drawn by a coarse copy while something moves. The copy is made when it is first needed, and again
/// after the geometry has other triangles.
export class CoarseWhileMoving {
  private of: BufferAttribute | null = null; // the index that the copy is of
  private copy: BufferGeometry | null = null;
  private readonly fine: BufferGeometry;

  constructor(
    private readonly mesh: { geometry: BufferGeometry },
    private readonly most: number,
  ) {
    this.fine = mesh.geometry;
  }

  /// Makes the copy again when it is next needed: other vertices or values.
  forget(): void {
    this.of = null;
  }

  show(coarse: boolean): void {
    if (!coarse) {
      this.mesh.geometry = this.fine;
      return;
    }
    const index = this.fine.getIndex();
    if (!index) return;
    if (this.of !== index) [this.copy, this.of] = [coarseCopy(this.fine, this.most), index];
    this.mesh.geometry = this.copy!;
  }
}
