// The model and the texels of a page, of a mesh and its atlas.
import type { Atlas } from 'sdm';
import { AreaByValue } from '../src/area_by_value';
import type { Model, TexelMap, Vec } from '../src/page_data';
import { valueAt } from '../src/pick';
import { boxOf } from '../src/subject';

const kNone = 0xffffffff;
const kCrease = 0.7; // cosine: a vertex is shaded by the faces around it that are less inclined to its own ones

export interface Triangles {
  positions: Float64Array; ///< three a vertex
  indices: Uint32Array; ///< three a triangle
}

/// Whether each edge belongs to two triangles.
export function isClosed({ positions, indices }: Triangles): boolean {
  const vertices = positions.length / 3;
  const edges = Float64Array.from(indices, (v, i) => {
    const next = indices[i % 3 === 2 ? i - 2 : i + 1];
    return Math.min(v, next) * vertices + Math.max(v, next);
  }).sort();
  for (let i = 0; i < edges.length; i += 2)
    if (edges[i] !== edges[i + 1] || edges[i] === edges[i + 2]) return false;
  return edges.length > 0;
}

/// Where a scene is: its centre and the length of its unit, in the units of the files.
export interface Frame {
  centre: Vec;
  size: number;
}

export function frameOf({ positions }: Triangles): Frame {
  const { lo, hi } = boxOf(positions);
  const centre = lo.map((x, k) => (x + hi[k]) / 2) as Vec;
  return { centre, size: Math.hypot(...lo.map((x, k) => hi[k] - x)) / 2 || 1 };
}

/// Positions in units of the scene.
export function inScene(
  positions: Float64Array,
  { centre, size }: Frame,
  out: Float32Array = new Float32Array(positions.length),
): Float32Array {
  for (let i = 0; i < positions.length; ++i) out[i] = (positions[i] - centre[i % 3]) / size;
  return out;
}

/// A mesh cut along the borders of its charts: its vertices have one place in the atlas each.
export interface Layout {
  model: Model;
  map: TexelMap; ///< without distances
  vertexOf: Uint32Array; ///< the vertex of the mesh of each of the model
  texelOf: Int32Array; ///< nearest to each vertex of the model; -1: its charts own none
  areas: Float64Array; ///< of the surface for each texel, 0 without an owner
  texelFaces: Uint32Array; ///< the face that owns each texel
  inAtlas: Float64Array; ///< twice the area of each face in the atlas
}

/// The vertices of the model: a vertex of the mesh once for each place that its corners have.
function split(indices: Uint32Array, corners: Float32Array, vertices: number) {
  const first = new Int32Array(vertices).fill(-1);
  const vertexOf: number[] = [];
  const place: number[] = [];
  const next: number[] = [];
  const triangle = new Uint32Array(indices.length);
  for (let corner = 0; corner < indices.length; ++corner) {
    const v = indices[corner];
    const [x, y] = [corners[2 * corner], corners[2 * corner + 1]].map((c) => (Number.isNaN(c) ? 0 : c));
    let m = first[v];
    while (m >= 0 && (place[2 * m] !== x || place[2 * m + 1] !== y)) m = next[m];
    if (m < 0) {
      m = vertexOf.push(v) - 1;
      place.push(x, y);
      next.push(first[v]);
      first[v] = m;
    }
    triangle[corner] = m;
  }
  return { triangle, vertexOf: Uint32Array.from(vertexOf), place: Float32Array.from(place) };
}

/// 1 + a number for each triangle, the same for those that are connected by vertices of the model.
function chartsOf(triangle: Uint32Array, vertices: number): Uint32Array {
  const parent = Uint32Array.from({ length: vertices }, (_, v) => v);
  const root = (v: number) => {
    while (parent[v] !== v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (let i = 0; i < triangle.length; i += 3)
    for (let k = 1; k < 3; ++k) parent[root(triangle[i + k])] = root(triangle[i]);
  return Uint32Array.from({ length: triangle.length / 3 }, (_, t) => 1 + root(triangle[3 * t]));
}

export function layoutOf(mesh: Triangles, atlas: Atlas, frame: Frame): Layout {
  const { triangle, vertexOf, place } = split(mesh.indices, atlas.corners, mesh.positions.length / 3);
  const chart = chartsOf(triangle, vertexOf.length);
  const model: Model = {
    ...frame,
    position: new Float32Array(3 * vertexOf.length),
    normal: new Int8Array(3 * vertexOf.length),
    distance: new Float32Array(vertexOf.length).fill(Number.NaN),
    triangle,
    place,
    chart,
    names: [],
    trianglesOfMesh: triangle.length / 3,
  };
  const map: TexelMap = {
    width: atlas.resolution,
    height: atlas.rows,
    step: 1,
    chart: Uint32Array.from(atlas.texelFaces, (face) => (face === kNone ? 0 : chart[face])),
    distance: new Float32Array(atlas.texelFaces.length).fill(Number.NaN),
    site: null,
    channels: [],
  };
  const layout: Layout = {
    model,
    map,
    vertexOf,
    texelOf: new Int32Array(vertexOf.length).fill(-1),
    areas: new Float64Array(atlas.texelFaces.length),
    texelFaces: atlas.texelFaces,
    inAtlas: inAtlasOf(atlas.corners),
  };
  findTexels(layout);
  measureTexels(layout, mesh);
  placeVertices(layout, mesh);
  return layout;
}

function findTexels({ model, map, texelOf }: Layout): void {
  const done = new Uint8Array(texelOf.length);
  for (let corner = 0; corner < model.triangle.length; ++corner) {
    const v = model.triangle[corner];
    if (done[v]) continue;
    done[v] = 1;
    const weights: Vec = [0, 0, 0];
    weights[corner % 3] = 1;
    const { texel } = valueAt(model, map, { triangle: Math.floor(corner / 3), weights });
    if (texel) texelOf[v] = texel[1] * map.width + texel[0];
  }
}

/// Twice the area of each face in the atlas.
function inAtlasOf(corners: Float32Array): Float64Array {
  return Float64Array.from({ length: corners.length / 6 }, (_, f) => {
    const at = (k: number) => corners[6 * f + k];
    return Math.abs((at(2) - at(0)) * (at(5) - at(1)) - (at(3) - at(1)) * (at(4) - at(0)));
  });
}

/// The area of the surface for each texel: that of its face by the face's area in the atlas.
export function measureTexels(
  { areas, texelFaces, inAtlas }: Layout,
  { positions: p, indices }: Triangles,
): void {
  const ofFace = inAtlas.map((area, f) => {
    const [a, b, c] = [0, 1, 2].map((k) => 3 * indices[3 * f + k]);
    return area > 0 ? Math.hypot(...cross(p, a, b, c)) / area : 0;
  });
  for (let i = 0; i < areas.length; ++i) areas[i] = texelFaces[i] === kNone ? 0 : ofFace[texelFaces[i]];
}

function cross(p: ArrayLike<number>, a: number, b: number, c: number): Vec {
  const [ux, uy, uz] = [p[b] - p[a], p[b + 1] - p[a + 1], p[b + 2] - p[a + 2]];
  const [vx, vy, vz] = [p[c] - p[a], p[c + 1] - p[a + 1], p[c + 2] - p[a + 2]];
  return [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
}

/// Moves the vertices of the model to those of the mesh, and shades them.
export function placeVertices({ model, vertexOf }: Layout, mesh: Triangles): void {
  const { centre, size, position, normal, triangle } = model;
  for (let m = 0; m < vertexOf.length; ++m)
    for (let k = 0; k < 3; ++k)
      position[3 * m + k] = (mesh.positions[3 * vertexOf[m] + k] - centre[k]) / size;
  // Normals of the faces, times their areas: of the charts at the vertices of the model, of all at those of the mesh.
  const faces = new Float32Array(triangle.length);
  const own = new Float32Array(position.length);
  for (let i = 0; i < triangle.length; i += 3) {
    const n = cross(position, 3 * triangle[i], 3 * triangle[i + 1], 3 * triangle[i + 2]);
    for (let k = 0; k < 3; ++k) {
      faces[i + k] = n[k];
      for (let corner = 0; corner < 3; ++corner) own[3 * triangle[i + corner] + k] += n[k];
    }
  }
  unit(own);
  const parts = piecesOf(vertexOf);
  const sums = new Float32Array(position.length);
  for (let i = 0; i < triangle.length; i += 3) {
    const length = Math.hypot(faces[i], faces[i + 1], faces[i + 2]);
    for (let corner = 0; corner < 3; ++corner)
      for (let m = parts.first[vertexOf[triangle[i + corner]]]; m >= 0; m = parts.next[m]) {
        const along = faces[i] * own[3 * m] + faces[i + 1] * own[3 * m + 1] + faces[i + 2] * own[3 * m + 2];
        if (along < kCrease * length) continue;
        for (let k = 0; k < 3; ++k) sums[3 * m + k] += faces[i + k];
      }
  }
  unit(sums);
  for (let i = 0; i < sums.length; ++i) normal[i] = Math.round(127 * sums[i]);
}

const kPieces = new WeakMap<Uint32Array, { first: Int32Array; next: Int32Array }>();

/// The vertices of the model that are of one vertex of the mesh, as lists.
function piecesOf(vertexOf: Uint32Array) {
  let pieces = kPieces.get(vertexOf);
  if (!pieces) {
    let most = 0;
    for (const v of vertexOf) most = Math.max(most, v);
    pieces = { first: new Int32Array(most + 1).fill(-1), next: new Int32Array(vertexOf.length) };
    for (let m = 0; m < vertexOf.length; ++m) {
      pieces.next[m] = pieces.first[vertexOf[m]];
      pieces.first[vertexOf[m]] = m;
    }
    kPieces.set(vertexOf, pieces);
  }
  return pieces;
}

function unit(vectors: Float32Array): void {
  for (let i = 0; i < vectors.length; i += 3) {
    const length = Math.hypot(vectors[i], vectors[i + 1], vectors[i + 2]) || 1;
    for (let k = 0; k < 3; ++k) vectors[i + k] /= length;
  }
}

/// How the area is distributed over the distances of a map.
export function areaOf({ map, areas }: Layout): AreaByValue {
  return AreaByValue.of(map.distance, areas);
}
