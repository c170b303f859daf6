// Keys of the canvas that move the reference, besides those that turn the view.
import type { Vec } from '../src/page_data';
import type { Motion } from './motion';
import type { LiveView } from './view';

const kStep = 0.03; // in units of the scene
const kTurn = 5; // degrees
const kShifts: Record<string, Vec> = {
  ArrowLeft: [-kStep, 0, 0],
  ArrowRight: [kStep, 0, 0],
  ArrowUp: [0, kStep, 0],
  ArrowDown: [0, -kStep, 0],
  PageUp: [0, 0, kStep],
  PageDown: [0, 0, -kStep],
};

export function listenToKeys(view: LiveView, motion: Motion): void {
  view.canvas.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key.toLowerCase() === 'p' && !event.shiftKey) motion.togglePlay();
    else if (event.shiftKey && Object.hasOwn(kShifts, event.key)) motion.nudge(kShifts[event.key]);
    else if (event.key === '<' || event.key === '>')
      motion.nudge([0, 0, 0], event.key === '<' ? kTurn : -kTurn);
    else return;
    event.preventDefault();
    event.stopImmediatePropagation();
  });
}
