// What the shader of the colours (color_scale.ts) needs.
import { kAbove, kBelow, kNoValue, kOpposite, kUnjudged, kViridis, kWithin } from 'sdm-rules';
import { Vector3 } from 'three';
import { colormapOf, modeOf, type Scale } from './color_scale';
import type { Vec } from './page_data';

const kStops = 11;

const triple = (list: Vec[]) => list.map((c) => new Vector3(...c).multiplyScalar(1 / 255));

export type Uniforms = Record<string, { value: unknown }>;

export function colorUniforms(): Uniforms {
  return {
    mode: { value: 0 },
    lo: { value: 0 },
    hi: { value: 1 },
    lower: { value: 0 },
    upper: { value: 0 },
    accuracy: { value: 0 },
    stops: { value: triple(kViridis) },
    stopCount: { value: kViridis.length },
    above: { value: triple(kAbove) },
    below: { value: triple(kBelow) },
    opposite: { value: triple(kOpposite) },
    within: { value: triple(kWithin) },
    unjudged: { value: triple([kUnjudged])[0] },
    noValue: { value: triple([kNoValue])[0] },
  };
}

export function setScale(uniforms: Uniforms, scale: Scale): void {
  uniforms.mode.value = modeOf(scale);
  const kMost = 1e38; // shaders cannot rely on infinity
  for (const key of ['lo', 'hi', 'lower', 'upper', 'accuracy'] as const)
    uniforms[key].value = Math.min(kMost, Math.max(-kMost, scale[key]));
  const stops = colormapOf(scale);
  uniforms.stopCount.value = stops.length;
  uniforms.stops.value = triple(
    Array.from({ length: kStops }, (_, i) => stops[Math.min(i, stops.length - 1)]),
  );
}
