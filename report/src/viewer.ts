// A canvas with a scene, and a camera that turns around it.
import { PerspectiveCamera, Scene, TOUCH, Vector3, WebGLRenderer } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { Pace } from './pace';
import type { Vec } from './page_data';

// Right, up and towards the viewer in the front view.
const kSides: Record<'y' | 'z', Record<string, Vec>> = {
  z: {
    front: [0, -1, 0],
    back: [0, 1, 0],
    left: [-1, 0, 0],
    right: [1, 0, 0],
    top: [0, -1e-4, 1],
    bottom: [0, -1e-4, -1],
    corner: [0.6, -1, 0.55],
  },
  y: {
    front: [0, 0, 1],
    back: [0, 0, -1],
    left: [-1, 0, 0],
    right: [1, 0, 0],
    top: [0, 1, 1e-4],
    bottom: [0, -1, 1e-4],
    corner: [0.6, 0.55, 1],
  },
};

export interface Camera {
  position: Vec;
  target: Vec;
}

/// The scene is about the origin, in units of half of its diagonal.
export class Viewer {
  readonly canvas: HTMLCanvasElement;
  readonly camera = new PerspectiveCamera(30, 1, 0.01, 100);
  readonly scene = new Scene();
  readonly firstPicture: Promise<void>; ///< is complete
  private readonly renderer: WebGLRenderer;
  protected readonly controls: OrbitControls;
  private readonly pace: Pace;
  private readonly resizes = new ResizeObserver(() => this.resize());
  private readonly finest = Math.min(2, window.devicePixelRatio); // pixel ratio
  private scheduled = false;
  private fitted = [0, 0]; // to this size of the container, in pixels
  private radius = 1; // of what is shown
  private shown: { lo: Vec; hi: Vec } | null = null; // its box; without one, all of the ball is framed

  /// `onChange` is called after every picture.
  constructor(
    container: HTMLElement,
    private readonly up: 'y' | 'z',
    private readonly onChange = () => {},
  ) {
    this.canvas = container.querySelector('canvas')!;
    // The picture is kept for printing.
    const context = this.canvas.getContext('webgl2', {
      antialias: true,
      stencil: true,
      alpha: true,
      preserveDrawingBuffer: true,
    });
    if (!context) throw new Error('this browser has no WebGL 2, or it is switched off');
    this.renderer = new WebGLRenderer({ canvas: this.canvas, context });
    this.renderer.setPixelRatio(this.finest);
    this.pace = new Pace(
      this.renderer.getContext() as WebGL2RenderingContext,
      () => this.draw(false),
      () => this.prepareCoarse(),
    );
    this.firstPicture = new Promise((resolve) => (this.pace.complete = () => !this.scheduled && resolve()));
    this.camera.up.set(0, up === 'y' ? 1 : 0, up === 'z' ? 1 : 0);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.zoomToCursor = true;
    this.scrollByOneFinger();
    this.controls.addEventListener('change', () => this.draw());
    this.resizes.observe(container);
    this.resize();
    this.look('corner');
  }

  /// Frees what the graphics card holds. The canvas cannot be used any more.
  dispose(): void {
    this.resizes.disconnect();
    this.controls.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }

  // One finger scrolls the page; two turn the view and zoom.
  private scrollByOneFinger(): void {
    this.controls.touches = { ONE: null, TWO: TOUCH.DOLLY_ROTATE };
    this.canvas.style.touchAction = 'pan-y';
    for (const type of ['touchstart', 'touchmove'] as const)
      this.canvas.addEventListener(
        type,
        (event) => event.touches.length > 1 && event.cancelable && event.preventDefault(),
        { passive: false },
      );
  }

  /// Fits the picture to its place, where that has another size: the canvas is empty until the next picture.
  resize(): void {
    const { clientWidth, clientHeight } = this.canvas.parentElement!;
    const isSame = clientWidth === this.fitted[0] && clientHeight === this.fitted[1];
    if (clientWidth === 0 || clientHeight === 0 || isSame) return;
    this.fitted = [clientWidth, clientHeight];
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.setAspect();
    this.draw();
  }

  /// Fits the camera to the canvas, or to one of as many pictures as are beside each other in it.
  protected setAspect(pictures = 1): void {
    this.camera.aspect = this.fitted[0] / pictures / Math.max(1, this.fitted[1]);
    this.camera.updateProjectionMatrix();
  }

  /// Draws a picture soon, one for any number of calls: where pictures take long a coarse one, which is fine again when
  /// nothing `changes` for a while.
  draw(changes = true): void {
    if (changes) this.pace.change();
    if (this.scheduled) return;
    this.scheduled = true;
    const frame = () => {
      if (this.pace.busy) {
        requestAnimationFrame(frame);
        return;
      }
      this.resize(); // here, or the first picture would be drawn again: the page has grown around it
      this.drawNow(this.pace.moving);
      this.pace.drawn();
    };
    requestAnimationFrame(frame);
  }

  /// Whether the picture is fine, and of the last change.
  get atRest(): boolean {
    return !this.scheduled && !this.pace.moving && !this.pace.busy;
  }

  /// Draws less of what is in the scene, or all of it.
  protected setCoarse(_coarse: boolean): void {}

  // Makes what coarse pictures need, so that the first one of a motion does not wait for it.
  private prepareCoarse(): void {
    this.setCoarse(true);
    this.setCoarse(this.pace.moving);
  }

  drawNow(coarse = false): void {
    this.scheduled = false;
    const ratio = coarse ? this.finest * this.pace.ratio : this.finest;
    if (ratio !== this.pixelRatio) this.renderer.setPixelRatio(ratio);
    this.canvas.parentElement!.classList.toggle('moving', coarse);
    this.setCoarse(coarse);
    const away = this.camera.position.length();
    const toTarget = this.camera.position.distanceTo(this.controls.target);
    this.camera.near = Math.max(1e-4, Math.min(Math.max((away - 4) / 2, away / 1000), toTarget / 10));
    this.camera.far = Math.max(away, toTarget) + 8 * this.radius;
    this.camera.updateProjectionMatrix();
    this.paint(this.renderer);
    this.onChange();
  }

  protected paint(renderer: WebGLRenderer): void {
    renderer.render(this.scene, this.camera);
  }

  get pixelRatio(): number {
    return this.renderer.getPixelRatio();
  }

  /// Looks at all from a side, or from where a normal points to; or at a point of it from outside.
  look(from: string | { point?: Vec; normal: Vec }): void {
    let direction: Vector3;
    let away = this.camera.position.distanceTo(this.controls.target);
    if (typeof from === 'string') {
      const sides = kSides[this.up];
      direction = new Vector3(...(sides[from] ?? sides.corner)).normalize();
    } else {
      direction = new Vector3(...from.normal).normalize();
      // Not along the vertical axis, where the view could turn to any side.
      direction.addScaledVector(new Vector3(0.3, 0.25, 0.35), 0.6).normalize();
    }
    if (typeof from !== 'string' && from.point) {
      this.controls.target.set(...from.point);
      away = Math.min(away, 2.6);
    } else {
      const { lo, hi } = this.shown ?? { lo: [0, 0, 0], hi: [0, 0, 0] };
      this.controls.target.set(...(lo.map((x, k) => (x + hi[k]) / 2) as Vec));
      away = this.shown ? this.toFitBox(direction) : this.toFit(1);
    }
    this.camera.position.copy(this.controls.target).addScaledVector(direction, away);
    this.controls.update();
    this.draw();
  }

  /// The box that look() shows all of.
  setShown(lo: Vec, hi: Vec): void {
    this.shown = { lo, hi };
  }

  /// How far away all corners of the box fit into the picture, seen from a direction; beside the legend, on either side.
  private toFitBox(direction: Vector3): number {
    const kFree = 0.78; // of the width
    const right = new Vector3().crossVectors(this.camera.up, direction).normalize();
    const up = new Vector3().crossVectors(direction, right);
    const tall = Math.tan((this.camera.fov * Math.PI) / 360);
    const wide = tall * this.camera.aspect * kFree;
    const { lo, hi } = this.shown!;
    let away = 0;
    for (let corner = 0; corner < 8; ++corner) {
      const at = new Vector3(...([0, 1, 2].map((k) => (corner & (1 << k) ? hi[k] : lo[k])) as Vec)).sub(
        this.controls.target,
      );
      away = Math.max(
        away,
        at.dot(direction) + 1.06 * Math.max(Math.abs(at.dot(right)) / wide, Math.abs(at.dot(up)) / tall),
      );
    }
    return Math.max(away, 1e-3);
  }

  /// Looks at all of a ball, from the same direction.
  frame(centre: Vec, radius: number): void {
    this.radius = Math.max(1, radius);
    const direction = this.camera.position.clone().sub(this.controls.target).normalize();
    this.controls.target.set(...centre);
    this.camera.position.copy(this.controls.target).addScaledVector(direction, this.toFit(radius));
    this.controls.update();
    this.draw();
  }

  /// How far away a ball fits into the picture.
  protected toFit(radius: number): number {
    const half = Math.tan((this.camera.fov * Math.PI) / 360) * Math.min(1, this.camera.aspect);
    return (1.02 * radius) / Math.sin(Math.atan(half));
  }

  /// Where the camera is and what it looks at.
  get pose(): Camera {
    return { position: this.camera.position.toArray() as Vec, target: this.controls.target.toArray() as Vec };
  }
  set pose({ position, target }: Camera) {
    this.camera.position.set(...position);
    this.controls.target.set(...target);
    this.controls.update();
    this.draw();
  }

  /// Turns the view by angles in degrees, around the vertical axis and up.
  turn(right: number, up: number): void {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const side = new Vector3().crossVectors(this.camera.up, offset).normalize();
    const angle = offset.angleTo(this.camera.up);
    const lift = Math.min(Math.max(angle - (up * Math.PI) / 180, 0.02), Math.PI - 0.02) - angle;
    offset.applyAxisAngle(side, lift).applyAxisAngle(this.camera.up, (right * Math.PI) / 180);
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
    this.draw();
  }

  zoom(factor: number): void {
    const offset = this.camera.position.clone().sub(this.controls.target).multiplyScalar(factor);
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
    this.draw();
  }

  /// Where a point of the scene is in the canvas, in CSS pixels from its upper left corner.
  place(point: Vec): { x: number; y: number; behind: boolean } {
    const at = new Vector3(...point).project(this.camera);
    const { clientWidth, clientHeight } = this.canvas;
    return { x: ((at.x + 1) / 2) * clientWidth, y: ((1 - at.y) / 2) * clientHeight, behind: at.z > 1 };
  }

  /// The direction from the camera through a place of the canvas, of length 1.
  through(x: number, y: number): Vec {
    const { clientWidth, clientHeight } = this.canvas;
    this.camera.updateMatrixWorld();
    return new Vector3((2 * x) / clientWidth - 1, 1 - (2 * y) / clientHeight, 0.5)
      .unproject(this.camera)
      .sub(this.camera.position)
      .normalize()
      .toArray() as Vec;
  }
}
