// The keys of report.json as tables: of those that the page does not know, and all numbers of the others.
import { byId, make, table } from './dom';
import { folded, inWords, kInWords } from './more';
import { count, percent, text } from './numbers';
import { type Report, reportText } from './page_data';

const kShown = new Set([
  'version',
  'live',
  'fields',
  'o1',
  'o2',
  'mesh',
  'measured_on',
  'units',
  'atlas',
  'precision',
  'engine',
  'max_distance',
  'colors',
  'measured',
  'sign',
  'distance',
  'extremes',
  'texels_with_value',
  'points_with_value',
  'negative_points',
  'texels_without_value',
  'negative_texels',
  'beyond_max_distance',
  'without_match',
  'boundary_texels',
  'accuracy',
  'accuracy_kind',
  'error_bound',
  'error_bound_kind',
  'evidence',
  'tolerance',
  'places',
  'group_tolerances',
  'coverage',
  'notes',
  'time_ms',
  'histogram',
]);

function isScalar(value: unknown): boolean {
  return value === null || typeof value !== 'object';
}

function cell(key: string, value: unknown): string {
  if (typeof value === 'boolean') return value ? 'yes' : 'no';
  if (value === '') return 'none';
  if (value === null) return key === 'lower' || key === 'upper' ? 'no limit' : 'none';
  if (typeof value === 'number') {
    if (/fraction/.test(key)) return percent(value);
    return Number.isInteger(value) ? count(value) : text(value);
  }
  if (Array.isArray(value) && value.every((x) => typeof x === 'number'))
    return value.map((x: number) => text(x, 10)).join(', ');
  return String(value);
}

function label(key: string): string {
  const words = key.replace(/[_.]/g, ' ');
  return words.charAt(0).toUpperCase() + words.slice(1);
}

/// The scalars of an object and of the objects in it, by their paths; with `lists` those of lists of objects too, by their
/// places from 0.
export function flattened(value: object, prefix = '', lists = false): [string, unknown][] {
  return Object.entries(value).flatMap(([key, x]): [string, unknown][] => {
    const path = prefix ? `${prefix}.${key}` : key;
    if (
      isScalar(x) ||
      (Array.isArray(x) &&
        x.length > 0 &&
        x.every(isScalar) &&
        (lists || x.every((y) => typeof y === 'number')))
    )
      return [[path, x]];
    return Array.isArray(x) && !lists ? [] : flattened(x as object, path, lists);
  });
}

const kMostColumns = 9;
const kMostRows = 12;

function tableOf(key: string, value: unknown): HTMLElement | null {
  if (Array.isArray(value)) {
    const rows = value.filter((x) => x !== null && typeof x === 'object').map((x) => flattened(x as object));
    if (rows.length === 0) return null;
    const columns = [...new Set(rows.flatMap((row) => row.map(([path]) => path)))].slice(0, kMostColumns);
    return table(
      ['', ...columns.map(label)],
      rows.map((row, i) => [
        String(i + 1),
        ...columns.map((c) => cell(c, Object.fromEntries(row)[c] ?? null)),
      ]),
      label(key),
      kMostRows,
    );
  }
  const rows = flattened(value as object);
  return rows.length === 0
    ? null
    : table(
        ['', 'Value'],
        rows.map(([path, x]) => [label(path), cell(path, x)]),
        label(key),
      );
}

/// What is left of the report: in words, or else by a table of each key, of which those that the page does not know are
/// open; and the text itself.
export function showMore(report: Report): void {
  const tablesOf = (key: string, value: unknown): Node[] => {
    const out: Node[] = [];
    const add = (title: string, x: unknown) => {
      const content = tableOf(title, x);
      if (content) out.push(make('h3', {}, label(title)), content);
    };
    add(key, value);
    if (value !== null && !Array.isArray(value))
      for (const [inner, x] of Object.entries(value as object))
        if (Array.isArray(x) && x.some((y) => !isScalar(y))) add(`${key}: ${inner}`, x);
    return out;
  };
  const tables = Object.entries(report).filter(([key, value]) => !isScalar(value) && !kShown.has(key));
  const known = tables
    .filter(([key]) => kInWords.includes(key))
    .flatMap(([key, value]) => tablesOf(key, value));
  const other = tables
    .filter(([key]) => !kInWords.includes(key))
    .flatMap(([key, value]) => tablesOf(key, value));
  byId('more-tables').replaceChildren(
    make('div', { class: 'in-words' }, ...inWords(report)),
    ...other,
    ...folded('All numbers of these as tables', known),
    ...folded('report.json, as programs read it', [make('pre', { tabindex: '0' }, reportText())]),
  );
}
