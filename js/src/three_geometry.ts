// Geometries of three.js, as arrays and with the texture coordinates of an atlas.
import { BufferAttribute, type BufferGeometry } from 'three';
import { type Atlas } from './surface.js';
import { SdmError } from './types.js';

/**
 * The positions and indices of a geometry, as surface(), sites() and their constructors take them: `...fromBufferGeometry(geometry)`.
 * Vertices stay apart where normals or texture coordinates differ, so that the mesh is open there: for signs, merge them first by
 * `mergeVertices` of three.js, without these attributes.
 */
export function fromBufferGeometry(
  geometry: BufferGeometry,
): [positions: Float64Array, indices: Uint32Array] {
  const position = geometry.getAttribute('position');
  if (!position) throw new SdmError('input', 'the geometry has no positions');
  const positions = new Float64Array(3 * position.count);
  for (let i = 0; i < position.count; ++i)
    positions.set([position.getX(i), position.getY(i), position.getZ(i)], 3 * i);
  const { index } = geometry;
  const count = index?.count ?? position.count;
  return [
    positions,
    Uint32Array.from({ length: count - (count % 3) }, (_, i) => (index ? index.getX(i) : i)),
  ];
}

/**
 * A copy of a geometry whose texture coordinates are those of an atlas, for DistanceMaterial: every corner is a vertex, as the faces of
 * different charts do not share texture coordinates.
 */
export function withAtlas(geometry: BufferGeometry, atlas: Atlas): BufferGeometry {
  const copy = geometry.index ? geometry.toNonIndexed() : geometry.clone();
  const corners = atlas.corners.length / 2;
  const { count } = copy.getAttribute('position');
  if (count - (count % 3) !== corners) throw new SdmError('input', 'the atlas is of another geometry');
  const uvs = new Float32Array(2 * count);
  for (let i = 0; i < corners; ++i) {
    // NaN, of faces without area, would be an error of some drivers.
    uvs[2 * i] = (atlas.corners[2 * i]! || 0) / atlas.resolution;
    uvs[2 * i + 1] = (atlas.corners[2 * i + 1]! || 0) / atlas.rows;
  }
  copy.setAttribute('uv', new BufferAttribute(uvs, 2));
  if (!copy.getAttribute('normal')) copy.computeVertexNormals();
  return copy;
}
