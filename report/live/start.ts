// The library in a worker, from what the build has put into the page: no file is loaded.
import { createWorker, type SdmWorker } from 'sdm';
import { bytesOfBase85, inflated } from '../src/arrays';
import { byId } from '../src/dom';

/// A file that is in the page, packed.
async function embedded(id: string): Promise<Uint8Array<ArrayBuffer>> {
  const element = byId(id);
  const bytes = bytesOfBase85(element.textContent!.trim()).subarray(0, Number(element.dataset.bytes));
  element.textContent = ''; // its memory is needed for meshes
  return (await inflated(bytes)) as Uint8Array<ArrayBuffer>;
}

const textOf = async (id: string) => new TextDecoder().decode(await embedded(id));

export async function startWorker(): Promise<SdmWorker> {
  if (typeof WebAssembly !== 'object')
    throw new Error('this browser has no WebAssembly, or it is switched off');
  const [full, program, reportPage] = await Promise.all([
    embedded('sdm-module'),
    textOf('sdm-worker'),
    textOf('sdm-report'),
  ]);
  const script = URL.createObjectURL(new Blob([program], { type: 'text/javascript' }));
  return createWorker({ full: true, modules: { full }, script, reportPage });
}
