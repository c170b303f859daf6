// The colour scale beside the part.
import { Colors, colorOf, css, Scale } from './color_scale';
import { byId, make } from './dom';
import { text, ticks, tickText, valueLabel } from './numbers';

const kColors = 192; // of the bar
const kScaleSteps = 10;
const kApart = 0.06; // numbers, of the length of the bar

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
export function scaleLabels(scale: Scale): ScaleLabel[] {
  const [lo, hi] = ends(scale);
  const round = ticks(lo, hi, kScaleSteps);
  const step = round.length > 1 ? round[1] - round[0] : hi - lo;
  const labels: ScaleLabel[] = [];
  const add = (value: number, isLimit: boolean) => {
    const close = labels.some((label) => Math.abs(label.value - value) < kApart * (hi - lo));
    if (close && !isLimit) return;
    const isRound = Math.abs(value / step - Math.round(value / step)) < 1e-6;
    labels.push({ value, text: close ? '' : isRound ? tickText(value, step) : valueLabel(value), isLimit });
  };
  add(lo, false), add(hi, false);
  if (scale.mode === 'tolerance') for (const limit of [scale.lower, scale.upper]) if (limit > lo && limit < hi) add(limit, true);
  for (const value of round) add(value, false);
  return labels.sort((a, b) => a.value - b.value);
}

export function drawLegend(scale: Scale, colors: Colors, quantity: string, unit: string, noValue: boolean): void {
  const [lo, hi] = ends(scale);
  const stops = Array.from({ length: kColors }, (_, i) => {
    const color = css(colorOf(scale, colors, lo + ((i + 0.5) / kColors) * (hi - lo)));
    return `${color} ${(100 * i) / kColors}% ${(100 * (i + 1)) / kColors}%`;
  });
  const bar = make('div', { class: 'bar', style: `background: linear-gradient(to top, ${stops.join(', ')})` });
  for (const label of scaleLabels(scale)) {
    const style = `bottom: ${(100 * (label.value - lo)) / (hi - lo)}%`;
    if (label.isLimit) bar.append(make('span', { class: 'limit', style }));
    if (label.text) bar.append(make('span', { class: `tick${label.isLimit ? ' of-limit' : ''}`, style }, label.text));
  }
  const legend = byId('legend');
  legend.replaceChildren(make('p', { class: 'unit' }, unit ? `${quantity} in ${unit}` : quantity), bar);
  if (noValue)
    legend.append(
      make('p', { class: 'missing' }, make('span', { style: `background: ${css(colors.no_value[0])}` }), 'no value'),
    );
  legend.setAttribute('aria-label', `Colour scale from ${text(lo)} to ${text(hi)} ${unit}`);
}
