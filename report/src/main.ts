// The page of report.html: the text first, then the part.
import { showBadge } from './badge';
import { Callouts } from './callouts';
import { Cloud } from './cloud';
import { drawCoverageLegend } from './coverage';
import { makeControls, State } from './controls';
import { byId, make } from './dom';
import { GroupName, showGroups } from './group_table';
import { drawHistogram } from './histogram';
import { GroupLimits } from './group_limits';
import { drawGroupLegend, drawLegend } from './legend';
import { showMade } from './made';
import { exactText, place } from './numbers';
import { openPage } from './open_page';
import { Listed, listedPlaces, onlyThickest, showPlaces } from './places';
import { PageData, readReport, Report, Vec } from './page_data';
import { distanceText } from './precision';
import { printPicture } from './print';
import { readData } from './read_page';
import { copyOfPage, csvOf, download, pageWith, readSaved, Saved } from './saved';
import { SectionView } from './section_view';
import { showWithoutPicture } from './without_picture';
import { boxOf, Subject, toFile, toScene } from './subject';
import { showSure } from './sure';
import { Surface } from './surface';
import { inputsOf, showFields, showInputs, showMethod, showMore, showNumbers, showOmissions, titleOf } from './tables';
import { isCloud, isSigned, outsideOf, unitOf, verdictOf, whatIf } from './verdict';
import { View } from './view';
import { capital, named, quantityOf } from './words';

function showVerdict(report: Report): void {
  const { verdict, sentence } = verdictOf(report);
  showBadge(verdict);
  showSure(report);
  const tile = report.atlas?.udim ? ' This page is of one tile of the texture; the verdict on all tiles is in report.json in the folder above.' : '';
  const doubts = verdict === 'FAIL' || verdict === 'NOT DECIDED' ? (report.doubts ?? []).map((doubt) => ` ${capital(doubt.text)}.`).join('') : '';
  const notes = report.notes?.length ?? 0;
  const link = notes === 0 ? '' : make('a', { href: '#method' }, notes === 1 ? 'One note' : `${notes} notes`);
  byId('sentence').replaceChildren(named(sentence + doubts, report) + tile, ...(link ? [' ', link, notes === 1 ? ' qualifies this.' : ' qualify this.'] : []));
  document.title = `${verdict}: ${titleOf(report)}`;
  byId('title').textContent = titleOf(report);
}

/// Words of page.html that differ for clouds.
function nameSubject(report: Report): void {
  byId('canvas').setAttribute('aria-label', `The part, coloured by ${quantityOf(report)}`);
  if (report.thickness) byId('worst-title').textContent = onlyThickest(report) ? 'Thickest places' : 'Thinnest places';
  else if (report.mesh) byId('worst-title').textContent = 'Smallest distances';
  else if (report.places?.limits_from === 'tolerance') byId('worst-title').textContent = 'Places out of tolerance';
  if (!isCloud(report)) return;
  byId('part-title').textContent = 'The cloud in 3D';
  byId('histogram-title').textContent = 'How the points are distributed';
}

/// What the lines of a section are.
function sectionWords({ part, other, factor }: SectionView): string {
  if (!part) return other ? 'Dark line: the reference.' : '';
  const inside = part.isClosed ? ' Grey: inside of the part.' : '';
  if (!other) return `The thick line is the profile of the part in the colours of its values.${inside}`;
  const gap = `${factor > 1 ? `${factor} times ` : ''}as long as the gap to the reference`;
  return `Thick line in colours: the part. Dark line: the reference. Thin lines towards it: ${gap} in this plane.${other.isClosed && part.isClosed ? ' Orange: only the part; blue: only the reference; grey: both.' : inside}`;
}

class Page {
  private readonly subject: Subject;
  private readonly cloud: Cloud | null;
  private readonly limits: GroupLimits | null; // of triangles, by their groups
  private readonly view: View;
  private readonly section: SectionView;
  private readonly callouts: Callouts;
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
    this.cloud = cloud && new Cloud(cloud, page.colors);
    const limits = surface && new GroupLimits(report, surface.model);
    this.limits = limits && limits.count > 1 ? limits : null;
    this.subject = this.cloud ?? new Surface(surface!.model, surface!.map, page.colors, measured?.closed ?? false, this.unit, this.limits);
    if (this.limits) showSure(report, this.limits.unjudged(surface!.model));
    this.section = this.makeSection();
    this.view = new View(byId('view'), this.subject, ghost, this.section, page.up, () => this.callouts?.update());
    this.callouts = new Callouts(this.view, (d) => this.valueText(d), this.unit, this.subject.size, (at) => this.lookAt(at));
    const ghostShown = this.apart();
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

  get firstPicture(): Promise<void> { return this.view.firstPicture; }

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
    const { lo, hi } = boxOf(ghost.position);
    const both = { lo: lo.map((x, k) => Math.min(x, this.subject.lo[k])) as Vec, hi: hi.map((x, k) => Math.max(x, this.subject.hi[k])) as Vec };
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

  /// Whether the reference is beside the part: then it hides nothing and is shown from the start.
  private apart(): boolean {
    const { ghost } = this.data;
    if (!ghost) return false;
    const { lo, hi } = boxOf(ghost.position);
    return [0, 1, 2].some((k) => this.subject.hi[k] < lo[k] || hi[k] < this.subject.lo[k]);
  }

  private apply(state: State): void {
    this.state = state;
    const { scale, section, ghost } = state;
    const { colors } = this.data.page;
    this.view.setScale(scale, colors);
    this.view.setGhost(ghost);
    this.view.setCoverage(state.coverage);
    this.showGroup(state);
    this.cloud?.setWidth(state.width);
    this.turnSection(section);
    if (section.axis === null) {
      this.view.setCut(null);
    } else {
      const [least, most] = [this.subject.lo[section.axis], this.subject.hi[section.axis]];
      const sign = section.flipped ? -1 : 1;
      const normal: Vec = [0, 0, 0];
      normal[section.axis] = sign;
      this.view.setCut({ normal, offset: sign * (least + section.at * (most - least)) });
      byId('section-words').textContent = sectionWords(this.section);
    }
    this.drawLegend();
    this.drawHistogram();
    this.showWhatIf(state);
  }

  private drawLegend(): void {
    const { report, limits } = this;
    const { scale, group, coverage } = this.state;
    const { colors } = this.data.page;
    if (coverage) return drawCoverageLegend(report);
    const hasGaps = [report.beyond_max_distance, report.without_match, report.texels_without_value].some((n) => Number(n ?? 0) > 0);
    const unit = report.units ?? '';
    if (limits !== null && scale.mode === 'tolerance') drawGroupLegend(scale, limits, limits.setsOf(this.data.surface!.model, group ?? null), colors, quantityOf(report), unit, hasGaps);
    else drawLegend(scale, colors, quantityOf(report), unit, hasGaps);
  }

  /// The cut surface of a section that is new faces the viewer.
  private turnSection(section: State['section']): void {
    if (section.axis !== null && section.axis !== this.cutAxis) {
      const { position, target } = this.view.pose;
      section.flipped = position[section.axis] < target[section.axis];
      (byId('section-flip') as HTMLInputElement).checked = section.flipped;
    }
    this.cutAxis = section.axis;
  }

  private showGroup(state: State): void {
    const { subject } = this;
    if (!(subject instanceof Surface) || !this.report.group_tolerances?.groups.some((g) => subject.hasGroup(g.kind, g.group))) return;
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
    drawHistogram(this.report, this.data.area, scale, this.data.page.colors, logarithmic);
  }

  private showWhatIf({ scale }: State): void {
    const [before, verdict, after] = whatIf(this.report, scale, outsideOf(this.report, scale, this.data.area));
    document.getElementById('what-if')?.replaceChildren(before, make('b', {}, verdict), after);
  }

  private listen(): void {
    const { canvas } = this.view;
    let next: (() => void) | null = null;
    const later = (action: () => void) => {
      if (!next) requestAnimationFrame(() => { next?.(); next = null; });
      next = action;
    };
    const at = (event: PointerEvent): [number, number] => [event.offsetX, event.offsetY];
    let pressed: [number, number] | null = null;
    canvas.addEventListener('pointermove', (event) => {
      const [x, y] = at(event);  // now: after its dispatch an event has no target that they refer to
      if (event.buttons === 0) later(() => this.probe(x, y));
    });
    canvas.addEventListener('pointerdown', (event) => {
      pressed = event.button === 0 ? at(event) : null;
    });
    canvas.addEventListener('pointerup', (event) => {
      const [x, y] = at(event);
      if (!pressed || Math.hypot(x - pressed[0], y - pressed[1]) > 4) return;
      pressed = null;
      this.probe(x, y);
      this.addCallout(x, y);
    });
    canvas.addEventListener('keydown', (event) => this.key(event));
    canvas.addEventListener('focus', () => byId('view').classList.toggle('keyboard', canvas.matches(':focus-visible')));
    canvas.addEventListener('blur', () => byId('view').classList.remove('keyboard'));
    printPicture(this.view);
    new ResizeObserver(() => this.drawHistogram()).observe(byId('histogram-chart'));
    new ResizeObserver(() => this.drawLegend()).observe(byId('legend'));
    byId('logarithmic').addEventListener('change', (event) => {
      this.state.logarithmic = (event.target as HTMLInputElement).checked;
      this.drawHistogram();
    });
  }

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const actions: Record<string, () => void> = {
      ArrowLeft: () => this.view.turn(-10, 0),
      ArrowRight: () => this.view.turn(10, 0),
      ArrowUp: () => this.view.turn(0, 10),
      ArrowDown: () => this.view.turn(0, -10),
      '+': () => this.view.zoom(0.85),
      '=': () => this.view.zoom(0.85),
      '-': () => this.view.zoom(1 / 0.85),
      Home: () => this.lookAtFirst(),
      Enter: () => this.addCallout(...this.middle()),
    };
    const action = actions[event.key];
    if (!action) return;
    event.preventDefault();
    byId('view').classList.add('keyboard');
    action();
    this.probe(...this.middle());
  }

  private middle(): [number, number] {
    return [this.view.canvas.clientWidth / 2, this.view.canvas.clientHeight / 2];
  }

  private probe(x: number, y: number): void {
    const found = this.view.find(x, y);
    const values = byId('probe-values');
    if (!found) {
      values.replaceChildren();
      return;
    }
    const row = (label: string, text: string, id: string) =>
      make('div', {}, make('dt', {}, label), make('dd', { id }, text));
    const isNone = Number.isNaN(found.distance);
    values.replaceChildren(
      row(capital(quantityOf(this.report)), isNone ? 'none in range' : this.valueText(found.distance), 'probe-distance'),
      row('Position', place(toFile(this.subject, found.at), this.subject.size) + this.unit, 'probe-position'),
      ...(isNone ? [] : [row('Not rounded', exactText(found.distance) + this.unit, 'probe-exact')]),
      ...found.rows.map(([label, text, id]) => row(label, text, id)),
    );
  }

  /// A distance as the tables of the page state it.
  private valueText(distance: number): string {
    return distanceText(distance, this.report, this.signs) + this.unit;
  }

  private addCallout(x: number, y: number): void {
    const found = this.view.find(x, y);
    if (!found || Number.isNaN(found.distance)) return;
    const { distance, at, detail } = found;
    this.callouts.add({ distance, point: toFile(this.subject, at), at, detail });
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
    if (place.distance !== null && !this.callouts.all.some((c) => c.point.every((x, k) => x === place.point[k])))
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
    return found && { ...found.value, point: toFile(this.subject, found.at), place: this.view.place(found.at) };
  }
}

const copy = copyOfPage();
const saved = readSaved();
const report = readReport();
nameSubject(report);
showVerdict(report);
showFields(report);
showNumbers(report);
showInputs(report);
showMethod(report);
showGroups(report);
showMore(report);
void openPage('sdmPage', 'part', 'The numbers are complete.', async () => {
  const data = await readData();
  try {
    return new Page(report, data, copy, saved);
  } catch (error) {
    showWithoutPicture(report, data);
    throw error;
  }
});
