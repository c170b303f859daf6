// A part whose map is computed again and again: coarsely while something moves, and finely at rest.
import { DataTexture, Group, LinearFilter, RGBAFormat, UnsignedByteType } from 'three';
import type { Scale } from '../src/color_scale';
import type { Uniforms } from '../src/color_uniforms';
import type { Vec } from '../src/page_data';
import { valueAt } from '../src/pick';
import type { CutPart } from '../src/section_view';
import { boxOf, Found, HalfSpace, Subject } from '../src/subject';
import { Surface } from '../src/surface';
import { filledValues, sourcesOf } from '../src/value_texture';
import type { Viewer } from '../src/viewer';
import { Layout, measureTexels, placeVertices, Triangles } from './layout';

// What was baked, in place of the distances: colours, or normals that the light falls on.
const kPaintedLook = `
  uniform sampler2D paint; // alpha 0: a texel without a match
  uniform int painted;
  uniform mat3 normalMatrix;
  vec3 lookHere(inout vec3 n) {
    if (painted == 0) return lookOfValue();
    if (byVertex) return vec3(0.72);
    ivec2 size = textureSize(paint, 0);
    if (texelFetch(paint, clamp(ivec2(floor(vPlace)), ivec2(0), size - 1), 0).a < 0.5) return noValue;
    vec3 here = texture(paint, vPlace / vec2(size)).rgb;
    if (painted == 1) return here;
    n = normalize(normalMatrix * (2.0 * here - 1.0));
    return vec3(0.78);
  }
`;

/// A texture of the texels of a map, four bytes each; alpha 0: a texel without a match.
export interface Paint {
  kind: 'colors' | 'normals';
  pixels: Uint8Array;
}

/// A surface whose vertices and distances change.
export class ChangingSurface extends Surface {
  painted: Paint | null = null; // in place of the distances
  private readonly sources: Int32Array;

  constructor(
    readonly layout: Layout,
    isClosed: boolean,
  ) {
    super(layout.model, layout.map, isClosed, '', null);
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

  protected override get lookShader(): string {
    return kPaintedLook;
  }
  protected override lookUniforms(): Uniforms {
    return { paint: { value: null }, painted: { value: 0 } };
  }

  /// Shows a texture in place of the distances; null: the distances.
  setPaint(paint: Paint | null): void {
    this.painted = paint;
    const { paint: texture, painted } = this.uniforms;
    (texture.value as DataTexture | null)?.dispose();
    texture.value = null;
    painted.value = paint === null ? 0 : paint.kind === 'colors' ? 1 : 2;
    if (!paint) return;
    const {
      map: { width, height },
      texelOf,
    } = this.layout;
    // Beside the charts, what has no owner is as where its value comes from.
    this.sources.forEach((source, i) => {
      const from = source < this.sources.length ? source : texelOf[source - this.sources.length];
      if (from >= 0 && from !== i) paint.pixels[4 * i + 3] = paint.pixels[4 * from + 3];
    });
    const made = new DataTexture(paint.pixels, width, height, RGBAFormat, UnsignedByteType);
    made.magFilter = made.minFilter = LinearFilter;
    made.needsUpdate = true;
    texture.value = made;
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
    this.setPaint(null);
  }
}

/// What is shown: one of two surfaces.
export class LiveSubject implements Subject {
  readonly object = new Group();
  readonly centre: Vec;
  readonly size: number;
  private shown: ChangingSurface;
  private scale: Scale | null = null;

  constructor(
    readonly coarse: ChangingSurface, // of the map while something moves
    readonly isClosed: boolean,
  ) {
    ({ centre: this.centre, size: this.size } = coarse);
    this.shown = coarse;
    this.object.add(coarse.object);
  }

  get surface(): ChangingSurface {
    return this.shown;
  }
  get uniforms(): Uniforms {
    return this.shown.uniforms;
  }
  get lo(): Vec {
    return boxOf(this.shown.layout.model.position).lo;
  }
  get hi(): Vec {
    return boxOf(this.shown.layout.model.position).hi;
  }

  show(surface: ChangingSurface): void {
    if (surface === this.shown) return;
    surface.uniforms.cut.value = this.shown.uniforms.cut.value;
    this.object.remove(this.shown.object);
    this.object.add(surface.object);
    this.shown = surface;
    if (this.scale) surface.setScale(this.scale);
  }

  /// What a section is made of: always of what is shown.
  get cuttable(): CutPart {
    const now = () => this.shown.layout;
    return {
      get position() {
        return now().model.position;
      },
      get triangle() {
        return now().model.triangle;
      },
      isClosed: this.isClosed,
      scaleAt: (_, scale) => scale,
      valueAt: (triangle, weights) => valueAt(now().model, now().map, { triangle, weights }).distance,
    };
  }

  setScale(scale: Scale): void {
    this.scale = scale;
    this.shown.setScale(scale);
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
