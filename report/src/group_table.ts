// The verdicts on the groups of a table of tolerances.
import { byId, make, table } from './dom';
import { percent, text } from './numbers';
import type { Report } from './page_data';
import { distanceText } from './precision';
import { isCloud, limitsText, unitOf, wholeOf } from './verdict';
import { capital, isSigned, quantityOf } from './words';

export interface GroupName {
  kind: string;
  group: string;
}
type Row = NonNullable<Report['group_tolerances']>['groups'][number];

/// What the verdict of a group rests on.
function kindOf({ verdict, certified, undecided_by: by }: Row, unit: string): string {
  if (verdict === 'NOT DECIDED') return typeof by === 'number' ? `open by ${text(by)}${unit}` : 'open';
  return certified ? 'proven' : 'estimate';
}

/// `show`, if given, is called with a group that is chosen, or null for one that was.
export function showGroups(
  report: Report,
  chosen: GroupName | null = null,
  show?: (group: GroupName | null) => void,
): void {
  const groups = report.group_tolerances?.groups ?? [];
  byId('groups').hidden = groups.length === 0;
  if (groups.length === 0) return;
  const unit = unitOf(report);
  // A distance below the accuracy may as well be 0.
  const value = (x: number | null) =>
    x === null
      ? 'none'
      : `${distanceText(Math.abs(x) <= (report.accuracy ?? 0) ? 0 : x, report, isSigned(report))}${unit}`;
  const name = (g: Row, i: number): Node | string => {
    if (!show) return g.group;
    const pressed = chosen?.kind === g.kind && chosen.group === g.group;
    const click = () => {
      show(pressed ? null : { kind: g.kind, group: g.group });
      byId('view').scrollIntoView({ block: 'nearest' }); // all of it: the section may be higher than the window
      byId('groups-table').querySelectorAll('button')[i].focus({ preventScroll: true }); // the table is made again
    };
    return make('button', { type: 'button', class: 'link', 'aria-pressed': String(pressed), click }, g.group);
  };
  const rows = groups.map((g, i) => [
    name(g, i),
    make('b', { class: g.verdict.toLowerCase().replace(' ', '-') }, g.verdict),
    g.kind,
    limitsText({ lower: g.lower ?? -Infinity, upper: g.upper ?? Infinity }, report),
    value(g.witness && g.witness.distance < (g.lowest ?? Infinity) ? g.witness.distance : g.lowest),
    value(g.witness && g.witness.distance > (g.highest ?? -Infinity) ? g.witness.distance : g.highest),
    percent(g.exceeded_area_fraction ?? g.exceeded_point_fraction ?? 0),
    kindOf(g, unit),
  ]);
  const what = capital(quantityOf(report));
  byId('groups-table').replaceChildren(
    table(
      [
        'Group',
        'Verdict',
        'Named as',
        'Limits',
        `Least ${quantityOf(report)}`,
        `Largest ${quantityOf(report)}`,
        `${capital(wholeOf(report))} out of tolerance`,
        'Kind',
      ],
      rows,
      `${what} by group`,
    ),
    make(
      'p',
      { class: 'hint' },
      `${show ? 'Choose a group to see it alone in colours. ' : ''}Of all groups: ${report.group_tolerances!.verdict}. ${isCloud(report) ? 'A point is of the groups of its closest face.' : 'Shares are estimates from the samples of each group.'} The verdict at the top is the worse one of those of the part and of its groups.`,
    ),
  );
}
