// Colours for distances: the scale of src/io/image/pictures/color_scale.h.
import type { Vec } from './page_data';

export type MapName = 'viridis' | 'diverging' | 'paper2006';
export type Mode = MapName | 'sequential' | 'tolerance';
export type Colors = Record<MapName | 'opposite' | 'within' | 'above' | 'below' | 'no_value' | 'unjudged', Vec[]>;

export interface Scale {
  mode: Mode;
  lo: number; ///< lo < hi; colours are constant outside
  hi: number;
  lower: number; ///< the tolerance: lower ≤ d ≤ upper; one of them infinite if there is but one limit
  upper: number;
  accuracy: number; ///< distances that exceed the tolerance, or 0, by less are within it
}

/// Piecewise linear through equally spaced colours.
function gradient(colors: Vec[], t: number): Vec {
  const s = Math.min(1, Math.max(0, t)) * (colors.length - 1);
  const i = Math.min(Math.floor(s), colors.length - 2);
  return colors[i].map((a, k) => a + (s - i) * (colors[i + 1][k] - a)) as Vec;
}

export const kViridis = 'Violet – green – yellow'; // viridis, in words

function fraction(x: number, from: number, to: number): number {
  return to > from ? (x - from) / (to - from) : 1;
}

/// How far a distance within the tolerance is on its way to the nearest limit, from 0 to 1. No limit: the end of the
/// scale is the farthest from the other one.
function closeness({ lower, upper, lo, hi }: Scale, d: number): number {
  if (lower <= 0 && upper >= 0) return d === 0 ? 0 : d > 0 ? fraction(d, 0, upper) : fraction(-d, 0, -lower);
  const room = upper === Infinity ? hi - lower : lower === -Infinity ? upper - lo : (Math.min(upper, hi) - Math.max(lower, lo)) / 2;
  return room > 0 ? 1 - Math.min(d - lower, upper - d) / room : 1;
}

export function colorOf(scale: Scale, colors: Colors, distance: number): Vec {
  if (!Number.isFinite(distance)) return colors.no_value[0];
  if (scale.mode === 'tolerance') {
    if (scale.lower === -Infinity && scale.upper === Infinity) return colors.unjudged[0];
    if (distance > scale.upper + scale.accuracy)
      return gradient(colors.above, fraction(distance, scale.upper, scale.hi));
    if (distance < scale.lower - scale.accuracy)
      return gradient(colors.below, fraction(-distance, -scale.lower, -scale.lo));
    const step = Math.floor(colors.within.length * closeness(scale, distance));
    return colors.within[Math.min(Math.max(step, 0), colors.within.length - 1)];
  }
  if (scale.mode === 'sequential') {
    const { lo, hi, accuracy } = scale;
    const up = hi >= -lo; // the longer side
    const d = up ? distance : -distance;
    if (d < -accuracy) return gradient(colors.opposite, fraction(-d, 0, up ? -lo : hi));
    return gradient(colors.viridis, fraction(d, Math.max(0, up ? lo : -hi), up ? hi : -lo));
  }
  if (scale.mode === 'diverging')
    return gradient(colors.diverging, 0.5 + (0.5 * distance) / Math.max(Math.abs(scale.lo), Math.abs(scale.hi)));
  return gradient(colors[scale.mode], fraction(distance, scale.lo, scale.hi));
}

export function css(color: Vec): string {
  return `rgb(${color.map(Math.round).join(' ')})`;
}

/// The same in GLSL, for a distance that is finite.
export const kColorShader = `
  uniform int mode; // 0 viridis or the like, 1 diverging, 2 tolerance, 3 sequential
  uniform float lo, hi, lower, upper, accuracy; // lower -1e38 or upper 1e38: no limit
  uniform vec3 stops[11], above[3], below[3], opposite[3], within[4], noValue, unjudged;
  uniform int stopCount;

  vec3 gradientOf(float t) {
    float s = clamp(t, 0.0, 1.0) * float(stopCount - 1);
    int i = min(int(s), stopCount - 2);
    return mix(stops[i], stops[i + 1], s - float(i));
  }
  vec3 gradientOf3(vec3 colors[3], float t) {
    float s = clamp(t, 0.0, 1.0) * 2.0;
    return s < 1.0 ? mix(colors[0], colors[1], s) : mix(colors[1], colors[2], s - 1.0);
  }
  float fractionOf(float x, float from, float to) { return to > from ? (x - from) / (to - from) : 1.0; }

  float closeness(float d) {
    if (lower <= 0.0 && upper >= 0.0) return d == 0.0 ? 0.0 : d > 0.0 ? fractionOf(d, 0.0, upper) : fractionOf(-d, 0.0, -lower);
    float room = upper > 1e37 ? hi - lower : lower < -1e37 ? upper - lo : (min(upper, hi) - max(lower, lo)) / 2.0;
    return room > 0.0 ? 1.0 - min(d - lower, upper - d) / room : 1.0;
  }
  vec3 sequentialOf(float x) {
    bool up = hi >= -lo;
    float d = up ? x : -x;
    if (d < -accuracy) return gradientOf3(opposite, fractionOf(-d, 0.0, up ? -lo : hi));
    return gradientOf(fractionOf(d, max(0.0, up ? lo : -hi), up ? hi : -lo));
  }

  vec3 colorOf(float d) {
    if (mode == 2) {
      if (lower < -1e37 && upper > 1e37) return unjudged;
      if (d > upper + accuracy) return gradientOf3(above, fractionOf(d, upper, hi));
      if (d < lower - accuracy) return gradientOf3(below, fractionOf(-d, -lower, -lo));
      return within[clamp(int(floor(4.0 * closeness(d))), 0, 3)];
    }
    if (mode == 3) return sequentialOf(d);
    if (mode == 1) return gradientOf(0.5 + 0.5 * d / max(abs(lo), abs(hi)));
    return gradientOf(fractionOf(d, lo, hi));
  }
`;
