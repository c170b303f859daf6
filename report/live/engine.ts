// What is computed for the page, in a worker: the map of the part to the reference, coarse while something moves and fine at
// rest, and the separation of both.
import type {
  Atlas,
  MatchOptions,
  SdmWorker,
  WorkerMap,
  WorkerMapOptions,
  WorkerMatches,
  WorkerPair,
  WorkerSites,
  WorkerSurface,
} from 'sdm';
import { Matrix4 } from 'three';
import type { Report } from '../src/page_data';
import type { Body } from './body';
import { isClosed, type Triangles } from './layout';
import { isIdentity, moved } from './placing';

export const kCoarse = 256; // texels a side while something moves

/// The map of one frame, while a body moves.
export interface FrameResult {
  distances: Float32Array;
  separation: number;
  milliseconds: number; ///< that it took to compute
}

/// The map at full size, once nothing moves.
export interface FineResult extends Omit<FrameResult, 'separation'> {
  atVertices: Float64Array | null; ///< null: those of the texels
  sites: Uint32Array; ///< 4 · number + type of each texel, 0xFFFFFFFF without one
  report: Report;
}

interface Measured {
  surface: WorkerSurface;
  map: WorkerMap;
  atlas: Atlas;
}

/// Says what is going on, such as "Laying out the atlas", and how far it is.
export type Say = (step: string, fraction: number) => void;

export class Engine {
  private sites: WorkerSites | null = null;
  private pair: WorkerPair | null = null;
  private coarse: Measured | null = null;
  private fine: Measured | null = null;
  private closed: [boolean, boolean] = [false, false];
  private bodies: [Body, Body] | null = null;
  private motion = new Matrix4(); // of the reference
  private placed = new Matrix4(); // the motion that the sites have; the coarse surface makes up for the difference
  private turned = false; // the fine surface has other vertices than the part
  private changed = false; // the bodies are not those that were loaded
  private facing: number | undefined; // degrees: distances are to faces that face the same way
  private signal: AbortSignal | undefined; // of what is being loaded

  constructor(private readonly worker: SdmWorker) {}

  get isClosed(): boolean {
    return this.closed[0];
  }
  get referenceIsClosed(): boolean {
    return this.closed[1];
  }
  get deformed(): boolean {
    return this.changed;
  }

  /// Distances are to the closest of the faces whose normal is within an angle of the part's; null: to the closest point.
  setFacing(degrees: number | null): void {
    this.facing = degrees ?? undefined;
  }

  /// Takes two bodies, and lays out the coarse atlas of the first. An abort loses what was there before.
  async load(bodies: [Body, Body], say: Say, signal?: AbortSignal): Promise<Atlas> {
    const [part, reference] = bodies;
    this.signal = signal;
    const sites = await this.sitesOf(reference, 'Reading the reference', say);
    // What there is stays until nothing can fail any more.
    const coarse = await this.measured(part, sites, kCoarse, say).catch((error: Error) => {
      sites.dispose();
      throw named(error, part);
    });
    const pair = await this.worker.pair(shapeOf(part), shapeOf(reference)).catch((error: Error) => {
      this.release(coarse);
      sites.dispose();
      throw error;
    });
    this.free();
    [this.bodies, this.sites, this.pair, this.coarse] = [bodies, sites, pair, coarse];
    this.closed = [isClosed(part), sites.closed];
    this.motion = new Matrix4();
    this.placed = new Matrix4();
    this.turned = this.changed = false;
    return coarse.atlas;
  }

  /// The factor by which the part fits the reference, where both are as loaded; null: as it is.
  async otherUnit(): Promise<number | null> {
    const unit = await this.worker.unitCheck(shapeOf(this.bodies![0]), this.sites!, { signal: this.signal });
    return unit?.factor ?? null;
  }

  private sitesOf(body: Body, step: string, say: Say): Promise<WorkerSites> {
    return this.worker
      .sites(body.positions, body.indices, { signal: this.signal, progress: (_, f) => say(step, f) })
      .catch((error: Error) => {
        throw named(error, body);
      });
  }

  private async measured(part: Body, sites: WorkerSites, resolution: number, say: Say): Promise<Measured> {
    const surface = await this.worker.surface(part.positions, part.indices, {
      resolution,
      signal: this.signal,
      progress: (_, f) => say('Laying out the atlas', f),
    });
    try {
      const map = await surface.map(sites, {
        ...this.matching,
        signal: this.signal,
        progress: (_, f) => say('Measuring', f),
      });
      return { surface, map, atlas: await surface.atlas() };
    } catch (error) {
      surface.dispose();
      throw error;
    }
  }

  private get matching(): WorkerMapOptions {
    return { engine: 'auto', facing: this.facing };
  }

  /// Lays out the fine atlas; null if that is the coarse one.
  async refine(resolution: number, say: Say, signal?: AbortSignal): Promise<Atlas | null> {
    this.signal = signal;
    if (this.fine) this.release(this.fine);
    this.fine = null;
    if (resolution <= kCoarse) return null;
    await this.settle();
    this.fine = await this.measured(this.bodies![0], this.sites!, resolution, say);
    return this.fine.atlas;
  }

  /// Moves the reference rigidly: a matrix in the units of the files. It is the coarse surface that moves the other way, as to
  /// refit a surface takes a small part of the time that sites take.
  async place(motion: Matrix4): Promise<void> {
    this.motion = motion.clone();
    const back = this.placed.clone().multiply(motion.clone().invert());
    await Promise.all([
      this.coarse!.surface.refit(moved(this.bodies![0].positions, back)),
      this.pair!.setPose(1, motion.elements),
    ]);
  }

  /// Moves the sites to where place() has moved the reference, and the coarse surface back.
  private async settle(): Promise<void> {
    if (this.placed.equals(this.motion)) return;
    this.placed = this.motion.clone();
    const [part, reference] = this.bodies!;
    await Promise.all([
      this.sites!.refit(moved(reference.positions, this.motion)),
      this.coarse!.surface.refit(part.positions),
    ]);
  }

  /// Moves the vertices of both bodies.
  async deform(positions: [Float64Array, Float64Array]): Promise<void> {
    const [part, reference] = this.bodies!;
    part.positions = positions[0];
    reference.positions = positions[1];
    this.placed = this.motion.clone();
    this.turned = this.changed = true;
    await Promise.all([
      this.sites!.refit(moved(reference.positions, this.placed)),
      this.coarse!.surface.refit(part.positions),
      this.pair!.refit(0, part.positions),
      this.pair!.refit(1, reference.positions),
      this.pair!.setPose(1, this.motion.elements),
    ]);
  }

  /// The coarse map, and the separation, after `change`.
  async frame(change: Promise<void>, began = performance.now()): Promise<FrameResult> {
    const { map } = this.coarse!;
    const [, , arrays, separation] = await Promise.all([
      change,
      map.update(this.matching),
      map.arrays('distances'),
      this.pair!.separation(),
    ]);
    return {
      distances: arrays.distances!,
      separation: separation.value,
      milliseconds: performance.now() - began,
    };
  }

  /// The fine map with its report.
  async atRest(tolerance: [number, number] | null, units: string, say: Say): Promise<FineResult> {
    const began = performance.now();
    const measured = this.fine ?? this.coarse!;
    const [part] = this.bodies!;
    await this.settle();
    if (this.turned && this.fine) await this.fine.surface.refit(part.positions);
    this.turned = false;
    await measured.map.update({ ...this.matching, progress: (_, f) => say('Measuring', f) });
    const milliseconds = performance.now() - began;
    const [arrays, atVertices] = await Promise.all([
      measured.map.arrays('distances', 'sitesOfTexels', 'siteTypes'),
      this.facing === undefined
        ? this.sites!.signedDistance(part.positions, { sign: measured.map.sign })
        : null,
    ]);
    const report = await this.report(tolerance, units);
    const sites = arrays.sitesOfTexels!.map((n, i) =>
      arrays.siteTypes![i] > 2 || n >= 2 ** 30 ? 0xffffffff : (n << 2) | arrays.siteTypes![i],
    );
    return {
      distances: arrays.distances!,
      atVertices: atVertices?.distances ?? null,
      sites,
      milliseconds,
      report,
    };
  }

  /// The point of the reference that belongs to each texel of the fine map.
  async match(options: MatchOptions): Promise<WorkerMatches> {
    await this.settle();
    return this.worker.match((this.fine ?? this.coarse!).surface, this.sites!, options);
  }

  /// Sums up the fine map, as report.json does.
  async report(tolerance: [number, number] | null, units: string): Promise<Report> {
    const { map } = this.fine ?? this.coarse!;
    const report = { ...(await map.summary({ units, tolerance: tolerance ?? undefined })) } as Report;
    for (const [key, { name }] of [
      ['o1', this.bodies![0]],
      ['o2', this.bodies![1]],
    ] as const)
      report[key] = { ...report[key]!, file: name };
    if (!isIdentity(this.motion)) report.o2!.transform = 'the handles';
    return report;
  }

  /// The text of report.html.
  html(tolerance: [number, number] | null, units: string, up: 'y' | 'z'): Promise<string> {
    const names = this.bodies!.map(({ name }) => name) as [string, string];
    return (this.fine ?? this.coarse!).map.report({ units, names, up, ...(tolerance ? { tolerance } : {}) });
  }

  private release({ surface, map }: Measured): void {
    map.dispose();
    surface.dispose();
  }

  private free(): void {
    for (const measured of [this.coarse, this.fine]) if (measured) this.release(measured);
    this.sites?.dispose();
    this.pair?.dispose();
    [this.coarse, this.fine, this.sites, this.pair] = [null, null, null, null];
  }
}

/// What the worker needs of a body.
const shapeOf = ({ positions, indices }: Body): Triangles => ({ positions, indices });

/// An error that names the body, unless it is not of it.
function named(error: Error, { name }: Body): Error {
  const isOfWorker = error.name === 'AbortError' || (error as { kind?: string }).kind === 'ended';
  return isOfWorker || error.message.includes(name) ? error : new Error(`${name}: ${error.message}`);
}
