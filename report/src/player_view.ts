// The bodies of a sequence in 3D, one frame at a time.
import { BufferAttribute, BufferGeometry, DoubleSide, DynamicDrawUsage, Mesh, ShaderMaterial, Vector3 } from 'three';
import { Colors, kColorShader, Scale } from './color_scale';
import { colorUniforms, setScale } from './color_uniforms';
import type { Vec } from './page_data';
import { distancesOf, placeFrame, PlayerData } from './player_data';
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

  constructor(container: HTMLElement, private readonly data: PlayerData) {
    super(container, data.page.up);
    [this.middle, this.size] = extent(data);
    this.bodies = data.bodies.map((_, which) => this.makeBody(which));
  }

  private makeBody(which: number): Drawn {
    const { vertices, triangles, distances } = this.data.bodies[which];
    const { colors } = this.data.page;
    const material = new ShaderMaterial({
      glslVersion: '300 es',
      vertexShader: kVertexShader,
      fragmentShader: kShader,
      side: DoubleSide,
      uniforms: {
        coloured: { value: distances !== null },
        alpha: { value: 1 },
        plain: { value: new Vector3(0.72, 0.74, 0.77) },
        ...colorUniforms(colors),
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

  setScale(scale: Scale, colors: Colors): void {
    for (const { mesh } of this.bodies) setScale((mesh.material as ShaderMaterial).uniforms, scale, colors);
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

function bounds(data: PlayerData, bodies: number[], frames: 'all' | 'first'): Bounds {
  const lo: Vec = [Infinity, Infinity, Infinity];
  const hi: Vec = [-Infinity, -Infinity, -Infinity];
  const { origin, step } = data.page;
  for (const which of bodies) {
    const { positions, vertices } = data.bodies[which];
    const count = frames === 'all' ? positions.length : 3 * vertices;
    for (let i = 0; i < count; ++i) {
      const x = origin[i % 3] + step * positions[i];
      lo[i % 3] = Math.min(lo[i % 3], x);
      hi[i % 3] = Math.max(hi[i % 3], x);
    }
  }
  return { lo, hi };
}

const diagonal = ({ lo, hi }: Bounds) => Math.hypot(...lo.map((x, k) => hi[k] - x));

/// The middle and half of the diagonal of the box of all frames, without a body at rest that is much larger, such as a floor.
function extent(data: PlayerData): [Vec, number] {
  const moving = [0, 1].filter((which) => data.bodies[which].moves);
  let box = bounds(data, [0, 1], 'all');
  if (moving.length > 0) {
    const inner = bounds(data, moving, 'all');
    if (diagonal(box) > 3 * diagonal(inner)) box = inner;
  }
  return [box.lo.map((x, k) => (x + box.hi[k]) / 2) as Vec, diagonal(box) / 2 || 1];
}

/// Whether a body has the other one in its box in the first frame, and would hide it.
export function encloses(data: PlayerData, which: number): boolean {
  const outer = bounds(data, [which], 'first');
  const inner = bounds(data, [1 - which], 'first');
  return outer.lo.every((x, k) => x < inner.lo[k] && outer.hi[k] > inner.hi[k]);
}
