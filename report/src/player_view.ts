// The bodies of a sequence in 3D, one frame at a time.
import {
  BufferAttribute,
  BufferGeometry,
  DoubleSide,
  DynamicDrawUsage,
  Mesh,
  PerspectiveCamera,
  Scene,
  ShaderMaterial,
  Vector3,
  WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { Colors, kColorShader, Scale } from './color_scale';
import type { Vec } from './page_data';
import { distancesOf, placeFrame, PlayerData } from './player_data';
import { kNoValue } from './value_texture';

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

export class PlayerView {
  readonly canvas: HTMLCanvasElement;
  private readonly camera = new PerspectiveCamera(30, 1, 0.01, 100);
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly controls: OrbitControls;
  private readonly bodies: Drawn[];
  private readonly middle: Vec;
  private readonly size: number;
  private scheduled = false;

  constructor(container: HTMLElement, private readonly data: PlayerData) {
    this.canvas = container.querySelector('canvas')!;
    this.renderer = new WebGLRenderer({ canvas: this.canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    [this.middle, this.size] = extent(data);
    this.bodies = data.bodies.map((_, which) => this.makeBody(which));
    this.camera.up.set(0, 1, 0);
    if (data.page.up === 'z') this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.zoomToCursor = true;
    this.controls.addEventListener('change', () => this.draw());
    new ResizeObserver(() => this.resize()).observe(container);
    this.look();
    this.resize();
  }

  private makeBody(which: number): Drawn {
    const { vertices, triangles, distances } = this.data.bodies[which];
    const { colors } = this.data.page;
    const triple = (list: Vec[]) => list.map((c) => new Vector3(...c).multiplyScalar(1 / 255));
    const material = new ShaderMaterial({
      glslVersion: '300 es',
      vertexShader: kVertexShader,
      fragmentShader: kShader,
      side: DoubleSide,
      uniforms: {
        coloured: { value: distances !== null },
        alpha: { value: 1 },
        plain: { value: new Vector3(0.72, 0.74, 0.77) },
        mode: { value: 0 },
        lo: { value: 0 },
        hi: { value: 1 },
        lower: { value: 0 },
        upper: { value: 0 },
        accuracy: { value: 0 },
        stops: { value: triple(colors.viridis) },
        stopCount: { value: colors.viridis.length },
        above: { value: triple(colors.above) },
        below: { value: triple(colors.below) },
        within: { value: triple(colors.within)[0] },
        noValue: { value: triple(colors.no_value)[0] },
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
    for (const { mesh } of this.bodies) {
      const u = (mesh.material as ShaderMaterial).uniforms;
      u.mode.value = scale.mode === 'tolerance' ? 2 : scale.mode === 'diverging' ? 1 : 0;
      for (const key of ['lo', 'hi', 'lower', 'upper', 'accuracy'] as const) u[key].value = scale[key];
      const stops = colors[scale.mode === 'tolerance' ? 'viridis' : scale.mode];
      u.stopCount.value = stops.length;
      u.stops.value = Array.from({ length: 11 }, (_, i) =>
        new Vector3(...stops[Math.min(i, stops.length - 1)]).multiplyScalar(1 / 255),
      );
    }
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

  /// From a corner, with all frames in the picture.
  look(): void {
    const direction = this.data.page.up === 'z' ? new Vector3(0.6, -1, 0.55) : new Vector3(0.6, 0.55, 1);
    const half = Math.tan((this.camera.fov * Math.PI) / 360) * Math.min(1, this.camera.aspect);
    this.controls.target.set(0, 0, 0);
    this.camera.position.copy(direction.normalize().multiplyScalar(0.56 / Math.sin(Math.atan(half))));
    this.controls.update();
    this.draw();
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.canvas.parentElement!;
    if (clientWidth === 0 || clientHeight === 0) return;
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.camera.aspect = clientWidth / clientHeight;
    this.draw();
  }

  draw(): void {
    if (this.scheduled) return;
    this.scheduled = true;
    requestAnimationFrame(() => {
      this.scheduled = false;
      const away = this.camera.position.length();
      this.camera.near = Math.max(away - 4, away / 1000);
      this.camera.far = away + 8;
      this.camera.updateProjectionMatrix();
      this.renderer.render(this.scene, this.camera);
    });
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

/// The middle and the diagonal of the box of all frames, without a body at rest that is much larger, such as a floor.
function extent(data: PlayerData): [Vec, number] {
  const moving = [0, 1].filter((which) => data.bodies[which].moves);
  let box = bounds(data, [0, 1], 'all');
  if (moving.length > 0) {
    const inner = bounds(data, moving, 'all');
    if (diagonal(box) > 3 * diagonal(inner)) box = inner;
  }
  return [box.lo.map((x, k) => (x + box.hi[k]) / 2) as Vec, diagonal(box) || 1];
}

/// Whether a body has the other one in its box in the first frame, and would hide it.
export function encloses(data: PlayerData, which: number): boolean {
  const outer = bounds(data, [which], 'first');
  const inner = bounds(data, [1 - which], 'first');
  return outer.lo.every((x, k) => x < inner.lo[k] && outer.hi[k] > inner.hi[k]);
}
