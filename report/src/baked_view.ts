// A coarse mesh with its textures and a detailed one, in two parts of one picture, under one camera.
import {
  BufferAttribute,
  BufferGeometry,
  ClampToEdgeWrapping,
  DoubleSide,
  LinearFilter,
  LinearMipmapLinearFilter,
  Mesh,
  NoColorSpace,
  ShaderMaterial,
  SRGBColorSpace,
  Texture,
  WebGLRenderer,
} from 'three';
import type { BakedData, Shape } from './baked_data';
import { CoarseWhileMoving } from './coarse_copy';
import { Viewer } from './viewer';

export type Shading = 'lit' | 'colours' | 'shape';
const kShadings: Shading[] = ['lit', 'colours', 'shape'];

const kVertexShader = `
  in vec2 place;
  in vec4 tangent, paint, surface;
  out vec3 vNormal, vTangent, vPaint, vFromEye;
  out vec2 vPlace, vSurface;
  out float vSign;
  vec3 linearOf(vec3 srgb) {
    return mix(pow((srgb + 0.055) / 1.055, vec3(2.4)), srgb / 12.92, lessThanEqual(srgb, vec3(0.04045)));
  }
  void main() {
    vNormal = normalMatrix * normal;
    vTangent = normalMatrix * tangent.xyz;
    vSign = tangent.w;
    vPaint = linearOf(paint.rgb);
    vPlace = place;
    vSurface = surface.yz;
    vec4 fromEye = modelViewMatrix * vec4(position, 1.0);
    vFromEye = fromEye.xyz;
    gl_Position = projectionMatrix * fromEye;
  }
`;

// glTF's material (appendix B) in the light of a lamp beside the camera and of the surroundings, with the fit of Karis, "Physically
// Based Shading on Mobile", for the light that is reflected from the surroundings.
const kShader = `
  precision highp float;
  uniform int shading;
  uniform bool painted, hasColors, hasNormals, hasOcclusion, hasEmission, hasSurface;
  uniform sampler2D colors, normals, occlusion, emission, surfaces;
  uniform vec4 baseColor;
  uniform vec3 emissive;
  uniform vec2 roughMetal;
  uniform float cutoff;
  in vec3 vNormal, vTangent, vPaint, vFromEye;
  in vec2 vPlace, vSurface;
  in float vSign;
  out vec4 outColor;
  const float kLamp = 0.7, kSurroundings = 0.42;
  vec3 srgbOf(vec3 light) {
    light = clamp(light, 0.0, 1.0);
    return mix(1.055 * pow(light, vec3(1.0 / 2.4)) - 0.055, 12.92 * light, lessThanEqual(light, vec3(0.0031308)));
  }
  // What a surface mirrors of a bright sky above a darker ground; the rougher it is, the more of both at once.
  float mirrored(vec3 direction, float roughness) {
    float blurred = 0.75 + 0.25 * direction.y;
    float sharp = 0.2 + 1.5 * smoothstep(-0.2, 0.35, direction.y);
    return kSurroundings * mix(sharp, blurred, sqrt(roughness));
  }
  vec3 glossOf(vec3 f0, float roughness, float ambient, vec3 n, vec3 eye, vec3 lamp) {
    float nv = max(dot(n, eye), 1e-3), nl = max(dot(n, lamp), 0.0);
    vec3 between = normalize(eye + lamp);
    float a2 = pow(max(roughness, 0.08), 4.0), nh = dot(n, between), d = nh * nh * (a2 - 1.0) + 1.0;
    float visible = 0.5 / max(nl * sqrt(nv * nv * (1.0 - a2) + a2) + nv * sqrt(nl * nl * (1.0 - a2) + a2), 1e-4);
    vec3 fresnel = f0 + (1.0 - f0) * pow(1.0 - max(dot(eye, between), 0.0), 5.0);
    vec4 r = roughness * vec4(-1.0, -0.0275, -0.572, 0.022) + vec4(1.0, 0.0425, 1.04, -0.04);
    float fit = min(r.x * r.x, exp2(-9.28 * nv)) * r.x + r.y;
    vec3 share = f0 * (-1.04 * fit + r.z) + 1.04 * fit + r.w;
    return kLamp * nl * a2 / (d * d) * visible * fresnel + ambient * mirrored(reflect(-eye, n), roughness) * share;
  }
  void main() {
    vec4 color = painted ? vec4(vPaint, 1.0) : hasColors ? texture(colors, vPlace) : baseColor;
    if (color.a < cutoff) discard;
    vec3 n = vNormal;
    if (hasNormals) {
      vec3 m = 2.0 * texture(normals, vPlace).xyz - 1.0;
      n = m.x * vTangent + m.y * vSign * cross(vNormal, vTangent) + m.z * vNormal;
    }
    n = normalize(n) * (gl_FrontFacing ? 1.0 : -1.0);
    vec3 lamp = normalize(vec3(0.35, 0.5, 0.8));
    float ambient = hasOcclusion ? texture(occlusion, vPlace).r : 1.0;
    float light = kSurroundings * ambient * (0.75 + 0.25 * n.y) + kLamp * max(0.0, dot(n, lamp));
    vec2 surface = !hasSurface ? roughMetal : painted ? vSurface : texture(surfaces, vPlace).gb;
    if (shading == 2) color.rgb = vec3(0.55);
    vec3 seen = shading == 1 ? color.rgb : light * color.rgb;
    if (shading == 0) {
      vec3 eye = isOrthographic ? vec3(0.0, 0.0, 1.0) : normalize(-vFromEye);
      seen *= 1.0 - surface.y;
      // What is rough and no metal is matt, and costs nothing more.
      float gloss = min(1.0, 4.0 * (1.0 - surface.x) + surface.y);
      if (gloss > 0.0) seen += gloss * glossOf(mix(vec3(0.04), color.rgb, surface.y), surface.x, ambient, n, eye, lamp);
      if (!painted) seen += hasEmission ? texture(emission, vPlace).rgb : emissive;
    }
    outColor = vec4(srgbOf(seen), 1.0);
  }
`;

const kEdgeShader = `
  precision highp float;
  out vec4 outColor;
  void main() { outColor = vec4(0.05, 0.1, 0.16, 1.0); }
`;

const kCoarse = 40_000; // triangles of the detailed mesh, while something moves

function textureOf(picture: ImageBitmap | undefined, isColor: boolean): Texture | null {
  if (!picture) return null;
  const texture = new Texture(picture);
  texture.colorSpace = isColor ? SRGBColorSpace : NoColorSpace;
  texture.flipY = false;
  texture.wrapS = texture.wrapT = ClampToEdgeWrapping;
  texture.magFilter = LinearFilter;
  texture.minFilter = LinearMipmapLinearFilter;
  texture.anisotropy = 4;
  texture.needsUpdate = true;
  return texture;
}

function geometryOf(shape: Shape): BufferGeometry {
  const geometry = new BufferGeometry();
  const vertices = shape.position.length / 3;
  geometry.setAttribute('position', new BufferAttribute(shape.position, 3));
  geometry.setAttribute('normal', new BufferAttribute(shape.normal, 3, true));
  geometry.setAttribute('place', new BufferAttribute(shape.place ?? new Float32Array(2 * vertices), 2));
  geometry.setAttribute('tangent', new BufferAttribute(shape.tangent ?? new Float32Array(4 * vertices), 4));
  geometry.setAttribute(
    'surface',
    new BufferAttribute(shape.surface ?? new Uint8Array(4 * vertices), 4, true),
  );
  geometry.setAttribute('paint', new BufferAttribute(shape.color ?? new Uint8Array(4 * vertices), 4, true));
  geometry.setIndex(new BufferAttribute(shape.triangle, 1));
  return geometry;
}

export class BakedView extends Viewer {
  private readonly low: Mesh;
  private readonly high: Mesh;
  private readonly edges: Mesh;
  private readonly coarse: CoarseWhileMoving;
  private share = 0.5; // of the width, from the left: the coarse mesh
  private beside = false; // both whole, each in half of the width

  constructor(container: HTMLElement, data: BakedData, onChange: () => void) {
    super(container, data.page.up, onChange);
    this.low = this.makeMesh(data, data.low, false);
    this.high = this.makeMesh(data, data.high, true);
    this.edges = new Mesh(
      this.low.geometry,
      new ShaderMaterial({
        glslVersion: '300 es',
        vertexShader: kVertexShader,
        fragmentShader: kEdgeShader,
        wireframe: true,
      }),
    );
    this.edges.visible = false;
    this.edges.frustumCulled = false;
    this.low.add(this.edges);
    this.scene.add(this.low, this.high);
    this.coarse = new CoarseWhileMoving(this.high, kCoarse);
    this.setShown(data.lo, data.hi);
    this.look('corner');
  }

  private makeMesh({ page, pictures }: BakedData, shape: Shape, painted: boolean): Mesh {
    const texture = (name: string, isColor = false) =>
      painted ? null : textureOf(pictures.get(name), isColor);
    const [colors, normals, occlusion] = [
      texture('base_color', true),
      texture('normal'),
      texture('occlusion'),
    ];
    const [emission, surfaces] = [texture('emissive', true), texture('metallic_roughness')];
    const material = new ShaderMaterial({
      glslVersion: '300 es',
      vertexShader: kVertexShader,
      fragmentShader: kShader,
      side: DoubleSide,
      polygonOffset: true, // behind the edges
      polygonOffsetFactor: 1,
      polygonOffsetUnits: 1,
      uniforms: {
        shading: { value: 0 },
        painted: { value: painted },
        hasColors: { value: colors !== null },
        hasNormals: { value: normals !== null && shape.tangent !== null },
        hasOcclusion: { value: occlusion !== null },
        hasEmission: { value: emission !== null },
        hasSurface: { value: surfaces !== null || shape.surface !== null },
        colors: { value: colors },
        normals: { value: normals },
        occlusion: { value: occlusion },
        emission: { value: emission },
        surfaces: { value: surfaces },
        roughMetal: { value: painted ? [1, 0] : [page.roughness, page.metallic] },
        baseColor: { value: page.base_color },
        emissive: { value: page.emissive },
        cutoff: {
          value: painted || page.alpha_mode === 0 ? -1 : page.alpha_mode === 1 ? page.alpha_cutoff : 0.02,
        },
      },
    });
    const mesh = new Mesh(geometryOf(shape), material);
    mesh.frustumCulled = false;
    return mesh;
  }

  protected override setCoarse(coarse: boolean): void {
    this.coarse.show(coarse);
  }

  protected override setAspect(): void {
    super.setAspect(this.beside ? 2 : 1);
  }

  protected override paint(renderer: WebGLRenderer): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const middle = Math.round(width * (this.beside ? 0.5 : this.share));
    renderer.setScissorTest(true);
    for (const isLow of [true, false]) {
      const [from, to] = isLow ? [0, middle] : [middle, width];
      if (from === to) continue;
      this.low.visible = isLow;
      this.high.visible = !isLow;
      renderer.setScissor(from, 0, to - from, height);
      if (this.beside) renderer.setViewport(from, 0, to - from, height);
      renderer.render(this.scene, this.camera);
    }
    renderer.setScissorTest(false);
    renderer.setViewport(0, 0, width, height);
  }

  setShare(share: number): void {
    this.share = share;
    this.draw();
  }

  setBeside(beside: boolean): void {
    const before = this.toFit(1);
    this.beside = beside;
    this.controls.zoomToCursor = !beside; // which is of a picture as wide as the canvas
    this.setAspect();
    this.zoom(this.toFit(1) / before);
  }

  setShading(shading: Shading): void {
    for (const mesh of [this.low, this.high])
      (mesh.material as ShaderMaterial).uniforms.shading.value = kShadings.indexOf(shading);
    this.draw();
  }

  setEdges(visible: boolean): void {
    this.edges.visible = visible;
    this.draw();
  }
}
