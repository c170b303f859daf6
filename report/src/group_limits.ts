// The limits of each triangle by a table of tolerances, and the scales of their bands.
import type { Scale } from './color_scale';
import type { Model, Report } from './page_data';
import type { Limits } from './verdict';

const kNoLimit: Limits = { lower: -Infinity, upper: Infinity };

/// What both accept.
function common(a: Limits, b: Limits): Limits {
  return { lower: Math.max(a.lower, b.lower), upper: Math.min(a.upper, b.upper) };
}

/// The scale with these limits. Its ends are as far beyond them as they are from the middle between them: ±2 of ±1.
function banded(scale: Scale, { lower, upper }: Limits): Scale {
  const both = upper - lower < Infinity;
  const away = both ? Math.abs(upper - lower) / 2 : Math.min(Math.abs(lower), Math.abs(upper));
  const room = away > 0 && away < Infinity ? away : Math.max(Math.abs(scale.lo), Math.abs(scale.hi));
  return {
    ...scale, lower, upper,
    lo: lower > -Infinity ? lower - room : Math.min(0, upper - room),
    hi: upper < Infinity ? upper + room : Math.max(0, lower + room),
  };
}

/// Sets of limits, of which each triangle has one: what all the rows of the table that name it accept.
export class GroupLimits {
  readonly ofTriangle: Uint32Array;
  private readonly sets: Limits[] = [kNoLimit]; // the first is of triangles that no row names

  constructor({ group_tolerances: table }: Report, { names, triangle }: Model) {
    this.ofTriangle = new Uint32Array(triangle.length / 3);
    const joined = new Map<string, number>();
    table?.groups.forEach(({ kind, group, lower, upper }, row) => {
      const named = names.find((n) => n.kind === kind);
      const number = named ? named.names.indexOf(group) + 1 : 0;
      if (number === 0) return;
      const limits = { lower: lower ?? -Infinity, upper: upper ?? Infinity };
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

  /// That of the row of a group.
  scaleOfGroup(report: Report, kind: string, group: string, scale: Scale): Scale {
    const row = report.group_tolerances!.groups.find((g) => g.kind === kind && g.group === group)!;
    return banded(scale, common({ lower: row.lower ?? -Infinity, upper: row.upper ?? Infinity }, scale));
  }

  /// In units of the limits, for a legend of all of them: from 0 if none has a lower one below.
  relative(scale: Scale): { scale: Scale; lower: boolean; upper: boolean; someHaveNone: boolean } {
    const used = new Set(this.ofTriangle);
    const limits = [...used].map((set) => common(this.sets[set], scale));
    const [lower, upper] = [limits.some((l) => l.lower > -Infinity), limits.some((l) => l.upper < Infinity)];
    return {
      scale: { ...scale, lower: lower ? -1 : -Infinity, upper: upper ? 1 : Infinity, lo: lower ? -2 : 0, hi: upper ? 2 : 0, accuracy: 0 },
      lower, upper,
      someHaveNone: limits.some((l) => l.lower === -Infinity && l.upper === Infinity),
    };
  }
}
