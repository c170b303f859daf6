// The reference in two colours: where it was measured, and where not.
import { BufferAttribute, BufferGeometry, DoubleSide, Group, Mesh, ShaderMaterial, Vector3 } from 'three';
import { css } from './color_scale';
import { byId, make } from './dom';
import { percent, text } from './numbers';
import type { Ghost, Report, Vec } from './page_data';
import { boxOf } from './subject';
import { unitOf } from './verdict';

const kCovered: Vec = [150, 172, 190];
const kMissing: Vec = [222, 105, 20];

/// Passes the point on to the fragments, in the space of the scene and in that of the camera.
export const kReferenceVertexShader = `
  out vec3 vPoint, vView;
  void main() {
    vPoint = (modelMatrix * vec4(position, 1.0)).xyz;
    vec4 view = modelViewMatrix * vec4(position, 1.0);
    vView = view.xyz;
    gl_Position = projectionMatrix * view;
  }
`;
const kShader = `
  precision highp float;
  uniform vec4 cut;
  uniform vec3 color;
  in vec3 vPoint, vView;
  out vec4 outColor;
  void main() {
    if (dot(cut.xyz, vPoint) > cut.w) discard;
    vec3 n = normalize(cross(dFdx(vView), dFdy(vView)));
    outColor = vec4(color * min(0.62 + 0.38 * abs(n.z) + 0.08 * n.y, 1.0), 1.0);
  }
`;

interface CoverageObject {
  object: Group;
  centre: Vec;
  radius: number;
  setCut: (cut: number[]) => void;
}

/// The triangles of the reference, those that are covered and the others; null if that is not known.
export function coverageOf({ position, triangle, covered }: Ghost): CoverageObject | null {
  if (!covered) return null;
  const object = new Group();
  const materials: ShaderMaterial[] = [];
  for (const [flag, color] of [
    [1, kCovered],
    [0, kMissing],
  ] as const) {
    const corners: number[] = [];
    covered.forEach((c, t) => c === flag && corners.push(...triangle.subarray(3 * t, 3 * t + 3)));
    const shape = new BufferGeometry();
    shape.setAttribute('position', new BufferAttribute(position, 3));
    shape.setIndex(new BufferAttribute(Uint32Array.from(corners), 1));
    const material = new ShaderMaterial({
      glslVersion: '300 es',
      vertexShader: kReferenceVertexShader,
      fragmentShader: kShader,
      side: DoubleSide,
      uniforms: { cut: { value: [0, 0, 0, 1] }, color: { value: new Vector3(...color).divideScalar(255) } },
    });
    const mesh = new Mesh(shape, material);
    mesh.frustumCulled = false;
    object.add(mesh);
    materials.push(material);
  }
  object.visible = false;
  const { lo, hi } = boxOf(position);
  const centre = lo.map((x, k) => (x + hi[k]) / 2) as Vec;
  const radius = Math.hypot(...lo.map((x, k) => hi[k] - x)) / 2;
  return { object, centre, radius, setCut: (cut) => materials.forEach((m) => (m.uniforms.cut.value = cut)) };
}

/// Draws the legend of coverage, which takes the place of the colour scale.
export function drawCoverageLegend(report: Report): void {
  const coverage = report.coverage!;
  const row = (color: Vec, words: string) =>
    make('p', { class: 'missing' }, make('span', { style: `background: ${css(color)}` }), words);
  byId('legend').replaceChildren(
    make('p', { class: 'unit' }, `measured within ${text(coverage.reach)}${unitOf(report)}`),
    row(kCovered, `covered ${percent(coverage.value)}`),
    row(kMissing, `not covered ${percent(1 - coverage.value)}`),
  );
  byId('legend').setAttribute(
    'aria-label',
    `${percent(coverage.value)} of the reference is covered; the rest is drawn in another colour`,
  );
}

/// Returns the row on coverage for the table of numbers.
export function coverageRow(report: Report): string[][] {
  const c = report.coverage;
  if (!c) return [];
  return [
    [
      'Coverage of the reference',
      percent(c.value),
      `of its area have a measured point within ${text(c.reach)}${unitOf(report)}: an estimate, proven to be between ${percent(c.lower)} and ${percent(c.upper)}`,
    ],
  ];
}
