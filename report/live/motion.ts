// How bodies move: frames of the coarse map while they do, and the fine map with its report at rest.
import { Matrix4 } from 'three';
import type { Vec } from '../src/page_data';
import type { Baking } from './baking';
import type { Display } from './display';
import { FineResult, FrameResult } from './engine';
import { inFile } from './placing';
import { areaOf } from './layout';
import { meanOf, showMean, showRate, showSeparation, showTime } from './live_values';
import { showBusy, showPlaying } from './panel';
import { Rate } from './rate';
import { showNoVerdict, showReport, speak } from './results';
import { kRest, type Session } from './session';

const kHistogram = 120; // milliseconds between histograms while something moves

export class Motion {
  private playing = false;
  private pumping = false;
  private wanted: Matrix4 | null = null; // of the reference
  private timer = 0;
  private histogramAt = 0;
  private readonly rate = new Rate();

  constructor(
    private readonly session: Session,
    private readonly display: Display,
    private readonly baking: Baking,
  ) {}

  get isPumping(): boolean {
    return this.pumping;
  }

  /// The reference was moved.
  move(): void {
    const { pair } = this.session;
    if (!pair) return;
    this.wanted = inFile(pair.view.motion, pair.subject);
    this.begin();
  }

  /// What is measured has changed, and nothing has moved.
  change(): void {
    ++this.session.version;
    if (!this.pumping && !this.session.loading) this.rest();
  }

  nudge(shift: Vec, turn = 0): void {
    this.session.pair?.view.nudge(shift, turn);
    this.move();
  }

  togglePlay(): void {
    if (this.session.loading || !this.session.pair) return;
    this.playing = !this.playing;
    showPlaying(this.playing);
    if (this.playing) this.begin();
  }

  stop(): void {
    this.playing = false;
    showPlaying(false);
    window.clearTimeout(this.timer);
  }

  /// The reference is to be moved by a matrix, by the next frame.
  want(motion: Matrix4): void {
    this.wanted = motion;
  }

  /// A pair is new.
  forget(): void {
    this.wanted = null;
  }

  /// Nothing is loaded any more: what was moved meanwhile is computed.
  resume(): void {
    if (this.wanted || this.playing) this.begin();
    else if (this.session.moving) this.rest();
  }

  private begin(): void {
    window.clearTimeout(this.timer);
    ++this.session.version;
    if (!this.pumping && !this.session.loading) void this.pump();
  }

  /// Computes frames until nothing moves.
  private async pump(): Promise<void> {
    const { session } = this;
    const pair = session.pair!;
    this.pumping = session.moving = true;
    showBusy(session);
    showNoVerdict(session);
    this.rate.begin();
    pair.callouts.clear();
    pair.section.show(null); // it is of the last rest
    this.baking.hide();
    const isOn = () => pair === session.pair && !session.loading;
    try {
      while (isOn() && (this.wanted || this.playing)) {
        const result = await session.inOrder(() => (isOn() ? this.nextFrame() : Promise.resolve(null)));
        if (result && isOn()) this.showFrame(result);
        await new Promise(requestAnimationFrame);
      }
    } catch (error) {
      this.stop();
      session.fault(error);
    }
    this.pumping = false;
    if (!session.loading) this.resume();
  }

  async nextFrame(playing = this.playing): Promise<FrameResult> {
    const { engine, scene } = this.session;
    const next = playing ? await this.nextPositions() : null;
    const motion = this.wanted;
    this.wanted = null;
    const began = performance.now(); // without the scene, which is not what is measured
    const change = (async () => {
      if (next) await engine.deform(next);
      if (motion) await engine.place(motion);
    })();
    const result = await engine.frame(change, began);
    if (next && scene) this.session.pair!.setVertices(next);
    return result;
  }

  /// The positions in the next frame of a scene; of files, the reference turns.
  private async nextPositions(): Promise<[Float64Array, Float64Array] | null> {
    const { scene, pair } = this.session;
    if (scene) return scene.advance();
    pair!.view.nudge([0, 0, 0], 1.5);
    this.wanted = inFile(pair!.view.motion, pair!.subject);
    return null;
  }

  private showFrame({ distances, separation, milliseconds }: FrameResult): void {
    const { session } = this;
    const { view, subject } = session.pair!;
    subject.coarse.setDistances(distances, null, null);
    subject.show(subject.coarse);
    view.draw();
    showSeparation(session, separation);
    this.rate.add(milliseconds);
    showRate(this.rate);
    if (performance.now() - this.histogramAt < kHistogram) return;
    this.histogramAt = performance.now();
    session.area = areaOf(subject.coarse.layout);
    showMean(session, meanOf(subject.coarse.layout));
    this.display.drawHistogram();
  }

  /// Computes the fine map soon, unless something moves again.
  rest(): void {
    window.clearTimeout(this.timer);
    const { session } = this;
    const { version } = session;
    this.timer = window.setTimeout(() => {
      if (version === session.version && !this.pumping && !session.loading)
        this.showAtRest().catch((error) => session.fault(error));
    }, kRest);
  }

  async showAtRest(): Promise<void> {
    const { session } = this;
    const { version, engine, pair } = session;
    const isOn = () => version === session.version && pair === session.pair;
    const result = await session.inOrder(async () => {
      if (!isOn()) return null;
      const frame = await engine.frame(Promise.resolve());
      return isOn()
        ? { ...frame, ...(await engine.atRest(session.tolerance, session.units, () => {})) }
        : null;
    });
    if (!result || !isOn()) return;
    pair!.placeReference();
    showSeparation(session, result.separation);
    this.showFine(result);
    await this.baking.update().catch((error) => session.fault(error));
    document.documentElement.dataset.rest = String(session.version);
  }

  private showFine({ distances, atVertices, sites, milliseconds, report }: FineResult): void {
    const { session, display } = this;
    const { subject, fine, view } = session.pair!;
    const surface = fine ?? subject.coarse;
    if (fine && session.scene) fine.setVertices(session.bodies![0]);
    surface.setDistances(distances, atVertices, sites);
    subject.show(surface);
    session.area = areaOf(surface.layout);
    session.moving = false;
    showReport(session, report);
    showMean(session, report.distance?.mean as number);
    showTime(session.resolution, milliseconds);
    display.showForm();
    view.draw();
    showBusy(session);
    speak(session);
  }
}
