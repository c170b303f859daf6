// What is compared: pairs are loaded into the worker, of which the last choice wins; what was shown comes back if that fails.
import { Matrix4 } from 'three';
import { byId } from '../src/dom';
import { explore } from '../src/explore';
import type { Baking } from './baking';
import type { Display } from './display';
import { kCoarse } from './engine';
import { inFile } from './placing';
import { readBody } from './files';
import { Body, movedBody, movesOf } from './body';
import { listenToKeys } from './keys';
import { frameOf, Layout, layoutOf } from './layout';
import type { Motion } from './motion';
import { Pair } from './pair';
import { showBusy, showChoices, showFactor, timesText } from './panel';
import { say, sayFault } from './status';
import { kScenes } from './scenes';
import type { Choice, Session } from './session';

export class Loading {
  private current: AbortController | null = null; // of what is being loaded
  private running: Promise<unknown> = Promise.resolve();
  private factor: number | null = null; // by which the part fits, if that is in another unit
  private intact = false; // the worker has what is shown
  private restarts = 0; // of the worker then
  private wanted: number; // resolution
  private readonly emptyView = byId('view').cloneNode(true) as HTMLElement;

  constructor(
    private readonly session: Session,
    private readonly motion: Motion,
    private readonly display: Display,
    private readonly baking: Baking,
  ) {
    this.wanted = session.resolution;
    session.fault = (error) => this.recover(error);
  }

  openScene(name: string): Promise<void> {
    return this.run(async (load) => {
      const scene = await this.again(load, () => kScenes[name].make(this.session.worker));
      await this.put({ name, bodies: scene.bodies, scene, units: scene.units }, load);
    });
  }

  /// Two files, or one in place of one of the bodies.
  async openFiles(files: File[], which: 0 | 1 | null): Promise<void> {
    if (files.length > 2 || (files.length === 2 && which !== null))
      return say('Choose one file for each body.', 'fault');
    if (files.length < 2 && !this.session.bodies) await this.running; // the first pair
    return this.run(async (load) => {
      const read: Body[] = [];
      const notes: string[] = [];
      for (const file of files) {
        say(`Reading ${file.name}…`);
        const { body, note } = await this.again(load, () => readBody(this.session.worker, file));
        read.push(body);
        if (note) notes.push(note);
      }
      const [part, reference] = this.session.bodies ?? [];
      const bodies = (read.length === 2 ? read : which === 0 ? [read[0], reference] : [part, read[0]]) as [
        Body,
        Body,
      ];
      await this.put(filesOf(bodies, ''), load);
      const unit = await this.checkUnit(load, bodies);
      const said = notes.map((note) => `${note}. Its first frame is measured. `);
      return (said.join('') + unit).trim();
    });
  }

  /// Says by which factor the part would fit, if it is in another unit.
  private async checkUnit(load: AbortController, [part, reference]: [Body, Body]): Promise<string> {
    const factor = await this.session.inOrder(() => this.session.engine.otherUnit());
    load.signal.throwIfAborted();
    this.factor = factor;
    if (factor === null) return '';
    return `${part.name} ${timesText(factor)} has the size of ${reference.name}: is it in another unit?`;
  }

  /// What was the reference, where it is now, becomes the part.
  async swap(): Promise<void> {
    const { bodies, pair } = this.session;
    if (!bodies || !pair) return;
    await this.replace([movedBody(bodies[1], inFile(pair.view.motion, pair.subject)), bodies[0]]);
  }

  /// Converts the part to the unit of the reference.
  async convert(): Promise<void> {
    const [part, reference] = this.session.bodies!;
    const factor = this.factor!;
    await this.replace([movedBody(part, new Matrix4().makeScale(factor, factor, factor)), reference]);
  }

  private replace(bodies: [Body, Body]): Promise<void> {
    const { units } = this.session;
    return this.run(async (load) => {
      await this.put(filesOf(bodies, units), load);
      return this.checkUnit(load, bodies);
    });
  }

  /// Sets the size of the map at rest, after a pair that is being loaded.
  async setResolution(resolution: number): Promise<void> {
    this.wanted = resolution;
    while (this.current) await this.running;
    const { session } = this;
    if (this.wanted !== resolution || session.resolution === resolution || !session.bodies) return;
    await this.run(async (load) => {
      const fault = await session.inOrder(async () => {
        load.signal.throwIfAborted();
        return this.refine(load);
      });
      await this.rest(fault);
    });
  }

  cancel(): void {
    this.intact = false;
    this.current?.abort();
  }

  // ---- one load ----

  /// `work` may return a note, which is said at its end.
  private run(work: (load: AbortController) => Promise<string | void>): Promise<void> {
    const running = this.runNow(work);
    this.running = running.catch(() => {});
    return running;
  }

  private begin(): AbortController {
    this.current = new AbortController();
    this.motion.stop();
    ++this.session.version;
    this.session.loading = true;
    this.factor = null;
    showBusy(this.session);
    return this.current;
  }

  private async runNow(work: (load: AbortController) => Promise<string | void>): Promise<void> {
    if (this.current) this.cancel();
    const load = this.begin();
    let [note, fault] = await work(load).then(
      (said): [string, null] => [said || '', null],
      (error): [string, ReturnType<typeof faultOf>] => ['', faultOf(error)],
    );
    if (this.current !== load) return; // a later choice has taken its place
    const cancelled = load.signal.aborted;
    if (cancelled) fault = null;
    if (this.session.choice && !this.isIntact) {
      const restoring = this.begin();
      const worse = await this.restore(restoring).then(() => null, faultOf);
      if (this.current !== restoring) return;
      if (worse && !restoring.signal.aborted) fault = worse;
    }
    this.end();
    if (fault) sayFault(fault);
    else say(cancelled ? 'Cancelled.' : note);
    showFactor(this.factor);
  }

  private end(): void {
    const { session } = this;
    this.current = null;
    session.loading = false;
    showChoices(session, this.wanted); // which may still wait for this load
    showBusy(session);
    this.motion.resume();
  }

  private get isIntact(): boolean {
    return this.intact && this.restarts === this.session.worker.restarts;
  }

  /// Calls once more what failed only as the worker was ended for an earlier call.
  private async again<T>(load: AbortController, call: () => Promise<T>): Promise<T> {
    load.signal.throwIfAborted();
    const result = await call().catch((error) => {
      load.signal.throwIfAborted();
      if ((error as { kind?: string }).kind !== 'ended') throw error;
      return call();
    });
    load.signal.throwIfAborted();
    return result;
  }

  /// Loads a pair and shows it with its fine map; `motion` of the reference before.
  private async put(choice: Choice, load: AbortController, motion = new Matrix4()): Promise<void> {
    const { session } = this;
    const { engine } = session;
    const fault = await session.inOrder(async () => {
      const atlas = await this.again(load, () => engine.load(choice.bodies, progress, load.signal));
      [this.intact, this.restarts] = [true, session.worker.restarts];
      this.show(choice, layoutOf(choice.bodies[0], atlas, frameOf(choice.bodies[0])), motion);
      await engine.place(motion);
      return this.refine(load);
    });
    await this.rest(fault);
  }

  /// Lays out the fine atlas. Returns why there is none.
  private async refine(load: AbortController): Promise<Error | null> {
    const { session, wanted } = this;
    const [part] = session.bodies!;
    const pair = session.pair!;
    try {
      const atlas = await session.engine.refine(wanted, progress, load.signal);
      load.signal.throwIfAborted();
      pair.setFine(atlas && layoutOf(part, atlas, pair.subject));
      session.resolution = wanted;
      return null;
    } catch (error) {
      load.signal.throwIfAborted();
      pair.setFine(null);
      session.resolution = this.wanted = kCoarse;
      if (!this.isIntact) throw error;
      return faultOf(error);
    }
  }

  /// Shows the pair at rest, then fails if its map is not as fine as was wanted.
  private async rest(fault: Error | null): Promise<void> {
    await this.motion.showAtRest();
    if (fault) throw fault;
  }

  /// What is shown is loaded again, as the worker has lost it.
  private async restore(load: AbortController): Promise<void> {
    const { choice, pair, resolution } = this.session;
    this.wanted = resolution;
    const { view, subject } = pair!;
    const { pose } = view;
    await this.put(choice!, load, inFile(view.motion, subject));
    this.session.pair!.view.pose = pose;
  }

  /// Says an error of what was computed; if the worker was lost by it, loads what is shown again.
  private recover(error: unknown): void {
    if (this.current) return; // that says it
    if (!this.session.choice || this.isIntact) sayFault(error);
    else void this.run(() => Promise.reject(error));
  }

  /// A new view, of a pair whose distances follow.
  private show(choice: Choice, layout: Layout, motion: Matrix4): void {
    const { session, motion: moves, display } = this;
    const { engine } = session;
    const isOther = choice !== session.choice;
    session.pair?.dispose();
    byId('view').replaceWith(this.emptyView.cloneNode(true));
    byId('message').remove();
    session.choice = choice;
    session.resolution = kCoarse;
    session.units = isOther ? choice.units : session.units;
    moves.forget();
    const pair = new Pair(
      choice.bodies,
      layout,
      engine.isClosed,
      engine.referenceIsClosed,
      (d) => session.valueText(d),
      () => moves.move(),
    );
    session.pair = pair;
    pair.setMotion(motion);
    this.baking.renew();
    display.renew(isOther);
    listenToKeys(pair.view, moves);
    const words = {
      quantity: 'distance',
      get unit() {
        return session.unitText;
      },
      valueText: (d: number) => session.valueText(d),
    };
    explore(pair.view, pair.subject, pair.callouts, words, () => pair.lookAtAll());
    showChoices(session, this.wanted);
  }
}

const filesOf = (bodies: [Body, Body], units: string): Choice => ({
  name: 'files',
  bodies,
  scene: movesOf(bodies),
  units,
});

const faultOf = (error: unknown): Error => (error instanceof Error ? error : new Error(String(error)));

const progress = (step: string, fraction: number) =>
  say(`${step}… ${Math.round(100 * fraction)} %`, 'progress');
