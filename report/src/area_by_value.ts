import { floatOfKey, keyOfFloat } from './arrays';

const kBins = 2048; // of equal width

/// The fraction of the area, that without a value included, up to a distance: of src/io/page/report/area_by_value.h.
export class AreaByValue {
  private readonly edges: number[] = []; ///< of the bins of floats: [from, to) of each
  private readonly sums = [0];
  private readonly binSums = [0];

  constructor(
    readonly lo: number,
    readonly hi: number,
    keys: Uint32Array,
    areaOfKey: Float32Array,
    areaOfBin: Float32Array,
    readonly withoutValue: number,
  ) {
    keys.forEach((key, i) => {
      this.edges.push(floatOfKey(key), floatOfKey(key + 1));
      this.sums.push(this.sums[i] + areaOfKey[i]);
    });
    areaOfBin.forEach((area, i) => this.binSums.push(this.binSums[i] + area));
  }

  /// Sums texels by their distances (NaN: none) and areas (0: no face).
  static of(distances: Float32Array, areas: Float64Array): AreaByValue {
    let [lo, hi, total, without] = [Infinity, -Infinity, 0, 0];
    areas.forEach((area, i) => {
      total += area;
      if (!Number.isFinite(distances[i])) without += area;
      else if (area > 0) [lo, hi] = [Math.min(lo, distances[i]), Math.max(hi, distances[i])];
    });
    if (lo > hi) lo = hi = 0;
    const byKey = new Float64Array(1 << 16);
    const byBin = new Float64Array(kBins);
    areas.forEach((area, i) => {
      if (area === 0 || !Number.isFinite(distances[i])) return;
      byKey[keyOfFloat(distances[i])] += area / total;
      byBin[Math.min(kBins - 1, Math.floor(hi > lo ? (kBins * (distances[i] - lo)) / (hi - lo) : 0))] +=
        area / total;
    });
    const keys = Uint32Array.from(byKey.keys()).filter((key) => byKey[key] > 0);
    return new AreaByValue(
      lo,
      hi,
      keys,
      Float32Array.from(keys, (key) => byKey[key]),
      Float32Array.from(byBin),
      total > 0 ? without / total : 0,
    );
  }

  /// The fraction of the area whose distance is at most d.
  upTo(d: number): number {
    if (this.edges.length === 0 || d < this.lo) return 0;
    if (d >= this.hi) return 1 - this.withoutValue;
    const bins = this.binSums.length - 1;
    const width = (this.hi - this.lo) / bins;
    // The bin of floats with d, or the one before it.
    let first = 0;
    let last = this.edges.length / 2 - 1;
    while (first < last) {
      const middle = (first + last + 1) >> 1;
      if (this.edges[2 * middle] <= d) first = middle;
      else last = middle - 1;
    }
    const from = Math.max(this.edges[2 * first], this.lo);
    const to = Math.min(this.edges[2 * first + 1], this.hi);
    const part = to > from ? Math.min(1, Math.max(0, (d - from) / (to - from))) : 1;
    const byFloat = this.sums[first] + part * (this.sums[first + 1] - this.sums[first]);
    if (to - from <= width) return byFloat;
    const at = Math.min((d - this.lo) / width, bins - 1e-9);
    const bin = Math.floor(at);
    return this.binSums[bin] + (at - bin) * (this.binSums[bin + 1] - this.binSums[bin]);
  }

  within(lower: number, upper: number): number {
    return Math.max(0, this.upTo(upper) - this.upTo(lower));
  }
}
