// Meshes from files.
import { type Module } from './module.js';
import { type Progress, SdmError } from './types.js';

/** Names of faces, of one kind. */
export interface FaceNames {
  /** `object`, `group` or `material`. */
  kind: string;
  names: string[];
  /** For each face the number of its name; 4294967295: none. */
  ofFace: Uint32Array;
}

/** A mesh, and what its file says about it. */
export interface MeshFile {
  /** Three coordinates a vertex. */
  positions: Float64Array;
  /** Three vertices a face. */
  indices: Uint32Array;
  /** Texture coordinates of the corners, six numbers a face, (0, 0) at the lower left; null: not all corners have some. */
  cornerUvs: Float64Array | null;
  names: FaceNames[];
  /** What was left out or may be wrong, a sentence each. */
  notes: string[];
  /** XXH3 of the file, 16 hexadecimal digits, as it stands in reports. */
  xxh3: string;
}

export interface ReadMeshOptions {
  /** Contents of files that the file refers to, such as the .bin of glTF, by their paths relative to it. */
  files?: Record<string, Uint8Array | ArrayBuffer> | undefined;
  progress?: Progress | undefined;
}

const bytesOf = (data: Uint8Array | ArrayBuffer) =>
  data instanceof Uint8Array ? data : new Uint8Array(data);

/** Files one after the other, with their names and the lengths of both. */
function packed(
  files: Record<string, Uint8Array | ArrayBuffer>,
): [names: Uint8Array, contents: Uint8Array, lengths: Uint32Array] {
  const parts = Object.entries(files).map(
    ([name, data]) => [new TextEncoder().encode(name), bytesOf(data)] as const,
  );
  const join = (arrays: Uint8Array[]) => {
    const all = new Uint8Array(arrays.reduce((sum, array) => sum + array.length, 0));
    let at = 0;
    for (const array of arrays) {
      all.set(array, at);
      at += array.length;
    }
    return all;
  };
  return [
    join(parts.map(([name]) => name)),
    join(parts.map(([, data]) => data)),
    Uint32Array.from(parts.flatMap(([name, data]) => [name.length, data.length])),
  ];
}

/** @internal What the readers of the module take: a file, its name, and the files that it may refer to. */
export function fileArguments(
  module: Module,
  call: string,
  bytes: Uint8Array | ArrayBuffer,
  name: string,
  { files }: ReadMeshOptions,
) {
  if (!module.has('sdm_read_mesh'))
    throw new SdmError('input', `${call} needs the module of start({ full: true })`);
  const file = bytesOf(bytes);
  const [names, contents, lengths] = packed(files ?? {});
  return [file, file.length, name, names, contents, lengths, lengths.length / 2];
}

export function readMesh(
  module: Module,
  bytes: Uint8Array | ArrayBuffer,
  name: string,
  options: ReadMeshOptions,
): MeshFile {
  const { positions, indices, cornerUvs, facts, ofFaces } = module.call<{
    positions: Float64Array;
    indices: Uint32Array;
    cornerUvs?: Float64Array;
    facts: string;
    ofFaces?: Uint32Array[];
  }>('sdm_read_mesh', fileArguments(module, 'readMesh', bytes, name, options), options.progress);
  const said = JSON.parse(facts) as Pick<MeshFile, 'notes' | 'xxh3'> & { names: Omit<FaceNames, 'ofFace'>[] };
  return {
    positions,
    indices,
    cornerUvs: cornerUvs ?? null,
    names: said.names.map((kind, i) => ({ ...kind, ofFace: ofFaces![i]! })),
    notes: said.notes,
    xxh3: said.xxh3,
  };
}
