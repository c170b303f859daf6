// How meshes look: materials, textures, colours and normals of their files.
import { type Bytes } from './bytes.js';
import { type ReadMeshOptions, fileArguments } from './mesh_file.js';
import { type Module } from './module.js';
import { Owned } from './owned.js';
import { SdmError } from './types.js';

/** The pixels of a texture. */
export interface Picture {
  width: number;
  height: number;
  /** Red, green, blue and alpha of each pixel, row after row from the top, alpha not multiplied, as `ImageData` has them. */
  data: Uint8Array | Uint8ClampedArray;
}

/**
 * How the faces of a mesh file look: its materials, textures, colours of vertices and normals. Pictures are decoded by the caller: those
 * that setPicture() was not called for do not take part.
 */
export class Look extends Owned {
  readonly hasMaterials: boolean;
  readonly hasColors: boolean;
  readonly hasNormals: boolean;
  private readonly facts: { textures: string[]; notes: string[] };

  constructor(module: Module, bytes: Uint8Array | ArrayBuffer, name: string, options: ReadMeshOptions = {}) {
    const made = module.call<{
      address: number;
      hasMaterials: boolean;
      hasColors: boolean;
      hasNormals: boolean;
      facts: string;
    }>('sdm_read_look', fileArguments(module, 'readLook', bytes, name, options), options.progress);
    super(module, made.address, 'sdm_free_look');
    this.hasMaterials = made.hasMaterials;
    this.hasColors = made.hasColors;
    this.hasNormals = made.hasNormals;
    this.facts = JSON.parse(made.facts);
  }

  /** The names of the textures, and their files, in PNG, JPEG or WebP. */
  textures(): { name: string; bytes: Bytes }[] {
    return this.facts.textures.map((name, i) => ({
      name,
      bytes: this.module.call<{ bytes: Bytes }>('sdm_texture_file', [this.handle, i]).bytes,
    }));
  }
  /** What was left out or may be wrong, a sentence each. */
  notes(): string[] {
    return this.facts.notes;
  }

  /** Sets the pixels of a texture, by its number in textures(). */
  setPicture(texture: number, { width, height, data }: Picture): void {
    if (!(Number.isInteger(width) && Number.isInteger(height) && data.length === 4 * width * height))
      throw new SdmError(
        'input',
        `a picture of ${width} × ${height} pixels needs ${4 * width * height} numbers, not ${data.length}`,
      );
    const bytes =
      data instanceof Uint8Array ? data : new Uint8Array(data.buffer, data.byteOffset, data.length);
    this.module.call('sdm_set_picture', [this.handle, texture, width, height, bytes, bytes.length]);
  }
}
