// The part with what was baked as its textures, as a GLB.
import type { BakedLook, BakedTexture, DrawnModel } from 'sdm';
import {
  BufferAttribute,
  BufferGeometry,
  DataTexture,
  DoubleSide,
  LinearFilter,
  LinearMipmapLinearFilter,
  Mesh,
  MeshStandardMaterial,
  NoColorSpace,
  RGBAFormat,
  SRGBColorSpace,
  UnsignedByteType,
} from 'three';
import { GLTFExporter } from 'three/addons/exporters/GLTFExporter.js';
import { metresOf } from './save';

/// As pictures of glTF are: four numbers a pixel.
function textureOf(
  { data, components }: Pick<BakedTexture, 'data' | 'components'>,
  width: number,
  isColor: boolean,
): DataTexture {
  const texels = data.length / components;
  const pixels = new Uint8Array(4 * texels).fill(255);
  for (let i = 0; i < texels; ++i)
    for (let k = 0; k < Math.max(3, components); ++k)
      pixels[4 * i + k] = data[components * i + (components < 3 ? 0 : k)];
  const texture = new DataTexture(pixels, width, texels / width, RGBAFormat, UnsignedByteType);
  texture.colorSpace = isColor ? SRGBColorSpace : NoColorSpace;
  texture.magFilter = LinearFilter;
  texture.minFilter = LinearMipmapLinearFilter;
  return texture;
}

function materialOf(look: BakedLook | null, normals: Uint8Array, width: number): MeshStandardMaterial {
  const material = new MeshStandardMaterial({ name: 'baked', side: DoubleSide, metalness: 0, roughness: 1 });
  material.normalMap = textureOf({ data: normals, components: 3 }, width, false);
  if (!look) return material;
  const { baseColor, emissive, metallic, roughness, alphaMode, alphaCutoff } = look.material;
  const [r, g, b, alpha] = baseColor;
  material.color.setRGB(r, g, b);
  material.opacity = alpha;
  material.emissive.setRGB(...emissive);
  [material.metalness, material.roughness] = [metallic, roughness];
  material.transparent = alphaMode === 'blend';
  material.alphaTest = alphaMode === 'mask' ? alphaCutoff : 0;
  // A texture contains its factor.
  const use: Record<BakedTexture['channel'], (texture: BakedTexture) => void> = {
    base_color: (baked) => {
      material.map = textureOf(baked, width, true);
      material.color.setRGB(1, 1, 1);
      material.opacity = 1;
    },
    metallic_roughness: (baked) => {
      material.metalnessMap = material.roughnessMap = textureOf(baked, width, false);
      material.metalness = material.roughness = 1;
    },
    occlusion: (baked) => (material.aoMap = textureOf(baked, width, false)),
    emissive: (baked) => {
      material.emissiveMap = textureOf(baked, width, true);
      material.emissive.setRGB(1, 1, 1);
    },
  };
  for (const baked of look.textures) use[baked.channel](baked);
  return material;
}

/// glTF has y up, and metres.
export async function bakedGlb(
  model: DrawnModel,
  look: BakedLook | null,
  normals: Uint8Array,
  width: number,
  up: 'y' | 'z',
  units: string,
): Promise<ArrayBuffer> {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(model.positions, 3));
  geometry.setAttribute('normal', new BufferAttribute(model.normals, 3));
  geometry.setAttribute('uv', new BufferAttribute(model.uvs, 2));
  geometry.setAttribute('tangent', new BufferAttribute(model.tangents!, 4));
  geometry.setIndex(new BufferAttribute(model.indices, 1));
  const mesh = new Mesh(geometry, materialOf(look, normals, width));
  mesh.name = 'part';
  mesh.scale.setScalar(metresOf(units));
  const [x, y, z] = model.origin;
  mesh.position
    .set(...(up === 'z' ? ([x, z, -y] as const) : ([x, y, z] as const)))
    .multiplyScalar(metresOf(units));
  if (up === 'z') mesh.rotation.x = -Math.PI / 2;
  return (await new GLTFExporter().parseAsync(mesh, { binary: true })) as ArrayBuffer;
}
