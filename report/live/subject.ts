// A part whose map is computed again and again: coarsely while something moves, and finely at rest.
import { Group } from 'three';
import type { Colors, Scale } from '../src/color_scale';
import type { Uniforms } from '../src/color_uniforms';
import type { Vec } from '../src/page_data';
import { valueAt } from '../src/pick';
import type { CutPart } from '../src/section_view';
import { boxOf, Found, HalfSpace, Subject } from '../src/subject';
import { Surface } from '../src/surface';
import { filledValues, sourcesOf } from '../src/value_texture';
import type { Viewer } from '../src/viewer';
import { Layout, measureTexels, placeVertices, Triangles } from './layout';

/// A surface whose vertices and distances change.
export class ChangingSurface extends Surface {
  private readonly sources: Int32Array;

  constructor(readonly layout: Layout, colors: Colors, isClosed: boolean) {
    super(layout.model, layout.map, colors, isClosed, '', null);
    this.sources = sourcesOf(layout.map, layout.model.place);
  }

  /// Shows distances of the texels, and those of the vertices of the mesh; without these, the nearest texels stand for them.
  setDistances(texels: Float32Array, vertices: Float64Array | null, site: Uint32Array | null): void {
    const { map, model, vertexOf, texelOf } = this.layout;
    map.distance = texels;
    map.site = site;
    for (let m = 0; m < vertexOf.length; ++m)
      model.distance[m] = vertices ? vertices[vertexOf[m]] : texelOf[m] < 0 ? Number.NaN : texels[texelOf[m]];
    filledValues(map, model, this.sources, this.texture.image.data as Float32Array);
    this.texture.needsUpdate = true;
    this.showVertexValues(this.object.geometry);
    this.forgetCopies();
  }

  setVertices(mesh: Triangles): void {
    placeVertices(this.layout, mesh);
    measureTexels(this.layout, mesh);
    for (const name of ['position', 'normal']) this.object.geometry.getAttribute(name).needsUpdate = true;
    this.forgetCopies();
  }

  dispose(): void {
    this.object.geometry.dispose();
    this.texture.dispose();
  }
}

/// What is shown: one of two surfaces.
export class LiveSubject implements Subject {
  readonly object = new Group();
  readonly centre: Vec;
  readonly size: number;
  private shown: ChangingSurface;
  private scale: [Scale, Colors] | null = null;

  constructor(
    readonly coarse: ChangingSurface, // of the map while something moves
    readonly isClosed: boolean,
  ) {
    ({ centre: this.centre, size: this.size } = coarse);
    this.shown = coarse;
    this.object.add(coarse.object);
  }

  get surface(): ChangingSurface { return this.shown; }
  get uniforms(): Uniforms { return this.shown.uniforms; }
  get lo(): Vec { return boxOf(this.shown.layout.model.position).lo; }
  get hi(): Vec { return boxOf(this.shown.layout.model.position).hi; }

  show(surface: ChangingSurface): void {
    if (surface === this.shown) return;
    surface.uniforms.cut.value = this.shown.uniforms.cut.value;
    this.object.remove(this.shown.object);
    this.object.add(surface.object);
    this.shown = surface;
    if (this.scale) surface.setScale(...this.scale);
  }

  /// What a section is made of: always of what is shown.
  get cuttable(): CutPart {
    const now = () => this.shown.layout;
    return {
      get position() { return now().model.position; },
      get triangle() { return now().model.triangle; },
      isClosed: this.isClosed,
      scaleAt: (_, scale) => scale,
      valueAt: (triangle, weights) => valueAt(now().model, now().map, { triangle, weights }).distance,
    };
  }

  setScale(scale: Scale, colors: Colors): void {
    this.scale = [scale, colors];
    this.shown.setScale(scale, colors);
  }
  prepare(): void {}
  setCoarse(coarse: boolean): void {
    if (this.shown !== this.coarse) this.shown.setCoarse(coarse);
  }
  find(viewer: Viewer, x: number, y: number, cut: HalfSpace | null): Found | null {
    return this.shown.find(viewer, x, y, cut);
  }
  isHidden(viewer: Viewer, point: Vec, cut: HalfSpace | null): boolean {
    return this.shown.isHidden(viewer, point, cut);
  }
  normalNear(point: Vec): Vec {
    return this.shown.normalNear(point);
  }
}
