// report.json, as far as the pages know it.

export type Vec = [number, number, number];

export interface Extreme {
  distance: number;
  point: Vec;
  at: 'texel' | 'vertex' | 'point';
}
/// All that a verdict depends on besides the tolerance.
export interface Evidence {
  lowest: number | null; ///< null: nothing has a distance
  highest: number | null;
  complete: boolean;
  estimated_signs: boolean;
  accuracy: number | null; ///< null: unknown
  error_bound: number | null;
  unmatched?: boolean; ///< a sample has no match
  samples_only?: boolean; ///< nothing bounds the distances between samples
  signed?: boolean; ///< false: no distance is negative
  guard?: number; ///< how far the meshes may be from the surfaces that are meant
  thin_walls?: number | null; ///< the thickness that walls are below; null: none
}
/// A mesh, or a cloud, which has points.
export interface Input {
  file: string;
  transform: string;
  vertices?: number;
  triangles?: number;
  closed?: boolean;
  degenerate_faces?: number;
  duplicate_faces?: number;
  points?: number;
  invalid_points?: number;
  normals?: boolean;
}

/// report.json, as far as the page knows it. Any key may be missing: reports of `sdm self` have fewer.
export interface Report {
  version?: string;
  o1?: Input;
  o2?: Input;
  mesh?: Input;
  thickness?: { method: string; text: string; min?: number | null; max?: number | null };
  measured_on?: 'o1' | 'o2';
  units?: string;
  alignment?: { text: string };
  live?: boolean; ///< of the live page, which has no options of a command
  fields?: Record<string, string>; ///< as the author of the report named them
  atlas?: {
    kind: string;
    resolution: number;
    rows?: number;
    udim?: number | null;
    charts: number;
    texels: number;
  };
  engine?: string;
  max_distance?: number | null;
  colors?: { map: string; range: [number, number]; range_from: string; by_group?: boolean }; ///< with a table: bands by it
  measured?: { kind: string; text: string };
  sign?: { method: string; reason: string };
  distance?: Record<string, number | string | null>;
  extremes?: { min: Extreme | null; max: Extreme | null };
  texels_with_value?: number;
  points_with_value?: number;
  beyond_max_distance?: number;
  without_match?: number;
  boundary_texels?: number;
  accuracy?: number | null;
  error_bound?: number | null;
  precision?: number | null;
  evidence?: Evidence;
  tolerance?: {
    value?: number | null;
    lower?: number;
    upper?: number;
    verdict?: string;
    within: boolean;
    certified?: boolean;
    reason?: string;
    nearest_limit?: 'lower' | 'upper';
    text?: string; ///< the verdict as a clause
    next?: { part: string; measurement: string }; ///< what follows from it; empty where nothing does
    by_facing?: boolean | null; ///< where walls are thin: faces that face the same way decide
    by_places?: object | null; ///< connected places of some size decide
    proof?: { witness: { distance: number; point: Vec } | null; faces_without_match?: number } | null;
    exceeded_area_fraction?: number;
    exceeded_point_fraction?: number;
  };
  group_tolerances?: {
    verdict: string;
    text: string; ///< the verdict as clauses
    beyond_max_distance?: number; ///< points of a cloud that are of no group
    without_match?: number; ///< the same
    groups: {
      kind: string;
      group: string;
      lower: number | null; ///< null: no limit
      upper: number | null;
      verdict: string;
      certified?: boolean;
      lowest: number | null;
      highest: number | null;
      exceeded_area_fraction?: number;
      exceeded_point_fraction?: number; ///< of a cloud
      undecided_by?: number | null;
      witness?: { distance: number; point: Vec } | null;
    }[];
  };
  coverage?: { value: number; lower: number; upper: number; reach: number };
  places?: Places | null;
  doubts?: { reason: string; text: string; remedy: string }[];
  notes?: string[];
  time_ms?: Record<string, number | null>;
  [key: string]: unknown;
}

/// A region that deviates, by its sample that is farthest beyond the limit.
export interface Place {
  distance: number | null; ///< null: no value, although a tolerance asks for one
  point: Vec;
  at: 'texel' | 'vertex' | 'point';
  index?: number; ///< of a point of a cloud
  area?: number;
  points?: number; ///< of a cloud
  group: string | null;
  small: boolean;
}

interface PlaceTotals {
  count: number;
  points?: number;
  area?: number;
  area_fraction?: number;
  point_fraction?: number;
}

export interface Places {
  lower: number | null;
  upper: number | null;
  limits_from: 'tolerance' | 'p99_abs';
  least_area_fraction?: number;
  least_point_fraction?: number;
  large: PlaceTotals;
  small: PlaceTotals;
  largest: Place[];
}

export function readReport(): Report {
  return JSON.parse(reportText()) as Report;
}
export function reportText(): string {
  return document.getElementById('report')?.textContent ?? '';
}
