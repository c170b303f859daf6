// Summaries and reports of maps, of the module `full`.
import { type Bytes } from './bytes.js';
import type * as declared from './declared.js';
import { declaredOptions } from './given.js';
import { type MeasureArguments } from './measures.js';
import { type Module } from './module.js';
import { type MapSummary } from './summary.js';
import { type Progress, SdmError } from './types.js';

export interface SummaryOptions extends declared.SummaryOptions {
  /** The names of O1's and O2's files. */
  names?: [string, string] | undefined;
  /** XXH3 of these files, as of MeshFile. */
  xxh3?: [string, string] | undefined;
  progress?: Progress | undefined;
}

export interface JudgedOptions extends SummaryOptions {
  tolerance: NonNullable<SummaryOptions['tolerance']>;
}

export interface ReportOptions extends SummaryOptions, declared.PageOptions {}

/** The addresses of a map, its surface and its sites, and the options by which it was computed. */
export type Computed = [map: number, surface: number, sites: number, ...MeasureArguments];

/** The options and the files of the meshes, as the module takes them. */
function argumentsOf({ names = ['O1', 'O2'], xxh3 = ['', ''], ...given }: ReportOptions) {
  return [...declaredOptions(given), JSON.stringify({ names, xxh3 })];
}

function demandFull(module: Module, name: string): void {
  if (!module.has('sdm_map_summary'))
    throw new SdmError('input', `${name} needs the module of start({ full: true })`);
}

export function summaryOf(module: Module, map: Computed, options: SummaryOptions): MapSummary {
  demandFull(module, 'summary');
  const values = [...map, ...argumentsOf(options)];
  return JSON.parse(module.call<{ json: string }>('sdm_map_summary', values, options.progress).json);
}

/** A stream of deflate: that of zlib without its header and its checksum, as older engines know no other. */
async function deflated(bytes: Bytes): Promise<Bytes> {
  const stream = new Blob([bytes]).stream().pipeThrough(new CompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer()).slice(2, -4);
}

const kDataPlace = '<!-- data -->'; // of the page, as src/io/page/report/page_file.cpp looks for it

/** `map`: called once nothing has to be waited for any more, as the objects may be disposed of meanwhile. */
export async function reportOf(module: Module, map: () => Computed, options: ReportOptions): Promise<string> {
  demandFull(module, 'report');
  const html = await module.reportPage!();
  if (!html.includes(kDataPlace))
    throw new SdmError(
      'input',
      `the reportPage has no ${kDataPlace}: it must be the text of report_page.txt`,
    );
  const { address, lengths, planes } = module.call<{ address: number; lengths: Uint32Array; planes: Bytes }>(
    'sdm_new_report',
    [...map(), ...argumentsOf(options)],
    options.progress,
  );
  try {
    let at = 0;
    const compressed = await Promise.all(
      Array.from(lengths, (length) => {
        const plane = planes.slice(at, at + length);
        at += length;
        return length > 0 ? deflated(plane) : plane;
      }),
    );
    const sizes = Uint32Array.from(compressed, (plane) => plane.length);
    const all = new Uint8Array(await new Blob(compressed).arrayBuffer());
    const values = [address, all, sizes, sizes.length, html];
    return module.call<{ html: string }>('sdm_finish_report', values).html;
  } finally {
    module.free('sdm_free_report', address);
  }
}
