// The colour scale beside the part.
import { kApart, kNoValue, kScaleSteps, kUnjudged } from 'sdm-rules';
import { colorOf, css, Scale } from './color_scale';
import { byId, make } from './dom';
import type { GroupLimits } from './group_limits';
import { text, ticks, tickText, valueLabel } from './numbers';
import type { Vec } from './page_data';

const kColors = 192; // of the bar
const kLine = 17; // pixels that a number takes

/// The distances at the ends of the bar: those of the scale, symmetric where its colours are.
export function ends(scale: Scale): [number, number] {
  if (scale.mode !== 'diverging') return [scale.lo, scale.hi];
  const reach = Math.max(Math.abs(scale.lo), Math.abs(scale.hi));
  return [-reach, reach];
}

interface ScaleLabel {
  value: number;
  text: string; ///< empty for a limit next to another number
  isLimit: boolean; ///< of the tolerance, and inside of the bar
}

/// The numbers beside the bar, from the lowest: those of pictures, by scale_labels() of src/io/image/pictures/legend.h.
/// `apart`: the least distance of two, of the length of the bar.
export function scaleLabels(scale: Scale, apart = kApart): ScaleLabel[] {
  const [lo, hi] = ends(scale);
  const round = ticks(lo, hi, kScaleSteps);
  const step = round.length > 1 ? round[1] - round[0] : hi - lo;
  const labels: ScaleLabel[] = [];
  const add = (value: number, isLimit: boolean) => {
    const close = labels.some((label) => Math.abs(label.value - value) < apart * (hi - lo));
    if (close && !isLimit) return;
    const isRound = Math.abs(value / step - Math.round(value / step)) < 1e-6;
    labels.push({ value, text: close ? '' : isRound ? tickText(value, step) : valueLabel(value), isLimit });
  };
  add(lo, false);
  add(hi, false);
  if (scale.mode === 'tolerance')
    for (const limit of [scale.lower, scale.upper]) if (limit > lo && limit < hi) add(limit, true);
  for (const value of round) add(value, false);
  return labels.sort((a, b) => a.value - b.value);
}

/// The bar with its labels, below a title; `keys`: other colours, below it.
function draw(
  scale: Scale,
  title: string,
  labelsOf: (apart: number) => ScaleLabel[],
  keys: [color: Vec, words: string][],
): void {
  const [lo, hi] = ends(scale);
  const stops = Array.from({ length: kColors }, (_, i) => {
    const color = css(colorOf(scale, lo + ((i + 0.5) / kColors) * (hi - lo)));
    return `${color} ${(100 * i) / kColors}% ${(100 * (i + 1)) / kColors}%`;
  });
  const bar = make('div', {
    class: 'bar',
    style: `background: linear-gradient(to top, ${stops.join(', ')})`,
  });
  const below = keys.map(([color, words]) =>
    make('p', { class: 'missing' }, make('span', { style: `background: ${css(color)}` }), words),
  );
  byId('legend').replaceChildren(make('p', { class: 'unit' }, title), bar, ...below);
  for (const label of labelsOf(Math.max(kApart, kLine / (bar.clientHeight || Infinity)))) {
    const style = `bottom: ${(100 * (label.value - lo)) / (hi - lo)}%`;
    if (label.isLimit) bar.append(make('span', { class: 'limit', style }));
    if (label.text)
      bar.append(make('span', { class: `tick${label.isLimit ? ' of-limit' : ''}`, style }, label.text));
  }
}

const noValueKey = (noValue: boolean): [Vec, string][] => (noValue ? [[kNoValue, 'no value']] : []);

const titleOf = (quantity: string, unit: string) => (unit ? `${quantity} in ${unit}` : quantity);
const nameOf = (scale: Scale, unit: string) =>
  `Colour scale from ${text(ends(scale)[0])} to ${text(ends(scale)[1])} ${unit}`;

export function drawLegend(scale: Scale, quantity: string, unit: string, noValue: boolean): void {
  draw(scale, titleOf(quantity, unit), (apart) => scaleLabels(scale, apart), noValueKey(noValue));
  byId('legend').setAttribute('aria-label', nameOf(scale, unit));
}

/// The legend of bands of these sets of limits: with their numbers if all have the same, otherwise in units of their limits.
export function drawGroupLegend(
  scale: Scale,
  limits: GroupLimits,
  sets: number[],
  quantity: string,
  unit: string,
  noValue: boolean,
): void {
  const { scale: joined, isRelative, lower, upper, someHaveNone } = limits.joined(sets, scale);
  const labels: ScaleLabel[] = [];
  if (lower) labels.push({ value: -1, text: 'lower', isLimit: true });
  if (upper) labels.push({ value: 1, text: 'upper', isLimit: true });
  const keys = noValueKey(noValue);
  if (someHaveNone) keys.unshift([kUnjudged, 'no limits']);
  draw(
    joined,
    isRelative ? `${quantity}, by the limits of each group` : titleOf(quantity, unit),
    (apart) => (isRelative ? labels : scaleLabels(joined, apart)),
    keys,
  );
  byId('legend').setAttribute(
    'aria-label',
    isRelative
      ? `Colour scale of each group from ${lower ? 'below its lower limit' : 'its least value'} to ${upper ? 'above its upper limit' : 'its largest value'}`
      : nameOf(joined, unit),
  );
}
