// The part in 3D, with the reference as a ghost.
import { BufferAttribute, BufferGeometry, DoubleSide, Mesh, ShaderMaterial, Vector3 } from 'three';
import { CoarseWhileMoving } from './coarse_copy';
import type { Scale } from './color_scale';
import { coverageOf, kReferenceVertexShader } from './coverage';
import type { Ghost, Vec } from './page_data';
import type { SectionView } from './section_view';
import type { Found, HalfSpace, Subject } from './subject';
import { type Camera, Viewer } from './viewer';

const kGhostShader = `
  precision highp float;
  uniform vec4 cut;
  uniform vec3 color;
  uniform float opacity; // where it faces the viewer
  in vec3 vPoint, vView;
  out vec4 outColor;
  void main() {
    if (dot(cut.xyz, vPoint) > cut.w) discard;
    vec3 n = normalize(cross(dFdx(vView), dFdy(vView)));
    float rim = 1.0 - abs(dot(n, normalize(vView)));
    outColor = vec4(color, opacity + 0.45 * rim * rim);
  }
`;

const dot = (a: Vec, b: Vec) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const kCoarseGhost = 4000; // triangles, while something moves

const kNoCut: HalfSpace = { normal: [0, 0, 0], offset: 1 };

export class View extends Viewer {
  protected readonly ghostMaterial: ShaderMaterial;
  protected readonly ghost: Mesh | null = null;
  private readonly coverage: ReturnType<typeof coverageOf> = null;
  private readonly coarse: CoarseWhileMoving[] = []; // the meshes of the reference
  private before: Camera | null = null; // the view of the part, while the reference is shown
  private cut: HalfSpace | null = null;

  constructor(
    container: HTMLElement,
    private readonly subject: Subject,
    ghost: Ghost | null,
    private readonly section: SectionView,
    up: 'y' | 'z',
    onChange: () => void,
  ) {
    super(container, up, onChange);
    this.scene.add(subject.object, section.object);
    this.setShown(subject.lo, subject.hi);
    this.look('corner');
    this.ghostMaterial = new ShaderMaterial({
      glslVersion: '300 es',
      vertexShader: kReferenceVertexShader,
      fragmentShader: kGhostShader,
      side: DoubleSide,
      transparent: true,
      depthWrite: false,
      polygonOffset: true,
      polygonOffsetFactor: 1,
      polygonOffsetUnits: 1,
      uniforms: {
        cut: { value: [0, 0, 0, 1] },
        color: { value: new Vector3(0.45, 0.5, 0.58) },
        opacity: { value: 0.1 },
      },
    });
    if (!ghost) return;
    const shape = new BufferGeometry();
    shape.setAttribute('position', new BufferAttribute(ghost.position, 3));
    shape.setIndex(new BufferAttribute(ghost.triangle, 1));
    this.ghost = new Mesh(shape, this.ghostMaterial);
    this.ghost.frustumCulled = false;
    this.ghost.visible = false;
    this.scene.add(this.ghost);
    this.coverage = coverageOf(ghost);
    if (this.coverage) this.scene.add(this.coverage.object);
    for (const mesh of [this.ghost, ...((this.coverage?.object.children ?? []) as Mesh[])])
      this.coarse.push(new CoarseWhileMoving(mesh, kCoarseGhost));
  }

  protected override setCoarse(coarse: boolean): void {
    this.subject.setCoarse(coarse);
    for (const mesh of this.coarse) mesh.show(coarse);
    this.subject.prepare(this);
    this.section?.prepare(this.camera.position.toArray() as Vec);
  }

  setScale(scale: Scale): void {
    this.subject.setScale(scale);
    this.section.setScale(scale);
    this.draw();
  }

  setCut(cut: HalfSpace | null): void {
    this.cut = cut;
    const { normal, offset } = cut ?? kNoCut;
    this.subject.uniforms.cut.value = this.ghostMaterial.uniforms.cut.value = [...normal, offset];
    this.coverage?.setCut([...normal, offset]);
    this.section.show(cut);
    this.draw();
  }

  /// Shows all of the part from where a point of it is seen, and nothing hides it.
  lookFrom(point: Vec): void {
    const normal = this.subject.normalNear(point);
    const from: Parameters<View['look']>[0][] = [
      { normal },
      'corner',
      'front',
      'right',
      'back',
      'left',
      'top',
      'bottom',
    ];
    for (const side of from) {
      this.look(side);
      if (!this.isHidden(point)) return;
    }
    this.look({ normal });
  }

  /// The vertices of the reference have moved.
  referenceMoved(): void {
    if (!this.ghost) return;
    this.ghost.geometry.getAttribute('position').needsUpdate = true;
    for (const mesh of this.coarse) mesh.forget();
    this.draw();
  }

  setGhost(visible: boolean): void {
    if (this.ghost) this.ghost.visible = visible;
    this.draw();
  }

  /// Shows where the reference was measured, in place of the part.
  setCoverage(visible: boolean): void {
    if (!this.coverage || this.coverage.object.visible === visible) return;
    this.coverage.object.visible = visible;
    this.subject.object.visible = !visible;
    if (visible) {
      this.before = this.pose;
      this.frame(this.coverage.centre, this.coverage.radius);
    } else if (this.before) {
      this.pose = this.before;
    }
    this.draw();
  }

  /// What is seen at a place of the canvas, in CSS pixels from its upper left corner.
  find(x: number, y: number): Found | null {
    const found = this.subject.object.visible ? this.subject.find(this, x, y, this.cut) : null;
    return found && !this.isInside(x, y, found) ? found : null;
  }

  /// Whether a point is on the side of the plane that is not shown.
  isCutAway(point: Vec): boolean {
    const kOnPlane = 1e-4;
    return this.cut !== null && dot(this.cut.normal, point) > this.cut.offset + kOnPlane;
  }

  /// Whether the inside of the part is what a ray meets: the cut surface is in front of it.
  private isInside(x: number, y: number, { normal }: Found): boolean {
    return this.cut !== null && this.subject.isClosed && dot(this.through(x, y), normal) > 0;
  }

  isHidden(point: Vec): boolean {
    return this.subject.isHidden(this, point, this.cut);
  }
}
