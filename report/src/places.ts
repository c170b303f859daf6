// The list of the places that deviate most.
import { byId, make, table } from './dom';
import { count, percent, place, text } from './numbers';
import type { PageJson, Place, Places, Report } from './page_data';
import { distanceText } from './precision';
import { isCloud, limitsText, unitOf } from './verdict';
import { capital, isSigned, quantityOf } from './words';

export type Listed = Pick<Place, 'distance' | 'point' | 'at'> & Partial<Place>;

function extentOf(report: Report, p: Listed): string {
  if (p.points !== undefined) return p.points === 1 ? '1 point' : `${count(p.points)} points`;
  if (!p.area) return 'vertex of the part';
  return report.units ? `${text(p.area, 3)}\u00a0${report.units}²` : text(p.area, 3);
}

/// What all places are, and how many are not in the list.
function hintOf(report: Report, places: Places): string {
  const unit = report.units ? `\u00a0${report.units}²` : '';
  const limits = { lower: places.lower ?? -Infinity, upper: places.upper ?? Infinity };
  const whole = isCloud(report) ? 'points' : 'area';
  const total = ({
    count: n,
    points,
    area,
    area_fraction: ofArea,
    point_fraction: ofPoints,
  }: Places['large']) =>
    `${count(n)}, together ${points !== undefined && isCloud(report) ? `${count(points)} points` : `${text(area ?? 0, 3)}${unit}`} (${percent(ofArea ?? ofPoints ?? 0)})`;
  const least = `${text(100 * (places.least_area_fraction ?? places.least_point_fraction ?? 0), 2)}\u00a0%`;
  const beyond =
    places.limits_from !== 'tolerance'
      ? `at or beyond the 99th percentile, ${limitsText(limits, report)}`
      : places.lower === null && places.upper === null
        ? 'out of the tolerance of their group'
        : `out of the tolerance of ${limitsText(limits, report)}${report.group_tolerances ? ', or of that of their group' : ''}`;
  return (
    `Connected regions ${beyond}: ${total(places.large)}; ` +
    `and small ones, below ${least} of the ${whole} each: ${total(places.small)}. ` +
    `Listed are ${places.largest.length < 10 ? 'all' : 'the ten largest'}, small ones last. ${isCloud(report) ? '' : 'Areas are estimates from the samples. '}`
  );
}

/// Whether the largest values matter: of wall thickness with an upper limit only.
export function onlyThickest({ thickness }: Report): boolean {
  return typeof thickness?.max === 'number' && typeof thickness.min !== 'number';
}

/// The places of a report on wall thickness, or on the distance of a part to itself.
const wallsOf = ({ thinnest, thickest }: PageJson): Listed[] | null => thinnest ?? thickest ?? null;

/// The places of the list, the worst one first.
export function listedPlaces(report: Report, page: PageJson): Listed[] {
  return wallsOf(page) ?? report.places?.largest ?? [];
}

/// The least distance of a part to itself, of all points; null if there is none.
export function separationOf(report: Report): number | null {
  const { value } = (report.separation ?? {}) as { value?: number };
  return report.mesh && typeof value === 'number' ? value : null;
}

/// Fills the list; without `show` the places cannot be seen.
export function showPlaces(
  report: Report,
  page: PageJson,
  size: number,
  show?: (place: Listed) => void,
): void {
  const signs = isSigned(report);
  const walls = wallsOf(page);
  const listed = listedPlaces(report, page);
  const grouped = listed.some((p) => p.group);
  const rows = listed.map((p, i) => {
    const value =
      p.distance === null ? 'no value' : `${distanceText(p.distance, report, signs)}${unitOf(report)}`;
    return [
      String(i + 1),
      show
        ? make(
            'button',
            {
              type: 'button',
              class: 'link',
              click: () => show(p),
              'aria-label': `Show place ${i + 1}, ${value}`,
            },
            value,
          )
        : value,
      place(p.point, size),
      ...(walls ? [] : [`${extentOf(report, p)}${p.small ? ', small' : ''}`]),
      ...(grouped ? [p.group ?? ''] : []),
    ];
  });
  const head = [
    '',
    capital(quantityOf(report)),
    report.units ? `Position in ${report.units}` : 'Position',
    ...(walls ? [] : ['Extent']),
    ...(grouped ? ['Group'] : []),
  ];
  const hint = walls
    ? `The ${onlyThickest(report) ? 'largest' : 'least'} values, at measured points that are at least 6 % of the part\u2019s size apart. ${separationOf(report) === null ? '' : `Of all points, also in between, the least is ${distanceText(separationOf(report), report)}${unitOf(report)}. `}`
    : report.places
      ? hintOf(report, report.places)
      : '';
  byId('worst-table').replaceChildren(
    rows.length === 0
      ? make(
          'p',
          {},
          walls || report.places
            ? `No point of the ${isCloud(report) ? 'cloud' : 'part'} has a distance beyond the accuracy.`
            : 'This report lists no places.',
        )
      : table(
          head,
          rows,
          walls
            ? `The places with the ${onlyThickest(report) ? 'largest' : 'least'} values`
            : 'The places with the largest distances',
        ),
    make('p', { class: 'hint' }, hint + (hint && show ? 'Choose one to see it.' : '')),
  );
}
