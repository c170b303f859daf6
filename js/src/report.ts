// Summaries and reports of maps, of the module `full`.
import { type Bytes } from './bytes.js';
import { type MeasureArguments } from './measures.js';
import { type Module } from './module.js';
import { type kColormapNames } from './rules.js';
import { type Progress, SdmError } from './types.js';

export type Colormap = (typeof kColormapNames)[number];

export interface SummaryOptions {
  /** The least and the largest distance allowed: the verdict PASS or FAIL is proven between the samples, too. */
  tolerance?: [least: number, largest: number];
  /** Of all lengths, such as `mm`. */
  units?: string;
  colormap?: Colormap;
  /** The distances at the ends of the colours. */
  range?: [number, number];
  /** The names of O1's and O2's files. */
  names?: [string, string];
  /** XXH3 of these files, as of MeshFile. */
  xxh3?: [string, string];
  /** That of the map: by default, of what it was computed with last. */
  maxDistance?: number;
  progress?: Progress;
}

export interface ReportOptions extends SummaryOptions {
  /** The axis of the meshes that points up. */
  up?: 'y' | 'z';
}

/** The keys of report.json, which docs/report.md of the project lists. */
export type MapSummary = { distance: Record<string, number>; [key: string]: unknown };

/** The addresses of a map, its surface and its sites, and the options by which it was computed. */
export type Computed = [map: number, surface: number, sites: number, ...MeasureArguments];

/** Two of a kind, or what stands for none. The module reads as many. */
function two<Value>(
  given: readonly Value[] | undefined,
  none: readonly [Value, Value],
  type: 'number' | 'string',
  option: string,
): readonly Value[] {
  if (given === undefined) return none;
  if (
    !Array.isArray(given) ||
    given.length !== 2 ||
    given.some((value) => typeof value !== type || Number.isNaN(value))
  )
    throw new SdmError('input', `${option} is ${JSON.stringify(given)}: it must be two ${type}s`);
  return given;
}

/** The numbers and words of the options, as the module takes them. */
function argumentsOf(module: Module, options: ReportOptions) {
  const none = [NaN, NaN] as const;
  const limits = [
    ...two(options.tolerance, none, 'number', 'tolerance'),
    ...two(options.range, none, 'number', 'range'),
  ];
  const words = JSON.stringify({
    units: options.units ?? '',
    names: two(options.names, ['O1', 'O2'], 'string', 'names'),
    xxh3: two(options.xxh3, ['', ''], 'string', 'xxh3'),
  });
  const colormap = module.number('colormap', options.colormap ?? 'automatic');
  return [...limits, options.maxDistance ?? NaN, colormap, module.number('up', options.up ?? 'y'), words];
}

function demandFull(module: Module, name: string): void {
  if (!module.has('sdm_map_summary'))
    throw new SdmError('input', `${name} needs the module of start({ full: true })`);
}

export function summaryOf(module: Module, map: Computed, options: SummaryOptions): MapSummary {
  demandFull(module, 'summary');
  const values = [...map, ...argumentsOf(module, options)];
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
      `the reportPage has no ${kDataPlace}: it must be the text of report_page.html`,
    );
  const { address, lengths, planes } = module.call<{ address: number; lengths: Uint32Array; planes: Bytes }>(
    'sdm_new_report',
    [...map(), ...argumentsOf(module, options)],
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
