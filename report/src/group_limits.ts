// The limits of each triangle by a table of tolerances, and the scales of their bands.
import { bandedHi, bandedLo } from 'sdm-rules';
import type { Scale } from './color_scale';
import type { Model, Report } from './page_data';
import type { GroupName } from './group_table';
import { isLimited, realLimits, type Limits } from './verdict';

/// The names of the kind of a group, and the number that its triangles have there.
function numberOf(model: Model, group: GroupName | null) {
  const named = group && model.names.find((n) => n.kind === group.kind);
  return { named, number: named ? named.names.indexOf(group.group) + 1 : 0 };
}

const kNoLimit: Limits = { lower: -Infinity, upper: Infinity };

/// What both accept.
function common(a: Limits, b: Limits): Limits {
  return { lower: Math.max(a.lower, b.lower), upper: Math.min(a.upper, b.upper) };
}

/// The scale with these limits.
function banded(scale: Scale, { lower, upper }: Limits): Scale {
  return {
    ...scale,
    lower,
    upper,
    lo: bandedLo(lower, upper, scale.lo, scale.hi),
    hi: bandedHi(lower, upper, scale.lo, scale.hi),
  };
}

/// Sets of limits, of which each triangle has one: what all the rows of the table that name it accept.
export class GroupLimits {
  readonly ofTriangle: Uint32Array;
  private readonly sets: Limits[] = [kNoLimit]; // the first is of triangles that no row names

  constructor(
    private readonly report: Report,
    { names, triangle }: Model,
  ) {
    this.ofTriangle = new Uint32Array(triangle.length / 3);
    const joined = new Map<string, number>();
    report.group_tolerances?.groups.forEach(({ kind, group, lower, upper }, row) => {
      const named = names.find((n) => n.kind === kind);
      const number = named ? named.names.indexOf(group) + 1 : 0;
      if (number === 0) return;
      const limits = realLimits({ lower: lower ?? -Infinity, upper: upper ?? Infinity }, report);
      named!.ofTriangle.forEach((n, t) => {
        if (n !== number) return;
        const before = this.ofTriangle[t];
        const key = `${before} ${row}`;
        if (!joined.has(key)) joined.set(key, this.sets.push(common(this.sets[before], limits)) - 1);
        this.ofTriangle[t] = joined.get(key)!;
      });
    });
  }

  get count(): number {
    return this.sets.length;
  }

  /// The scale of a set: bands are those of its limits and of the scale.
  scaleOf(set: number, scale: Scale): Scale {
    return scale.mode === 'tolerance' ? banded(scale, common(this.sets[set], scale)) : scale;
  }

  /// The sets of all triangles, or of those of a group.
  setsOf(model: Model, group: GroupName | null): number[] {
    const { named, number } = numberOf(model, group);
    return [...new Set(this.ofTriangle.filter((_, t) => !named || named.ofTriangle[t] === number))];
  }

  /// The limits that several sets have in units of these, from 0 if none has a lower one below: a scale for the legend of
  /// all of them. Of sets with the same limits it is theirs.
  joined(
    sets: number[],
    scale: Scale,
  ): { scale: Scale; isRelative: boolean; lower: boolean; upper: boolean; someHaveNone: boolean } {
    const limits = sets.map((set) => realLimits(common(this.sets[set], scale), this.report));
    const judged = limits.filter(isLimited);
    const [lower, upper] = [judged.some((l) => l.lower > -Infinity), judged.some((l) => l.upper < Infinity)];
    const isRelative = judged.some((l) => l.lower !== judged[0].lower || l.upper !== judged[0].upper);
    const relative = {
      ...scale,
      lower: lower ? -1 : -Infinity,
      upper: upper ? 1 : Infinity,
      lo: lower ? -2 : 0,
      hi: upper ? 2 : 0,
      accuracy: 0,
    };
    return {
      scale: isRelative || judged.length === 0 ? relative : banded(scale, judged[0]),
      isRelative,
      lower,
      upper,
      someHaveNone: judged.length < limits.length,
    };
  }

  /// The share of the area of the part that no limit is for.
  unjudged({ position, triangle }: Model): number {
    const area = [0, 0]; // without limits, and all
    const edge = (t: number, k: number) =>
      [0, 1, 2].map((i) => position[3 * triangle[3 * t + k] + i] - position[3 * triangle[3 * t] + i]);
    this.ofTriangle.forEach((set, t) => {
      const [a, b] = [edge(t, 1), edge(t, 2)];
      const size = Math.hypot(
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
      );
      area[1] += size;
      if (!isLimited(this.sets[set])) area[0] += size;
    });
    return area[1] > 0 ? area[0] / area[1] : 0;
  }
}
