// Files of meshes, dropped or chosen.
import type { SdmWorker } from 'sdm';
import { make } from '../src/dom';
import { type Body, Film } from './body';

const kLargest = 512 * 2 ** 20; // bytes: more than a module of 32 bits can read and measure
const kMostTriangles = 5_000_000;
export const kFormats = '.stl,.ply,.obj,.off,.3ds,.glb,.gltf';

/// A mesh of a file, with a note on what of it cannot be played; or an error of one sentence.
export async function readBody(worker: SdmWorker, file: File): Promise<{ body: Body; note: string }> {
  if (file.size === 0) throw new Error(`${file.name} is empty.`);
  if (file.size > kLargest)
    throw new Error(
      `${file.name} has ${Math.round(file.size / 2 ** 20)} MB, more than the ${kLargest / 2 ** 20} MB that this page can read; use the command sdm for it.`,
    );
  const { film, note } = await filmOf(worker, file);
  const { positions, indices } = film
    ? await film.mesh()
    : await worker.readMesh(new Uint8Array(await file.arrayBuffer()), file.name, { transfer: true });
  if (indices.length === 0) throw new Error(`${file.name} has no triangles.`);
  if (indices.length > 3 * kMostTriangles)
    throw new Error(
      `${file.name} has ${indices.length / 3} triangles, more than the ${kMostTriangles} that this page can measure; use the command sdm for it.`,
    );
  return { body: { name: file.name, positions, indices, file, ...(film ? { film } : {}) }, note };
}

/// What an animated glTF plays. An animation that cannot be played is a note.
async function filmOf(worker: SdmWorker, file: File): Promise<{ film: Film | null; note: string }> {
  if (!/\.(glb|gltf)$/i.test(file.name)) return { film: null, note: '' };
  try {
    return { film: await Film.of(worker, file), note: '' };
  } catch (error) {
    // A file that is damaged is refused by readMesh(), too.
    if ((error as { kind?: string }).kind !== 'input') throw error;
    return { film: null, note: (error as Error).message };
  }
}

/// A button that chooses a file, or several.
export function fileButton(
  id: string,
  label: string,
  multiple: boolean,
  chosen: (files: File[]) => void,
): HTMLElement {
  const input = make('input', {
    type: 'file',
    id,
    multiple,
    accept: kFormats,
    class: 'hidden',
    change: () => {
      const files = [...(input.files ?? [])];
      input.value = ''; // so that the same file can be chosen again
      if (files.length > 0) chosen(files);
    },
  });
  return make('label', { class: 'file', for: id }, input, label);
}

/// Calls back with files dropped anywhere on the page.
export function listenToDrops(dropped: (files: File[]) => void): void {
  const over = (on: boolean) => document.body.classList.toggle('drop', on);
  const hasFiles = (event: DragEvent) => event.dataTransfer?.types.includes('Files') ?? false;
  document.addEventListener('dragover', (event) => {
    if (!hasFiles(event)) return;
    event.preventDefault();
    over(true);
  });
  document.addEventListener('dragleave', (event) => event.relatedTarget === null && over(false));
  document.addEventListener('drop', (event) => {
    if (!hasFiles(event)) return;
    event.preventDefault();
    over(false);
    dropped([...event.dataTransfer!.files]);
  });
}
