// The place and the frame that a player opens on, and its mark in the picture.
import { byId, make, makeSvg } from './dom';
import type { Vec } from './page_data';
import { distancesOf, PlayerData } from './player_data';
import type { Viewer } from './viewer';

export interface Worst {
  frame: number; ///< among those in the page
  body: number;
  vertex: number;
  distance: number;
  isLeast: boolean; ///< of all distances; otherwise the largest
}

/// The distance that is farthest out of the tolerance; without one the least, or, where all are negative as inside of a
/// box, the largest: where the bodies are nearest to touching, or overlap most. Cost: linear in all distances.
export function worstOf(data: PlayerData): Worst | null {
  let least: Worst | null = null;
  let largest: Worst | null = null;
  data.bodies.forEach(({ distances, vertices }, body) => {
    if (!distances) return;
    const values = new Float32Array(vertices);
    for (let frame = 0; frame < data.page.shown.length; ++frame) {
      distancesOf(data, body, frame, values);
      values.forEach((distance, vertex) => {
        if (Number.isNaN(distance)) return;
        if (!least || distance < least.distance) least = { frame, body, vertex, distance, isLeast: true };
        if (!largest || distance > largest.distance) largest = { frame, body, vertex, distance, isLeast: false };
      });
    }
  });
  const [lo, hi] = [least as Worst | null, largest as Worst | null];
  if (!lo || !hi) return null;
  const { mode, lower, upper } = data.page.scale;
  if (mode === 'tolerance') return hi.distance - upper > lower - lo.distance ? hi : lo;
  return hi.distance <= 0 ? hi : lo;
}

/// A label at a point of the scene.
export class Mark {
  private readonly label: HTMLElement;
  private readonly dot = makeSvg('circle', { r: 4 });
  private readonly line = makeSvg('line', {});
  private at: Vec | null = null;

  constructor(private readonly viewer: Viewer, text: string) {
    this.label = make('div', { class: 'callout' }, text);
    byId('labels').append(this.label);
    byId('leaders').append(this.line, this.dot);
    this.show(null);
  }

  /// Moves the mark; null: hides it.
  show(at: Vec | null): void {
    this.at = at;
    this.update();
  }

  /// After each picture.
  update(): void {
    const { clientWidth, clientHeight } = this.viewer.canvas;
    const { x, y, behind } = this.viewer.place(this.at ?? [0, 0, 0]);
    const right = x < clientWidth * 0.6;
    const lx = Math.min(Math.max(x + (right ? 26 : -26), 4), clientWidth - 4);
    const ly = Math.min(Math.max(y - 30, 14), clientHeight - 14);
    this.label.style.transform = `translate(${lx}px, ${ly}px) translate(${right ? '0' : '-100%'}, -50%)`;
    for (const [name, value] of Object.entries({ cx: x, cy: y })) this.dot.setAttribute(name, String(value));
    for (const [name, value] of Object.entries({ x1: x, y1: y, x2: lx, y2: ly })) this.line.setAttribute(name, String(value));
    for (const element of [this.label, this.dot, this.line]) element.classList.toggle('outside', behind || this.at === null);
  }
}
