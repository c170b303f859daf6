// The text of the page: numbers, inputs and method.
import { byId, make, table } from './dom';
import { coverageRow } from './coverage';
import { alignmentWords } from './more';
import { count, text } from './numbers';
import { Input, PageData, Report } from './page_data';
import { separationOf } from './places';
import { distanceText } from './precision';
import { isCloud, unitOf } from './verdict';
import { capital, endsOf, isSigned, isThickness, named, quantityOf } from './words';

function fileName(path: string): string {
  return path.split(/[\\/]/).pop() || path;
}

/// The measured mesh and the one that distances go to.
export function inputsOf(report: Report): { measured?: Input; reference?: Input } {
  if (report.mesh) return { measured: report.mesh };
  return report.measured_on === 'o2'
    ? { measured: report.o2, reference: report.o1 }
    : { measured: report.o1, reference: report.o2 };
}

export function titleOf(report: Report): string {
  const { measured, reference } = inputsOf(report);
  if (!measured) return 'Distance report';
  const tile = report.atlas?.udim ? `, tile ${report.atlas.udim}` : '';
  return reference
    ? `${fileName(measured.file)}${tile} compared with ${fileName(reference.file)}`
    : `${fileName(measured.file)}: ${isThickness(report) ? 'wall thickness' : 'distance to itself'}`;
}

/// What the author of the report says about it, below the title.
export function showFields(report: Report): void {
  const rows = Object.entries(report.fields ?? {});
  byId('fields').hidden = rows.length === 0;
  byId('fields').replaceChildren(
    ...rows.map(([name, value]) => make('div', {}, make('dt', {}, name), make('dd', {}, value))),
  );
}

/// What is measured, as the head of a table, unless it is the closest point.
function otherDistance(report: Report): string | null {
  const measured = report.measured;
  if (!measured || measured.kind === 'closest' || isThickness(report)) return null;
  return capital(named(measured.text, report));
}

export function showNumbers(report: Report): void {
  const d = report.distance ?? {};
  const unit = unitOf(report);
  const signs = isSigned(report);
  const rows: string[][] = [];
  const value = (key: string) => (typeof d[key] === 'number' ? (d[key] as number) : null);
  const add = (label: string, key: string, kind: string, withSign = false) => {
    const x = value(key);
    if (x !== null) rows.push([label, `${distanceText(x, report, withSign && signs)}${unit}`, kind]);
  };
  const extremes = report.extremes;
  const ends = endsOf(report);
  const bound = report.error_bound;
  const cloud = isCloud(report);
  const compared = signs && !isThickness(report);
  const sampled = (by: number, how: 'more' | 'less') =>
    report.evidence?.samples_only
      ? 'at the points; an estimate in between'
      : by > 0
        ? `measured; at most ${distanceText(by, report)}${unit} ${how} in between`
        : 'measured';
  // A distance below the accuracy may as well be 0; a wall is not.
  const shown = (x: number) =>
    `${distanceText(!isThickness(report) && Math.abs(x) <= (report.accuracy ?? 0) ? 0 : x, report, signs)}${unit}`;
  if (extremes?.max) rows.push([ends.largest, shown(extremes.max.distance), sampled(bound ?? 0, 'more')]);
  else add('Largest', 'max', 'measured', true);
  if (extremes?.min)
    rows.push([
      ends.smallest,
      shown(extremes.min.distance),
      sampled(Math.min(bound ?? 0, signs ? Infinity : extremes.min.distance), 'less'),
    ]);
  else if (separationOf(report) !== null)
    rows.push(['Smallest', `${distanceText(separationOf(report), report)}${unit}`, 'exact, of all points']);
  else add('Smallest', 'min', 'measured', true);
  const estimate = cloud ? 'of all points' : 'estimate over the area';
  const share = cloud ? 'points are' : 'area is';
  add('Mean', 'mean', estimate, true);
  if (compared) add('Mean of the absolute distance', 'mean_abs', estimate);
  add('Root mean square', 'rms', estimate);
  add('Standard deviation', 'stddev', estimate);
  add('Median', 'p50', estimate, true);
  add(compared ? `95 % of the ${share} closer than` : '95th percentile', 'p95_abs', estimate);
  add(compared ? `99 % of the ${share} closer than` : '99th percentile', 'p99_abs', estimate);
  const samples = report.texels_with_value ?? report.points_with_value;
  if (samples !== undefined) rows.push(['Measured points', count(samples), 'exact']);
  if ((report.beyond_max_distance ?? 0) > 0)
    rows.push(['Points farther than the limit', count(report.beyond_max_distance!), 'exact']);
  if ((report.without_match ?? 0) > 0)
    rows.push(['Points that no face of the reference matches', count(report.without_match!), 'exact']);
  if (cloud && (report.o1?.invalid_points ?? 0) > 0)
    rows.push(['Points without coordinates', count(report.o1!.invalid_points!), 'exact']);
  rows.push(...coverageRow(report));
  byId('numbers-table').replaceChildren(
    table([otherDistance(report) ?? capital(quantityOf(report)), 'Value', 'Kind'], rows, 'The numbers'),
  );
}

export function showInputs(report: Report): void {
  const { measured, reference } = inputsOf(report);
  const inputs = [measured, reference].filter((x): x is Input => x !== undefined);
  const head = ['', ...(reference ? ['Measured part', 'Reference'] : ['Part'])];
  const row = (label: string, of: (input: Input) => string) => [label, ...inputs.map(of)];
  const number = (x: number | undefined) => (x === undefined ? '–' : count(x));
  const faults = (i: Input) =>
    [
      (i.invalid_points ?? 0) > 0 ? `${count(i.invalid_points!)} points without coordinates` : '',
      (i.degenerate_faces ?? 0) > 0 ? `${count(i.degenerate_faces!)} triangles without area` : '',
      (i.duplicate_faces ?? 0) > 0 ? `${count(i.duplicate_faces!)} repeated triangles` : '',
    ]
      .filter(Boolean)
      .join(', ') || 'none';
  const moved = (i: Input) =>
    [i.transform, report.alignment && i === report.o1 ? 'the alignment' : '']
      .filter(Boolean)
      .join(', then ') || 'nothing';
  byId('inputs-table').replaceChildren(
    table(
      head,
      [
        row('File', (i) => i.file),
        ...(isCloud(report) ? [row('Points', (i) => number(i.points))] : []),
        row('Triangles', (i) => number(i.triangles)),
        row('Vertices', (i) => number(i.vertices)),
        row('Watertight', (i) => (i.closed === undefined ? '–' : i.closed ? 'yes' : 'no')),
        row('Faults', faults),
        row('Moved by', moved),
      ],
      'The inputs',
    ),
    ...alignmentWords(report),
  );
}

function sentence(...parts: (string | false | undefined)[]): HTMLElement {
  return make('p', {}, parts.filter(Boolean).join(' '));
}

/// A text whose options, such as --precision, are not broken at their hyphens.
function unbroken(words: string): (string | Node)[] {
  return words.split(/(--[\w-]+)/).map((part, i) => (i % 2 ? make('span', { class: 'option' }, part) : part));
}

export function showMethod(report: Report): void {
  const unit = unitOf(report);
  const { atlas, sign, error_bound: bound, accuracy } = report;
  const reference = report.mesh ? 'the rest of the part' : 'the reference';
  const out: HTMLElement[] = [];
  out.push(
    sentence(
      atlas &&
        `The surface of the measured part was covered with ${count(atlas.texels)} points, the centres of the pixels (texels) of a texture of ${atlas.resolution} × ${atlas.rows ?? atlas.resolution}.`,
      isCloud(report) &&
        `The measured part is a cloud of ${count(report.o1!.points!)} points. Nothing is said about places between them.`,
      report.thickness
        ? `For each, the thickness of the wall below it was found (${report.thickness.text}). Between the points, the thickness is an estimate.`
        : otherDistance(report)
          ? `Measured is the ${report.measured!.text}. What lies between the measured points is an estimate.`
          : `For each, the nearest point of ${reference} was found: on its faces, edges and corners, not only at its vertices.`,
      typeof accuracy === 'number' &&
        `Each of these ${isThickness(report) ? 'values' : 'distances'} is exact to ${text(accuracy, 2)}${unit}.`,
    ),
  );
  if (typeof bound === 'number')
    out.push(
      sentence(
        `Error bound: no point of the part is farther than ${text(bound)}${unit} from a measured point, and a distance cannot change faster than the point moves.`,
        `So at any point of the part, the distance differs from that of the nearest measured point by at most ${text(bound)}${unit}.`,
        `This is proven, not estimated; ${report.live ? 'a finer map makes it smaller' : '--precision makes it as small as needed'}.`,
      ),
    );
  if (sign && !isThickness(report))
    out.push(
      sentence(
        sign.method === 'none'
          ? `Distances have no sign (${sign.reason}).`
          : report.measured && report.measured.kind !== 'closest'
            ? 'Positive is in front of the face that is measured to, the side to which its normal points: outside, or above. Negative is behind it.'
            : sign.method === 'side'
              ? `Positive is in front of ${reference}, negative is behind (${sign.reason}).`
              : `Positive is outside ${reference}, negative is inside (${sign.reason}).`,
        sign.method === 'winding' && 'The reference is not watertight, so inside and outside are estimates.',
      ),
    );
  if (report.boundary_texels)
    out.push(
      sentence(
        `${count(report.boundary_texels)} points are nearest to an open edge of the reference: they may lie beside the part of the surface that it covers.`,
      ),
    );
  for (const note of report.notes ?? [])
    out.push(make('p', { class: 'note' }, `Note: ${note}${note.endsWith('?') ? '' : '.'}`));
  const total = report.time_ms?.total;
  out.push(
    sentence(
      `Made by sdm ${report.version ?? ''}${report.engine ? `, engine ${report.engine}` : ''}${total ? `, in ${text(total / 1000, 2)} s` : ''}.`,
      'Words in this report: "exact" and "bounded" numbers hold for the whole surface or say by how much they may differ; "estimate" means computed from the measured points only.',
    ),
  );
  for (const element of out) element.replaceChildren(...unbroken(named(element.textContent!, report)));
  byId('method-text').replaceChildren(...out);
}

/// What this page leaves out of large inputs.
export function showOmissions(report: Report, { page, surface, cloud, ghost }: PageData): void {
  const out: HTMLElement[] = [];
  if (surface && surface.map.step > 1)
    out.push(
      sentence(
        `This page contains one of each ${surface.map.step} × ${surface.map.step} measured points; all of them are in map.exr. Verdict and numbers are from all points.`,
      ),
    );
  if (surface && !surface.model.place)
    out.push(
      sentence(
        `The part has ${count(surface.model.trianglesOfMesh)} triangles; the 3D view shows a coarser copy of ${count(surface.model.triangle.length / 3)}. Its vertices are vertices of the part with their own exact distances, of each neighbourhood the one with the largest.`,
      ),
    );
  if (cloud && page.cloud) out.push(...omittedPoints(cloud.distance.length, page.cloud));
  if (ghost?.isBox)
    out.push(
      sentence(
        `The reference has ${count(ghost.trianglesOfMesh)} triangles; the 3D view shows only its box${report.coverage ? ', without its coverage' : ''}.`,
      ),
    );
  byId('method-text').append(...out);
}

function omittedPoints(
  shown: number,
  { points, picked, normals }: NonNullable<PageData['page']['cloud']>,
): HTMLElement[] {
  const out: HTMLElement[] = [];
  if (shown < points) {
    const short = `${count(shown)} of the ${count(points)} points are shown`;
    byId('shown').textContent = `${short}; numbers, histogram and largest distances are of all of them.`;
    byId('shown').hidden = false;
    out.push(
      sentence(
        `${short}: ${count(picked)} at random places of the file, spread evenly over it, and ${count(shown - picked)} others, so that each of up to 5832 neighbourhoods has the point with its largest distance, and both extremes are there.`,
        `All points are in points.ply. Verdict, numbers, histogram and the list of largest distances are from all points.`,
      ),
    );
  }
  if (!normals)
    out.push(sentence('The cloud has no normals: its points are shaded by those of their closest faces.'));
  return out;
}
