// How a pair is shown: the form, the legend, the histogram, and the verdict with the limits of the sliders.
import { cutOpen } from '../src/cut';
import { makeControls } from '../src/controls';
import { startOf, State } from '../src/state';
import { byId, make } from '../src/dom';
import { drawHistogram } from '../src/histogram';
import { drawLegend } from '../src/legend';
import type { Report } from '../src/page_data';
import { csvOf } from '../src/saved';
import { toFile } from '../src/subject';
import { outsideOf, whatIf } from '../src/verdict';
import { quantityOf } from '../src/words';
import { kUp } from './pair';
import { showLimits, showReport } from './results';
import { addSaveButtons, glbOf } from './save';
import { kRest, type Session } from './session';

const colorsOf = ({ scale: { mode, lo, hi } }: State) => [mode, lo, hi].join();

export class Display {
  private state: State | null = null;
  private cutAxis: State['section']['axis'] = null; // of the section that is shown
  private touched = false; // the colours were chosen by the user
  private fitted = ''; // the colours that suit the map
  private made = ''; // what the form was made for

  constructor(private readonly session: Session) {
    new ResizeObserver(() => this.drawHistogram()).observe(byId('histogram-chart'));
    byId('logarithmic').addEventListener('change', (event) => {
      if (this.state) this.state.logarithmic = (event.target as HTMLInputElement).checked;
      this.drawHistogram();
    });
  }

  /// A pair is new; `isOther`: than the one before.
  renew(isOther: boolean): void {
    this.cutAxis = null;
    this.made = '';
    if (isOther) [this.touched, this.state, this.session.tolerance] = [false, null, null];
    const legend = new ResizeObserver(() => this.drawLegend());
    legend.observe(byId('legend'));
  }

  /// Shows the form of a report that is new, made again only if it has other ranges or another unit.
  showForm(): void {
    const { report, pair } = this.session;
    const { extremes, units, sign } = report!;
    const { lo, hi } = pair!.subject;
    const ranges = this.touched ? [] : [extremes?.min?.distance, extremes?.max?.distance, lo, hi];
    const made = JSON.stringify([units, sign?.method, ranges]);
    if (this.state && made === this.made) {
      this.apply(this.state);
      return;
    }
    if (this.made && (JSON.parse(this.made) as unknown[])[0] !== (units ?? null)) pair!.callouts.renew();
    this.made = made;
    this.makeForm();
  }

  private makeForm(): void {
    const { session } = this;
    const { view, subject } = session.pair!;
    // The tolerance is that of the sliders, which can be taken away again.
    const { tolerance: _, ...unjudged } = session.report!;
    this.state = makeControls(
      unjudged,
      session.area!,
      true,
      false,
      true,
      false,
      false,
      [toFile(subject, subject.lo), toFile(subject, subject.hi)],
      this.kept(unjudged),
      (state) => {
        this.touched = colorsOf(state) !== this.fitted;
        this.apply(state);
      },
      (side) => (side ? view.look(side) : session.pair!.lookAtAll()),
    );
    this.addSaveButtons();
    if (!this.touched) this.fitted = colorsOf(this.state);
    this.apply(this.state);
  }

  /// The settings of the form before, whose colours suit the map if they did so before.
  private kept(report: Report): State | null {
    const before = this.state;
    if (!before || this.touched) return before;
    const { scale } = startOf(report, this.session.area!, true);
    const { lower, upper, mode } = before.scale;
    return { ...before, scale: { ...scale, lower, upper, mode: mode === 'tolerance' ? mode : scale.mode } };
  }

  private addSaveButtons(): void {
    const { session } = this;
    addSaveButtons(
      {
        picture: () => {
          const { view } = session.pair!;
          view.drawNow();
          return view.canvas.toDataURL('image/png');
        },
        csv: () => csvOf(session.report!, session.pair!.callouts.all),
        model: () => glbOf(session.pair!.subject.surface.layout, this.state!.scale, kUp, session.units),
        report: () => session.inOrder(() => session.engine.html(session.tolerance, session.units, kUp)),
      },
      (error) => session.fault(error),
    );
  }

  private apply(state: State): void {
    this.state = state;
    const { view, subject, section } = this.session.pair!;
    view.setScale(state.scale);
    view.setGhost(state.ghost);
    this.cutAxis = cutOpen(view, subject, section, state.section, this.cutAxis);
    if (this.session.moving) section.show(null);
    this.drawLegend();
    this.drawHistogram();
    this.judge(state.scale.lower, state.scale.upper);
  }

  private drawLegend(): void {
    const { report } = this.session;
    if (this.state && report) drawLegend(this.state.scale, quantityOf(report), report.units ?? '', false);
  }

  drawHistogram(): void {
    const { report, area, moving } = this.session;
    if (!this.state || !area || !report) return;
    // The extremes of the report are those of the last rest.
    const extremes = {
      min: { ...report.extremes?.min, distance: area.lo },
      max: { ...report.extremes?.max, distance: area.hi },
    } as Report['extremes'];
    drawHistogram(
      moving ? { ...report, extremes } : report,
      area,
      this.state.scale,
      this.state.logarithmic ?? false,
    );
  }

  /// Judges limits that are new: by the rule at once, and a little later by what the library can prove. While something moves
  /// the next rest does that.
  private judge(lower: number, upper: number): void {
    const { session } = this;
    const [before, verdict, after] = whatIf(
      session.report!,
      { lower, upper },
      outsideOf(session.report!, this.state!.scale, session.area!),
    );
    document.getElementById('what-if')?.replaceChildren(before, make('b', {}, verdict), after);
    const limits: [number, number] | null =
      Number.isFinite(lower) || Number.isFinite(upper) ? [lower, upper] : null;
    if (String(limits) === String(session.tolerance)) return;
    session.tolerance = limits;
    if (!session.moving) showLimits(session, limits);
    const { version } = session;
    const isCurrent = () =>
      String(limits) === String(session.tolerance) &&
      version === session.version &&
      !session.moving &&
      !session.loading;
    window.setTimeout(() => {
      if (!isCurrent()) return;
      session
        .inOrder(() => (isCurrent() ? session.engine.report(limits, session.units) : Promise.resolve(null)))
        .then((report) => {
          if (!report || !isCurrent()) return;
          showReport(session, report);
          this.apply(this.state!);
        })
        .catch((error) => session.fault(error));
    }, kRest);
  }
}
