// The verdict, as a word with a sign in its colour.
import { byId, make } from './dom';
import type { Verdict } from './verdict';

const kSigns: Record<Verdict | 'MOVING', string> = {
  MOVING: '…',
  PASS: '✓',
  FAIL: '✗',
  'NOT DECIDED': '?',
  DOUBTFUL: '?',
  MEASURED: 'i',
};

export function showBadge(verdict: Verdict | 'MOVING'): void {
  const badge = byId('verdict');
  badge.className = verdict.toLowerCase().replace(' ', '-');
  badge.replaceChildren(make('span', { 'aria-hidden': 'true' }, kSigns[verdict]), ` ${verdict}`);
  badge.hidden = false;
}
