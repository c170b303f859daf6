// Objects in a worker: sites, surfaces, maps and pairs.
import { type Bytes } from './bytes.js';
import { type CallOptions, type Connection, type Made, type Options, Remote } from './connection.js';
import { type JudgedOptions, type ReportOptions, type SummaryOptions } from './report.js';
import { type JudgedSummary, type MapSummary } from './summary.js';
import { type Contacts } from './pair.js';
import {
  type ClosestPointOptions,
  type ClosestPoints,
  type Hausdorff,
  type HausdorffOptions,
  type RayOptions,
  type RayHits,
  type SignedDistanceOptions,
  type SignedDistances,
} from './sites.js';
import { type MapOptions } from './measures.js';
import { type Atlas } from './surface.js';
import { type TransferOptions } from './transfer.js';
import {
  type BoundedLength,
  type EngineChoice,
  type MapStatistics,
  type MapValues,
  type Points,
  type SignMethod,
} from './types.js';

/** Those of MapOptions, with the engine. */
export type WorkerMapOptions = Options<MapOptions> & { engine?: EngineChoice | undefined };

/** Sites in a worker. */
export class WorkerSites extends Remote {
  readonly closed: boolean;
  readonly orientable: boolean;

  /** @internal */
  constructor(connection: Connection, made: Made) {
    super(connection, made);
    const { fields } = made;
    [this.closed, this.orientable] = [fields['closed'] as boolean, fields['orientable'] as boolean];
  }
  refit(positions: Points, options?: CallOptions): Promise<void> {
    return this.call('refit', [positions], options);
  }
  /** As of Sites, with the same errors. */
  closestPoints(points: Points, options?: Options<ClosestPointOptions>): Promise<ClosestPoints> {
    return this.call('closestPoints', [points], options);
  }
  signedDistance(points: Points, options?: Options<SignedDistanceOptions>): Promise<SignedDistances> {
    return this.call('signedDistance', [points], options);
  }
  firstHits(origins: Points, directions: Points, options?: Options<RayOptions>): Promise<RayHits> {
    return this.call('firstHits', [origins, directions], options);
  }
  hausdorff(other: WorkerSites, options?: Options<HausdorffOptions>): Promise<Hausdorff> {
    return this.call('hausdorff', [other], options);
  }
}

/** A surface in a worker. */
export class WorkerSurface extends Remote {
  refit(positions: Points, options?: CallOptions): Promise<void> {
    return this.call('refit', [positions], options);
  }
  atlas(): Promise<Atlas> {
    return this.call('atlas', []);
  }
  storedAtlas(): Promise<Bytes> {
    return this.call('storedAtlas', []);
  }
  samples(): Promise<{ texels: Uint32Array; points: Float64Array }> {
    return this.call('samples', []);
  }
  sampleCounts(): Promise<{ samples: number; grain: number }> {
    return this.call('sampleCounts', []);
  }
  /** The surface distance map. It stays in the worker, until its arrays() are asked for. */
  async map(sites: WorkerSites, options?: WorkerMapOptions): Promise<WorkerMap> {
    return new WorkerMap(this.connection, await this.call('map', [sites], options), this, sites);
  }
  /** A map without values, for computeSamples(). */
  async emptyMap(sites: WorkerSites): Promise<WorkerMap> {
    return new WorkerMap(this.connection, await this.call('emptyMap', [sites]), this, sites);
  }
}

type ArrayName = keyof MapValues;

/** A map in a worker. */
export class WorkerMap extends Remote {
  readonly resolution: number;
  readonly rows: number;
  /** Of what was computed last. */
  sign: SignMethod;
  signReason: string;
  engine: 'cpu' | 'gpu';

  /** @internal Keeps the surface and the sites from being collected before it. */
  constructor(
    connection: Connection,
    made: Made,
    /** @internal */ readonly surface: WorkerSurface,
    /** @internal */ readonly sites: WorkerSites,
  ) {
    super(connection, made);
    const { fields } = made;
    [this.resolution, this.rows] = [fields['resolution'] as number, fields['rows'] as number];
    [this.sign, this.signReason] = [fields['sign'] as SignMethod, fields['signReason'] as string];
    this.engine = fields['engine'] as 'cpu' | 'gpu';
  }
  /** Copies of the arrays that are named, as of DistanceMap. */
  arrays<Name extends ArrayName>(...names: Name[]): Promise<Pick<MapValues, Name>> {
    return this.call('arrays', names);
  }
  /** Computes it again, after refit() of the surface or the sites; takes no more memory. */
  async update(options?: WorkerMapOptions): Promise<void> {
    Object.assign(this, await this.call('update', [], options));
  }
  /** As of DistanceMap. Returns what `sign` and `signReason` then are. */
  async computeSamples(
    first: number,
    count: number,
    options?: Options<MapOptions>,
  ): Promise<{ sign: SignMethod; signReason: string }> {
    const signs = await this.call('computeSamples', [first, count], options);
    Object.assign(this, signs);
    return signs;
  }
  /** @internal computeSamples() and valuesOfSamples() at once, so that no other call comes between. */
  computeValues(
    first: number,
    count: number,
    options: object,
  ): Promise<MapValues & { sign: SignMethod; signReason: string }> {
    return this.call('computeValues', [first, count], options);
  }
  valuesOfSamples(first: number, count: number): Promise<MapValues> {
    return this.call('valuesOfSamples', [first, count]);
  }
  statistics(): Promise<MapStatistics> {
    return this.call('statistics', []);
  }
  transfer(values: ArrayLike<number>, options?: Options<TransferOptions>): Promise<Float32Array> {
    return this.call('transfer', [values], options);
  }
  /** The keys of report.json. Of the module `full` only. */
  summary(options: Options<JudgedOptions>): Promise<JudgedSummary>;
  summary(options?: Options<SummaryOptions>): Promise<MapSummary>;
  summary(options?: Options<SummaryOptions>): Promise<MapSummary> {
    return this.call('summary', [], options);
  }
  /** The text of report.html. Of the module `full` only. */
  report(options?: Options<ReportOptions>): Promise<string> {
    return this.call('report', [], options);
  }
}

/** Two bodies in a worker. Of the module `full` only. */
export class WorkerPair extends Remote {
  setPose(body: 0 | 1, matrix: ArrayLike<number>): Promise<void> {
    return this.call('setPose', [body, matrix]);
  }
  refit(body: 0 | 1, positions: Points, options?: CallOptions): Promise<void> {
    return this.call('refit', [body, positions], options);
  }
  separation(): Promise<BoundedLength> {
    return this.call('separation', []);
  }
  colliding(): Promise<boolean> {
    return this.call('colliding', []);
  }
  penetrationDepth(): Promise<BoundedLength | null> {
    return this.call('penetrationDepth', []);
  }
  contacts(): Promise<Contacts> {
    return this.call('contacts', []);
  }
}
