// Types of arguments and results.
import { type DistanceStatistics } from './declared.js';

export type {
  AtlasKind,
  AttributeDomain,
  BoundedLength,
  Certainty,
  Colormap,
  DistanceKind,
  DoubtReason,
  MapMeasure,
  MatchCounts,
  MatchMethod,
  SignMethod,
  ThicknessMethod,
  Verdict,
  VerdictReason,
} from './declared.js';

export type NumberArray = Float64Array | Float32Array | Uint32Array | Int32Array | Uint16Array | Uint8Array;

/** Three numbers for each point: an array of numbers, typed or not. */
export type Points = ArrayLike<number>;
/** Three indices of vertices for each triangle, counter-clockwise seen from outside; null: consecutive vertices. */
export type Indices = ArrayLike<number> | null;

/** Called with the current step and the fraction of it that is done; returning false cancels the call. */
export type Progress = (step: string, fraction: number) => boolean | void;

/**
 * Why a call failed: its arguments, its signal, memory, a fault of the library, or a worker that has ended, with the objects that
 * were in it.
 */
export type ErrorKind = 'input' | 'cancelled' | 'memory' | 'internal' | 'ended';

export class SdmError extends Error {
  constructor(
    readonly kind: ErrorKind,
    message: string,
  ) {
    super(message);
    this.name = 'SdmError';
  }
}

export type SiteType = 'vertex' | 'edge' | 'face';

/** Statistics of the texels that have a value, each weighted by its area; NaN if there are none. */
export type MapStatistics = DistanceStatistics;

/** Values of texels, or of samples. */
export interface MapValues {
  /** Negative inside; NaN without a value. */
  distances: Float32Array;
  /** Closest point − point of the texel: three numbers each. */
  vectors: Float32Array;
  /** The closest vertex, edge or face. */
  sitesOfTexels: Uint32Array;
  /** 0: a vertex, 1: an edge, 2: a face, 255: no value. */
  siteTypes: Uint8Array;
}

/**
 * What computes a map: the processor (`cpu`, the default), a GPU by WebGPU (`gpu`), or the one of them that has taken less time for a
 * sample in the same worker (`auto`): first the processor, then a GPU once it is ready, unless it is emulated or has failed.
 */
export type EngineChoice = 'auto' | 'cpu' | 'gpu';
