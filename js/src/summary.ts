// The keys of report.json in a summary, as docs/report.md of the project describes them: null stands for a number that there is not.
import type * as declared from './declared.js';

type Snake<Name extends string> = Name extends `${infer First}${infer Rest}`
  ? `${First extends Lowercase<First> ? First : `_${Lowercase<First>}`}${Snake<Rest>}`
  : '';
type Point = [x: number, y: number, z: number];

/** Statistics, by their names in report.json: `p50_abs` of DistanceStatistics.p50Abs. */
export type SummaryStatistics = { kind: declared.Certainty } & {
  [Name in Exclude<keyof declared.DistanceStatistics, 'texels' | 'negativeTexels'> as Snake<Name>]:
    | number
    | null;
};

export interface SummaryMesh {
  file: string;
  xxh3: string | null;
  transform: string;
  vertices: number;
  triangles: number;
  closed: boolean;
  degenerate_faces: number;
  duplicate_faces: number;
  /** Of the mesh that distances go to. */
  embedded?: boolean | null;
}

export interface SummaryExtreme {
  distance: number;
  point: Point;
  at: 'texel' | 'vertex';
}

/** Of a place, or of several: texels and their area. */
export interface SummaryShare {
  texels: number;
  area: number;
  area_fraction: number;
}

export interface SummaryPlace extends SummaryShare {
  distance: number | null;
  point: Point;
  at: 'texel' | 'vertex';
  triangle: number;
  kind: string | null;
  group: string | null;
  small: boolean;
  lower: number | null;
  upper: number | null;
}

export interface SummaryPlaces {
  kind: declared.Certainty;
  lower: number | null;
  upper: number | null;
  limits_from: 'tolerance' | 'p99_abs';
  least_area_fraction: number;
  large: { count: number } & SummaryShare;
  small: { count: number } & SummaryShare;
  largest: SummaryPlace[];
}

export interface AreaFractions {
  below: number;
  within: number;
  above: number;
  without_value: number;
}

export interface SummaryProof {
  /** A point that is out of the tolerance. */
  witness: {
    distance: number | null;
    point: Point;
    closest: Point;
    triangle: number;
    closest_triangle: number;
  } | null;
  undecided_by: number | null;
  depends_on_signs: boolean;
  faces_without_match: number;
}

export interface SummaryTolerance {
  /** Of a symmetric tolerance. */
  value: number | null;
  lower: number | null;
  upper: number | null;
  verdict: declared.Verdict;
  reason: declared.VerdictReason;
  decision_rule: declared.DecisionRule;
  /** The verdict as a clause. */
  text: string;
  /** What follows from it for the part, and which options would measure more; empty where nothing does. */
  next: { part: string; measurement: string };
  exceeded_area_fraction: number;
  area_fractions: AreaFractions;
  within: boolean;
  /** Whether the verdict is proven for every point of the surface. */
  certified: boolean;
  margin: number | null;
  nearest_limit: 'lower' | 'upper';
  proof: SummaryProof | null;
  by_facing: boolean | null;
  /** Areas, where the size of connected places decides. */
  by_places: { least: number; certain: number; possible: number } | null;
}

export interface SummaryPart {
  /** Of groups; null for the triangles without one. */
  name?: string | null;
  triangles: number;
  first_triangle: number;
  bounds: { lower: Point; upper: Point };
  area_fraction: number;
  distance: SummaryStatistics;
  texels_with_value: number;
  tolerance?: AreaFractions;
}

export interface SummaryParts {
  kind: string;
  count: number;
  largest: SummaryPart[];
}

/** What a verdict depends on besides the tolerance. */
export interface SummaryEvidence {
  lowest: number | null;
  highest: number | null;
  complete: boolean;
  estimated_signs: boolean;
  accuracy: number | null;
  error_bound: number | null;
  signed: boolean;
  unmatched: boolean;
  samples_only: boolean;
  guard: number;
  uncertainty: number;
  thin_walls: number | null;
}

/**
 * The keys of report.json. Optional are those that some measures lack, and those of options; of a map of a mesh to itself, `mesh`
 * stands for `o1` and `o2`.
 */
export interface MapSummary {
  version: string;
  o1?: SummaryMesh;
  o2?: SummaryMesh;
  mesh?: SummaryMesh;
  measured_on?: 'o1' | 'o2';
  units: string;
  atlas: {
    kind: declared.AtlasKind;
    resolution: number;
    rows: number;
    charts: number;
    texels: number;
    utilisation: number;
    max_stretch: number;
    gutter: number;
    overlapping_texels: number;
    area_fraction_without_texels: number;
    udim?: number | null;
    cut_faces?: number;
  };
  precision?: number | null;
  engine: string;
  max_distance: number | null;
  colors: {
    map: Exclude<declared.Colormap, 'automatic'> | 'tolerance';
    range: [least: number, largest: number];
    range_from: 'option' | 'p99_abs';
  };
  measured?: { kind: declared.DistanceKind; text: string; settings: Record<string, unknown> };
  sign?: { method: declared.SignMethod; reason: string };
  distance: SummaryStatistics;
  extremes?: { min: SummaryExtreme | null; max: SummaryExtreme | null };
  texels_with_value: number;
  texels_without_value?: number;
  negative_texels?: number;
  beyond_max_distance?: number;
  beyond_max_distance_area_fraction?: number;
  without_match?: number;
  boundary_texels?: number;
  accuracy?: number | null;
  accuracy_kind?: 'bounded' | 'unknown';
  error_bound?: number | null;
  error_bound_kind?: 'bounded' | 'unknown';
  hausdorff?: {
    one_sided: {
      lower: number | null;
      upper: number | null;
      kind: 'bounded' | 'unknown';
      point: Point | null;
    };
  };
  evidence?: SummaryEvidence;
  tolerance?: SummaryTolerance;
  places?: SummaryPlaces | null;
  doubts?: { reason: declared.DoubtReason; text: string; remedy: string }[];
  histogram?: {
    lower: number;
    upper: number;
    area_fractions: number[];
    below: number;
    above: number;
    without_value: number;
  } | null;
  bands?: { lower: number | null; upper: number | null; area_fraction: number }[];
  components?: SummaryParts;
  groups?: SummaryParts[];
  notes: string[];
  time_ms: Record<string, number | null>;
}

/** Of summary() with a tolerance. */
export interface JudgedSummary extends MapSummary {
  tolerance: SummaryTolerance;
}
