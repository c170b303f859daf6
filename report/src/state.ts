// What the form sets, and what a page opens with.
import type { AreaByValue } from './area_by_value';
import type { Mode, Scale } from './color_scale';
import type { Report } from './page_data';
import { limitsOf } from './verdict';

export interface State {
  scale: Scale;
  section: { axis: 0 | 1 | 2 | null; at: number; flipped: boolean }; ///< at: 0 to 1 along the box
  ghost: boolean;
  group?: { kind: string; group: string } | null; ///< alone in colours
  coverage: boolean; ///< of the reference, in place of the part
  width: number; ///< of the points of a cloud, relative to the usual one
  logarithmic?: boolean; ///< the heights of the histogram
}

/// The settings that a page opens with; `byGroup`: triangles have limits by their groups.
export function startOf(report: Report, area: AreaByValue, ghostShown: boolean, byGroup = false): State {
  const [least, most] = [
    report.extremes?.min?.distance ?? area.lo,
    report.extremes?.max?.distance ?? area.hi,
  ];
  const largest = Math.max(Math.abs(least), Math.abs(most)) || 1;
  const [lo, hi] = report.colors?.range ?? [
    least < 0 ? -largest : least,
    Math.max(most, least + largest * 1e-6),
  ];
  return {
    scale: {
      mode: (byGroup && report.colors?.by_group !== false
        ? 'tolerance'
        : (report.colors?.map ?? (least < 0 && most > 0 ? 'diverging' : 'viridis'))) as Mode,
      lo,
      hi: hi > lo ? hi : lo + 1,
      ...(limitsOf(report) ?? { lower: -Infinity, upper: Infinity }),
      accuracy: report.accuracy ?? 0,
    },
    section: { axis: null, at: 0.5, flipped: false },
    ghost: ghostShown,
    coverage: false,
    width: 1,
  };
}
