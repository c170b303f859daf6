// Meshes from files.
import { float64, text, uint32 } from './bytes.js';
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
  files?: Record<string, Uint8Array | ArrayBuffer>;
  progress?: Progress;
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
  const path = new TextEncoder().encode(name);
  const [names, contents, lengths] = packed(files ?? {});
  return [file, file.length, path, path.length, names, contents, lengths, lengths.length / 2];
}

export function readMesh(
  module: Module,
  bytes: Uint8Array | ArrayBuffer,
  name: string,
  options: ReadMeshOptions,
): MeshFile {
  const [positions, indices, uvs, facts, ...ofFaces] = module.call(
    'sdm_read_mesh',
    fileArguments(module, 'readMesh', bytes, name, options),
    options.progress,
  );
  const said = JSON.parse(text(facts!)) as {
    names: { kind: string; names: string[] }[];
    notes: string[];
    xxh3: string;
  };
  return {
    positions: float64(positions!),
    indices: uint32(indices!),
    cornerUvs: uvs!.length > 0 ? float64(uvs!) : null,
    names: said.names.map(({ kind, names: words }, i) => ({
      kind,
      names: words,
      ofFace: uint32(ofFaces[i]!),
    })),
    notes: said.notes,
    xxh3: said.xxh3,
  };
}
