// The line that says what the page is doing.
import { byId } from '../src/dom';

/// What the page is doing, or a fault; empty: nothing. Progress is not read out.
export function say(text: string, kind: 'fault' | 'progress' | '' = ''): void {
  const status = byId('status');
  status.classList.toggle('fault', kind === 'fault');
  status.setAttribute('aria-live', kind === 'progress' ? 'off' : 'polite');
  status.textContent = text;
  byId('said').classList.toggle('says', text !== '');
  byId('cancel').hidden = kind !== 'progress';
}

/// Shows an error as a sentence.
export function sayFault(error: unknown): void {
  const words = error instanceof Error ? error.message : String(error);
  say(/[.?!]$/.test(words) ? words : `${words}.`, 'fault');
}
