// The colour scale beside the part.
import { Colors, colorOf, css, Scale } from './color_scale';
import { byId, make } from './dom';
import { text, ticks, tickText } from './numbers';

const kSteps = 96;

/// The distances at the ends of the bar: those of the scale, symmetric where its colours are.
export function ends(scale: Scale): [number, number] {
  if (scale.mode !== 'diverging') return [scale.lo, scale.hi];
  const reach = Math.max(Math.abs(scale.lo), Math.abs(scale.hi));
  return [-reach, reach];
}

export function drawLegend(scale: Scale, colors: Colors, quantity: string, unit: string, noValue: boolean): void {
  const [lo, hi] = ends(scale);
  const stops = Array.from({ length: kSteps }, (_, i) => {
    const color = css(colorOf(scale, colors, lo + ((i + 0.5) / kSteps) * (hi - lo)));
    return `${color} ${(100 * i) / kSteps}% ${(100 * (i + 1)) / kSteps}%`;
  });
  const at = (d: number) => `${(100 * (d - lo)) / (hi - lo)}%`;
  const marks = ticks(lo, hi, 6);
  const step = marks.length > 1 ? marks[1] - marks[0] : hi - lo;
  const bar = make('div', { class: 'bar', style: `background: linear-gradient(to top, ${stops.join(', ')})` });
  for (const mark of marks)
    bar.append(make('span', { class: 'tick', style: `bottom: ${at(mark)}` }, tickText(mark, step)));
  if (scale.mode === 'tolerance')
    for (const limit of [scale.lower, scale.upper])
      if (limit > lo && limit < hi) bar.append(make('span', { class: 'limit', style: `bottom: ${at(limit)}` }));
  const legend = byId('legend');
  legend.replaceChildren(make('p', { class: 'unit' }, unit ? `${quantity} in ${unit}` : quantity), bar);
  if (noValue)
    legend.append(
      make('p', { class: 'missing' }, make('span', { style: `background: ${css(colors.no_value[0])}` }), 'no value'),
    );
  legend.setAttribute('aria-label', `Colour scale from ${text(lo)} to ${text(hi)} ${unit}`);
}
