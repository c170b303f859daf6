// A measured cloud: points as discs, of which the page has some.
import { BufferAttribute, BufferGeometry, Points, ShaderMaterial } from 'three';
import { kColorShader, Scale } from './color_scale';
import { colorUniforms, setScale, Uniforms } from './color_uniforms';
import { count } from './numbers';
import type { CloudData, Vec } from './page_data';
import { Found, HalfSpace, nearest, Subject } from './subject';
import { kNoValue } from './value_texture';
import type { Viewer } from './viewer';

// Diameters in CSS pixels.
const kLeast = 2;
const kMost = 24;

const kVertexShader = `
  uniform float width, pixelsPerUnit, pixelRatio;
  in float value;
  out vec3 vPoint, vNormal;
  out float vValue;
  void main() {
    vPoint = position;
    vNormal = normalMatrix * normal;
    vValue = value;
    vec4 view = modelViewMatrix * vec4(position, 1.0);
    gl_Position = projectionMatrix * view;
    gl_PointSize = pixelRatio * clamp(width * pixelsPerUnit / -view.z, ${kLeast.toFixed(1)}, ${kMost.toFixed(1)});
  }
`;

const kShader = `
  precision highp float;
  uniform vec4 cut;
  in vec3 vPoint, vNormal;
  in float vValue;
  out vec4 outColor;
  ${kColorShader}

  void main() {
    if (dot(cut.xyz, vPoint) > cut.w) discard;
    vec2 p = 2.0 * gl_PointCoord - 1.0;
    if (dot(p, p) > 1.0) discard;
    float light = 1.0;
    if (dot(vNormal, vNormal) > 0.0) {
      vec3 n = normalize(vNormal);
      light = min(1.0, 0.62 + 0.38 * abs(n.z) + 0.08 * n.y);
    }
    outColor = vec4((vValue > 1e38 ? noValue : colorOf(vValue)) * light, 1.0);
  }
`;

const kCoarse = 4000; // points, while something moves

// How far from a disc the cursor may be.
const kReach = 5;

/// About how far apart the points are: the median distance of some of them to the nearest other one.
function spacing(position: Float32Array): number {
  const points = position.length / 3;
  const probes = 48;
  const found: number[] = [];
  for (let k = 0; k < Math.min(probes, points); ++k) {
    const p = 3 * Math.floor(((k + 0.5) * points) / Math.min(probes, points));
    let least = Infinity;
    for (let i = 0; i < position.length; i += 3) {
      const away =
        (position[i] - position[p]) ** 2 +
        (position[i + 1] - position[p + 1]) ** 2 +
        (position[i + 2] - position[p + 2]) ** 2;
      if (away > 0 && away < least) least = away;
    }
    if (Number.isFinite(least)) found.push(Math.sqrt(least));
  }
  found.sort((a, b) => a - b);
  return found[found.length >> 1] ?? 0.02;
}

export class Cloud implements Subject {
  readonly centre: Vec;
  readonly size: number;
  readonly lo: Vec;
  readonly hi: Vec;
  readonly uniforms: Uniforms;
  readonly object: Points;
  readonly isClosed = false;
  private readonly spacing: number;
  private readonly stride: number; // of the points that are drawn while something moves
  private readonly few: BufferAttribute | null;
  private factor = 1;

  constructor(private readonly data: CloudData) {
    ({ centre: this.centre, size: this.size, lo: this.lo, hi: this.hi } = data);
    this.spacing = spacing(data.position);
    this.uniforms = {
      ...colorUniforms(),
      cut: { value: [0, 0, 0, 1] },
      width: { value: 0 },
      pixelsPerUnit: { value: 1 },
      pixelRatio: { value: 1 },
    };
    this.setWidth(1);
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(data.position, 3));
    geometry.setAttribute('normal', new BufferAttribute(data.normal, 3, true));
    geometry.setAttribute(
      'value',
      new BufferAttribute(
        Float32Array.from(data.distance, (d) => (Number.isNaN(d) ? kNoValue : d)),
        1,
      ),
    );
    this.object = new Points(
      geometry,
      new ShaderMaterial({
        glslVersion: '300 es',
        vertexShader: kVertexShader,
        fragmentShader: kShader,
        uniforms: this.uniforms,
      }),
    );
    this.object.frustumCulled = false;
    const points = data.distance.length;
    this.stride = Math.max(1, Math.ceil(points / kCoarse));
    this.few =
      this.stride === 1
        ? null
        : new BufferAttribute(
            Uint32Array.from({ length: Math.floor(points / this.stride) }, (_, i) => i * this.stride),
            1,
          );
  }

  setScale(scale: Scale): void {
    setScale(this.uniforms, scale);
  }

  /// Some of the points, with larger discs that overlap less.
  setCoarse(coarse: boolean): void {
    this.object.geometry.setIndex(coarse ? this.few : null);
    this.uniforms.width.value = (coarse && this.few ? 0.6 * Math.sqrt(this.stride) : 1) * this.width();
  }

  private width(): number {
    return 2.8 * this.factor * this.spacing;
  }

  /// The size of the discs: at 1, those of a surface that is covered evenly by random points touch.
  setWidth(factor: number): void {
    this.factor = factor;
    this.uniforms.width.value = this.width();
  }

  prepare(viewer: Viewer): void {
    const { camera, canvas } = viewer;
    this.uniforms.pixelsPerUnit.value = canvas.clientHeight / 2 / Math.tan((camera.fov * Math.PI) / 360);
    this.uniforms.pixelRatio.value = viewer.pixelRatio;
  }

  /// The disc in front at a place of the canvas, or the nearest one within kReach. Cost: linear.
  find(viewer: Viewer, x: number, y: number, cut: HalfSpace | null): Found | null {
    const i = this.pick(viewer, x, y, cut);
    if (i < 0) return null;
    const { position, normal, distance, face, number } = this.data;
    const detail = face[i] === 0xffffffff ? '' : `face ${face[i]} of the reference`;
    const rows: Found['rows'] = detail ? [['Nearest', detail, 'probe-site']] : [];
    rows.push(['Point', count(number[i]), 'probe-point']);
    return {
      at: Array.from(position.subarray(3 * i, 3 * i + 3)) as Vec,
      normal: Array.from(normal.subarray(3 * i, 3 * i + 3)) as Vec,
      distance: distance[i],
      detail,
      rows,
      value: { distance: distance[i], face: face[i], number: number[i] },
    };
  }

  private pick(viewer: Viewer, x: number, y: number, cut: HalfSpace | null): number {
    const { position: p } = this.data;
    this.prepare(viewer);
    viewer.camera.updateMatrixWorld();
    const v = viewer.camera.matrixWorldInverse.elements;
    const { clientWidth, clientHeight } = viewer.canvas;
    const scale = this.uniforms.pixelsPerUnit.value as number;
    const width = this.width();
    let [front, depth] = [-1, Infinity];
    let [near, least] = [-1, kReach];
    for (let i = 0; i < p.length; i += 3) {
      const z = -(v[2] * p[i] + v[6] * p[i + 1] + v[10] * p[i + 2] + v[14]);
      if (z <= viewer.camera.near) continue;
      const dx =
        clientWidth / 2 + ((v[0] * p[i] + v[4] * p[i + 1] + v[8] * p[i + 2] + v[12]) * scale) / z - x;
      const dy =
        clientHeight / 2 - ((v[1] * p[i] + v[5] * p[i + 1] + v[9] * p[i + 2] + v[13]) * scale) / z - y;
      const outside = Math.hypot(dx, dy) - Math.min(kMost, Math.max(kLeast, (width * scale) / z)) / 2;
      if (outside > least || (outside <= 0 && z > depth)) continue;
      if (cut && cut.normal[0] * p[i] + cut.normal[1] * p[i + 1] + cut.normal[2] * p[i + 2] > cut.offset)
        continue;
      if (outside <= 0) [front, depth] = [i, z];
      else [near, least] = [i, outside];
    }
    const found = front >= 0 ? front : near;
    return found < 0 ? -1 : found / 3;
  }

  isHidden(viewer: Viewer, point: Vec, cut: HalfSpace | null): boolean {
    const { x, y } = viewer.place(point);
    const i = this.pick(viewer, x, y, cut);
    if (i < 0) return false;
    const from = viewer.camera.position.toArray();
    const away = (to: ArrayLike<number>) => Math.hypot(to[0] - from[0], to[1] - from[1], to[2] - from[2]);
    return away(this.data.position.subarray(3 * i, 3 * i + 3)) < away(point) - 0.03; // noise hides nothing
  }

  normalNear(point: Vec): Vec {
    const i = nearest(this.data.position, point);
    const normal = Array.from(this.data.normal.subarray(3 * i, 3 * i + 3)) as Vec;
    return normal.some((x) => x !== 0) ? normal : (point.map((x) => x || 1e-6) as Vec);
  }
}
