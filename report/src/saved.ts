// What a reader of the page may keep: the page with its callouts and settings, and its numbers.
import type { Callout } from './callouts';
import type { State } from './state';
import type { Report } from './page_data';
import { flattened } from './json_tables';
import type { Camera } from './viewer';

/// What a saved page opens with.
export interface Saved {
  state: State;
  callouts: Callout[];
  camera: Camera;
}

const kId = 'saved';

/// A copy of the document before anything is added to it. Text is shared with the document.
export function copyOfPage(): HTMLElement {
  return document.documentElement.cloneNode(true) as HTMLElement;
}

/// The settings in the page, if it was saved.
export function readSaved(): Saved | null {
  const text = document.getElementById(kId)?.textContent;
  if (!text) return null;
  const saved = JSON.parse(text) as Saved;
  // JSON has no infinite numbers: null is no limit.
  const { scale } = saved.state;
  scale.lower ??= -Infinity;
  scale.upper ??= Infinity;
  return saved;
}

/// The text of a page that opens with the settings.
export function pageWith(copy: HTMLElement, saved: Saved): string {
  copy.querySelector(`#${kId}`)?.remove();
  const script = document.createElement('script');
  script.type = 'application/json';
  script.id = kId;
  script.textContent = JSON.stringify(saved).replace(/</g, '\\u003c'); // no end of a script inside of it
  copy.querySelector('script')!.before(script);
  return `<!DOCTYPE html>\n${copy.outerHTML}\n`;
}

function csvField(value: unknown): string {
  const text = value === null ? '' : Array.isArray(value) ? value.join(' ') : String(value);
  return /[",\r\n]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text;
}

/// Every number and word of report.json and every callout, one a row: the path of its key and the value as in the file.
export function csvOf(report: Report, callouts: Callout[]): string {
  const rows = flattened({ ...report, ...(callouts.length > 0 ? { callouts } : {}) }, '', true);
  return (
    ['name,value', ...rows.map(([path, value]) => `${csvField(path)},${csvField(value)}`)].join('\r\n') +
    '\r\n'
  );
}

/// Offers a text, or bytes, as a file.
export function download(name: string, type: string, content: string | ArrayBuffer): void {
  const url = URL.createObjectURL(new Blob([content], { type }));
  const link = document.createElement('a');
  link.href = url;
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 60000); // after the browser has taken it
}
