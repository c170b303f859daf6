// What the shader of the colours (color_scale.ts) needs.
import { Vector3 } from 'three';
import type { Colors, Scale } from './color_scale';
import type { Vec } from './page_data';

const kStops = 11;

const triple = (list: Vec[]) => list.map((c) => new Vector3(...c).multiplyScalar(1 / 255));

export type Uniforms = Record<string, { value: unknown }>;

export function colorUniforms(colors: Colors): Uniforms {
  return {
    mode: { value: 0 },
    lo: { value: 0 },
    hi: { value: 1 },
    lower: { value: 0 },
    upper: { value: 0 },
    accuracy: { value: 0 },
    stops: { value: triple(colors.viridis) },
    stopCount: { value: colors.viridis.length },
    above: { value: triple(colors.above) },
    below: { value: triple(colors.below) },
    opposite: { value: triple(colors.opposite) },
    within: { value: triple(colors.within) },
    unjudged: { value: triple(colors.unjudged)[0] },
    noValue: { value: triple(colors.no_value)[0] },
  };
}

export function setScale(uniforms: Uniforms, scale: Scale, colors: Colors): void {
  uniforms.mode.value = { viridis: 0, paper2006: 0, diverging: 1, tolerance: 2, sequential: 3 }[scale.mode];
  const kMost = 1e38; // shaders cannot rely on infinity
  for (const key of ['lo', 'hi', 'lower', 'upper', 'accuracy'] as const) uniforms[key].value = Math.min(kMost, Math.max(-kMost, scale[key]));
  const stops = colors[scale.mode === 'tolerance' || scale.mode === 'sequential' ? 'viridis' : scale.mode];
  uniforms.stopCount.value = stops.length;
  uniforms.stops.value = triple(Array.from({ length: kStops }, (_, i) => stops[Math.min(i, stops.length - 1)]));
}
