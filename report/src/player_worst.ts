// The place and the frame that a player opens on, and its mark in the picture.
import { Label } from './label';
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
        if (!largest || distance > largest.distance)
          largest = { frame, body, vertex, distance, isLeast: false };
      });
    }
  });
  const [lo, hi] = [least as Worst | null, largest as Worst | null];
  if (!lo || !hi) return null;
  const { mode, lower, upper } = data.page.scale;
  if (mode === 'tolerance') return hi.distance - upper > lower - lo.distance ? hi : lo;
  return hi.distance <= 0 ? hi : lo;
}

/// A label at a point of the scene that stays where it is.
export class Mark {
  private readonly label: Label;
  private at: Vec | null = null;

  constructor(viewer: Viewer, text: string) {
    this.label = new Label(viewer, text);
    this.update();
  }

  /// Moves the mark; null: hides it.
  show(at: Vec | null): void {
    this.at = at;
    this.update();
  }

  /// After each picture.
  update(): void {
    this.label.show(this.at);
  }
}
