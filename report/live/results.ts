// The text of the page: what is known of a pair at rest.
import { byId } from '../src/dom';
import { nameSubject, showMoving, showVerdict } from '../src/headline';
import type { PageJson, Report } from '../src/page_data';
import { showPlaces } from '../src/places';
import { toScene } from '../src/subject';
import { showInputs, showMethod, showNumbers } from '../src/tables';
import { showMore } from '../src/json_tables';
import { verdictOf } from '../src/verdict';
import type { Session } from './session';

declare const SDM_VERSION: string; // by the build

export function showReport(session: Session, of: Report): void {
  const report: Report = { version: SDM_VERSION, live: true, ...of };
  session.report = report;
  byId('report').textContent = JSON.stringify(report, null, 2);
  nameSubject(report);
  showVerdict(report);
  showNumbers(report);
  showInputs(report);
  showMethod(report);
  showMore(report);
  const pair = session.pair!;
  showPlaces(report, {} as PageJson, pair.subject.size, (place) => {
    const at = toScene(pair.subject, place.point);
    if (place.distance !== null)
      pair.callouts.add({ distance: place.distance, point: place.point, at, detail: '' });
    pair.lookAt(at);
  });
}

/// Limits are new: there is no verdict on them yet, and without any there is none.
export function showLimits(session: Session, limits: [number, number] | null): void {
  const { tolerance: _, doubts: __, ...unjudged } = session.report!;
  session.report = unjudged;
  byId('report').textContent = JSON.stringify(unjudged, null, 2);
  showVerdict(unjudged);
  if (limits) byId('sentence').textContent = 'The verdict on these limits follows.';
}

/// Until the next rest there is no verdict.
export function showNoVerdict({ report }: Session): void {
  if (report) showMoving(report);
}

/// Reads the results out.
export function speak(session: Session): void {
  const { extremes } = session.report!;
  const [least, most] = [extremes?.min, extremes?.max].map((end) =>
    session.valueText(end?.distance ?? Number.NaN),
  );
  byId('spoken').textContent =
    `${verdictOf(session.report!).verdict}. Distances from ${least} to ${most}. Separation ${byId('separation').textContent}.`;
}
