// What is measured, as the page draws it and finds it under the cursor: a surface (surface.ts) or a cloud (cloud.ts).
import type { Object3D } from 'three';
import type { Scale } from './color_scale';
import type { Uniforms } from './color_uniforms';
import type { Vec } from './page_data';
import type { Viewer } from './viewer';

export interface HalfSpace {
  normal: Vec;
  offset: number; ///< points p with normal · p ≤ offset are visible
}

/// What is under a place of the canvas.
export interface Found {
  at: Vec; ///< in units of the scene
  normal: Vec; ///< towards the outside, of any length
  distance: number; ///< NaN without one
  detail: string; ///< what it is closest to, for callouts; empty if unknown
  rows: [label: string, text: string, id: string][]; ///< the same and where it is, beside distance and position
  value: object; ///< for tests
}

export interface Subject {
  readonly centre: Vec; ///< of the scene, in the units of the files
  readonly size: number; ///< of a unit of the scene
  readonly lo: Vec; ///< the corners of the box, in units of the scene
  readonly hi: Vec;
  readonly uniforms: Uniforms; ///< those of color_uniforms.ts, which setScale() sets, and `cut`
  readonly object: Object3D;
  readonly isClosed: boolean; ///< has an inside, which a cut opens

  setScale(scale: Scale): void;
  /// Called before each picture.
  prepare(viewer: Viewer): void;
  /// Whether less is drawn, while something moves and pictures take long. What is found stays.
  setCoarse(coarse: boolean): void;
  find(viewer: Viewer, x: number, y: number, cut: HalfSpace | null): Found | null;
  /// Whether something is in front of a point.
  isHidden(viewer: Viewer, point: Vec, cut: HalfSpace | null): boolean;
  normalNear(point: Vec): Vec;
}

export interface Box {
  lo: Vec;
  hi: Vec;
}

export function boxOf(position: Float32Array | Float64Array): Box {
  const lo: Vec = [Infinity, Infinity, Infinity];
  const hi: Vec = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < position.length; ++i) {
    const k = i % 3;
    if (position[i] < lo[k]) lo[k] = position[i];
    if (position[i] > hi[k]) hi[k] = position[i];
  }
  return { lo, hi };
}

export function united(a: Box, b: Box): Box {
  return {
    lo: a.lo.map((x, k) => Math.min(x, b.lo[k])) as Vec,
    hi: a.hi.map((x, k) => Math.max(x, b.hi[k])) as Vec,
  };
}

export function areApart(a: Box, b: Box): boolean {
  return [0, 1, 2].some((k) => a.hi[k] < b.lo[k] || b.hi[k] < a.lo[k]);
}

/// The number of the position that is nearest to a point.
export function nearest(position: Float32Array, at: Vec): number {
  let best = 0;
  let least = Infinity;
  for (let i = 0; i < position.length; i += 3) {
    const away = (position[i] - at[0]) ** 2 + (position[i + 1] - at[1]) ** 2 + (position[i + 2] - at[2]) ** 2;
    if (away < least) [best, least] = [i, away];
  }
  return best / 3;
}

/// A point of the scene in the units of the files, and back.
export function toFile({ centre, size }: Subject, point: Vec): Vec {
  return point.map((x, k) => x * size + centre[k]) as Vec;
}
export function toScene({ centre, size }: Subject, point: Vec): Vec {
  return point.map((x, k) => (x - centre[k]) / size) as Vec;
}
