// What C++, TypeScript and GLSL must agree on: colours, units, words, and rules for numbers.
//
// report/rules.cjs translates the text of this file into the module sdm-rules of report/ and js/, so that it
// keeps to a part of C++ that all three have: constants, arrays of them, and functions of doubles and bools
// that consist of constants, `if`, `return`, `?:` and functions of <cmath>. Numbers in functions have a
// decimal point. Names become camel case.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace sdm::rules {

struct Rgb {
  std::uint8_t r = 0, g = 0, b = 0;
  friend bool operator==(const Rgb&, const Rgb&) = default;
};

inline constexpr Rgb kNoValue{128, 130, 134};
/// Faces that no tolerance judges, beside those that one does.
inline constexpr Rgb kUnjudged{216, 206, 188};
/// Within the tolerance, by the share of the way to the nearest limit: up to a quarter, a half, and so on.
/// They darken towards the limit and stay greener than the colours beyond, also for those who see green and
/// orange alike.
inline constexpr std::array<Rgb, 4> kWithin{
    {{225, 243, 233}, {176, 224, 199}, {122, 196, 161}, {66, 158, 122}}};
/// Beyond the tolerance, from its edge to the end of the scale.
inline constexpr std::array<Rgb, 3> kAbove{{{255, 214, 94}, {240, 120, 40}, {165, 15, 21}}};
inline constexpr std::array<Rgb, 3> kBelow{{{150, 200, 235}, {60, 130, 200}, {8, 48, 107}}};
/// The shorter side of a sequential scale, from 0 to its end: none is close to a colour of viridis.
inline constexpr std::array<Rgb, 3> kOpposite{{{255, 110, 80}, {225, 30, 40}, {130, 0, 20}}};
/// Ten equal steps of Matplotlib's viridis.
inline constexpr std::array<Rgb, 11> kViridis{{{68, 1, 84},
                                               {72, 36, 117},
                                               {65, 68, 135},
                                               {53, 95, 141},
                                               {42, 120, 142},
                                               {33, 145, 140},
                                               {34, 168, 132},
                                               {68, 191, 112},
                                               {122, 209, 81},
                                               {189, 223, 38},
                                               {253, 231, 37}}};
/// ColorBrewer's RdBu reversed, with a pure white middle.
inline constexpr std::array<Rgb, 11> kDiverging{{{5, 48, 97},
                                                 {33, 102, 172},
                                                 {67, 147, 195},
                                                 {146, 197, 222},
                                                 {209, 229, 240},
                                                 {255, 255, 255},
                                                 {253, 219, 199},
                                                 {244, 165, 130},
                                                 {214, 96, 77},
                                                 {178, 24, 43},
                                                 {103, 0, 31}}};
inline constexpr std::array<Rgb, 3> kPaper2006{{{255, 0, 0}, {255, 255, 0}, {0, 255, 0}}};

// GLSL: the functions and numbers from here.

/// Limits beyond it are none: shaders cannot rely on infinity.
inline constexpr double kNoLimit = 1e37;
/// The modes of scales: a colormap from one end to the other, centred on zero, the bands of a tolerance, or
/// viridis from 0 to the end of the longer side.
inline constexpr double kEndToEnd = 0.0;
inline constexpr double kCentred = 1.0;
inline constexpr double kBands = 2.0;
inline constexpr double kSequential = 3.0;
/// Where color_place() is 0 to 1 more than one of these, it is in these colours.
inline constexpr double kInColormap = 0.0;
inline constexpr double kInOpposite = 2.0;
inline constexpr double kInWithin = 4.0;
inline constexpr double kInAbove = 6.0;
inline constexpr double kInBelow = 8.0;
inline constexpr double kInUnjudged = 10.0;

/// The position of x between `from` (0) and `to` (1).
inline double fraction(double x, double from, double to) {
  return to > from ? std::min(std::max((x - from) / (to - from), 0.0), 1.0) : 1.0;
}

/// How far a distance within the tolerance is on its way to the nearest limit, from 0 (at distance 0, or in
/// the middle of a tolerance without it, or at the end of the scale where there is no limit) to 1.
inline double closeness(double d, double lo, double hi, double lower, double upper) {
  if (lower <= 0.0 && upper >= 0.0)
    return d == 0.0 ? 0.0 : d > 0.0 ? fraction(d, 0.0, upper) : fraction(-d, 0.0, -lower);
  const double room = upper > kNoLimit    ? hi - lower
                      : lower < -kNoLimit ? upper - lo
                                          : (std::min(upper, hi) - std::max(lower, lo)) / 2.0;
  return room > 0.0 ? 1.0 - fraction(std::min(d - lower, upper - d), 0.0, room) : 1.0;
}

/// Which colour a distance has: one of kInColormap and so on, plus the place in these colours, from 0 to 1.
/// Colours are constant beyond `lo` and `hi`, where lo < hi. Distances that exceed the tolerance, or 0, by
/// less than the accuracy are within it.
inline double color_place(double d, double mode, double lo, double hi, double lower, double upper,
                          double accuracy) {
  if (mode == kBands) {
    if (lower < -kNoLimit && upper > kNoLimit) return kInUnjudged;
    if (d > upper + accuracy) return kInAbove + fraction(d, upper, hi);
    if (d < lower - accuracy) return kInBelow + fraction(-d, -lower, -lo);
    return kInWithin + std::min(std::floor(4.0 * closeness(d, lo, hi, lower, upper)), 3.0) / 3.0;
  }
  if (mode == kSequential) {
    const bool up = hi >= -lo;  // the longer side
    const double x = up ? d : -d;
    if (x < -accuracy) return kInOpposite + fraction(-x, 0.0, up ? -lo : hi);
    return kInColormap + fraction(x, std::max(0.0, up ? lo : -hi), up ? hi : -lo);
  }
  if (mode == kCentred)
    return kInColormap + fraction(0.5 + 0.5 * d / std::max(std::abs(lo), std::abs(hi)), 0.0, 1.0);
  return kInColormap + fraction(d, lo, hi);
}

// Not GLSL.

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The ends of a scale by limits of its own: as far beyond them as they are from the middle between them, ±2
/// of ±1.
inline double room_beside(double lower, double upper, double lo, double hi) {
  const double away =
      upper - lower < kInfinity ? std::abs(upper - lower) / 2.0 : std::min(std::abs(lower), std::abs(upper));
  return away > 0.0 && away < kInfinity ? away : std::max(std::abs(lo), std::abs(hi));
}
inline double banded_lo(double lower, double upper, double lo, double hi) {
  const double room = room_beside(lower, upper, lo, hi);
  return lower > -kInfinity ? lower - room : std::min(0.0, upper - room);
}
inline double banded_hi(double lower, double upper, double lo, double hi) {
  const double room = room_beside(lower, upper, lo, hi);
  return upper < kInfinity ? upper + room : std::max(0.0, lower + room);
}

inline constexpr double kScaleSteps = 10.0;  ///< of scales of colours, at most
inline constexpr double kApart = 0.06;       ///< numbers beside a scale, of its length

/// A multiple of a digit times a power of ten, nearest to the decimal number: 3 steps of 0.1 are 0.3.
inline double step_multiple(double n, double digit, double exponent) {
  const double power = std::pow(10.0, std::abs(exponent));
  return exponent < 0.0 ? n * digit / power : n * digit * power;
}
/// The least of 1, 2, 5 and 10 times the power of ten of this exponent that is not smaller than a number.
inline double step_exponent(double least) {
  return std::floor(std::log10(least));
}
inline double step_digit(double least) {
  const double exponent = step_exponent(least);
  const double most = 1.0 + 1e-12;
  return least <= most * step_multiple(1.0, 1.0, exponent)   ? 1.0
         : least <= most * step_multiple(1.0, 2.0, exponent) ? 2.0
         : least <= most * step_multiple(1.0, 5.0, exponent) ? 5.0
                                                             : 10.0;
}
/// The multiples of a round step, which is not smaller than `least`, next to a number.
inline double round_below(double x, double least) {
  const double digit = step_digit(least);
  const double exponent = step_exponent(least);
  return step_multiple(std::floor(x / step_multiple(1.0, digit, exponent) + 1e-9), digit, exponent) + 0.0;
}
inline double round_above(double x, double least) {
  const double digit = step_digit(least);
  const double exponent = step_exponent(least);
  return step_multiple(std::ceil(x / step_multiple(1.0, digit, exponent) - 1e-9), digit, exponent) + 0.0;
}
/// The ends of a range, the upper one beyond the lower one, moved outwards to round numbers.
inline double widened_hi(double lo, double hi) {
  return lo < hi ? hi : lo + (lo != 0.0 ? std::abs(lo) : 1.0);
}
inline bool can_round(double lo, double hi) {
  const double least = (hi - lo) / kScaleSteps;
  const double below = round_below(lo, least);
  const double above = round_above(hi, least);
  // Far from zero, steps of the range may be too small to be numbers.
  return below < above && std::abs(below) < kInfinity && std::abs(above) < kInfinity;
}
inline double rounded_lo(double lo, double hi) {
  const double end = widened_hi(lo, hi);
  return can_round(lo, end) ? round_below(lo, (end - lo) / kScaleSteps) : lo;
}
inline double rounded_hi(double lo, double hi) {
  const double end = widened_hi(lo, hi);
  return can_round(lo, end) ? round_above(end, (end - lo) / kScaleSteps) : end;
}

// The scale of colours of distances from `least` to `most`, where it is not given.

inline constexpr double kVanishing = 0.1;    ///< part of a range in which a diverging scale is nearly white
inline constexpr double kShorterSide = 0.5;  ///< of a sequential scale, of the longer one

/// The values of Colormap, in its order.
inline constexpr double kViridisMap = 1.0;
inline constexpr double kSequentialMap = 2.0;
inline constexpr double kDivergingMap = 3.0;

/// The least and the largest distance, at least as far apart as they are accurate: what is nearer to 0 is 0.
inline double least_shown(double least, double most, double accuracy) {
  if (std::max(std::abs(least), std::abs(most)) <= accuracy) return 0.0;
  return least < 0.0 && least >= -accuracy ? 0.0 : least;
}
inline double most_shown(double least, double most, double accuracy) {
  if (std::max(std::abs(least), std::abs(most)) <= accuracy) return accuracy;
  return most > 0.0 && most <= accuracy && least < -accuracy ? 0.0 : most;
}
/// How far a scale goes to either side: as far as 99 % of the area.
inline double scale_reach(double least, double most, double p99_abs, double accuracy) {
  return p99_abs > accuracy ? p99_abs : std::max(std::abs(least), std::abs(most));
}
/// Whether on that side of 0 is less than 5 % of the area, or nothing far from it.
inline bool few_below(double least, double p05, double reach, double accuracy) {
  return least >= 0.0 || p05 >= -accuracy || -least < kVanishing * reach;
}
inline bool few_above(double most, double p95, double reach, double accuracy) {
  return most <= 0.0 || p95 <= accuracy || most < kVanishing * reach;
}
inline double automatic_colormap(double least, bool below_few, bool above_few) {
  if (least >= 0.0) return kViridisMap;
  return below_few || above_few ? kSequentialMap : kDivergingMap;
}
/// That of a range that was given: both sides of 0 have their colours if neither is short.
inline double colormap_of_range(double automatic, double lo, double hi) {
  const bool both = std::min(-lo, hi) > kShorterSide * std::max(-lo, hi);
  return automatic == kSequentialMap && both ? kDivergingMap : automatic;
}

/// Whether the longer side of a range of colours is above 0: bands are counted from its end to that of the
/// shorter one.
inline bool is_longer_above(double least, double most, bool below_few, bool above_few) {
  return below_few == above_few ? most >= -least : below_few && most > 0.0;
}
inline double longer_side(double least, double most, double reach, bool above) {
  return std::min(reach, above ? most : -least);
}
inline double shorter_side(double least, double most, double reach, bool above) {
  return std::min(kShorterSide * longer_side(least, most, reach, above),
                  std::max(0.0, above ? -least : most));
}
inline double sequential_lo(double least, double most, double reach, bool above) {
  return above ? -shorter_side(least, most, reach, above) : -longer_side(least, most, reach, above);
}
inline double sequential_hi(double least, double most, double reach, bool above) {
  return above ? longer_side(least, most, reach, above) : shorter_side(least, most, reach, above);
}

/// x, not farther from 0 than that.
inline double within_reach(double x, double reach) {
  return std::min(std::max(x, -reach), reach);
}
/// The distances as far as the scale goes, unless nearly all of the area has one distance.
inline double cut_hi(double least, double most, double reach) {
  return within_reach(least, reach) < within_reach(most, reach) ? within_reach(most, reach) : most;
}
inline double cut_lo(double least, double most, double reach) {
  const double hi = cut_hi(least, most, reach);
  const double lo =
      within_reach(least, reach) < within_reach(most, reach) ? within_reach(least, reach) : least;
  return lo > 0.0 && (lo < hi / 2.0 || !(lo < hi)) ? 0.0 : lo;
}

/// The ends by a colormap, before they are rounded.
inline double automatic_lo(double map, double least, double most, double reach, bool above) {
  if (map == kDivergingMap) return -reach;
  return map == kSequentialMap ? sequential_lo(least, most, reach, above) : cut_lo(least, most, reach);
}
inline double automatic_hi(double map, double least, double most, double reach, bool above) {
  if (map == kDivergingMap) return reach;
  return map == kSequentialMap ? sequential_hi(least, most, reach, above) : cut_hi(least, most, reach);
}
/// The same of bands: the limits are in the scale, and as much beyond them as the larger one.
inline double limits_margin(double lower, double upper) {
  return std::max(std::abs(lower > -kInfinity ? lower : upper), std::abs(upper < kInfinity ? upper : lower));
}
inline double limits_lo(double least, double reach, double lower, double upper) {
  const double edge = (lower > -kInfinity ? lower : upper) - limits_margin(lower, upper);
  return least < 0.0 ? std::min(std::max(least, -reach), edge) : 0.0;
}
inline double limits_hi(double most, double reach, double lower, double upper) {
  const double edge = (upper < kInfinity ? upper : lower) + limits_margin(lower, upper);
  return std::max(within_reach(most, reach), edge);
}

struct Unit {
  const char* name;
  double metres;
};
inline constexpr std::array<Unit, 8> kUnits{{{"m", 1.0},
                                             {"cm", 1e-2},
                                             {"mm", 1e-3},
                                             {"um", 1e-6},
                                             {"\u00b5m", 1e-6},  // the micro sign
                                             {"\u03bcm", 1e-6},  // the Greek letter
                                             {"in", 0.0254},
                                             {"ft", 0.3048}}};

/// How limits are said: words of kLimitWords, the limit, and where it is kBetween " to " and the upper one.
inline constexpr double kAtMost = 0.0;
inline constexpr double kAtLeast = 1.0;
inline constexpr double kBetween = 2.0;
inline constexpr double kPlusMinus = 3.0;
inline constexpr double kUpTo = 4.0;
inline constexpr std::array<const char*, 5> kLimitWords{"at most ", "at least ", "", "\u00b1", ""};
inline constexpr double kLimitDigits = 5.0;  ///< significant ones
inline double limits_form(double lower, double upper, bool is_signed) {
  if (lower == -kInfinity) return kAtMost;
  if (upper == kInfinity) return kAtLeast;
  return lower != -upper ? kBetween : is_signed ? kPlusMinus : kUpTo;
}

/// The words of Verdict and VerdictReason, in their order.
inline constexpr std::array<const char*, 4> kVerdictNames{"PASS", "FAIL", "NOT DECIDED", "DOUBTFUL"};
inline constexpr std::array<const char*, 13> kReasonNames{
    "all within",      "exceeded",   "beyond max distance", "without match",    "between samples",
    "within rounding", "guard band", "estimated signs",     "unknown accuracy", "nothing measured",
    "thin walls",      "in doubt",   "small places"};

inline constexpr double kPass = 0.0;
inline constexpr double kFail = 1.0;
inline constexpr double kNotDecided = 2.0;
inline constexpr double kDoubtful = 3.0;
inline constexpr double kAllWithin = 0.0;
inline constexpr double kExceeded = 1.0;
inline constexpr double kBeyondMaxDistance = 2.0;
inline constexpr double kWithoutMatch = 3.0;
inline constexpr double kBetweenSamples = 4.0;
inline constexpr double kWithinRounding = 5.0;
inline constexpr double kGuardBand = 6.0;
inline constexpr double kEstimatedSigns = 7.0;
inline constexpr double kUnknownAccuracy = 8.0;
inline constexpr double kNothingMeasured = 9.0;
inline constexpr double kThinWalls = 10.0;
inline constexpr double kInDoubt = 11.0;
inline constexpr double kSmallPlaces = 12.0;

/// The lower limit, none where it cannot be exceeded as no distance is negative.
inline double lower_of(double lower, bool is_signed) {
  return is_signed || lower > 0.0 ? lower : -kInfinity;
}

/// A computed distance d stands for those from d − accuracy to d + accuracy; if |d| ≤ accuracy, its sign is
/// not certain either.
inline bool is_below(double d, double lower, double accuracy) {
  return (std::abs(d) <= accuracy ? std::abs(d) : d) < lower - accuracy;
}
inline bool is_above(double d, double upper, double accuracy) {
  return (std::abs(d) <= accuracy ? -std::abs(d) : d) > upper + accuracy;
}

/// How far the distances stay from the limits.
inline double margin_of(double lowest, double highest, double lower, double upper, double accuracy) {
  return std::min(upper - highest, lowest - lower) - accuracy;
}

/// The larger one of the limits that are finite; 0 without any.
inline double largest_limit(double lower, double upper) {
  return std::max(std::abs(lower) < kInfinity ? std::abs(lower) : 0.0,
                  std::abs(upper) < kInfinity ? std::abs(upper) : 0.0);
}

/// The reason of the verdict on evidence; `lower`: of lower_of(). `lowest` is infinite and
/// `highest` negatively so where nothing was measured.
inline double reason_of(double lowest, double highest, double lower, double upper, double accuracy,
                        double guard, double error_bound, double thin_walls, bool complete, bool unmatched,
                        bool estimated_signs, bool samples_only) {
  const double error = accuracy + guard;
  const double farthest = std::max(-lowest, highest);
  const double measured = margin_of(lowest, highest, lower, upper, error);
  const double margin = estimated_signs ? margin_of(-farthest, farthest, lower, upper, error) : measured;
  if (!complete) return unmatched ? kWithoutMatch : kBeyondMaxDistance;
  if (is_below(lowest, lower, error) || is_above(highest, upper, error)) return kExceeded;
  if (lowest > highest) return kNothingMeasured;
  // No point of a wall is farther than its half from both skins.
  if (error_bound <= margin) return 2.0 * largest_limit(lower, upper) > thin_walls ? kThinWalls : kAllWithin;
  if (samples_only && margin >= 0.0 && margin < kInfinity) return kAllWithin;
  if (!(accuracy < kInfinity)) return kUnknownAccuracy;
  if (error_bound <= measured || (margin <= 0.0 && measured > 0.0)) return kEstimatedSigns;
  if (margin > 0.0) return kBetweenSamples;
  return guard > 0.0 ? kGuardBand : kWithinRounding;
}

inline double verdict_of(double reason) {
  if (reason == kAllWithin || reason == kSmallPlaces) return kPass;
  if (reason <= kWithoutMatch) return kFail;
  return reason == kInDoubt ? kDoubtful : kNotDecided;
}

}  // namespace sdm::rules
