// The bodies of a sequence in 3D, one frame at a time.
import {
  BufferAttribute,
  BufferGeometry,
  DoubleSide,
  DynamicDrawUsage,
  Mesh,
  ShaderMaterial,
  Vector3,
} from 'three';
import { kColorShader, Scale } from './color_scale';
import { colorUniforms, setScale } from './color_uniforms';
import type { Vec } from './page_data';
import { firstHit } from './pick';
import { distancesOf, placeFrame, PlayerData } from './player_data';
import type { Worst } from './player_worst';
import { kNoValue } from './value_texture';
import { Viewer } from './viewer';

const kVertexShader = `
  in float value;
  out vec3 vNormal, vView;
  out float vValue;
  void main() {
    vNormal = normalMatrix * normal;
    vValue = value;
    vec4 view = modelViewMatrix * vec4(position, 1.0);
    vView = view.xyz;
    gl_Position = projectionMatrix * view;
  }
`;

const kShader = `
  precision highp float;
  uniform bool coloured;
  uniform float alpha;
  uniform vec3 plain;
  in vec3 vNormal, vView;
  in float vValue;
  out vec4 outColor;
  ${kColorShader}

  void main() {
    vec3 n = normalize(dot(vNormal, vNormal) > 0.0 ? vNormal : cross(dFdx(vView), dFdy(vView)));
    float light = min(1.0, 0.62 + 0.38 * abs(n.z) + 0.08 * n.y);
    vec3 color = !coloured ? plain : vValue > 1e38 ? noValue : colorOf(vValue);
    float rim = 1.0 - abs(dot(n, normalize(vView)));
    outColor = vec4(color * light, alpha < 1.0 ? alpha * (0.35 + rim) : 1.0);
  }
`;

interface Drawn {
  mesh: Mesh;
  position: BufferAttribute;
  value: BufferAttribute;
}

export class PlayerView extends Viewer {
  private readonly bodies: Drawn[];
  private readonly middle: Vec;
  private readonly size: number;

  constructor(
    container: HTMLElement,
    private readonly data: PlayerData,
    onChange: () => void,
  ) {
    super(container, data.page.up, onChange);
    const box = extent(data, null);
    this.middle = box.lo.map((x, k) => (x + box.hi[k]) / 2) as Vec;
    this.size = diagonal(box) / 2 || 1;
    this.bodies = data.bodies.map((_, which) => this.makeBody(which));
    this.lookAtAll();
  }

  /// Shows the places of the bodies in all frames.
  lookAtAll(): void {
    this.frameBox(extent(this.data, null));
    this.look('corner');
  }

  private frameBox({ lo, hi }: Bounds): void {
    const inScene = (corner: Vec) => corner.map((x, k) => (x - this.middle[k]) / this.size) as Vec;
    this.setShown(inScene(lo), inScene(hi));
  }

  private makeBody(which: number): Drawn {
    const { vertices, triangles, distances } = this.data.bodies[which];
    const material = new ShaderMaterial({
      glslVersion: '300 es',
      vertexShader: kVertexShader,
      fragmentShader: kShader,
      side: DoubleSide,
      uniforms: {
        coloured: { value: distances !== null },
        alpha: { value: 1 },
        plain: { value: new Vector3(0.72, 0.74, 0.77) },
        ...colorUniforms(),
      },
    });
    const position = new BufferAttribute(new Float32Array(3 * vertices), 3).setUsage(DynamicDrawUsage);
    const value = new BufferAttribute(new Float32Array(vertices), 1).setUsage(DynamicDrawUsage);
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', position);
    geometry.setAttribute('value', value);
    geometry.setIndex(new BufferAttribute(triangles, 1));
    const mesh = new Mesh(geometry, material);
    mesh.frustumCulled = false;
    this.scene.add(mesh);
    return { mesh, position, value };
  }

  /// Shows a frame of the page.
  show(frame: number): void {
    this.bodies.forEach(({ mesh, position, value }, which) => {
      placeFrame(this.data, which, frame, this.middle, this.size, position.array as Float32Array);
      position.needsUpdate = true;
      mesh.geometry.computeVertexNormals();
      const values = value.array as Float32Array;
      distancesOf(this.data, which, frame, values);
      for (let i = 0; i < values.length; ++i) if (Number.isNaN(values[i])) values[i] = kNoValue;
      value.needsUpdate = true;
    });
    this.draw();
  }

  /// Where a vertex is in the frame that is shown.
  at({ body, vertex }: Worst): Vec {
    return Array.from(
      (this.bodies[body].position.array as Float32Array).subarray(3 * vertex, 3 * vertex + 3),
    ) as Vec;
  }

  /// Shows the frame of the worst place, which is the one that is shown, from where this is seen. Returns whether there is
  /// such a side.
  lookFrom(worst: Worst): boolean {
    this.frameBox(extent(this.data, worst.frame));
    const at = this.at(worst);
    const normals = this.bodies[worst.body].mesh.geometry.getAttribute('normal').array;
    const normal = Array.from(normals.subarray(3 * worst.vertex, 3 * worst.vertex + 3)) as Vec;
    const from: Parameters<Viewer['look']>[0][] = [
      'corner',
      { normal },
      'front',
      'right',
      'back',
      'left',
      'top',
      'bottom',
    ];
    const free = from.find((side) => {
      this.look(side);
      return !this.isHidden(at);
    });
    if (free === undefined) this.look('corner');
    return free !== undefined;
  }

  // Whether a body that is drawn solid is in front of a point.
  private isHidden(at: Vec): boolean {
    const from = this.camera.position;
    const to = new Vector3(...at).sub(from);
    const away = to.length();
    const direction = to.normalize().toArray() as Vec;
    return this.bodies.some(({ mesh, position }, which) => {
      if (!mesh.visible || (mesh.material as ShaderMaterial).transparent) return false;
      const model = { position: position.array as Float32Array, triangle: this.data.bodies[which].triangles };
      const hit = firstHit(model, from.toArray() as Vec, direction, null);
      return hit !== null && hit.distance < away - 0.01;
    });
  }

  setScale(scale: Scale): void {
    for (const { mesh } of this.bodies) setScale((mesh.material as ShaderMaterial).uniforms, scale);
    this.draw();
  }

  /// How a body is drawn.
  setStyle(which: number, style: 'solid' | 'ghost' | 'hidden'): void {
    const { mesh } = this.bodies[which];
    const material = mesh.material as ShaderMaterial;
    mesh.visible = style !== 'hidden';
    material.transparent = style === 'ghost';
    material.depthWrite = style !== 'ghost';
    material.uniforms.alpha.value = style === 'ghost' ? 0.3 : 1;
    mesh.renderOrder = style === 'ghost' ? 1 : 0;
    this.draw();
  }
}

interface Bounds {
  lo: Vec;
  hi: Vec;
}

/// The bounds of some bodies in a frame of the page; null: in all frames.
function bounds(data: PlayerData, bodies: number[], frame: number | null): Bounds {
  const lo: Vec = [Infinity, Infinity, Infinity];
  const hi: Vec = [-Infinity, -Infinity, -Infinity];
  const { origin, step } = data.page;
  for (const which of bodies) {
    const { positions, vertices, moves } = data.bodies[which];
    const first = frame === null || !moves ? 0 : 3 * vertices * frame;
    const end = frame === null ? positions.length : first + 3 * vertices;
    for (let i = first; i < end; ++i) {
      const x = origin[i % 3] + step * positions[i];
      lo[i % 3] = Math.min(lo[i % 3], x);
      hi[i % 3] = Math.max(hi[i % 3], x);
    }
  }
  return { lo, hi };
}

const diagonal = ({ lo, hi }: Bounds) => Math.hypot(...lo.map((x, k) => hi[k] - x));

/// The box of a frame, or of all, without a body at rest that is much larger, such as a floor.
function extent(data: PlayerData, frame: number | null): Bounds {
  const moving = [0, 1].filter((which) => data.bodies[which].moves);
  let box = bounds(data, [0, 1], frame);
  if (moving.length > 0) {
    const inner = bounds(data, moving, frame);
    if (diagonal(box) > 3 * diagonal(inner)) box = inner;
  }
  return box;
}

/// Whether a body has the other one in its box in the first frame, and would hide it.
export function encloses(data: PlayerData, which: number): boolean {
  const outer = bounds(data, [which], 0);
  const inner = bounds(data, [1 - which], 0);
  return outer.lo.every((x, k) => x < inner.lo[k] && outer.hi[k] > inner.hi[k]);
}
