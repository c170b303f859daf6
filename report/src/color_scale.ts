// Colours for distances: the scale of src/io/image/pictures/color_scale.h.
import type { Vec } from './page_data';

export type MapName = 'viridis' | 'diverging' | 'paper2006';
export type Mode = MapName | 'tolerance';
export type Colors = Record<MapName | 'within' | 'above' | 'below' | 'no_value', Vec[]>;

export interface Scale {
  mode: Mode;
  lo: number; ///< lo < hi; colours are constant outside
  hi: number;
  lower: number; ///< the tolerance: lower ≤ d ≤ upper
  upper: number;
  accuracy: number; ///< distances that exceed the tolerance by less are within it
}

/// Piecewise linear through equally spaced colours.
function gradient(colors: Vec[], t: number): Vec {
  const s = Math.min(1, Math.max(0, t)) * (colors.length - 1);
  const i = Math.min(Math.floor(s), colors.length - 2);
  return colors[i].map((a, k) => a + (s - i) * (colors[i + 1][k] - a)) as Vec;
}

function fraction(x: number, from: number, to: number): number {
  return to > from ? (x - from) / (to - from) : 1;
}

export function colorOf(scale: Scale, colors: Colors, distance: number): Vec {
  if (!Number.isFinite(distance)) return colors.no_value[0];
  if (scale.mode === 'tolerance') {
    if (distance > scale.upper + scale.accuracy)
      return gradient(colors.above, fraction(distance, scale.upper, scale.hi));
    if (distance < scale.lower - scale.accuracy)
      return gradient(colors.below, fraction(-distance, -scale.lower, -scale.lo));
    return colors.within[0];
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
  uniform int mode; // 0 viridis or the like, 1 diverging, 2 tolerance
  uniform float lo, hi, lower, upper, accuracy;
  uniform vec3 stops[11], above[3], below[3], within, noValue;
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

  vec3 colorOf(float d) {
    if (mode == 2) {
      if (d > upper + accuracy) return gradientOf3(above, fractionOf(d, upper, hi));
      if (d < lower - accuracy) return gradientOf3(below, fractionOf(-d, -lower, -lo));
      return within;
    }
    if (mode == 1) return gradientOf(0.5 + 0.5 * d / max(abs(lo), abs(hi)));
    return gradientOf(fractionOf(d, lo, hi));
  }
`;
