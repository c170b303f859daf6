// Colours for distances, by the rule of all pictures.
import {
  colorPlace,
  kAbove,
  kBands,
  kBelow,
  kCentred,
  kColorRule,
  kDiverging,
  kEndToEnd,
  kInAbove,
  kInBelow,
  kInOpposite,
  kInUnjudged,
  kInWithin,
  kNoValue,
  kOpposite,
  kPaper2006,
  kSequential,
  kUnjudged,
  kViridis,
  kWithin,
} from 'sdm-rules';
import type { Vec } from './page_data';

export type Mode = 'viridis' | 'diverging' | 'paper2006' | 'sequential' | 'tolerance';

export interface Scale {
  mode: Mode;
  lo: number; ///< lo < hi; colours are constant outside
  hi: number;
  lower: number; ///< the tolerance: lower ≤ d ≤ upper; one of them infinite if there is but one limit
  upper: number;
  accuracy: number; ///< distances that exceed the tolerance, or 0, by less are within it
}

export const kViridisInWords = 'Violet – green – yellow';

const kModes: Record<Mode, number> = {
  viridis: kEndToEnd,
  paper2006: kEndToEnd,
  diverging: kCentred,
  tolerance: kBands,
  sequential: kSequential,
};
export const modeOf = ({ mode }: Scale): number => kModes[mode];

/// Piecewise linear through equally spaced colours; t in [0, 1].
function gradient(colors: Vec[], t: number): Vec {
  const s = t * (colors.length - 1);
  const i = Math.min(Math.floor(s), colors.length - 2);
  return colors[i].map((a, k) => a + (s - i) * (colors[i + 1][k] - a)) as Vec;
}

export function colorOf(scale: Scale, distance: number): Vec {
  if (!Number.isFinite(distance)) return kNoValue;
  const place = colorPlace(
    distance,
    modeOf(scale),
    scale.lo,
    scale.hi,
    scale.lower,
    scale.upper,
    scale.accuracy,
  );
  if (place >= kInUnjudged) return kUnjudged;
  if (place >= kInBelow) return gradient(kBelow, place - kInBelow);
  if (place >= kInAbove) return gradient(kAbove, place - kInAbove);
  if (place >= kInWithin) return gradient(kWithin, place - kInWithin);
  if (place >= kInOpposite) return gradient(kOpposite, place - kInOpposite);
  return gradient(colormapOf(scale), place);
}

/// The colours of a scale between its ends.
export function colormapOf({ mode }: Scale): Vec[] {
  return mode === 'diverging' ? kDiverging : mode === 'paper2006' ? kPaper2006 : kViridis;
}

export function css(color: Vec): string {
  return `rgb(${color.map(Math.round).join(' ')})`;
}

/// The same in GLSL, for a distance that is finite.
export const kColorShader = `
  uniform float mode, lo, hi, lower, upper, accuracy; // lower -1e38 or upper 1e38: no limit
  uniform vec3 stops[11], above[3], below[3], opposite[3], within[4], noValue, unjudged;
  uniform int stopCount;

  ${kColorRule}

  vec3 gradientOf(float t) {
    float s = t * float(stopCount - 1);
    int i = min(int(s), stopCount - 2);
    return mix(stops[i], stops[i + 1], s - float(i));
  }
  vec3 gradientOf3(vec3 colors[3], float t) {
    float s = t * 2.0;
    return s < 1.0 ? mix(colors[0], colors[1], s) : mix(colors[1], colors[2], s - 1.0);
  }

  vec3 colorOf(float d) {
    float place = colorPlace(d, mode, lo, hi, lower, upper, accuracy);
    if (place >= kInUnjudged) return unjudged;
    if (place >= kInBelow) return gradientOf3(below, place - kInBelow);
    if (place >= kInAbove) return gradientOf3(above, place - kInAbove);
    if (place >= kInWithin) return within[int(3.0 * (place - kInWithin) + 0.5)];
    if (place >= kInOpposite) return gradientOf3(opposite, place - kInOpposite);
    return gradientOf(place);
  }
`;
