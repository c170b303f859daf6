// The part in 3D.
import {
  BufferAttribute,
  BufferGeometry,
  DataTexture,
  DoubleSide,
  FloatType,
  Mesh,
  PerspectiveCamera,
  RedFormat,
  Scene,
  ShaderMaterial,
  Vector3,
  WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { kColorShader, Scale, Colors } from './color_scale';
import type { PageData, Vec } from './page_data';
import { firstHit, HalfSpace, Hit } from './pick';
import { filledValues, kNoValue } from './value_texture';

const kVertexShader = `
  in vec2 place;
  in float value;
  out vec3 vPoint, vNormal;
  out vec2 vPlace;
  out float vValue;
  void main() {
    vPoint = position;
    vNormal = normalMatrix * normal;
    vPlace = place;
    vValue = value;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  }
`;

// Values between texels are interpolated for the picture; a texel without a value stays as it is.
const kPartShader = `
  precision highp float;
  precision highp sampler2D;
  uniform sampler2D values;
  uniform bool byVertex, showBacks;
  uniform vec4 cut;
  uniform vec3 cutColor;
  in vec3 vPoint, vNormal;
  in vec2 vPlace;
  in float vValue;
  out vec4 outColor;
  ${kColorShader}

  float valueAt(ivec2 at) { return texelFetch(values, clamp(at, ivec2(0), textureSize(values, 0) - 1), 0).r; }
  float valueHere() {
    if (byVertex) return vValue;
    ivec2 nearest = ivec2(floor(vPlace));
    float value = valueAt(nearest);
    if (value > 1e38) return value;
    vec2 corner = floor(vPlace - 0.5), part = vPlace - 0.5 - corner;
    float sum = 0.0, weight = 0.0;
    for (int k = 0; k < 4; ++k) {
      ivec2 step = ivec2(k & 1, k >> 1);
      float v = valueAt(ivec2(corner) + step);
      if (v > 1e38) continue;
      vec2 w = mix(1.0 - part, part, vec2(step));
      sum += w.x * w.y * v, weight += w.x * w.y;
    }
    return weight > 0.0 ? sum / weight : value;
  }

  void main() {
    if (dot(cut.xyz, vPoint) > cut.w) discard;
    if (!gl_FrontFacing && !showBacks) {  // the inside of a body that is cut open
      float stripe = step(0.5, fract((gl_FragCoord.x + gl_FragCoord.y) / 9.0));
      outColor = vec4(cutColor * (0.92 + 0.08 * stripe), 1.0);
      return;
    }
    vec3 n = normalize(vNormal);
    float light = 0.62 + 0.38 * abs(n.z) + 0.08 * n.y;
    float value = valueHere();
    outColor = vec4((value > 1e38 ? noValue : colorOf(value)) * min(light, 1.0), 1.0);
  }
`;

const kGhostVertexShader = `
  out vec3 vPoint, vView;
  void main() {
    vPoint = position;
    vec4 view = modelViewMatrix * vec4(position, 1.0);
    vView = view.xyz;
    gl_Position = projectionMatrix * view;
  }
`;
const kGhostShader = `
  precision highp float;
  uniform vec4 cut;
  uniform vec3 color;
  in vec3 vPoint, vView;
  out vec4 outColor;
  void main() {
    if (dot(cut.xyz, vPoint) > cut.w) discard;
    vec3 n = normalize(cross(dFdx(vView), dFdy(vView)));
    float rim = 1.0 - abs(dot(n, normalize(vView)));
    outColor = vec4(color, 0.1 + 0.45 * rim * rim);
  }
`;

const kNoCut = { normal: [0, 0, 0] as Vec, offset: 1 };

export class View {
  readonly camera = new PerspectiveCamera(30, 1, 0.01, 100);
  readonly canvas: HTMLCanvasElement;
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly controls: OrbitControls;
  private readonly part: ShaderMaterial;
  private readonly ghostMaterial: ShaderMaterial;
  private readonly ghost: Mesh | null = null;
  private readonly up: Vector3;
  private cut: HalfSpace | null = null;
  private scheduled = false;
  private radius = 1;

  /// `onChange` is called after every picture.
  constructor(
    container: HTMLElement,
    private readonly data: PageData,
    colors: Colors,
    isClosed: boolean,
    private readonly onChange: () => void,
  ) {
    const { model, map } = data;
    this.canvas = container.querySelector('canvas')!;
    // The picture is kept for printing.
    this.renderer = new WebGLRenderer({
      canvas: this.canvas,
      antialias: true,
      alpha: true,
      preserveDrawingBuffer: true,
    });
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));

    const texture = new DataTexture(filledValues(map, model), map.width, map.height, RedFormat, FloatType);
    texture.needsUpdate = true;
    const triple = (list: Vec[]) => list.map((c) => new Vector3(...c).multiplyScalar(1 / 255));
    this.part = new ShaderMaterial({
      glslVersion: '300 es',
      vertexShader: kVertexShader,
      fragmentShader: kPartShader,
      side: DoubleSide,
      uniforms: {
        values: { value: texture },
        byVertex: { value: model.place === null },
        // The folds of a coarser copy are not the inside of the part.
        showBacks: { value: !isClosed || model.place === null },
        cut: { value: [0, 0, 0, 1] },
        cutColor: { value: new Vector3(0.72, 0.72, 0.74) },
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
    this.ghostMaterial = new ShaderMaterial({
      glslVersion: '300 es',
      vertexShader: kGhostVertexShader,
      fragmentShader: kGhostShader,
      side: DoubleSide,
      transparent: true,
      depthWrite: false,
      polygonOffset: true,
      polygonOffsetFactor: 1,
      polygonOffsetUnits: 1,
      uniforms: { cut: { value: [0, 0, 0, 1] }, color: { value: new Vector3(0.45, 0.5, 0.58) } },
    });

    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(model.position, 3));
    geometry.setAttribute('normal', new BufferAttribute(model.normal, 3, true));
    geometry.setAttribute('place', new BufferAttribute(model.place ?? new Float32Array(2 * model.distance.length), 2));
    geometry.setAttribute(
      'value',
      new BufferAttribute(Float32Array.from(model.distance, (d) => (Number.isNaN(d) ? kNoValue : d)), 1),
    );
    geometry.setIndex(new BufferAttribute(model.triangle, 1));
    const mesh = new Mesh(geometry, this.part);
    mesh.frustumCulled = false;
    this.scene.add(mesh);
    if (data.ghost) {
      const shape = new BufferGeometry();
      shape.setAttribute('position', new BufferAttribute(data.ghost.position, 3));
      shape.setIndex(new BufferAttribute(data.ghost.triangle, 1));
      this.ghost = new Mesh(shape, this.ghostMaterial);
      this.ghost.frustumCulled = false;
      this.ghost.visible = false;
      this.scene.add(this.ghost);
    }

    this.up = data.page.up === 'z' ? new Vector3(0, 0, 1) : new Vector3(0, 1, 0);
    this.camera.up.copy(this.up);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.zoomToCursor = true;
    this.controls.addEventListener('change', () => this.draw());
    new ResizeObserver(() => this.resize()).observe(container);
    this.resize();
    this.look('corner');
  }

  /// Fits the picture to its place.
  resize(): void {
    const { clientWidth, clientHeight } = this.canvas.parentElement!;
    if (clientWidth === 0 || clientHeight === 0) return;
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.camera.aspect = clientWidth / clientHeight;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  /// Draws a picture soon, one for any number of calls.
  draw(): void {
    if (this.scheduled) return;
    this.scheduled = true;
    requestAnimationFrame(() => this.drawNow());
  }

  drawNow(): void {
    this.scheduled = false;
    const away = this.camera.position.length();
    this.camera.near = Math.max(1e-4, (away - 4 * this.radius) / 2, away / 1000);
    this.camera.far = away + 8 * this.radius;
    this.camera.updateProjectionMatrix();
    this.renderer.render(this.scene, this.camera);
    this.onChange();
  }

  setScale(scale: Scale, colors: Colors): void {
    const u = this.part.uniforms;
    u.mode.value = scale.mode === 'tolerance' ? 2 : scale.mode === 'diverging' ? 1 : 0;
    u.lo.value = scale.lo;
    u.hi.value = scale.hi;
    u.lower.value = scale.lower;
    u.upper.value = scale.upper;
    u.accuracy.value = scale.accuracy;
    const stops = colors[scale.mode === 'tolerance' ? 'viridis' : scale.mode];
    u.stopCount.value = stops.length;
    u.stops.value = Array.from({ length: 11 }, (_, i) =>
      new Vector3(...stops[Math.min(i, stops.length - 1)]).multiplyScalar(1 / 255),
    );
    this.draw();
  }

  setCut(cut: HalfSpace | null): void {
    this.cut = cut;
    const { normal, offset } = cut ?? kNoCut;
    this.part.uniforms.cut.value = this.ghostMaterial.uniforms.cut.value = [...normal, offset];
    this.draw();
  }

  setGhost(visible: boolean): void {
    if (this.ghost) this.ghost.visible = visible;
    this.draw();
  }

  /// Looks at the whole part from a side, or at a point of it from outside.
  look(from: string | { point: Vec; normal: Vec }): void {
    const z = this.data.page.up === 'z';
    // Right, up and towards the viewer in the front view.
    const frame: Record<string, Vec> = z
      ? { front: [0, -1, 0], back: [0, 1, 0], left: [-1, 0, 0], right: [1, 0, 0], top: [0, -1e-4, 1], bottom: [0, -1e-4, -1], corner: [0.6, -1, 0.55] }
      : { front: [0, 0, 1], back: [0, 0, -1], left: [-1, 0, 0], right: [1, 0, 0], top: [0, 1, 1e-4], bottom: [0, -1, 1e-4], corner: [0.6, 0.55, 1] };
    let direction: Vector3;
    let away = this.camera.position.distanceTo(this.controls.target);
    if (typeof from === 'string') {
      direction = new Vector3(...(frame[from] ?? frame.corner)).normalize();
      this.controls.target.set(0, 0, 0);
      const half = Math.tan((this.camera.fov * Math.PI) / 360) * Math.min(1, this.camera.aspect);
      away = (1.02 * this.radius) / Math.sin(Math.atan(half));
    } else {
      direction = new Vector3(...from.normal).normalize();
      // Not along the vertical axis, where the view could turn to any side.
      direction.addScaledVector(new Vector3(0.3, 0.25, 0.35), 0.6).normalize();
      this.controls.target.set(...from.point);
      away = Math.min(away, 2.6 * this.radius);
    }
    this.camera.position.copy(this.controls.target).addScaledVector(direction, away);
    this.controls.update();
    this.draw();
  }

  /// Turns the view by angles in degrees, around the vertical axis and up.
  turn(right: number, up: number): void {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const side = new Vector3().crossVectors(this.up, offset).normalize();
    const angle = offset.angleTo(this.up);
    const lift = Math.min(Math.max(angle - (up * Math.PI) / 180, 0.02), Math.PI - 0.02) - angle;
    offset.applyAxisAngle(side, lift).applyAxisAngle(this.up, (right * Math.PI) / 180);
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

  /// What is seen at a place of the canvas, in CSS pixels from its upper left corner.
  hitAt(x: number, y: number): Hit | null {
    const { clientWidth, clientHeight } = this.canvas;
    this.camera.updateMatrixWorld();
    const through = new Vector3((2 * x) / clientWidth - 1, 1 - (2 * y) / clientHeight, 0.5).unproject(this.camera);
    const from = this.camera.position;
    return firstHit(this.data.model, from.toArray() as Vec, through.sub(from).normalize().toArray() as Vec, this.cut);
  }

  /// Where a point of the model is in the canvas, and whether something is in front of it.
  place(point: Vec): { x: number; y: number; behind: boolean } {
    const at = new Vector3(...point).project(this.camera);
    const { clientWidth, clientHeight } = this.canvas;
    return { x: ((at.x + 1) / 2) * clientWidth, y: ((1 - at.y) / 2) * clientHeight, behind: at.z > 1 };
  }

  isHidden(point: Vec): boolean {
    const from = this.camera.position;
    const to = new Vector3(...point).sub(from);
    const away = to.length();
    const hit = firstHit(this.data.model, from.toArray() as Vec, to.normalize().toArray() as Vec, this.cut);
    return hit !== null && hit.distance < away - 0.01 * this.radius;
  }
}
