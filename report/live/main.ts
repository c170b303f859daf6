// The page live.html: two bodies whose map is computed here, while they move.
import type { SdmWorker } from 'sdm';
import { Matrix4 } from 'three';
import type { AreaByValue } from '../src/area_by_value';
import { Callouts } from '../src/callouts';
import type { Colors } from '../src/color_scale';
import { cutOpen } from '../src/cut';
import { makeControls, startOf, State } from '../src/controls';
import { byId, make } from '../src/dom';
import { explore } from '../src/explore';
import { nameSubject, showVerdict } from '../src/headline';
import { drawHistogram } from '../src/histogram';
import { drawLegend } from '../src/legend';
import { signedText, text } from '../src/numbers';
import { openPage } from '../src/open_page';
import type { PageJson, Report, Vec } from '../src/page_data';
import { showPlaces } from '../src/places';
import { distanceText } from '../src/precision';
import { printPicture } from '../src/print';
import { csvOf } from '../src/saved';
import { SectionView } from '../src/section_view';
import { toFile, toScene } from '../src/subject';
import { showInputs, showMethod, showMore, showNumbers } from '../src/tables';
import { isSigned, outsideOf, unitOf, verdictOf, whatIf } from '../src/verdict';
import { quantityOf } from '../src/words';
import { Body, Engine, FineResult, FrameResult, inFile, kCoarse, moved } from './engine';
import { listenToDrops, readBody } from './files';
import { areaOf, frameOf, inScene, Layout, layoutOf } from './layout';
import { addPanel, say, showPlaying } from './panel';
import { Rate } from './rate';
import { addSaveButtons, glbOf } from './save';
import type { Scene } from './scene';
import { kScenes } from './scenes';
import { startWorker } from './start';
import { ChangingSurface, LiveSubject } from './subject';
import { Handles, LiveView } from './view';

declare const SDM_COLORS: Colors; // by the build
declare const SDM_VERSION: string;

const kUp = 'z';
const kRest = 220; // milliseconds without a motion, after which the map is fine
const kHistogram = 120; // milliseconds between histograms while something moves

/// What is shown of a pair.
interface Shown {
  view: LiveView;
  subject: LiveSubject;
  fine: ChangingSurface | null; // null: the coarse one is as fine
  section: SectionView;
  reference: { position: Float32Array; triangle: Uint32Array; isClosed: boolean }; // where it is now
  ghost: Float32Array; // without the motion by the handles
  callouts: Callouts;
}

class Live {
  private bodies: [Body, Body] | null = null;
  private shown: Shown | null = null;
  private scene: Scene | null = null;
  private units = '';
  private resolution = 1024;
  private report: Report | null = null;
  private area: AreaByValue | null = null;
  private state: State | null = null;
  private cutAxis: State['section']['axis'] = null; // of the section that is shown
  private touched = false; // the colours were chosen by the user
  private fitted = ''; // the colours that suit the map
  private playing = false;
  private pumping = false;
  private motion: Matrix4 | null = null; // wanted
  private version = 0; // of the places of the bodies
  private timer = 0;
  private histogramAt = 0;
  private tolerance: [number, number] | null = null;
  private loading = new AbortController();
  private readonly rate = new Rate();
  private readonly emptyView = byId('view').cloneNode(true) as HTMLElement;
  private readonly engine: Engine;
  private work: Promise<unknown> = Promise.resolve(); // what the worker does, in order

  constructor(private readonly worker: SdmWorker, scene: string) {
    this.engine = new Engine(worker);
    if (window.matchMedia('(max-width: 600px)').matches) this.resolution = 512;
    addPanel(scene, this.resolution, {
      openScene: (name) => void this.openScene(name),
      openFiles: (files, which) => void this.openFiles(files, which),
      cancel: () => this.loading.abort(),
      swap: () => void this.swap(),
      setResolution: (resolution) => void this.setResolution(resolution),
      setUnits: (units) => {
        this.units = units;
        this.rest();
      },
      setHandles: (handles) => this.setHandles(handles),
      resetMotion: () => {
        this.shown?.view.resetMotion();
        this.move();
      },
      togglePlay: () => this.togglePlay(),
    });
    listenToDrops((files) => void this.openFiles(files, null));
    document.body.append(make('script', { type: 'application/json', id: 'report' }));
    new ResizeObserver(() => this.drawHistogram()).observe(byId('histogram-chart'));
    byId('logarithmic').addEventListener('change', (event) => {
      if (this.state) this.state.logarithmic = (event.target as HTMLInputElement).checked;
      this.drawHistogram();
    });
  }

  get firstPicture(): Promise<void> { return this.shown!.view.firstPicture; }

  async openScene(name: string): Promise<void> {
    const known = kScenes[name];
    if (!known) {
      say(`There is no scene “${name}”; there are ${Object.keys(kScenes).join(', ')}.`, 'fault');
      return this.openScene('letters');
    }
    this.stop();
    (byId('scene') as HTMLSelectElement).value = name;
    const scene = await known.make(this.worker);
    (byId('units') as HTMLInputElement).value = this.units = scene.units;
    await this.open(scene.bodies, scene);
  }

  /// Two files, or one in place of one of the bodies.
  async openFiles(files: File[], which: 0 | 1 | null): Promise<void> {
    this.stop();
    if (files.length > 2 || (files.length === 2 && which !== null)) return say('Choose one file for each body.', 'fault');
    try {
      const read: Body[] = [];
      for (const file of files) {
        say(`Reading ${file.name}…`);
        read.push(await readBody(this.worker, file));
      }
      const [part, reference] = this.bodies ?? [];
      const bodies = read.length === 2 ? read : which === 0 ? [read[0], reference] : [part, read[0]];
      (byId('units') as HTMLInputElement).value = this.units = '';
      await this.open(bodies as [Body, Body], null);
      (byId('scene') as HTMLSelectElement).value = 'files';
    } catch (error) {
      this.fault(error);
    }
  }

  /// What was the reference, where it is now, becomes the part.
  private async swap(): Promise<void> {
    if (!this.bodies) return;
    const [part, reference] = this.bodies;
    const { view, subject } = this.shown!;
    (byId('scene') as HTMLSelectElement).value = 'files';
    await this.open([{ ...reference, positions: moved(reference.positions, inFile(view.motion, subject)) }, part], null);
  }

  private fault(error: unknown): void {
    const words = error instanceof Error ? error.message : String(error);
    say(/[.?!]$/.test(words) ? words : `${words}.`, 'fault');
  }

  /// Calls of the worker, one after the other.
  private inOrder<T>(call: () => Promise<T>): Promise<T> {
    const result = this.work.then(call, call);
    this.work = result.catch(() => {});
    return result;
  }

  private async open(bodies: [Body, Body], scene: Scene | null): Promise<void> {
    this.stop();
    const { signal } = (this.loading = new AbortController());
    window.clearTimeout(this.timer);
    ++this.version;
    document.body.setAttribute('aria-busy', 'true');
    try {
      await this.inOrder(async () => {
        const atlas = await this.engine.load(bodies, progress, signal);
        this.bodies = bodies;
        this.scene = scene;
        this.motion = null;
        [this.touched, this.state, this.tolerance, this.cutAxis] = [false, null, null, null];
        this.show(layoutOf(bodies[0], atlas, frameOf(bodies[0])));
        const fine = await this.engine.refine(this.resolution, progress, signal);
        this.setFine(fine && layoutOf(bodies[0], fine, frameOf(bodies[0])));
      });
      await this.showAtRest();
      say('');
    } catch (error) {
      if (!signal.aborted) this.fault(error);
    } finally {
      document.body.removeAttribute('aria-busy');
    }
    if (signal.aborted) await this.recover(this.bodies === bodies);
  }

  /// After an abort the worker has lost all: what is shown is loaded again, coarsely if its fine map was what took long.
  private async recover(wasRefining: boolean): Promise<void> {
    if (wasRefining) {
      this.resolution = kCoarse;
      (byId('resolution') as HTMLSelectElement).value = String(kCoarse);
    }
    if (this.bodies) await this.open(this.bodies, this.scene);
    say('Cancelled.');
  }

  private setFine(layout: Layout | null): void {
    const { shown } = this;
    if (!shown) return;
    const old = shown.fine;
    shown.fine = layout && new ChangingSurface(layout, SDM_COLORS, this.engine.isClosed);
    shown.subject.show(shown.subject.coarse);
    old?.dispose();
  }

  private async setResolution(resolution: number): Promise<void> {
    this.resolution = resolution;
    this.stop();
    if (!this.bodies) return;
    const [part] = this.bodies;
    const { centre, size } = this.shown!.subject;
    try {
      await this.inOrder(async () => {
        const atlas = await this.engine.refine(resolution, progress);
        this.setFine(atlas && layoutOf(part, atlas, { centre, size }));
      });
      await this.showAtRest();
      say('');
    } catch (error) {
      this.fault(error);
    }
  }

  /// A new view, of a pair whose distances follow.
  private show(layout: Layout): void {
    const { engine, bodies } = this;
    this.shown?.callouts.clear();
    this.shown?.view.dispose();
    byId('view').replaceWith(this.emptyView.cloneNode(true));
    byId('message').remove();
    const coarse = new ChangingSurface(layout, SDM_COLORS, engine.isClosed);
    const subject = new LiveSubject(coarse, engine.isClosed);
    const [, { positions, indices }] = bodies!;
    const ghost = inScene(positions, subject);
    const reference = { position: ghost.slice(), triangle: indices, isClosed: engine.referenceIsClosed };
    const section = new SectionView(subject.cuttable, reference, subject.size);
    const view = new LiveView(
      byId('view'), subject, { position: ghost, triangle: indices, covered: null, trianglesOfMesh: indices.length / 3, isBox: false }, section, kUp,
      () => this.shown?.callouts.update(), () => this.move(),
    );
    view.canvas.addEventListener('keydown', (event) => this.key(event));
    const callouts = new Callouts(view, (d) => this.valueText(d), '', subject.size, (at) => this.lookAt(at));
    this.shown = { view, subject, fine: null, section, reference, ghost, callouts };
    const unit = () => this.units && `\u00a0${this.units}`;
    const words = { quantity: 'distance', get unit() { return unit(); }, valueText: (d: number) => this.valueText(d) };
    explore(view, subject, callouts, words, () => this.lookAtAll());
    printPicture(view);
    new ResizeObserver(() => this.drawLegend()).observe(byId('legend'));
    this.setHandles((document.querySelector('input[name=handles]:checked') as HTMLInputElement).value as Handles);
    this.lookAtAll();
  }

  private lookAtAll(): void {
    const { view, subject, reference } = this.shown!;
    const kMost = 3; // times the part: of a larger reference, the part would be too small
    const lo = [...subject.lo] as Vec;
    const hi = [...subject.hi] as Vec;
    for (let i = 0; i < reference.position.length; ++i) {
      lo[i % 3] = Math.min(lo[i % 3], reference.position[i]);
      hi[i % 3] = Math.max(hi[i % 3], reference.position[i]);
    }
    const fits = Math.hypot(...lo.map((x, k) => hi[k] - x)) < 2 * kMost;
    view.setShown(fits ? lo : subject.lo, fits ? hi : subject.hi);
    view.look('corner');
  }

  private lookAt(at: Vec): void {
    const { view, subject } = this.shown!;
    view.look({ point: at, normal: subject.normalNear(at) });
    byId('view').scrollIntoView({ block: 'nearest' });
  }

  private setHandles(handles: Handles): void {
    this.shown?.view.setHandles(handles);
  }

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const kStep = 0.03;
    const shifts: Record<string, Vec> = {
      ArrowLeft: [-kStep, 0, 0], ArrowRight: [kStep, 0, 0], ArrowUp: [0, kStep, 0], ArrowDown: [0, -kStep, 0], PageUp: [0, 0, kStep], PageDown: [0, 0, -kStep],
    };
    const { view } = this.shown!;
    if (event.key.toLowerCase() === 'p' && !event.shiftKey) this.togglePlay();
    else if (event.shiftKey && shifts[event.key]) view.nudge(shifts[event.key]), this.move();
    else if (event.key === '<' || event.key === '>') view.nudge([0, 0, 0], event.key === '<' ? 5 : -5), this.move();
    else return;
    event.preventDefault();
    event.stopImmediatePropagation();
  }

  // ---- motion ----

  /// The reference was moved.
  private move(): void {
    const { view, subject } = this.shown!;
    this.motion = inFile(view.motion, subject);
    this.begin();
  }

  togglePlay(): void {
    this.playing = !this.playing;
    showPlaying(this.playing);
    if (this.playing) this.begin();
  }

  private stop(): void {
    this.playing = false;
    showPlaying(false);
  }

  private begin(): void {
    window.clearTimeout(this.timer);
    ++this.version;
    if (!this.pumping) void this.pump();
  }

  /// Computes frames until nothing moves.
  private async pump(): Promise<void> {
    this.pumping = true;
    this.rate.begin();
    this.shown!.callouts.clear();
    const { shown } = this;
    try {
      while (shown === this.shown && (this.motion || this.playing)) {
        this.showFrame(await this.inOrder(() => this.nextFrame()));
        await new Promise(requestAnimationFrame);
      }
    } catch (error) {
      this.stop();
      this.fault(error);
    }
    this.pumping = false;
    this.rest();
  }

  private async nextFrame(): Promise<FrameResult> {
    const { engine, scene } = this;
    const next = this.playing ? this.nextPositions() : null;
    const { motion } = this;
    this.motion = null;
    const began = performance.now(); // without the scene, which is not what is measured
    const change = (async () => {
      if (next) await engine.deform(next);
      if (motion) await engine.place(motion);
    })();
    const result = await engine.frame(change, began);
    if (next && scene) this.setVertices(next);
    return result;
  }

  /// Of a scene, those of its next frame; of files, the reference turns.
  private nextPositions(): [Float64Array, Float64Array] | null {
    if (this.scene) return this.scene.advance();
    const { view, subject } = this.shown!;
    view.nudge([0, 0, 0], 1.5);
    this.motion = inFile(view.motion, subject);
    return null;
  }

  private setVertices([first, second]: [Float64Array, Float64Array]): void {
    const { view, subject, ghost } = this.shown!;
    const { indices } = this.bodies![0];
    subject.coarse.setVertices({ positions: first, indices });
    inScene(second, subject, ghost);
    view.referenceMoved();
  }

  private showFrame({ distances, separation, milliseconds }: FrameResult): void {
    const { view, subject } = this.shown!;
    subject.coarse.setDistances(distances, null, null);
    subject.show(subject.coarse);
    view.draw();
    this.showSeparation(separation);
    this.rate.add(milliseconds);
    byId('rate').textContent = this.rate.text;
    if (performance.now() - this.histogramAt < kHistogram) return;
    this.histogramAt = performance.now();
    this.area = areaOf(subject.coarse.layout);
    byId('live-mean').textContent = this.live(meanOf(subject.coarse.layout));
    this.drawHistogram();
  }

  private showSeparation(separation: number): void {
    byId('separation').textContent = separation === 0 ? '0, they touch' : this.live(separation);
  }

  private live(value: number): string {
    return `${signedText(value, this.signs && value < 0, 3)}${this.units && `\u00a0${this.units}`}`;
  }

  // ---- at rest ----

  /// Computes the fine map soon, unless something moves again.
  private rest(): void {
    window.clearTimeout(this.timer);
    const { version } = this;
    this.timer = window.setTimeout(() => {
      if (version === this.version && !this.pumping) this.showAtRest().catch((error) => this.fault(error));
    }, kRest);
  }

  private async showAtRest(): Promise<void> {
    const { version } = this;
    const frame = await this.inOrder(() => this.engine.frame(Promise.resolve()));
    const result = await this.inOrder(() => (version === this.version ? this.engine.atRest(this.tolerance, this.units, () => {}) : Promise.resolve(null)));
    if (!result || version !== this.version) return;
    this.placeReference();
    this.showSeparation(frame.separation);
    this.showFine(result);
  }

  /// Where the reference is now, for sections.
  private placeReference(): void {
    const { view, reference, ghost } = this.shown!;
    reference.position.set(Float32Array.from(moved(Float64Array.from(ghost), view.motion)));
  }

  private showFine({ distances, atVertices, sites, milliseconds, report }: FineResult): void {
    const { subject, fine, view } = this.shown!;
    const surface = fine ?? subject.coarse;
    if (fine && this.scene) fine.setVertices(this.bodies![0]);
    surface.setDistances(distances, atVertices, sites);
    subject.show(surface);
    this.area = areaOf(surface.layout);
    this.setReport(report);
    byId('live-mean').textContent = this.live(report.distance?.mean as number);
    byId('rate').textContent = `${this.resolution}² in ${text(milliseconds, 3)} ms`;
    if (!this.touched || !this.state) this.makeForm();
    else this.apply(this.state);
    view.draw();
    byId('spoken').textContent = `${verdictOf(report).verdict}. Distances from ${this.valueText(report.extremes?.min?.distance ?? Number.NaN)} to ${this.valueText(report.extremes?.max?.distance ?? Number.NaN)}. Separation ${byId('separation').textContent}.`;
    document.documentElement.dataset.rest = String(this.version);
  }

  private setReport(report: Report): void {
    this.report = { version: SDM_VERSION, live: true, ...report };
    byId('report').textContent = JSON.stringify(this.report, null, 2);
    nameSubject(this.report);
    showVerdict(this.report);
    showNumbers(this.report);
    showInputs(this.report);
    showMethod(this.report);
    showMore(this.report);
    const { subject, callouts } = this.shown!;
    showPlaces(this.report, {} as PageJson, subject.size, (place) => {
      const at = toScene(subject, place.point);
      if (place.distance !== null) callouts.add({ distance: place.distance, point: place.point, at, detail: '' });
      this.lookAt(at);
    });
  }

  private get signs(): boolean {
    return this.report !== null && isSigned(this.report);
  }

  private valueText(distance: number): string {
    return distanceText(distance, this.report!, this.signs) + unitOf(this.report!);
  }

  // ---- display ----

  private makeForm(): void {
    const { view, subject } = this.shown!;
    const before = this.state;
    // The tolerance is that of the sliders, which can be taken away again.
    const { tolerance: _, ...unjudged } = this.report!;
    const { scale } = startOf(unjudged, this.area!, true);
    const limits = before && { lower: before.scale.lower, upper: before.scale.upper };
    const saved = before && { ...before, scale: { ...scale, ...limits, mode: before.scale.mode === 'tolerance' ? before.scale.mode : scale.mode } };
    this.state = makeControls(
      unjudged, this.area!, true, false, true, false, false, [toFile(subject, subject.lo), toFile(subject, subject.hi)], saved,
      (state) => {
        this.touched = colorsOf(state) !== this.fitted;
        this.apply(state);
      },
      (side) => (side ? view.look(side) : this.lookAtAll()),
    );
    addSaveButtons(
      {
        picture: () => {
          view.drawNow();
          return view.canvas.toDataURL('image/png');
        },
        csv: () => csvOf(this.report!, this.shown!.callouts.all),
        model: () => glbOf(subject.surface.layout, this.state!.scale, SDM_COLORS, kUp),
        report: () => this.inOrder(() => this.engine.html(this.tolerance, this.units, kUp)),
      },
      (error) => this.fault(error),
    );
    this.fitted = colorsOf(this.state);
    this.apply(this.state);
  }

  private apply(state: State): void {
    this.state = state;
    const { view, subject, section } = this.shown!;
    const { scale } = state;
    view.setScale(scale, SDM_COLORS);
    view.setGhost(state.ghost);
    this.cutAxis = cutOpen(view, subject, section, state.section, this.cutAxis);
    this.drawLegend();
    this.drawHistogram();
    this.judge(scale.lower, scale.upper);
  }

  private drawLegend(): void {
    if (!this.state || !this.report) return;
    drawLegend(this.state.scale, SDM_COLORS, quantityOf(this.report), this.report.units ?? '', false);
  }

  private drawHistogram(): void {
    if (this.state && this.area && this.report) drawHistogram(this.report, this.area, this.state.scale, SDM_COLORS, this.state.logarithmic ?? false);
  }

  /// Judges limits that are new: by the rule at once, and a little later by what the library can prove.
  private judge(lower: number, upper: number): void {
    const [before, verdict, after] = whatIf(this.report!, { lower, upper }, outsideOf(this.report!, this.state!.scale, this.area!));
    document.getElementById('what-if')?.replaceChildren(before, make('b', {}, verdict), after);
    const limits: [number, number] | null = Number.isFinite(lower) || Number.isFinite(upper) ? [lower, upper] : null;
    if (String(limits) === String(this.tolerance)) return;
    this.tolerance = limits;
    const { version } = this;
    window.setTimeout(() => {
      if (String(limits) !== String(this.tolerance) || version !== this.version) return;
      this.inOrder(() => this.engine.report(this.tolerance, this.units))
        .then((report) => {
          if (String(limits) !== String(this.tolerance) || version !== this.version) return;
          this.setReport(report);
          this.apply(this.state!);
        })
        .catch((error) => this.fault(error));
    }, kRest);
  }

  // ---- for tests ----

  /// The bodies as they are, with the reference moved.
  get meshes() {
    const [part, reference] = this.bodies!;
    const { view, subject } = this.shown!;
    return [part, { ...reference, positions: moved(reference.positions, inFile(view.motion, subject)) }].map(({ name, positions, indices }) => ({
      name, positions: Array.from(positions), indices: Array.from(indices),
    }));
  }
  get numbers(): Report | null { return this.report; }
  handleAt(axis: 'X' | 'Y' | 'Z'): { x: number; y: number } { return this.shown!.view.handleAt(axis); }
  memoryBytes(): Promise<number> { return this.worker.memoryBytes(); }
  get atRest(): boolean { return !this.pumping && this.shown !== null && this.shown.view.atRest; }

  /// Milliseconds of each of a number of frames of the coarse map, without pictures.
  async measure(frames: number): Promise<number[]> {
    const times: number[] = [];
    this.playing = true;
    for (let i = 0; i < frames; ++i) {
      if (!this.scene) this.motion = inFile(new Matrix4().makeRotationZ((2 * Math.PI * i) / frames), this.shown!.subject);
      times.push((await this.inOrder(() => this.nextFrame())).milliseconds);
    }
    this.stop();
    this.rest();
    return times;
  }
}

const colorsOf = ({ scale: { mode, lo, hi } }: State) => [mode, lo, hi].join();

const progress = (step: string, fraction: number) => say(`${step}… ${Math.round(100 * fraction)} %`, 'progress');

function meanOf({ map, areas }: Layout): number {
  let [sum, total] = [0, 0];
  for (let i = 0; i < areas.length; ++i)
    if (areas[i] > 0 && Number.isFinite(map.distance[i])) (sum += areas[i] * map.distance[i]), (total += areas[i]);
  return total > 0 ? sum / total : Number.NaN;
}

void openPage('sdmLive', 'bodies', 'Is WebGL 2 on in this browser?', async () => {
  byId('message').textContent = 'Starting…';
  const worker = await startWorker();
  const wanted = new URLSearchParams(window.location.search).get('scene') ?? 'letters';
  const live = new Live(worker, wanted in kScenes ? wanted : 'letters');
  await live.openScene(wanted);
  return live;
});
