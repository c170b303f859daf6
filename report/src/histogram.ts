// How the area of the part, or its points, are distributed over the distances.
import { Colors, colorOf, css, Scale } from './color_scale';
import { byId, make, makeSvg } from './dom';
import { ends } from './legend';
import { percent, text, ticks, tickText } from './numbers';
import type { AreaByValue } from './area_by_value';
import type { Limits } from './verdict';

const kBins = 48;
const kHeight = 210;
const kLeft = 46;
const kRight = 20;
const kTop = 12;
const kBottom = 36;

/// Fills the chart, as wide as its place is.
export function drawHistogram(area: AreaByValue, whole: 'area' | 'points', scale: Scale, colors: Colors, limits: Limits, unit: string): void {
  const plotWidth = Math.max(280, byId('histogram-chart').clientWidth || 640);
  let [lo, hi] = ends(scale);
  // What has values, and the limits: the rest of the scale would be empty.
  lo = Math.max(lo, Math.min(area.lo, limits.lower));
  hi = Math.min(hi, Math.max(area.hi, limits.upper));
  if (area.lo >= 0) lo = Math.max(lo, 0);
  if (!(lo < hi)) [lo, hi] = ends(scale);
  const width = (hi - lo) / kBins;
  const shares = Array.from({ length: kBins }, (_, i) =>
    area.within(lo + i * width - (i === 0 ? width * 1e-9 : 0), lo + (i + 1) * width),
  );
  const most = Math.max(...shares, 1e-9);
  const x = (d: number) => kLeft + ((d - lo) / (hi - lo)) * (plotWidth - kLeft - kRight);
  const y = (share: number) => kTop + (1 - share / most) * (kHeight - kTop - kBottom);
  const svg = makeSvg('svg', { viewBox: `0 0 ${plotWidth} ${kHeight}`, 'aria-hidden': 'true' });
  for (const share of ticks(0, most, 4)) {
    svg.append(makeSvg('line', { class: 'grid', x1: kLeft, x2: plotWidth - kRight, y1: y(share), y2: y(share) }));
    svg.append(makeSvg('text', { x: kLeft - 6, y: y(share) + 4, 'text-anchor': 'end' }, `${text(100 * share, 3)} %`));
  }
  shares.forEach((share, i) => {
    const from = lo + i * width;
    const bar = makeSvg('rect', {
      class: 'bin',
      x: x(from) + 0.5,
      y: y(share),
      width: x(from + width) - x(from) - 1,
      height: Math.max(0, y(0) - y(share)),
      fill: css(colorOf(scale, colors, from + width / 2)),
    });
    bar.append(makeSvg('title', {}, `${text(from)} to ${text(from + width)}: ${percent(share)} of the ${whole}`));
    svg.append(bar);
  });
  for (const limit of [limits.lower, limits.upper])
    if (limit > lo && limit < hi) {
      svg.append(makeSvg('line', { class: 'limit', x1: x(limit), x2: x(limit), y1: kTop, y2: y(0) }));
    }
  const marks = ticks(lo, hi, plotWidth / 70);
  const step = marks.length > 1 ? marks[1] - marks[0] : hi - lo;
  for (const mark of marks) {
    svg.append(makeSvg('line', { class: 'axis', x1: x(mark), x2: x(mark), y1: y(0), y2: y(0) + 4 }));
    svg.append(makeSvg('text', { x: x(mark), y: y(0) + 18, 'text-anchor': 'middle' }, tickText(mark, step)));
  }
  svg.append(makeSvg('line', { class: 'axis', x1: kLeft, x2: plotWidth - kRight, y1: y(0), y2: y(0) }));

  const below = area.upTo(lo - width * 1e-9);
  const above = Math.max(0, 1 - area.withoutValue - area.upTo(hi));
  const without = area.withoutValue;
  const sentence =
    `${percent(Math.max(0, 1 - without - below - above))} of the ${whole} ${whole === 'area' ? 'is' : 'are'} between ${text(lo)} and ${text(hi)}${unit ? ` ${unit}` : ''}` +
    (below > 0 ? `, ${percent(below)} below` : '') +
    (above > 0 ? `, ${percent(above)} above` : '') +
    (without > 0 ? `, ${percent(without)} without a value` : '') +
    (whole === 'area' ? '. Areas are estimates from the samples.' : '. All points of the cloud were counted.');
  byId('histogram-chart').replaceChildren(
    make('div', { role: 'img', class: 'chart', 'aria-label': `Histogram of the ${whole} by distance. ${sentence}` }, svg),
    make('p', { class: 'hint' }, sentence),
  );
}
