// The part in 3D, and the reference with handles by which it is moved.
import { Matrix4, Object3D, Vector3 } from 'three';
import { TransformControls } from 'three/addons/controls/TransformControls.js';
import type { Ghost, Vec } from '../src/page_data';
import type { SectionView } from '../src/section_view';
import { boxOf, Found, Subject } from '../src/subject';
import { View } from '../src/view';

export type Handles = 'none' | 'move' | 'turn';

export class LiveView extends View {
  private readonly handles: TransformControls;
  private readonly pivot = new Object3D(); // in the middle of the reference
  private readonly toPivot = new Matrix4(); // from where the reference was read
  private readonly dark = window.matchMedia('screen and (prefers-color-scheme: dark)');
  private readonly ghostIsAround: boolean; // the part is inside of the reference
  private fittedPose = ''; // where the camera was when all was fitted into the picture

  /// `onMove` is called after each motion of the reference by its handles.
  constructor(
    container: HTMLElement,
    subject: Subject,
    reference: Ghost,
    section: SectionView,
    up: 'y' | 'z',
    onChange: () => void,
    onMove: () => void,
  ) {
    super(container, subject, reference, section, up, onChange);
    this.handles = new TransformControls(this.camera, this.canvas);
    this.handles.size = window.matchMedia('(pointer: coarse)').matches ? 1.5 : 1.1;
    this.scene.add(this.handles.getHelper(), this.pivot);
    this.ghost!.matrixAutoUpdate = false;
    this.ghostIsAround = encloses(boxOf(reference.position), subject);
    this.showGhostColor();
    this.dark.addEventListener('change', this.showGhostColor);
    this.centrePivot();
    this.setHandles('none');
    this.handles.addEventListener('change', () => this.draw());
    this.handles.addEventListener('dragging-changed', ({ value }) => (this.controls.enabled = !value));
    this.handles.addEventListener('objectChange', () => {
      this.showPose();
      onMove();
    });
  }

  /// A body that moves, not only what the part is compared with: darker than a light background, lighter than a dark one.
  private readonly showGhostColor = (): void => {
    const { opacity, color } = this.ghostMaterial.uniforms;
    const isDark = this.dark.matches;
    opacity.value = this.ghostIsAround ? 0.08 : isDark ? 0.3 : 0.36;
    color.value = isDark ? new Vector3(0.62, 0.67, 0.74) : new Vector3(0.3, 0.36, 0.46);
    this.draw();
  };

  /// Looks at all. A picture of another shape shows all again, unless the user has turned it.
  fitAll(): void {
    this.look('corner');
    this.fittedPose = JSON.stringify(this.pose);
  }

  override resize(): void {
    const { aspect } = this.camera;
    super.resize();
    if (this.camera.aspect !== aspect && JSON.stringify(this.pose) === this.fittedPose) this.fitAll();
  }

  /// Puts the pivot in the middle of the reference, with no motion.
  private centrePivot(): void {
    const { lo, hi } = boxOf(this.referencePosition);
    this.pivot.position.set(...(lo.map((x, k) => (x + hi[k]) / 2) as Vec));
    this.pivot.rotation.set(0, 0, 0);
    this.pivot.updateMatrix();
    this.toPivot.copy(this.pivot.matrix).invert();
    this.showPose();
  }

  private get referencePosition(): Float32Array {
    return this.ghost!.geometry.getAttribute('position').array as Float32Array;
  }

  private showPose(): void {
    this.pivot.updateMatrix();
    this.ghost!.matrix.multiplyMatrices(this.pivot.matrix, this.toPivot);
    this.ghost!.matrixWorldNeedsUpdate = true;
    this.draw();
  }

  /// The motion of the reference, in the space of the scene.
  get motion(): Matrix4 {
    return this.ghost!.matrix;
  }

  setMotion(motion: Matrix4): void {
    this.pivot.matrix.multiplyMatrices(motion, this.toPivot.clone().invert());
    this.pivot.matrix.decompose(this.pivot.position, this.pivot.quaternion, this.pivot.scale);
    this.showPose();
  }

  /// Moves the reference along the axes, in units of the scene, and turns it about the vertical axis by degrees.
  nudge(shift: Vec, turn = 0): void {
    this.pivot.position.add(new Vector3(...shift));
    if (turn !== 0) this.pivot.rotateOnWorldAxis(this.camera.up, (turn * Math.PI) / 180);
    this.showPose();
  }

  resetMotion(): void {
    this.centrePivot();
  }

  setHandles(which: Handles): void {
    this.handles.enabled = which !== 'none';
    if (which === 'none') {
      this.handles.detach();
      this.canvas.style.touchAction = 'pan-y';
    } else {
      this.handles.setMode(which === 'move' ? 'translate' : 'rotate');
      this.handles.attach(this.pivot);
      this.canvas.style.touchAction = 'none';
    }
    this.draw();
  }

  /// Where the handle of an axis is in the canvas; for tests.
  handleAt(axis: 'X' | 'Y' | 'Z'): { x: number; y: number } {
    const kAlong = 0.3; // of the length of a handle, by three's sizes
    const length =
      (kAlong *
        this.camera.position.distanceTo(this.pivot.position) *
        Math.tan((this.camera.fov * Math.PI) / 360) *
        1.9 *
        this.handles.size) /
      4;
    const at = this.pivot.position.clone();
    at.setComponent('XYZ'.indexOf(axis), at.getComponent('XYZ'.indexOf(axis)) + length);
    return this.place(at.toArray() as Vec);
  }

  /// The one under the pointer, by which a drag would move the reference; for tests.
  get handle(): string | null {
    return this.handles.axis;
  }

  override find(x: number, y: number): Found | null {
    return this.handles.dragging || this.handles.axis !== null ? null : super.find(x, y);
  }

  override dispose(): void {
    this.dark.removeEventListener('change', this.showGhostColor);
    this.handles.dispose();
    super.dispose();
  }
}

/// Whether a box has another one inside.
function encloses(outer: { lo: Vec; hi: Vec }, inner: { lo: Vec; hi: Vec }): boolean {
  return outer.lo.every((x, k) => x < inner.lo[k] && outer.hi[k] > inner.hi[k]);
}
