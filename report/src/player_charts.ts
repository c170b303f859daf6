// Curves over the frames, with a cursor at the frame that is shown.
import { make, makeSvg } from './dom';
import { text, ticks, tickText } from './numbers';
import type { Panel } from './player_data';

const kHeight = 132;
const kLeft = 72;
const kTop = 10;
const kBottom = 24;
const kStyles = ['first', 'second', 'third']; // of curves: colour and dashes

/// A piece of a curve, before its name.
function swatch(i: number): SVGElement {
  const svg = makeSvg('svg', {
    class: 'swatch',
    viewBox: '0 0 22 8',
    width: 22,
    height: 8,
    'aria-hidden': 'true',
  });
  svg.append(makeSvg('path', { class: `curve ${kStyles[i % kStyles.length]}`, d: 'M1 4H21' }));
  return svg;
}

export class Chart {
  readonly element: HTMLElement;
  private readonly title: string;
  private readonly unit: string; // after numbers
  private readonly svg = makeSvg('svg', { 'aria-hidden': 'true' });
  private readonly cursor = makeSvg('line', { class: 'cursor', y1: kTop, y2: kHeight - kBottom });
  private readonly readout = make('span', { class: 'readout' });
  private width = 0;
  private shown = 0; // a place among the frames

  /// `pick` is called with a place among `frames` when the chart is clicked. A title that ends with the units in
  /// brackets is of lengths.
  constructor(
    private readonly panel: Panel,
    private readonly frames: number[],
    units: string,
    pick: (place: number) => void,
  ) {
    const end = ` (${units})`;
    const isLength = units !== '' && panel.title.endsWith(end);
    this.title = isLength ? panel.title.slice(0, -end.length) : panel.title;
    this.unit = isLength ? `\u00a0${units}` : '';
    const { svg } = this;
    const picked = (event: Event) => {
      const { left, width: shown } = svg.getBoundingClientRect();
      const x = (((event as PointerEvent).clientX - left) / shown) * this.width;
      const part = (x - kLeft) / (this.width - kLeft - 8);
      pick(Math.round(Math.min(1, Math.max(0, part)) * (frames.length - 1)));
    };
    svg.addEventListener('pointerdown', (event) => {
      (svg as Element).setPointerCapture((event as PointerEvent).pointerId);
      picked(event);
    });
    svg.addEventListener('pointermove', (event) => {
      if ((event as PointerEvent).buttons & 1) picked(event);
    });
    this.element = make(
      'div',
      { class: 'chart', role: 'img', 'aria-label': `${this.title} over the frames: ${this.range()}` },
      make('h3', {}, this.title, ' ', this.readout),
      svg,
    );
  }

  /// Draws the chart that wide, in pixels.
  draw(width: number): void {
    if (width === this.width || width <= 0) return;
    this.width = width;
    const { svg, panel } = this;
    svg.setAttribute('viewBox', `0 0 ${width} ${kHeight}`);
    svg.replaceChildren();
    this.shadeNegative();
    this.drawAxes();
    panel.curves.forEach((curve, i) => svg.append(this.path(curve.values, kStyles[i % kStyles.length])));
    svg.append(this.cursor);
    this.show(this.shown);
  }

  show(place: number): void {
    this.shown = place;
    const x = this.x(place);
    this.cursor.setAttribute('x1', String(x));
    this.cursor.setAttribute('x2', String(x));
    const { curves } = this.panel;
    this.readout.replaceChildren(
      ...curves.map(({ name, values }, i) =>
        make(
          'span',
          {},
          ...(curves.length > 1 ? [swatch(i), ` ${name} `] : []),
          `${text(values[place])}${values[place] === null ? '' : this.unit}`,
        ),
      ),
      ...(this.hasSigns()
        ? [
            make(
              'span',
              {},
              make('span', { class: 'negative', 'aria-hidden': 'true' }),
              'frames with negative values',
            ),
          ]
        : []),
    );
  }

  private hasSigns(): boolean {
    const values = this.values();
    return values.some((v) => v < 0) && values.some((v) => v > 0);
  }

  // Frames with a negative value: on the axis it may be too small to be seen.
  private shadeNegative(): void {
    if (!this.hasSigns()) return;
    const isNegative = (place: number) => this.panel.curves.some(({ values }) => (values[place] ?? 0) < 0);
    const half = (this.x(1) - this.x(0)) / 2;
    for (let place = 0; place < this.frames.length; ++place) {
      if (!isNegative(place)) continue;
      const from = place;
      while (place + 1 < this.frames.length && isNegative(place + 1)) ++place;
      const left = Math.max(kLeft, this.x(from) - half);
      const right = Math.min(this.width - 8, this.x(place) + half);
      this.svg.append(
        makeSvg('rect', {
          class: 'negative',
          x: left,
          y: kTop,
          width: right - left,
          height: kHeight - kTop - kBottom,
        }),
      );
    }
  }

  private values(): number[] {
    return this.panel.curves.flatMap(({ values }) => values.filter((v): v is number => v !== null));
  }

  private range(): string {
    const values = this.values();
    return values.length === 0
      ? 'no values'
      : `from ${text(Math.min(...values))} to ${text(Math.max(...values))}${this.unit}`;
  }

  private ends(): [number, number] {
    const values = this.values();
    let lo = Math.min(...values, Infinity);
    let hi = Math.max(...values, -Infinity);
    if (!(lo <= hi)) [lo, hi] = [0, 1];
    if (lo > 0 && lo < 0.5 * hi) lo = 0;
    if (lo === 0 && hi === 0) hi = 1;
    return hi - lo > 1e-9 * Math.abs(hi)
      ? [lo, hi]
      : [lo - 0.5 * (Math.abs(lo) || 1), hi + 0.5 * (Math.abs(hi) || 1)];
  }

  private x(place: number): number {
    return kLeft + (place / Math.max(1, this.frames.length - 1)) * (this.width - kLeft - 8);
  }

  private y(value: number): number {
    const [lo, hi] = this.ends();
    return kTop + (1 - (value - lo) / (hi - lo)) * (kHeight - kTop - kBottom);
  }

  private drawAxes(): void {
    const { svg } = this;
    const [lo, hi] = this.ends();
    const marks = ticks(lo, hi, 3);
    const step = marks.length > 1 ? marks[1] - marks[0] : hi - lo;
    for (const mark of marks) {
      svg.append(
        makeSvg('line', { class: 'grid', x1: kLeft, x2: this.width - 8, y1: this.y(mark), y2: this.y(mark) }),
      );
      svg.append(
        makeSvg(
          'text',
          { x: kLeft - 6, y: this.y(mark) + 4, 'text-anchor': 'end' },
          `${tickText(mark, step)}${this.unit}`,
        ),
      );
    }
    if (lo < 0 && hi > 0)
      svg.append(
        makeSvg('line', { class: 'axis', x1: kLeft, x2: this.width - 8, y1: this.y(0), y2: this.y(0) }),
      );
    svg.append(makeSvg('text', { x: kLeft - 6, y: kHeight - 6, 'text-anchor': 'end' }, 'frame'));
    const last = this.frames.length - 1;
    const places = ticks(0, Math.max(1, last), Math.max(2, this.width / 90)).filter(
      (p) => Number.isInteger(p) && p <= last,
    );
    for (const place of places)
      svg.append(
        makeSvg(
          'text',
          { x: this.x(place), y: kHeight - 6, 'text-anchor': 'middle' },
          String(this.frames[place]),
        ),
      );
  }

  private path(values: (number | null)[], style: string): SVGElement {
    let d = '';
    let drawing = false;
    values.forEach((value, place) => {
      if (value !== null)
        d += `${drawing ? 'L' : 'M'}${this.x(place).toFixed(1)} ${this.y(value).toFixed(1)}${drawing ? '' : 'h0'}`;
      drawing = value !== null;
    });
    return makeSvg('path', { class: `curve ${style}`, d });
  }
}
