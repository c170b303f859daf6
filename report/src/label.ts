// A label beside a point of the picture, with a line to the point.
import { byId, make, makeSvg } from './dom';
import type { Vec } from './page_data';
import type { Viewer } from './viewer';

export class Label {
  private readonly label: HTMLElement;
  private readonly dot = makeSvg('circle', { r: 4 });
  private readonly halo = makeSvg('line', { class: 'halo' });
  private readonly line = makeSvg('line', {});

  constructor(
    private readonly viewer: Viewer,
    ...words: (Node | string)[]
  ) {
    this.label = make('div', { class: 'callout' }, ...words);
    byId('labels').append(this.label);
    byId('leaders').append(this.halo, this.line, this.dot);
  }

  private get parts(): Element[] {
    return [this.label, this.halo, this.line, this.dot];
  }

  /// Moves the label to a point of the scene, beside the legend; null: hides it.
  show(at: Vec | null): void {
    const { clientWidth, clientHeight } = this.viewer.canvas;
    const most = byId('legend').offsetLeft - 4;
    const { x, y, behind } = this.viewer.place(at ?? [0, 0, 0]);
    const width = this.label.offsetWidth;
    const right = x < clientWidth * 0.6 && x + 26 + width <= most;
    const lx = right ? Math.max(x + 26, 4) : Math.max(Math.min(x - 26, most), width + 4);
    const ly = Math.min(Math.max(y - 30, 14), clientHeight - 14);
    this.label.style.transform = `translate(${lx}px, ${ly}px) translate(${right ? '0' : '-100%'}, -50%)`;
    const set = (element: Element, numbers: Record<string, number>) =>
      Object.entries(numbers).forEach(([name, value]) => element.setAttribute(name, String(value)));
    set(this.dot, { cx: x, cy: y });
    for (const line of [this.halo, this.line]) set(line, { x1: x, y1: y, x2: lx, y2: ly });
    this.mark('outside', behind || at === null);
  }

  /// Sets a class of all parts, or takes it away.
  mark(name: string, on: boolean): void {
    for (const element of this.parts) element.classList.toggle(name, on);
  }

  remove(): void {
    for (const element of this.parts) element.remove();
  }
}
