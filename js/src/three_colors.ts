// The colours of distances in three.js, by the rule of all pictures.
import { DataTexture, LinearFilter, SRGBColorSpace } from 'three';
import {
  automaticColormap,
  automaticHi,
  automaticLo,
  colormapOfRange,
  fewAbove,
  fewBelow,
  isLongerAbove,
  kAbove,
  kBelow,
  kCentred,
  kColormapNames,
  kColorRule,
  kDiverging,
  kEndToEnd,
  kNoValue,
  kOpposite,
  kPaper2006,
  kSequential,
  kUnjudged,
  kViridis,
  kWithin,
  leastShown,
  limitsHi,
  limitsLo,
  mostShown,
  roundedHi,
  roundedLo,
  scaleReach,
} from './rules.js';
import { type Colormap } from './types.js';

const kLut = 256;
export const kModes = {
  viridis: kEndToEnd,
  sequential: kSequential,
  diverging: kCentred,
  paper2006: kEndToEnd,
};

// The texture of colours has a row for each kind of place that the rule tells apart, in their order, and one for no value.
const kRows = 7;
/** The colour of a distance, in GLSL. */
export const kDeclarations = `
uniform sampler2D sdmDistances;
uniform sampler2D sdmColors;
uniform float sdmMode;
uniform vec2 sdmRange;
uniform vec2 sdmLimits;
uniform float sdmAccuracy;
${kColorRule}
vec3 sdmColor(float d) {
  float place = d > 1e37 ? ${2 * (kRows - 1)}.0 : colorPlace(d, sdmMode, sdmRange.x, sdmRange.y, sdmLimits.x, sdmLimits.y, sdmAccuracy);
  float row = floor(place / 2.0);
  return texture2D(sdmColors, vec2(((place - 2.0 * row) * ${kLut - 1}.0 + 0.5) / ${kLut}.0, (row + 0.5) / ${kRows}.0)).rgb;
}`;

type Rgb = [number, number, number];

export function colorTexture(colormap: keyof typeof kModes): DataTexture {
  const colors = { viridis: kViridis, sequential: kViridis, diverging: kDiverging, paper2006: kPaper2006 }[
    colormap
  ];
  const rows = [colors, kOpposite, kWithin, kAbove, kBelow, [kUnjudged, kUnjudged], [kNoValue, kNoValue]];
  const data = Uint8Array.from(
    rows.flatMap((row) =>
      Array.from({ length: kLut }, (_, i) => [...gradient(row, i / (kLut - 1)), 255]).flat(),
    ),
  );
  const texture = new DataTexture(data, kLut, kRows);
  [texture.minFilter, texture.magFilter] = [LinearFilter, LinearFilter];
  texture.colorSpace = SRGBColorSpace;
  texture.needsUpdate = true;
  return texture;
}

function gradient(colors: Rgb[], t: number): Rgb {
  const at = Math.min(colors.length - 2, Math.floor(t * (colors.length - 1)));
  const f = t * (colors.length - 1) - at;
  return colors[at]!.map((x, k) => Math.round(x * (1 - f) + colors[at + 1]![k]! * f)) as Rgb;
}

/** What a material is given of its colours. */
interface GivenColors {
  range?: [number, number] | undefined;
  tolerance?: [number, number] | undefined;
  accuracy?: number | undefined;
  colormap?: Exclude<Colormap, 'automatic'> | undefined;
}

/** The colormap and the range that are not given, by the rule of all pictures. */
export function colorsOf(
  distances: Float32Array,
  given: GivenColors,
): { colormap: keyof typeof kModes; range: [number, number] } {
  const { range, tolerance } = given;
  const accuracy = Number.isFinite(given.accuracy) ? given.accuracy! : 0;
  const step = Math.max(1, Math.floor(distances.length / 65536));
  const sample: number[] = [];
  let lowest = Infinity;
  let highest = -Infinity;
  for (let i = 0; i < distances.length; ++i) {
    const d = distances[i]!;
    if (!Number.isFinite(d)) continue;
    [lowest, highest] = [Math.min(lowest, d), Math.max(highest, d)];
    if (i % step === 0) sample.push(d);
  }
  if (lowest > highest) [lowest, highest] = [0, 0];
  const quantile = (values: number[], q: number) =>
    values.sort((a, b) => a - b)[Math.floor(q * (values.length - 1))] ?? NaN;
  const least = leastShown(lowest, highest, accuracy);
  const most = mostShown(lowest, highest, accuracy);
  const reach = scaleReach(least, most, quantile(sample.map(Math.abs), 0.99), accuracy);
  const below = fewBelow(least, quantile(sample, 0.05), reach, accuracy);
  const above = fewAbove(most, quantile(sample, 0.95), reach, accuracy);
  let map = given.colormap ? kColormapNames.indexOf(given.colormap) : automaticColormap(least, below, above);
  if (range && !given.colormap) map = colormapOfRange(map, ...range);
  const longerAbove = isLongerAbove(least, most, below, above);
  const [lo, hi] = tolerance
    ? [limitsLo(least, reach, ...tolerance), limitsHi(most, reach, ...tolerance)]
    : [automaticLo(map, least, most, reach, longerAbove), automaticHi(map, least, most, reach, longerAbove)];
  return {
    colormap: kColormapNames[map] as keyof typeof kModes,
    range: range ?? [roundedLo(lo, hi), roundedHi(lo, hi)],
  };
}
