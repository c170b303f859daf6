// The head of a page: what was compared, the verdict, and how sure it is.
import { showBadge } from './badge';
import { byId, make } from './dom';
import type { Report } from './page_data';
import { onlyThickest } from './places';
import { showSure } from './sure';
import { titleOf } from './tables';
import { isCloud, verdictOf } from './verdict';
import { capital, named, quantityOf } from './words';

/// The verdict with its sentence, and the title.
export function showVerdict(report: Report): void {
  const { verdict, sentence } = verdictOf(report);
  showBadge(verdict);
  showSure(report);
  const tile = report.atlas?.udim
    ? ' This page is of one tile of the texture; the verdict on all tiles is in report.json in the folder above.'
    : '';
  const doubts =
    verdict === 'FAIL' || verdict === 'NOT DECIDED'
      ? (report.doubts ?? []).map((doubt) => ` ${capital(doubt.text)}.`).join('')
      : '';
  const notes = report.notes?.length ?? 0;
  const link = notes === 0 ? '' : make('a', { href: '#method' }, notes === 1 ? 'One note' : `${notes} notes`);
  byId('sentence').replaceChildren(
    named(sentence + doubts, report) + tile,
    ...(link ? [' ', link, notes === 1 ? ' qualifies this.' : ' qualify this.'] : []),
  );
  showNext(report);
  document.title = `${verdict}: ${titleOf(report)}`;
  byId('title').textContent = titleOf(report);
}

/// What follows for the part and, on pages that a command has made, for the measurement.
function showNext(report: Report): void {
  const next = report.tolerance?.next;
  const rows = [
    ['For the part', next?.part],
    ['For the measurement', report.live ? '' : next?.measurement],
  ].filter(([, step]) => step);
  byId('next').hidden = rows.length === 0;
  byId('next').replaceChildren(
    ...rows.flatMap(([name, step]) => [make('dt', {}, name!), make('dd', {}, named(step!, report))]),
  );
}

function worstTitle(report: Report): string {
  if (report.thickness) return onlyThickest(report) ? 'Thickest places' : 'Thinnest places';
  if (report.mesh) return 'Smallest distances';
  return report.places?.limits_from === 'tolerance' ? 'Places out of tolerance' : 'Largest distances';
}

/// While something moves: the verdict of the report is not of what is seen.
export function showMoving(report: Report): void {
  showBadge('MOVING');
  byId('sure').hidden = byId('next').hidden = true;
  byId('sentence').textContent = 'The verdict and the numbers follow at rest.';
  document.title = `MOVING: ${titleOf(report)}`;
}

/// Words of page.html that differ for clouds.
export function nameSubject(report: Report): void {
  byId('canvas').setAttribute('aria-label', `The part, coloured by ${quantityOf(report)}`);
  byId('worst-title').textContent = worstTitle(report);
  if (!isCloud(report)) return;
  byId('part-title').textContent = 'The cloud in 3D';
  byId('histogram-title').textContent = 'How the points are distributed';
}
