// Alignment, bands and the largest distance, in words and bars; and all other numbers, folded away.
import { make, table } from './dom';
import { count, percent, place, text } from './numbers';
import type { Report, Vec } from './page_data';
import { limitsIn, limitsOf, unitOf, wholeOf } from './verdict';
import { isSigned, isThickness, named, quantityOf } from './words';

/// The keys of the report that are shown in words.
export const kInWords = ['alignment', 'hausdorff', 'bands', 'separation', 'exclusion', 'thickness', 'doubts'];

interface Residual {
  rms: number;
  trimmed_rms: number;
}

interface Freedom {
  standard_error: number | null;
  free: boolean;
  locked: boolean;
}

interface AlignmentJson {
  text: string;
  from?: string;
  converged?: boolean;
  iterations?: number;
  samples?: number;
  fraction_used?: number;
  before?: Residual;
  after?: Residual;
  degrees_of_freedom?: Freedom[];
  matrix?: number[][];
}

interface Bounds {
  lower: number | null;
  upper: number | null;
  kind: string;
  point?: Vec | null;
}

interface Band {
  lower: number | null;
  upper: number | null;
  area_fraction: number;
}

function words(...sentences: (string | false | null | undefined)[]): HTMLElement {
  return make('p', {}, sentences.filter(Boolean).join(' '));
}

/// How well the motions of an alignment are known.
function freedomWords(freedoms: Freedom[], unit: string): string {
  const free = freedoms.filter((f) => f.free).length;
  const locked = freedoms.filter((f) => f.locked).length;
  const errors = freedoms.map((f) => f.standard_error).filter((x): x is number => typeof x === 'number');
  const lockedWords =
    locked > 0 ? ` ${locked === 1 ? 'One motion was' : `${locked} motions were`} locked.` : '';
  if (free > 0)
    return `The surfaces do not determine ${free === 1 ? 'one motion' : `${free} motions`} of six, such as sliding along a plane or turning about an axis: there the placement is arbitrary.${lockedWords}`;
  const error =
    errors.length > 0
      ? ` The least certain one has a standard error of ${text(Math.max(...errors), 2)}${unit}, an estimate.`
      : '';
  return `${locked > 0 ? 'All other motions' : 'All six motions'} are determined by the surfaces.${error}${lockedWords}`;
}

/// What the alignment did, and how well it fits.
export function alignmentWords(report: Report): Node[] {
  const a = report.alignment as AlignmentJson | undefined;
  if (!a) return [];
  const unit = unitOf(report);
  // Its residuals are named in a sentence.
  const done = named(a.text.replace(/; residual rms .*?\(.*?\)/, ''), report);
  const from = (key: keyof Residual) =>
    `from ${text(a.before?.[key], 3)} to ${text(a.after?.[key], 3)}${unit}`;
  return [
    words(
      `Alignment: ${done}.`,
      a.before &&
        a.after &&
        `The root mean square distance went ${from('trimmed_rms')} for the samples that fit, and ${from('rms')} for all samples: estimates.`,
    ),
  ];
}

function alignment(report: Report): Node[] {
  const a = report.alignment as AlignmentJson | undefined;
  if (!a) return [];
  const unit = unitOf(report);
  const fitted = a.from !== '321';
  return [
    make('h3', {}, 'Alignment'),
    words(
      'Before anything was measured, the part was placed on the reference.',
      fitted &&
        typeof a.fraction_used === 'number' &&
        typeof a.samples === 'number' &&
        `${percent(a.fraction_used)} of ${count(a.samples)} samples fit; dents and outliers did not count.`,
      fitted && a.converged === false && 'It did not settle: another start may fit better.',
      a.degrees_of_freedom && freedomWords(a.degrees_of_freedom, unit),
    ),
    ...(a.matrix
      ? [
          make(
            'details',
            {},
            make('summary', {}, 'Its matrix'),
            table(
              ['Row', 'x', 'y', 'z', 'Translation'],
              a.matrix.map((row, i) => [String(i + 1), ...row.map((x) => text(x, 7))]),
              'The matrix of the alignment',
            ),
          ),
        ]
      : []),
  ];
}

function between({ lower, upper, kind }: Bounds, unit: string): string | null {
  if (kind === 'unknown' || lower === null || upper === null) return null;
  return lower === upper
    ? `is ${text(lower)}${unit}, exactly`
    : `is between ${text(lower)} and ${text(upper)}${unit}: proven, for every point`;
}

function hausdorff(report: Report): Node[] {
  const h = report.hausdorff as { one_sided?: Bounds; symmetric?: Bounds } | undefined;
  if (!h?.one_sided) return [];
  const unit = unitOf(report);
  const size = Math.max(...(h.one_sided.point ?? [0]).map(Math.abs), 1e-300);
  const one = between(h.one_sided, unit);
  const both = h.symmetric && between(h.symmetric, unit);
  const at = h.one_sided.point ? ` The largest one measured is at (${place(h.one_sided.point, size)}).` : '';
  return [
    make('h3', {}, 'Largest distance of all points (Hausdorff distance)'),
    words(
      one
        ? `The largest distance from any point of the part to the reference (one-sided) ${one}.${at}`
        : 'The largest distance of all points of the part is not bounded by this measurement.',
      both && `That of both directions (symmetric) ${both}.`,
    ),
  ];
}

function separation(report: Report): Node[] {
  const s = report.separation as { value?: number; witness?: [Vec, Vec] | Vec[] | null } | null | undefined;
  if (!s || typeof s.value !== 'number') return [];
  const [a, b] = s.witness ?? [];
  const { rings, geodesic } = (report.exclusion ?? {}) as { rings?: number | null; geodesic?: number | null };
  const size = Math.max(...(a ?? [0]).map(Math.abs), 1e-300);
  return [
    make('h3', {}, 'Separation'),
    words(
      `The part comes as near to itself as ${text(s.value)}${unitOf(report)}, neighbours along the surface aside: exact, of all points.`,
      typeof geodesic === 'number' &&
        `Neighbours are what is nearer than ${text(geodesic)}${unitOf(report)} along the surface.`,
      typeof geodesic !== 'number' &&
        typeof rings === 'number' &&
        `Neighbours of a face are those within ${rings === 1 ? 'one ring' : `${rings} rings`} of faces around it.`,
      a && b && `There, (${place(a, size)}) is opposite of (${place(b, size)}).`,
    ),
  ];
}

/// What the method of wall thickness says that is not shown.
function otherThickness(report: Report): Node[] {
  const other = (
    report.thickness as
      | { other?: { method: string; distance: Record<string, number | null>; file: string | null } | null }
      | undefined
  )?.other;
  if (!other) return [];
  const unit = unitOf(report);
  return [
    make('h3', {}, 'By the other method'),
    words(
      `By ${other.method === 'ray' ? 'a ray along the normal' : other.method === 'ball' ? 'the largest ball inside' : other.method}, the thickness is from ${text(other.distance.min)} to ${text(other.distance.max)}${unit}, ${text(other.distance.mean)}${unit} on average: estimates from the samples.`,
      other.file && `All values are in ${other.file}.`,
    ),
  ];
}

/// Where a band lies with respect to the tolerance: without one, to zero.
function sideOf(
  { lower, upper }: Band,
  limits: { lower: number; upper: number },
): 'below' | 'within' | 'above' {
  if (upper !== null && upper <= limits.lower) return 'below';
  return lower !== null && lower >= limits.upper ? 'above' : 'within';
}

/// The bands as one bar, and as a list with the same marks.
function bandsBar(report: Report): Node[] {
  const bands = (report.bands as Band[] | undefined) ?? [];
  if (bands.length === 0) return [];
  const limits = limitsOf(report) ?? { lower: 0, upper: Infinity };
  const unit = unitOf(report);
  const what = quantityOf(report);
  const within = bands.findIndex((band) => sideOf(band, limits) === 'within');
  const zero = bands.findIndex(
    ({ lower, upper }) => lower !== null && lower <= 0 && (upper === null || upper > 0),
  );
  const middle = zero >= 0 ? zero : within; // lighter than its neighbours
  const named = bands.map((band, i) => {
    const { lower, upper } = band;
    const label =
      lower === null
        ? `below ${text(upper)}${unit}`
        : upper === null
          ? `above ${text(lower)}${unit}`
          : limitsIn({ lower, upper }, unit, isSigned(report));
    return {
      share: band.area_fraction,
      label,
      mark: `${sideOf(band, limits)}${(i - middle) % 2 ? ' odd' : ''}`,
    };
  });
  const whole = wholeOf(report);
  const sum = Math.max(
    1,
    named.reduce((total, { share }) => total + share, 0),
  );
  const bar = make('div', {
    class: 'bands',
    role: 'img',
    'aria-label': named.map(({ label, share }) => `${label}: ${percent(share)}`).join(', '),
  });
  for (const { share, mark } of named)
    if (share > 0) bar.append(make('span', { class: mark, style: `width: ${(100 * share) / sum}%` }));
  const rows = named.map(({ share, label, mark }) => [
    make('span', {}, make('span', { class: `band ${mark}`, 'aria-hidden': 'true' }), label),
    percent(share),
  ]);
  return [
    make('h3', {}, `Bands of ${what}`),
    bar,
    table(
      [
        isThickness(report) ? 'Thickness' : isSigned(report) ? 'Distance, negative inside' : 'Distance',
        `Share of the ${whole}, an estimate`,
      ],
      rows,
      `Bands of ${what}`,
    ),
  ];
}

/// What the page says of them, in the order of interest.
export function inWords(report: Report): Node[] {
  return [
    ...alignment(report),
    ...hausdorff(report),
    ...separation(report),
    ...otherThickness(report),
    ...bandsBar(report),
  ];
}

/// Folded away, with a word of what is inside.
export function folded(title: string, content: Node[]): Node[] {
  return content.length === 0 ? [] : [make('details', {}, make('summary', {}, title), ...content)];
}
