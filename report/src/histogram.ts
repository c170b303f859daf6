// How the area of the part, or its points, are distributed over the distances.
import { colorOf, css, Scale } from './color_scale';
import { byId, make, makeSvg } from './dom';
import { ends } from './legend';
import { percent, text, ticks, tickText } from './numbers';
import type { AreaByValue } from './area_by_value';
import type { Report } from './page_data';
import { distanceText } from './precision';
import { Limits, realLimits, unitOf, wholeOf } from './verdict';
import { capital, isSigned, quantityOf } from './words';

const kBins = 48;
const kHeight = 236;
const kLeft = 60;
const kRight = 20;
const kTop = 26;
const kBottom = 50;
const kFloor = kHeight - kBottom;
const kLeastBar = 1.5; // pixels of a bin that is not empty
const kMostEmpty = 4; // lengths of the range of values that the chart may have, to reach a limit

/// The distances at the ends of the chart: what has values in the colours of the scale, and limits that are not far
/// from it.
function rangeOf(area: AreaByValue, scale: Scale, { lower, upper }: Limits): [number, number] {
  const [first, last] = ends(scale);
  let [lo, hi] = [Math.max(first, area.lo), Math.min(last, area.hi)];
  if (!(lo < hi)) [lo, hi] = [first, last];
  const most = kMostEmpty * (hi - lo);
  const [left, right] = [lo, hi];
  if (lower < lo && right - lower <= most) lo = lower;
  if (upper > hi && upper - left <= most) hi = upper;
  const margin = 0.04 * (hi - lo);
  return [lo === lower ? lo - margin : lo, hi === upper ? hi + margin : hi];
}

/// Heights by the share of the whole, and the shares at the lines of a grid.
function heights(shares: number[], logarithmic: boolean): { y: (share: number) => number; grid: number[] } {
  const most = Math.max(...shares, 1e-9);
  if (!logarithmic)
    return { y: (share) => kTop + (1 - share / most) * (kFloor - kTop), grid: ticks(0, most, 4) };
  const least = Math.max(-6, Math.floor(Math.log10(Math.min(...shares.filter((share) => share > 0), most))));
  const top = Math.max(least + 1, Math.log10(most));
  const grid = Array.from({ length: Math.floor(top + 1e-9) - least + 1 }, (_, i) => 10 ** (least + i));
  const height = (share: number) => (Math.log10(Math.max(share, 10 ** least)) - least) / (top - least);
  return { y: (share) => kFloor - height(share) * (kFloor - kTop), grid };
}

/// The limits, each with its number, and tints of what is beyond them; a limit that is not in the chart at its side.
function limitMarks(
  { lower, upper }: Limits,
  [lo, hi]: [number, number],
  x: (d: number) => number,
  unit: string,
): [SVGElement[], SVGElement[]] {
  const tints: SVGElement[] = [];
  const lines: SVGElement[] = [];
  const [left, right] = [x(lo), x(hi)];
  for (const [limit, from, to, beyond] of [
    [lower, left, x(lower), lower < lo],
    [upper, x(upper), right, upper > hi],
  ] as const) {
    if (!Number.isFinite(limit)) continue;
    const at = Math.min(Math.max(x(limit), left), right);
    const isInside = limit >= lo && limit <= hi;
    const [a, b] = [Math.min(Math.max(from, left), right), Math.min(Math.max(to, left), right)];
    if (!beyond && b > a)
      tints.push(makeSvg('rect', { class: 'out', x: a, y: kTop, width: b - a, height: kFloor - kTop }));
    lines.push(
      makeSvg('line', {
        class: isInside ? 'limit' : 'limit beyond',
        x1: at,
        x2: at,
        y1: kTop,
        y2: kFloor,
        'data-limit': limit,
      }),
    );
    const words = `${beyond && limit === lower ? '← ' : ''}${text(limit)}${unit ? ` ${unit}` : ''}${beyond && limit === upper ? ' →' : ''}`;
    const isLower = limit === lower && lower !== upper;
    const anchor =
      at < left + 40
        ? 'start'
        : at > right - 40
          ? 'end'
          : upper - lower < 0.3 * (hi - lo)
            ? isLower
              ? 'end'
              : 'start'
            : 'middle';
    lines.push(makeSvg('text', { class: 'limit-text', x: at, y: kTop - 8, 'text-anchor': anchor }, words));
  }
  return [tints, lines];
}

/// Fills the chart, as wide as its place is.
export function drawHistogram(report: Report, area: AreaByValue, scale: Scale, logarithmic: boolean): void {
  const [whole, quantity, unit, limits] = [
    wholeOf(report),
    quantityOf(report),
    report.units ?? '',
    realLimits(scale, report),
  ];
  const plotWidth = Math.max(280, byId('histogram-chart').clientWidth || 640);
  const [lo, hi] = rangeOf(area, scale, limits);
  const width = (hi - lo) / kBins;
  const shares = Array.from({ length: kBins }, (_, i) =>
    area.within(lo + i * width - (i === 0 ? width * 1e-9 : 0), lo + (i + 1) * width),
  );
  const x = (d: number) => kLeft + ((d - lo) / (hi - lo)) * (plotWidth - kLeft - kRight);
  const { y, grid } = heights(shares, logarithmic);
  const svg = makeSvg('svg', { viewBox: `0 0 ${plotWidth} ${kHeight}`, 'aria-hidden': 'true' });
  const [tints, limitLines] = limitMarks(limits, [lo, hi], x, unit);
  svg.append(...tints);
  for (const share of grid) {
    svg.append(
      makeSvg('line', { class: 'grid', x1: kLeft, x2: plotWidth - kRight, y1: y(share), y2: y(share) }),
    );
    svg.append(
      makeSvg('text', { x: kLeft - 6, y: y(share) + 4, 'text-anchor': 'end' }, `${text(100 * share, 3)} %`),
    );
  }
  shares.forEach((share, i) => {
    const from = lo + i * width;
    const height = share > 0 ? Math.max(kLeastBar, kFloor - y(share)) : 0;
    const bar = makeSvg('rect', {
      class: 'bin',
      x: x(from) + 0.5,
      y: kFloor - height,
      width: x(from + width) - x(from) - 1,
      height,
      fill: css(colorOf(scale, from + width / 2)),
    });
    bar.append(
      makeSvg(
        'title',
        {},
        `${text(from)} to ${text(from + width)}${unit ? ` ${unit}` : ''}: ${percent(share)} of the ${whole}`,
      ),
    );
    svg.append(bar);
  });
  svg.append(...limitLines);
  const marks = ticks(lo, hi, plotWidth / 70);
  const step = marks.length > 1 ? marks[1] - marks[0] : hi - lo;
  for (const mark of marks) {
    svg.append(makeSvg('line', { class: 'axis', x1: x(mark), x2: x(mark), y1: kFloor, y2: kFloor + 4 }));
    svg.append(
      makeSvg(
        'text',
        { class: 'tick-text', x: x(mark), y: kFloor + 18, 'text-anchor': 'middle' },
        tickText(mark, step),
      ),
    );
  }
  svg.append(makeSvg('line', { class: 'axis', x1: kLeft, x2: plotWidth - kRight, y1: kFloor, y2: kFloor }));
  svg.append(
    makeSvg(
      'text',
      { x: (kLeft + plotWidth - kRight) / 2, y: kFloor + 38, 'text-anchor': 'middle' },
      unit ? `${quantity} in ${unit}` : quantity,
    ),
  );

  const sentence = sentenceOf(report, area, [lo, hi], logarithmic);
  byId('histogram-chart').replaceChildren(
    make(
      'div',
      { role: 'img', class: 'chart', 'aria-label': `Histogram of the ${whole} by ${quantity}. ${sentence}` },
      svg,
    ),
    make('p', { class: 'hint' }, sentence),
  );
}

/// The range of the values, and what is not in the chart.
function sentenceOf(
  report: Report,
  area: AreaByValue,
  [lo, hi]: [number, number],
  logarithmic: boolean,
): string {
  const below = area.upTo(lo - ((hi - lo) / kBins) * 1e-9);
  const without = area.withoutValue;
  const above = Math.max(0, 1 - without - area.upTo(hi));
  const whole = wholeOf(report);
  const [min, max] = (['min', 'max'] as const).map(
    (end) => report.extremes?.[end]?.distance ?? (report.distance?.[end] as number | null),
  );
  const shown = (d: number) => distanceText(d, report, isSigned(report));
  const beside = [
    below > 0 && `${percent(below)} below the chart`,
    above > 0 && `${percent(above)} above the chart`,
    without > 0 && `${percent(without)} without a value`,
  ].filter(Boolean);
  return (
    (typeof min === 'number' && typeof max === 'number'
      ? `${capital(quantityOf(report))} from ${shown(min)} to ${shown(max)}${unitOf(report)}`
      : 'No values') +
    (beside.length > 0 ? `; of the ${whole}, ${beside.join(', ')}` : '') +
    (report.group_tolerances ? '. The limits of groups are not in this chart' : '') +
    (logarithmic ? '. Each line of the grid is ten times the one below it' : '') +
    (whole === 'area' ? '. Areas are estimates from the samples.' : '. All points of the cloud were counted.')
  );
}
