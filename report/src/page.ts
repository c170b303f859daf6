// The measured part of report.html with its form, which show one another.
import { Callouts } from './callouts';
import { Cloud } from './cloud';
import { drawCoverageLegend } from './coverage';
import { makeControls } from './controls';
import { State } from './state';
import { cutOpen } from './cut';
import { byId, make } from './dom';
import { explore } from './explore';
import { GroupName, showGroups } from './group_table';
import { drawHistogram } from './histogram';
import { GroupLimits } from './group_limits';
import { drawGroupLegend, drawLegend } from './legend';
import { showMade } from './made';
import { Listed, listedPlaces, showPlaces } from './places';
import { PageData, Report, Vec } from './page_data';
import { distanceText } from './precision';
import { printPicture } from './print';
import { csvOf, download, pageWith, Saved } from './saved';
import { SectionView } from './section_view';
import { areApart, boxOf, Subject, toFile, toScene, united } from './subject';
import { showSure } from './sure';
import { Surface } from './surface';
import { inputsOf, showOmissions } from './tables';
import { outsideOf, unitOf, verdictOf, whatIf } from './verdict';
import { View } from './view';
import { isSigned, quantityOf } from './words';

export class Page {
  private readonly subject: Subject;
  private readonly cloud: Cloud | null;
  private readonly limits: GroupLimits | null; // of triangles, by their groups
  private readonly view: View;
  private readonly section: SectionView;
  private readonly callouts: Callouts;
  readonly explored: ReturnType<typeof explore>; ///< for tests
  private readonly first: Listed | undefined; // place of the list, of a part that is judged
  private readonly signs: boolean;
  private readonly unit: string;
  private state: State;
  private highlighted: GroupName | null | undefined;
  private cutAxis: State['section']['axis'] = null; // of the section that is shown

  constructor(
    private readonly report: Report,
    private readonly data: PageData,
    private readonly copy: HTMLElement, // of the page as it was in the file
    saved: Saved | null,
  ) {
    this.signs = isSigned(report);
    this.unit = unitOf(report);
    const { page, surface, cloud, ghost } = data;
    this.first = verdictOf(report).verdict === 'MEASURED' ? undefined : listedPlaces(report, page)[0];
    const { measured } = inputsOf(report);
    this.cloud = cloud && new Cloud(cloud);
    const limits = surface && new GroupLimits(report, surface.model);
    this.limits = limits && limits.count > 1 ? limits : null;
    this.subject =
      this.cloud ??
      new Surface(surface!.model, surface!.map, measured?.closed ?? false, this.unit, this.limits);
    if (this.limits) showSure(report, this.limits.unjudged(surface!.model));
    this.section = this.makeSection();
    this.view = new View(byId('view'), this.subject, ghost, this.section, page.up, () =>
      this.callouts?.update(),
    );
    this.callouts = new Callouts(
      this.view,
      (d) => this.valueText(d),
      this.unit,
      this.subject.size,
      (at) => this.lookAt(at),
    );
    const words = {
      quantity: quantityOf(report),
      unit: this.unit,
      valueText: (d: number) => this.valueText(d),
    };
    this.explored = explore(this.view, this.subject, this.callouts, words, () => this.lookAtFirst());
    // A reference beside the part hides nothing, and is shown from the start.
    const ghostShown = ghost !== null && areApart(this.subject, boxOf(ghost.position));
    this.state = makeControls(
      report,
      data.area,
      data.ghost !== null,
      data.ghost?.covered != null,
      ghostShown,
      data.cloud !== null,
      this.limits !== null,
      [toFile(this.subject, this.subject.lo), toFile(this.subject, this.subject.hi)],
      saved?.state ?? null,
      (state) => this.apply(state),
      (side) => (side ? this.view.look(side) : this.lookAtFirst()),
    );
    this.cutAxis = this.state.section.axis;
    this.apply(this.state);
    this.listen();
    this.showWorst();
    showOmissions(report, data);
    showMade([report.o1, report.o2, report.mesh], page);
    this.addSaveButtons();
    this.showBoth(ghostShown);
    if (!saved) {
      if (this.first?.distance) this.addPlace(this.first);
      this.lookAtFirst();
      return;
    }
    for (const callout of saved.callouts) this.callouts.add(callout);
    this.view.pose = saved.camera;
  }

  get firstPicture(): Promise<void> {
    return this.view.firstPicture;
  }

  private makeSection(): SectionView {
    const { ghost } = this.data;
    const { reference } = inputsOf(this.report);
    const part = this.subject instanceof Surface ? this.subject.cuttable : null;
    const other = ghost && !ghost.isBox ? { ...ghost, isClosed: reference?.closed ?? false } : null;
    return new SectionView(part, other, this.subject.size);
  }

  /// The reference beside the part is in the picture.
  private showBoth(ghostShown: boolean): void {
    const { ghost } = this.data;
    if (!ghost || !ghostShown) return;
    const both = united(this.subject, boxOf(ghost.position));
    const kMost = 5; // half diagonals of the part: with a larger box, the part would be too small
    if (Math.hypot(...both.hi.map((x, k) => x - both.lo[k])) <= kMost) this.view.setShown(both.lo, both.hi);
  }

  /// The view that the page opens with: of a part that is judged, the first place of the list faces the viewer.
  private lookAtFirst(): void {
    this.view.look('corner');
    if (this.first) this.view.lookFrom(toScene(this.subject, this.first.point));
  }

  /// The page as it is shown, in one file.
  text(): string {
    return pageWith(this.copy, { state: this.state, callouts: this.callouts.all, camera: this.view.pose });
  }

  /// All numbers of the page, for spreadsheets.
  csv(): string {
    return csvOf(this.report, this.callouts.all);
  }

  private addSaveButtons(): void {
    const button = (id: string, label: string, name: string, type: string, text: () => string) =>
      make('button', { type: 'button', id, click: () => download(name, type, text()) }, label);
    byId('form').append(
      button('save-page', 'Save this page', 'report.html', 'text/html', () => this.text()),
      button('save-numbers', 'Numbers as CSV', 'numbers.csv', 'text/csv', () => this.csv()),
      make('p', { class: 'hint' }, 'The saved page keeps callouts, section, colours and view.'),
    );
  }

  private apply(state: State): void {
    this.state = state;
    const { scale, section, ghost } = state;
    this.view.setScale(scale);
    this.view.setGhost(ghost);
    this.view.setCoverage(state.coverage);
    this.showGroup(state);
    this.cloud?.setWidth(state.width);
    this.cutAxis = cutOpen(this.view, this.subject, this.section, section, this.cutAxis);
    this.drawLegend();
    this.drawHistogram();
    this.showWhatIf(state);
  }

  private drawLegend(): void {
    const { report, limits } = this;
    const { scale, group, coverage } = this.state;
    if (coverage) {
      drawCoverageLegend(report);
      return;
    }
    const hasGaps = [report.beyond_max_distance, report.without_match, report.texels_without_value].some(
      (n) => Number(n ?? 0) > 0,
    );
    const unit = report.units ?? '';
    if (limits !== null && scale.mode === 'tolerance')
      drawGroupLegend(
        scale,
        limits,
        limits.setsOf(this.data.surface!.model, group ?? null),
        quantityOf(report),
        unit,
        hasGaps,
      );
    else drawLegend(scale, quantityOf(report), unit, hasGaps);
  }

  private showGroup(state: State): void {
    const { subject } = this;
    if (
      !(subject instanceof Surface) ||
      !this.report.group_tolerances?.groups.some((g) => subject.hasGroup(g.kind, g.group))
    )
      return;
    const chosen = state.group ?? null;
    if (chosen === this.highlighted) return;
    this.highlighted = chosen;
    subject.highlight(chosen);
    showGroups(this.report, chosen, (group) => {
      state.group = group;
      this.apply(state);
      const middle = group && subject.middleOf(group);
      if (middle) this.view.lookFrom(middle);
    });
  }

  private drawHistogram(): void {
    const { scale, logarithmic = false } = this.state;
    (byId('logarithmic') as HTMLInputElement).checked = logarithmic;
    drawHistogram(this.report, this.data.area, scale, logarithmic);
  }

  private showWhatIf({ scale }: State): void {
    const [before, verdict, after] = whatIf(
      this.report,
      scale,
      outsideOf(this.report, scale, this.data.area),
    );
    document.getElementById('what-if')?.replaceChildren(before, make('b', {}, verdict), after);
  }

  private listen(): void {
    printPicture(this.view);
    new ResizeObserver(() => this.drawHistogram()).observe(byId('histogram-chart'));
    new ResizeObserver(() => this.drawLegend()).observe(byId('legend'));
    byId('logarithmic').addEventListener('change', (event) => {
      this.state.logarithmic = (event.target as HTMLInputElement).checked;
      this.drawHistogram();
    });
  }

  /// A distance as the tables of the page state it.
  private valueText(distance: number): string {
    return distanceText(distance, this.report, this.signs) + this.unit;
  }

  private lookAt(at: Vec): void {
    if (this.view.isCutAway(at)) {
      const section = byId('section') as HTMLSelectElement;
      section.value = '';
      section.dispatchEvent(new Event('change'));
    }
    this.view.look({ point: at, normal: this.subject.normalNear(at) });
    byId('view').scrollIntoView({ block: 'nearest' });
  }

  private showWorst(): void {
    showPlaces(this.report, this.data.page, this.subject.size, (place) => this.lookAt(this.addPlace(place)));
  }

  /// A callout at a place of the list, if it has a value; where it is in the scene.
  private addPlace(place: { distance: number | null; point: Vec; group?: string | null }): Vec {
    const at = toScene(this.subject, place.point);
    if (
      place.distance !== null &&
      !this.callouts.all.some((c) => c.point.every((x, k) => x === place.point[k]))
    )
      this.callouts.add({ distance: place.distance, point: place.point, at, detail: place.group ?? '' });
    return at;
  }

  /// The fraction out of the limits as it is shown, and by the bins alone; for tests.
  outside() {
    const { scale } = this.state;
    const binned = 1 - this.data.area.within(scale.lower - scale.accuracy, scale.upper + scale.accuracy);
    return { stated: outsideOf(this.report, scale, this.data.area), binned };
  }

  /// What is under a place of the canvas; for tests.
  inspect(x: number, y: number) {
    const found = this.view.find(x, y);
    return (
      found && { ...found.value, point: toFile(this.subject, found.at), place: this.view.place(found.at) }
    );
  }
}
