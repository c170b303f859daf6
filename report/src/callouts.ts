// Labels at points of the part that stay, with their values.
import { byId, make, makeSvg } from './dom';
import { place } from './numbers';
import type { Vec } from './page_data';
import type { View } from './view';

export interface Callout {
  distance: number;
  point: Vec; ///< of the mesh
  at: Vec; ///< the same in units of the model
  detail: string;
}

interface Placed extends Callout {
  number: number;
  hidden: boolean;
  label: HTMLElement;
  dot: SVGElement;
  line: SVGElement;
  item: HTMLElement;
}

export class Callouts {
  private readonly placed: Placed[] = [];
  private count = 0;
  private timer = 0;

  constructor(
    private readonly view: View,
    private readonly valueText: (distance: number) => string, // with its unit
    private readonly unit: string, // after a position
    private readonly size: number, // of the part
    private readonly show: (at: Vec) => void,
  ) {}

  add(callout: Callout): void {
    const number = ++this.count;
    const value = this.valueText(callout.distance);
    const remove = () => this.remove(number);
    const item = make(
      'li',
      { value: number },
      make('button', { type: 'button', class: 'link', click: () => this.show(callout.at), 'aria-label': `Show callout ${number}, ${value}` }, value),
      ` at ${place(callout.point, this.size)}${this.unit}${callout.detail ? `, ${callout.detail}` : ''} `,
      make('button', { type: 'button', class: 'remove', click: remove, 'aria-label': `Remove callout ${number}` }, '×'),
    );
    const label = make('div', { class: 'callout' }, make('b', {}, String(number)), ` ${value}`);
    const dot = makeSvg('circle', { r: 4 });
    const line = makeSvg('line', {});
    byId('labels').append(label);
    byId('leaders').append(line, dot);
    byId('callout-list').append(item);
    byId('callouts').classList.remove('empty');
    this.placed.push({ ...callout, number, hidden: false, label, dot, line, item });
    this.update();
  }

  /// Those that are shown.
  get all(): Callout[] {
    return this.placed.map(({ distance, point, at, detail }) => ({ distance, point, at, detail }));
  }

  private remove(number: number): void {
    const index = this.placed.findIndex((c) => c.number === number);
    if (index < 0) return;
    const [callout] = this.placed.splice(index, 1);
    for (const element of [callout.label, callout.dot, callout.line, callout.item]) element.remove();
    byId('callouts').classList.toggle('empty', this.placed.length === 0);
    this.view.canvas.focus();
  }

  /// After each picture: labels follow the points; soon after the last one, those behind the part fade.
  update(): void {
    const { clientWidth, clientHeight } = this.view.canvas;
    const most = byId('legend').offsetLeft - 4; // labels are beside the legend
    for (const c of this.placed) {
      const { x, y, behind } = this.view.place(c.at);
      const isCutAway = this.view.isCutAway(c.at);
      c.item.classList.toggle('cut-away', isCutAway);
      const width = c.label.offsetWidth;
      const right = x < clientWidth * 0.6 && x + 26 + width <= most;
      const lx = right ? Math.max(x + 26, 4) : Math.max(Math.min(x - 26, most), width + 4);
      const ly = Math.min(Math.max(y - 30, 14), clientHeight - 14);
      c.label.style.transform = `translate(${lx}px, ${ly}px) translate(${right ? '0' : '-100%'}, -50%)`;
      c.dot.setAttribute('cx', String(x));
      c.dot.setAttribute('cy', String(y));
      c.line.setAttribute('x1', String(x));
      c.line.setAttribute('y1', String(y));
      c.line.setAttribute('x2', String(lx));
      c.line.setAttribute('y2', String(ly));
      for (const element of [c.label, c.dot, c.line]) {
        element.classList.toggle('outside', behind || isCutAway);
        element.classList.toggle('behind', c.hidden);
      }
    }
    window.clearTimeout(this.timer);
    if (this.placed.length > 0) this.timer = window.setTimeout(() => this.findHidden(), 120);
  }

  private findHidden(): void {
    for (const c of this.placed) {
      c.hidden = this.view.isHidden(c.at);
      for (const element of [c.label, c.dot, c.line]) element.classList.toggle('behind', c.hidden);
    }
  }
}
