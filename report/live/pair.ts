// What is shown of a pair: the view, its surfaces, its section and its callouts.
import { Matrix4 } from 'three';
import { Callouts } from '../src/callouts';
import { byId } from '../src/dom';
import type { Vec } from '../src/page_data';
import { printPicture } from '../src/print';
import { SectionView } from '../src/section_view';
import { boxOf } from '../src/subject';
import { moved } from './placing';
import { Body } from './body';
import { inScene, Layout } from './layout';
import { ChangingSurface, LiveSubject } from './subject';
import { Handles, LiveView } from './view';

export const kUp = 'z';

export class Pair {
  readonly view: LiveView;
  readonly subject: LiveSubject;
  readonly section: SectionView;
  readonly callouts: Callouts;
  fine: ChangingSurface | null = null; // null: the coarse one is as fine
  private readonly reference: { position: Float32Array; triangle: Uint32Array; isClosed: boolean }; // where it is now
  private readonly ghost: Float32Array; // without the motion by the handles
  private readonly forgetPrinting: () => void;
  private readonly part: Body;

  /// Fills the element `view`. `onMove` is called after each motion of the reference by its handles.
  constructor(
    [part, { positions, indices }]: [Body, Body],
    coarse: Layout,
    private readonly isClosed: boolean,
    referenceIsClosed: boolean,
    valueText: (distance: number) => string,
    onMove: () => void,
  ) {
    this.part = part;
    this.subject = new LiveSubject(new ChangingSurface(coarse, isClosed), isClosed);
    this.ghost = inScene(positions, this.subject);
    this.reference = { position: this.ghost.slice(), triangle: indices, isClosed: referenceIsClosed };
    this.section = new SectionView(this.subject.cuttable, this.reference, this.subject.size);
    const ghost = {
      position: this.ghost,
      triangle: indices,
      covered: null,
      trianglesOfMesh: indices.length / 3,
      isBox: false,
    };
    this.view = new LiveView(
      byId('view'),
      this.subject,
      ghost,
      this.section,
      kUp,
      () => this.callouts?.update(),
      onMove,
    );
    this.callouts = new Callouts(this.view, valueText, '', this.subject.size, (at) => this.lookAt(at));
    this.forgetPrinting = printPicture(this.view);
    this.setHandles(
      (document.querySelector('input[name=handles]:checked') as HTMLInputElement).value as Handles,
    );
    this.lookAtAll();
  }

  /// Lays the fine surface over the coarse one, or takes it away.
  setFine(layout: Layout | null): void {
    const old = this.fine;
    this.fine = layout && new ChangingSurface(layout, this.isClosed);
    this.subject.show(this.subject.coarse);
    old?.dispose();
  }

  lookAtAll(): void {
    const kMost = 3; // times the part: of a larger reference, the part would be too small
    const { subject, view } = this;
    const other = boxOf(this.reference.position);
    const lo = subject.lo.map((x, k) => Math.min(x, other.lo[k])) as Vec;
    const hi = subject.hi.map((x, k) => Math.max(x, other.hi[k])) as Vec;
    const fits = Math.hypot(...lo.map((x, k) => hi[k] - x)) < 2 * kMost;
    view.setShown(fits ? lo : subject.lo, fits ? hi : subject.hi);
    view.fitAll();
  }

  lookAt(at: Vec): void {
    this.view.look({ point: at, normal: this.subject.normalNear(at) });
    byId('view').scrollIntoView({ block: 'nearest' });
  }

  setHandles(handles: Handles): void {
    this.view.setHandles(handles);
  }

  /// Moves the vertices of both bodies.
  setVertices([first, second]: [Float64Array, Float64Array]): void {
    this.subject.coarse.setVertices({ positions: first, indices: this.part.indices });
    inScene(second, this.subject, this.ghost);
    this.view.referenceMoved();
  }

  /// Where the reference is now, for sections.
  placeReference(): void {
    this.reference.position.set(moved(Float64Array.from(this.ghost), this.view.motion));
  }

  /// The reference is moved by a matrix in the units of the files.
  setMotion(motion: Matrix4): void {
    const { centre, size } = this.subject;
    const toFile = new Matrix4()
      .makeTranslation(...centre)
      .multiply(new Matrix4().makeScale(size, size, size));
    this.view.setMotion(toFile.clone().invert().multiply(motion).multiply(toFile));
  }

  dispose(): void {
    this.forgetPrinting();
    this.callouts.clear();
    this.view.dispose();
    this.subject.coarse.dispose();
    this.fine?.dispose();
  }
}
