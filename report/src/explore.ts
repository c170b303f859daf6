// Exploring a part by pointer and keyboard: its values under the cursor, and callouts.
import type { Callouts } from './callouts';
import { byId, make } from './dom';
import { exactText, place } from './numbers';
import { Subject, toFile } from './subject';
import type { View } from './view';
import { capital } from './words';

interface ValueWords {
  quantity: string;
  unit: string; ///< with the space before it
  valueText: (distance: number) => string; ///< with the unit
}

interface Explored {
  addCallout: (x: number, y: number) => void; ///< at what is under a place of the canvas
  middle: () => [number, number]; ///< of the canvas, where keys look
}

/// Listens to the canvas of a view; `home` shows what the page opened with.
export function explore(
  view: View,
  subject: Subject,
  callouts: Callouts,
  words: ValueWords,
  home: () => void,
): Explored {
  const { canvas } = view;
  const probe = (x: number, y: number): void => {
    const found = view.find(x, y);
    if (!found) {
      byId('probe-values').replaceChildren();
      return;
    }
    const row = (label: string, text: string, id: string) =>
      make('div', {}, make('dt', {}, label), make('dd', { id }, text));
    const isNone = Number.isNaN(found.distance);
    byId('probe-values').replaceChildren(
      row(
        capital(words.quantity),
        isNone ? 'none in range' : words.valueText(found.distance),
        'probe-distance',
      ),
      row('Position', place(toFile(subject, found.at), subject.size) + words.unit, 'probe-position'),
      ...(isNone ? [] : [row('Not rounded', exactText(found.distance) + words.unit, 'probe-exact')]),
      ...found.rows.map(([label, text, id]) => row(label, text, id)),
    );
  };
  const addCallout = (x: number, y: number): void => {
    const found = view.find(x, y);
    if (!found || Number.isNaN(found.distance)) return;
    const { distance, at, detail } = found;
    callouts.add({ distance, point: toFile(subject, at), at, detail });
  };
  listenToPointer(canvas, probe, addCallout);
  const middle = (): [number, number] => [canvas.clientWidth / 2, canvas.clientHeight / 2];
  const actions: Record<string, () => void> = {
    ArrowLeft: () => view.turn(-10, 0),
    ArrowRight: () => view.turn(10, 0),
    ArrowUp: () => view.turn(0, 10),
    ArrowDown: () => view.turn(0, -10),
    '+': () => view.zoom(0.85),
    '=': () => view.zoom(0.85),
    '-': () => view.zoom(1 / 0.85),
    Home: home,
    Enter: () => addCallout(...middle()),
  };
  canvas.addEventListener('keydown', (event) => {
    const action = actions[event.key];
    if (!action || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    byId('view').classList.add('keyboard');
    action();
    probe(...middle());
  });
  canvas.addEventListener('focus', () =>
    byId('view').classList.toggle('keyboard', canvas.matches(':focus-visible')),
  );
  canvas.addEventListener('blur', () => byId('view').classList.remove('keyboard'));
  return { addCallout, middle };
}

/// Probes where the pointer is, at most once a frame, and picks where it is pressed and released.
function listenToPointer(
  canvas: HTMLCanvasElement,
  probe: (x: number, y: number) => void,
  pick: (x: number, y: number) => void,
): void {
  let next: (() => void) | null = null;
  const later = (action: () => void) => {
    if (!next)
      requestAnimationFrame(() => {
        next?.();
        next = null;
      });
    next = action;
  };
  const at = (event: PointerEvent): [number, number] => [event.offsetX, event.offsetY];
  let pressed: [number, number] | null = null;
  canvas.addEventListener('pointermove', (event) => {
    const [x, y] = at(event); // now: after its dispatch an event has no target that they refer to
    if (event.buttons === 0) later(() => probe(x, y));
  });
  canvas.addEventListener('pointerdown', (event) => {
    pressed = event.button === 0 ? at(event) : null;
  });
  canvas.addEventListener('pointerup', (event) => {
    const [x, y] = at(event);
    if (!pressed || Math.hypot(x - pressed[0], y - pressed[1]) > 4) return;
    pressed = null;
    probe(x, y);
    pick(x, y);
  });
}
