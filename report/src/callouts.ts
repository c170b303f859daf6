// Labels at points of the part that stay, with their values.
import { byId, make } from './dom';
import { Label } from './label';
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
  label: Label;
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
      make(
        'button',
        {
          type: 'button',
          class: 'link',
          click: () => this.show(callout.at),
          'aria-label': `Show callout ${number}, ${value}`,
        },
        value,
      ),
      ` at ${place(callout.point, this.size)}${this.unit}${callout.detail ? `, ${callout.detail}` : ''} `,
      make(
        'button',
        { type: 'button', class: 'remove', click: remove, 'aria-label': `Remove callout ${number}` },
        '×',
      ),
    );
    const label = new Label(this.view, make('b', {}, String(number)), ` ${value}`);
    byId('callout-list').append(item);
    byId('callouts').classList.remove('empty');
    this.placed.push({ ...callout, number, label, item });
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
    callout.label.remove();
    callout.item.remove();
    byId('callouts').classList.toggle('empty', this.placed.length === 0);
    this.view.canvas.focus();
  }

  /// Makes all again, as their unit is another one.
  renew(): void {
    const { all } = this;
    this.clear();
    for (const callout of all) this.add(callout);
  }

  /// Takes all away; the next one is the first.
  clear(): void {
    for (const { label, item } of this.placed.splice(0)) {
      label.remove();
      item.remove();
    }
    this.count = 0;
    byId('callouts').classList.add('empty');
  }

  /// After each picture: labels follow the points; soon after the last one, those behind the part fade.
  update(): void {
    for (const { label, at, item } of this.placed) {
      const isCutAway = this.view.isCutAway(at);
      item.classList.toggle('cut-away', isCutAway);
      label.show(isCutAway ? null : at);
    }
    window.clearTimeout(this.timer);
    if (this.placed.length > 0) this.timer = window.setTimeout(() => this.findHidden(), 120);
  }

  private findHidden(): void {
    for (const { label, at } of this.placed) label.mark('behind', this.view.isHidden(at));
  }
}
