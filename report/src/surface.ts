// A measured surface: its triangles with the texels of the map.
import {
  BufferAttribute,
  BufferGeometry,
  DataTexture,
  DoubleSide,
  FloatType,
  Mesh,
  RedFormat,
  ShaderMaterial,
  Vector3,
} from 'three';
import { CoarseWhileMoving } from './coarse_copy';
import { colorUniforms, setScale, Uniforms } from './color_uniforms';
import type { Scale } from './color_scale';
import type { GroupLimits } from './group_limits';
import { exactText } from './numbers';
import type { Channel, Model, TexelMap, Vec } from './page_data';
import { firstHit, pointOf, valueAt } from './pick';
import type { Hit } from './pick';
import type { CutPart } from './section_view';
import { boxOf, Found, HalfSpace, nearest, Subject } from './subject';
import { kVertexShader, partShader } from './surface_shader';
import { filledValues, kNoValue } from './value_texture';
import type { Viewer } from './viewer';

const kCoarse = 6000; // triangles, while something moves

const kSites = ['vertex', 'edge', 'face'];

function siteText(site: number): string {
  return site === 0xffffffff ? '' : `${kSites[site & 3]} ${site >>> 2} of the reference`;
}

/// The row of a channel below the distance, such as "Closest face: 12".
function channelRow(
  { name, whole, length, values }: Channel,
  texel: number,
  unit: string,
): Found['rows'][number] {
  const numbers = values.map((ofComponent) => ofComponent[texel]);
  const isNone = numbers.some((x) => (whole ? x === 0xffffffff : Number.isNaN(x)));
  const label = name[0].toUpperCase() + name.slice(1).replace(/_/g, ' ');
  return [label, isNone ? 'none' : numbers.map(exactText).join(', ') + (length ? unit : ''), `probe-${name}`];
}

export class Surface implements Subject {
  readonly centre: Vec;
  readonly size: number;
  readonly lo: Vec;
  readonly hi: Vec;
  readonly uniforms: Uniforms;
  readonly object: Mesh;
  private readonly rest: Mesh; // the triangles that are not highlighted
  private readonly ofSet: Uniforms[]; // of each set of limits
  private readonly coarse: CoarseWhileMoving[];
  private readonly showBacks: boolean;
  protected readonly texture: DataTexture;

  constructor(
    protected readonly model: Model,
    protected readonly map: TexelMap,
    readonly isClosed: boolean,
    private readonly unit: string,
    readonly limits: GroupLimits | null, // of the triangles, which have a tolerance of their own
  ) {
    ({ centre: this.centre, size: this.size } = model);
    ({ lo: this.lo, hi: this.hi } = boxOf(model.position));
    this.texture = new DataTexture(filledValues(map, model), map.width, map.height, RedFormat, FloatType);
    this.texture.needsUpdate = true;
    // The folds of a coarser copy are not the inside of the part.
    this.showBacks = !isClosed || model.place === null;
    this.uniforms = {
      ...colorUniforms(),
      values: { value: this.texture },
      byVertex: { value: model.place === null },
      showBacks: { value: this.showBacks },
      cut: { value: [0, 0, 0, 1] },
      cutColor: { value: new Vector3(0.72, 0.72, 0.74) },
      ...this.lookUniforms(),
    };
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(model.position, 3));
    geometry.setAttribute('normal', new BufferAttribute(model.normal, 3, true));
    geometry.setAttribute(
      'place',
      new BufferAttribute(model.place ?? new Float32Array(2 * model.distance.length), 2),
    );
    geometry.setAttribute('value', new BufferAttribute(new Float32Array(model.distance.length), 1));
    this.showVertexValues(geometry);
    const own = () => Object.fromEntries(['lo', 'hi', 'lower', 'upper'].map((key) => [key, { value: 0 }]));
    this.ofSet = limits
      ? Array.from({ length: limits.count }, () => ({ ...this.uniforms, ...own() }))
      : [this.uniforms];
    const meshOf = (shape: BufferGeometry, faded: boolean) => {
      const materials = this.ofSet.map(
        (uniforms) =>
          new ShaderMaterial({
            glslVersion: '300 es',
            vertexShader: kVertexShader,
            fragmentShader: partShader(this.lookShader),
            side: DoubleSide,
            uniforms: { ...uniforms, faded: { value: faded } },
          }),
      );
      const mesh = new Mesh(shape, materials);
      mesh.frustumCulled = false;
      return mesh;
    };
    this.setTriangles(geometry);
    this.object = meshOf(geometry, false);
    const others = new BufferGeometry();
    for (const [name, attribute] of Object.entries(geometry.attributes)) others.setAttribute(name, attribute);
    this.rest = meshOf(others, true);
    this.rest.visible = false;
    this.object.add(this.rest);
    this.coarse = [this.object, this.rest].map((mesh) => new CoarseWhileMoving(mesh, kCoarse));
  }

  /// What partShader() is made with.
  protected get lookShader(): string {
    return 'vec3 lookHere(inout vec3 n) { return lookOfValue(); }';
  }
  protected lookUniforms(): Uniforms {
    return {};
  }

  /// Has coarse copies made again, for other vertices or values.
  protected forgetCopies(): void {
    for (const mesh of this.coarse) mesh.forget();
  }

  /// Colours a coarser copy by the values at its vertices, as its triangles have no texels.
  protected showVertexValues(geometry: BufferGeometry): void {
    const values = geometry.getAttribute('value') as BufferAttribute;
    this.model.distance.forEach((d, v) => (values.array[v] = Number.isNaN(d) ? kNoValue : d));
    values.needsUpdate = true;
  }

  /// What a section is made of.
  get cuttable(): CutPart {
    const { model, map, isClosed } = this;
    const scaleAt = (triangle: number, scale: Scale) =>
      this.limits?.scaleOf(this.limits.ofTriangle[triangle], scale) ?? scale;
    return {
      position: model.position,
      triangle: model.triangle,
      isClosed,
      scaleAt,
      valueAt: (triangle, weights) => valueAt(model, map, { triangle, weights }).distance,
    };
  }

  setScale(scale: Scale): void {
    setScale(this.uniforms, scale);
    if (this.limits)
      this.ofSet.forEach((uniforms, set) => setScale(uniforms, this.limits!.scaleOf(set, scale)));
  }

  /// The triangles of a geometry, by their sets of limits, which have a material each; by default all.
  private setTriangles(geometry: BufferGeometry, chosen?: number[]): void {
    const { triangle } = this.model;
    const setOf = (t: number) => this.limits?.ofTriangle[t] ?? 0;
    const bySet: number[][] = this.ofSet.map(() => []);
    const add = (t: number) => bySet[setOf(t)].push(t);
    if (chosen) chosen.forEach(add);
    else if (this.limits) for (let t = 0; t < triangle.length / 3; ++t) add(t);
    const index =
      chosen || this.limits
        ? new Uint32Array(3 * bySet.reduce((sum, list) => sum + list.length, 0))
        : triangle;
    geometry.clearGroups();
    if (index === triangle) geometry.addGroup(0, triangle.length, 0);
    let at = 0;
    bySet.forEach((list, set) => {
      if (list.length > 0) geometry.addGroup(at, 3 * list.length, set);
      for (const t of list) {
        index.set(triangle.subarray(3 * t, 3 * t + 3), at);
        at += 3;
      }
    });
    geometry.setIndex(new BufferAttribute(index, 1));
  }

  /// A vertex in the middle of the triangles of a group, if they are known.
  middleOf({ kind, group }: { kind: string; group: string }): Vec | null {
    const named = this.model.names.find((n) => n.kind === kind);
    const number = named ? named.names.indexOf(group) + 1 : 0;
    if (number === 0) return null;
    const { triangle, position } = this.model;
    const corners: number[] = [];
    named!.ofTriangle.forEach((n, t) => n === number && corners.push(...triangle.subarray(3 * t, 3 * t + 3)));
    const of = (v: number) => Array.from(position.subarray(3 * v, 3 * v + 3)) as Vec;
    const mean = corners.reduce((sum, v) => sum.map((x, k) => x + of(v)[k] / corners.length) as Vec, [
      0, 0, 0,
    ] as Vec);
    const away = (v: number) => Math.hypot(...of(v).map((x, k) => x - mean[k]));
    const best = corners.reduce((nearest, v) => (away(v) < away(nearest) ? v : nearest), corners[0]);
    return corners.length > 0 ? of(best) : null;
  }

  /// Whether the triangles of a group are known.
  hasGroup(kind: string, group: string): boolean {
    return this.model.names.some((n) => n.kind === kind && n.names.includes(group));
  }

  /// Shows all but the triangles of a group in grey; null: all in colours.
  highlight(group: { kind: string; group: string } | null): void {
    this.setCoarse(false);
    const named = group && this.model.names.find((n) => n.kind === group.kind);
    const number = named ? named.names.indexOf(group.group) + 1 : 0;
    this.rest.visible = number > 0;
    if (number === 0) {
      this.setTriangles(this.object.geometry);
      return;
    }
    const chosen: [number[], number[]] = [[], []]; // of the group, and of the rest
    named!.ofTriangle.forEach((n, t) => chosen[n === number ? 0 : 1].push(t));
    this.setTriangles(this.object.geometry, chosen[0]);
    this.setTriangles(this.rest.geometry, chosen[1]);
  }

  prepare(): void {}

  setCoarse(coarse: boolean): void {
    for (const mesh of this.coarse) mesh.show(coarse);
    const isCopy = coarse && this.model.triangle.length > 3 * kCoarse;
    this.uniforms.byVertex.value = isCopy || this.model.place === null;
    this.uniforms.showBacks.value = isCopy || this.showBacks;
  }

  find(viewer: Viewer, x: number, y: number, cut: HalfSpace | null): Found | null {
    const { model, map } = this;
    const hit = firstHit(model, viewer.camera.position.toArray() as Vec, viewer.through(x, y), cut);
    if (!hit) return null;
    const value = valueAt(model, map, hit);
    const rows: Found['rows'] = [];
    const detail = siteText(value.site);
    if (detail) rows.push(['Nearest', detail, 'probe-site']);
    if (value.texel)
      rows.push([
        map.step > 1 ? `Pixels (${map.step}² each)` : 'Pixel',
        value.texel.join(', '),
        'probe-texel',
      ]);
    else rows.push(['Of', 'the nearest vertex', 'probe-texel']);
    if (value.texel) {
      const texel = value.texel[1] * map.width + value.texel[0];
      rows.push(...map.channels.map((channel) => channelRow(channel, texel, this.unit)));
    }
    return {
      at: pointOf(model, hit),
      normal: this.normalOf(hit),
      distance: value.distance,
      detail,
      rows,
      value: { ...value, triangle: hit.triangle },
    };
  }

  isHidden(viewer: Viewer, point: Vec, cut: HalfSpace | null): boolean {
    const from = viewer.camera.position;
    const to = new Vector3(...point).sub(from);
    const away = to.length();
    const hit = firstHit(this.model, from.toArray() as Vec, to.normalize().toArray() as Vec, cut);
    return hit !== null && hit.distance < away - 0.01;
  }

  normalNear(point: Vec): Vec {
    const v = nearest(this.model.position, point);
    return Array.from(this.model.normal.subarray(3 * v, 3 * v + 3)) as Vec;
  }

  private normalOf({ triangle }: Hit): Vec {
    const { model } = this;
    const normal: Vec = [0, 0, 0];
    for (let corner = 0; corner < 3; ++corner)
      for (let k = 0; k < 3; ++k) normal[k] += model.normal[3 * model.triangle[3 * triangle + corner] + k];
    return normal;
  }
}
