// The verdicts on the groups of a table of tolerances.
import { byId, make, table } from './dom';
import { percent, signedText, text } from './numbers';
import type { Report } from './page_data';
import { isSigned, limitsText, unitOf } from './verdict';
import { capital, quantityOf } from './words';

type Row = NonNullable<Report['group_tolerances']>['groups'][number];

/// What the verdict of a group rests on.
function kindOf({ verdict, certified, undecided_by: by }: Row, unit: string): string {
  if (verdict === 'NOT DECIDED') return typeof by === 'number' ? `open by ${text(by)}${unit}` : 'open';
  return certified ? 'certified' : 'estimate';
}

export function showGroups(report: Report): void {
  const groups = report.group_tolerances?.groups ?? [];
  byId('groups').hidden = groups.length === 0;
  if (groups.length === 0) return;
  const unit = unitOf(report);
  // A distance below the accuracy may as well be 0.
  const value = (x: number | null) =>
    x === null ? 'none' : `${Math.abs(x) <= (report.accuracy ?? 0) ? '0' : signedText(x, isSigned(report))}${unit}`;
  const rows = groups.map((g) => [
    g.group,
    g.kind,
    limitsText(g, report),
    make('b', { class: g.verdict.toLowerCase().replace(' ', '-') }, g.verdict),
    value(g.lowest),
    value(g.witness && g.witness.distance > (g.highest ?? -Infinity) ? g.witness.distance : g.highest),
    percent(g.exceeded_area_fraction ?? 0),
    kindOf(g, unit),
  ]);
  const what = capital(quantityOf(report));
  byId('groups-table').replaceChildren(
    table(['Group', 'Named as', 'Limits', 'Verdict', `Least ${quantityOf(report)}`, `Largest ${quantityOf(report)}`, 'Area out of tolerance', 'Kind'], rows, `${what} by group`),
    make('p', { class: 'hint' }, `Of all groups: ${report.group_tolerances!.verdict}. Shares are estimates from the samples of each group. The verdict at the top is the worse one of those of the part and of its groups.`),
  );
}
