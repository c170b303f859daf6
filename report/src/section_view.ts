// The section in 3D: cut surfaces, profiles and gap.
import {
  AlwaysStencilFunc,
  BufferAttribute,
  BufferGeometry,
  Color,
  DoubleSide,
  EqualStencilFunc,
  Group,
  InvertStencilOp,
  KeepStencilOp,
  Mesh,
  ShaderMaterial,
  SRGBColorSpace,
  Vector3,
} from 'three';
import { LineMaterial } from 'three/addons/lines/LineMaterial.js';
import { LineSegments2 } from 'three/addons/lines/LineSegments2.js';
import { LineSegmentsGeometry } from 'three/addons/lines/LineSegmentsGeometry.js';
import { colorOf, Scale } from './color_scale';
import type { Vec } from './page_data';
import {
  fanOf,
  gapFactor,
  gapLines,
  Profile,
  profileOf,
  ProfilePoint,
  sampledProfile,
  Triangles,
} from './section';
import type { HalfSpace } from './subject';

const kLongest = 0.008; // pieces of a profile of one colour, in units of the scene
const kSpacing = 0.022; // of the lines of the gap
const kLongestGap = 0.3;
const kReferenceLine: Vec = [22, 26, 32];

/// What is cut, and how it is filled: a number of the stencil for each set of bodies that cover a pixel.
const kFills: [covers: number, color: Vec][] = [
  [1, [0.95, 0.68, 0.42]], // only the part
  [2, [0.5, 0.7, 0.93]], // only the reference
  [3, [0.6, 0.62, 0.65]],
];
const kPartAlone: Vec = [0.6, 0.62, 0.65]; // if the reference has no inside

const kVertexShader = `
  void main() { gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }
`;
const kFillShader = `
  precision highp float;
  uniform vec3 color;
  out vec4 outColor;
  void main() {
    float stripe = step(0.5, fract((gl_FragCoord.x + gl_FragCoord.y) / 9.0));
    outColor = vec4(color * (0.95 + 0.05 * stripe), 1.0);
  }
`;

export interface Cuttable extends Triangles {
  isClosed: boolean; ///< whether it has an inside that can be filled
}

export interface CutPart extends Cuttable {
  valueAt: (triangle: number, weights: Vec) => number; ///< the distance at a point of a triangle, NaN without one
  scaleAt: (triangle: number, scale: Scale) => Scale; ///< that of a triangle, which may have limits of its own
}

/// The fills of the bodies that cover a pixel by an odd number of triangles of their fans.
class Caps {
  readonly object = new Group();
  private readonly fans: Mesh[] = [];
  private readonly plane = new BufferGeometry();

  constructor(isClosed: boolean[]) {
    isClosed.forEach((closed, body) => {
      const fan = new Mesh(
        new BufferGeometry(),
        new ShaderMaterial({
          glslVersion: '300 es',
          vertexShader: kVertexShader,
          fragmentShader: 'precision highp float; out vec4 c; void main() { c = vec4(0.0); }',
          side: DoubleSide,
          colorWrite: false,
          depthWrite: false,
          depthTest: false,
          stencilWrite: true,
          stencilFunc: AlwaysStencilFunc,
          stencilWriteMask: 1 << body,
          stencilFail: KeepStencilOp,
          stencilZFail: InvertStencilOp,
          stencilZPass: InvertStencilOp,
        }),
      );
      fan.visible = closed;
      fan.renderOrder = 1;
      this.fans.push(fan);
    });
    for (const [covers, color] of kFills) {
      const fill = new Mesh(
        this.plane,
        new ShaderMaterial({
          glslVersion: '300 es',
          vertexShader: kVertexShader,
          fragmentShader: kFillShader,
          side: DoubleSide,
          uniforms: { color: { value: new Vector3(...(isClosed[1] ? color : kPartAlone)) } },
          stencilWrite: true,
          stencilFunc: EqualStencilFunc,
          stencilRef: covers,
          stencilFuncMask: 3,
          stencilWriteMask: 0,
        }),
      );
      fill.renderOrder = 2;
      this.object.add(fill);
    }
    this.object.add(...this.fans);
    for (const mesh of this.object.children) mesh.frustumCulled = false;
  }

  show(profiles: (Profile | null)[], { normal, offset }: HalfSpace): void {
    profiles.forEach((profile, body) => {
      this.fans[body].geometry.setAttribute(
        'position',
        new BufferAttribute(profile ? fanOf(profile) : new Float32Array(0), 3),
      );
    });
    // A square of the plane around all of the scene that is cut.
    const axis = normal.findIndex((x) => x !== 0);
    const corner = (u: number, v: number) => {
      const at: Vec = [0, 0, 0];
      [at[axis], at[(axis + 1) % 3], at[(axis + 2) % 3]] = [offset * normal[axis], u, v];
      return at;
    };
    const reach = Math.max(...profiles.flatMap((profile) => (profile ? [farthest(profile.ends)] : [0])));
    const square = [
      corner(-reach, -reach),
      corner(reach, -reach),
      corner(reach, reach),
      corner(-reach, reach),
    ];
    this.plane.setAttribute('position', new BufferAttribute(Float32Array.from(square.flat()), 3));
    this.plane.setIndex([0, 1, 2, 0, 2, 3]);
  }
}

function farthest(values: Float32Array): number {
  let most = 0;
  for (const x of values) most = Math.max(most, Math.abs(x));
  return most;
}

function lines(width: number, order: number): LineSegments2 {
  const mesh = new LineSegments2(
    new LineSegmentsGeometry(),
    new LineMaterial({ linewidth: width, vertexColors: true, depthWrite: false }),
  );
  mesh.frustumCulled = false;
  mesh.renderOrder = order;
  return mesh;
}

export class SectionView {
  readonly object = new Group();
  private readonly caps: Caps;
  private readonly profile = lines(5, 5);
  private readonly reference = lines(2, 6);
  private readonly gap = lines(1.6, 4);
  private points: ProfilePoint[] = [];
  private otherProfile: Profile = { ends: new Float32Array(0), triangle: new Uint32Array(0) };
  private cut: HalfSpace | null = null;
  private color: (point: ProfilePoint) => Vec = () => [0, 0, 0];
  private largest = 0; // distance of the scale

  /// `part` is null for clouds, `other` if the reference is not in the page; `size` of a unit of the scene.
  constructor(
    readonly part: CutPart | null,
    readonly other: Cuttable | null,
    private readonly size: number,
  ) {
    // The reference is filled where the part is not, which is known only of a part that has an inside.
    const filled = part?.isClosed ?? false;
    this.caps = new Caps([filled, filled && (other?.isClosed ?? false)]);
    this.object.add(this.caps.object, this.gap, this.profile, this.reference);
    this.object.visible = false;
  }

  show(cut: HalfSpace | null): void {
    this.cut = cut;
    this.object.visible = cut !== null;
    if (!cut) return;
    const profiles = [this.part, this.other].map((body) => (body ? profileOf(body, cut) : null));
    this.caps.show(profiles, cut);
    this.points =
      this.part && profiles[0] ? sampledProfile(this.part, profiles[0], kLongest, this.part.valueAt) : [];
    if (profiles[1]) this.otherProfile = profiles[1];
    const { ends } = this.otherProfile;
    setLines(
      this.reference,
      ends,
      Array.from(ends, (_, i) => kReferenceLine[i % 3]),
    );
    this.recolour();
  }

  setScale(scale: Scale): void {
    this.color = ({ distance, triangle }) => colorOf(this.part?.scaleAt(triangle, scale) ?? scale, distance);
    this.largest = Math.max(Math.abs(scale.lo), Math.abs(scale.hi));
    if (this.cut) this.recolour();
  }

  /// How much larger than it is the gap is drawn.
  get factor(): number {
    return gapFactor(this.largest / this.size, 2);
  }

  /// Before each picture: what is in the plane hides the rest for an eye in front of it, and is hidden behind it.
  prepare(eye: Vec): void {
    if (!this.cut) return;
    const inFront = this.cut.normal.reduce((sum, x, k) => sum + x * eye[k], 0) > this.cut.offset;
    for (const mesh of [this.profile, this.reference, this.gap]) mesh.material.depthTest = !inFront;
  }

  private recolour(): void {
    const draw = (mesh: LineSegments2, points: ProfilePoint[]) =>
      setLines(
        mesh,
        Float32Array.from(points.flatMap(({ at }) => at)),
        points.flatMap((point) => this.color(point)),
      );
    draw(this.profile, this.points);
    draw(this.gap, gapLines(this.points, this.otherProfile, kSpacing, this.factor, kLongestGap));
  }
}

/// Lines between pairs of points, with a colour for each point.
function setLines(mesh: LineSegments2, ends: Float32Array, colors: number[]): void {
  mesh.visible = ends.length > 0;
  if (ends.length === 0) return;
  const color = new Color();
  const linear = new Float32Array(colors.length);
  for (let i = 0; i < colors.length; i += 3)
    color
      .setRGB(colors[i] / 255, colors[i + 1] / 255, colors[i + 2] / 255, SRGBColorSpace)
      .toArray(linear, i);
  mesh.geometry.dispose();
  mesh.geometry = new LineSegmentsGeometry().setPositions(ends).setColors(linear);
}
