// Where a plane cuts the part and the reference: profiles, the cut surface, and the gap between the two.
import type { Vec } from './page_data';
import type { HalfSpace } from './subject';

/// Triangles, of which some are cut.
export interface Triangles {
  position: Float32Array;
  triangle: Uint32Array;
}

/// Where triangles are cut: two points for each that is.
export interface Profile {
  ends: Float32Array; ///< three coordinates a point, from end to end of each piece
  triangle: Uint32Array; ///< of each piece
}

/// The profile of triangles in a plane. Neighbours that share an edge, as points if not by number, share the point on it
/// bit by bit, so that the profile of a closed surface is closed. Cost: linear in the triangles.
export function profileOf(
  { position: p, triangle: t }: Triangles,
  { normal: n, offset }: HalfSpace,
): Profile {
  const ends: number[] = [];
  const cut: number[] = [];
  const above = (v: number) => n[0] * p[v] + n[1] * p[v + 1] + n[2] * p[v + 2] - offset;
  const first = (a: number, b: number) => {
    for (let k = 0; k < 3; ++k) if (p[a + k] !== p[b + k]) return p[a + k] < p[b + k];
    return true;
  };
  const add = (a: number, b: number) => {
    const [from, to] = first(a, b) ? [a, b] : [b, a];
    const [x, y] = [above(from), above(to)];
    const s = x / (x - y);
    for (let k = 0; k < 3; ++k) ends.push(p[from + k] + s * (p[to + k] - p[from + k]));
  };
  for (let i = 0; i < t.length; i += 3) {
    const [a, b, c] = [3 * t[i], 3 * t[i + 1], 3 * t[i + 2]];
    const [aboveA, aboveB, aboveC] = [above(a) > 0, above(b) > 0, above(c) > 0];
    if (aboveA === aboveB && aboveB === aboveC) continue;
    if (aboveA !== aboveB) add(a, b);
    if (aboveB !== aboveC) add(b, c);
    if (aboveC !== aboveA) add(c, a);
    cut.push(i / 3);
  }
  return { ends: Float32Array.from(ends), triangle: Uint32Array.from(cut) };
}

/// Triangles in the plane that cover a point an odd number of times where it is inside of a closed profile.
export function fanOf({ ends }: Profile): Float32Array {
  const result = new Float32Array((3 * ends.length) / 2);
  for (let i = 0, o = 0; i < ends.length; i += 6, o += 9) {
    result.set(ends.subarray(0, 3), o);
    result.set(ends.subarray(i, i + 6), o + 3);
  }
  return result;
}

/// A point of the profile of the part.
export interface ProfilePoint {
  at: Vec;
  distance: number; ///< NaN without one
  triangle: number; ///< of the part
}

/// Pieces of at most a length of the profile of a part, two points each, with the values there.
export function sampledProfile(
  model: Triangles,
  profile: Profile,
  longest: number,
  valueAt: (triangle: number, weights: Vec) => number,
): ProfilePoint[] {
  const points: ProfilePoint[] = [];
  profile.triangle.forEach((triangle, piece) => {
    const corners = [0, 1, 2].map((k) =>
      model.position.subarray(3 * model.triangle[3 * triangle + k], 3 * model.triangle[3 * triangle + k] + 3),
    );
    const a = profile.ends.subarray(6 * piece, 6 * piece + 3);
    const b = profile.ends.subarray(6 * piece + 3, 6 * piece + 6);
    const parts = Math.min(200, Math.max(1, Math.ceil(length(minus(b, a)) / longest)));
    const sample = (s: number): ProfilePoint => {
      const at = [0, 1, 2].map((k) => a[k] + s * (b[k] - a[k])) as Vec;
      return { at, distance: valueAt(triangle, weightsOf(at, corners)), triangle };
    };
    let last = sample(0);
    for (let i = 1; i <= parts; ++i) {
      const next = sample(i / parts);
      points.push(last, next);
      last = next;
    }
  });
  return points;
}

/// How much larger than it is a gap is drawn, so that one of `most` takes 6 % of the part: a round number, at least 1.
export function gapFactor(most: number, sizeOfPart: number): number {
  const wanted = (0.06 * sizeOfPart) / most;
  if (!(wanted > 2) || !Number.isFinite(wanted)) return 1;
  const power = 10 ** Math.floor(Math.log10(wanted));
  return power * [5, 2, 1].find((digit) => digit * power <= wanted)!;
}

/// The nearest point of a profile; null if it is empty. Cost: linear.
function nearestOf({ ends }: Profile, to: Vec): Vec | null {
  let best: Vec | null = null;
  let least = Infinity;
  for (let i = 0; i < ends.length; i += 6) {
    const ux = ends[i + 3] - ends[i];
    const uy = ends[i + 4] - ends[i + 1];
    const uz = ends[i + 5] - ends[i + 2];
    const px = to[0] - ends[i];
    const py = to[1] - ends[i + 1];
    const pz = to[2] - ends[i + 2];
    const s = Math.min(1, Math.max(0, (px * ux + py * uy + pz * uz) / (ux * ux + uy * uy + uz * uz || 1)));
    const away = (px - s * ux) ** 2 + (py - s * uy) ** 2 + (pz - s * uz) ** 2;
    if (away >= least) continue;
    least = away;
    best = [ends[i] + s * ux, ends[i + 1] + s * uy, ends[i + 2] + s * uz];
  }
  return best;
}

/// Lines from some points of the profile of a part, `spacing` apart, towards the nearest points of that of the reference,
/// `factor` times as long as the gap in the plane: two points each. Those that are longer than `longest` are left out.
export function gapLines(
  points: ProfilePoint[],
  reference: Profile,
  spacing: number,
  factor: number,
  longest: number,
): ProfilePoint[] {
  const lines: ProfilePoint[] = [];
  const taken = new Set<string>();
  for (const point of points) {
    if (Number.isNaN(point.distance)) continue;
    const cell = point.at.map((x) => Math.floor(x / spacing)).join();
    if (taken.has(cell)) continue;
    taken.add(cell);
    const nearest = nearestOf(reference, point.at);
    if (!nearest) continue;
    const line = minus(nearest, point.at).map((x) => factor * x) as Vec;
    if (length(line) <= longest)
      lines.push(point, { ...point, at: point.at.map((x, k) => x + line[k]) as Vec });
  }
  return lines;
}

type List = ArrayLike<number>;
const minus = (a: List, b: List): Vec => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const dot = (a: List, b: List) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const length = (a: Vec) => Math.hypot(...a);

/// The weights of the corners of a triangle for a point of it.
function weightsOf(at: Vec, [a, b, c]: List[]): Vec {
  const [u, v, p] = [minus(b, a), minus(c, a), minus(at, a)];
  const [uu, uv, vv, pu, pv] = [dot(u, u), dot(u, v), dot(v, v), dot(p, u), dot(p, v)];
  const area = uu * vv - uv * uv;
  if (!(area > 0)) return [1, 0, 0];
  const clamped = (x: number) => Math.min(1, Math.max(0, x));
  const second = clamped((vv * pu - uv * pv) / area);
  const third = clamped((uu * pv - uv * pu) / area);
  return [Math.max(0, 1 - second - third), second, third];
}
