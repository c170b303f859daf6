// Bounds on rounding errors.
#pragma once

#include <limits>

namespace sdm::core {

// J. R. Shewchuk, Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates, 1997:
// the rounding error of a determinant of differences is at most this fraction of the sum of the magnitudes of
// its terms, plus what underflows: far less than kUnderflow for coordinates up to 1e40.
inline constexpr double kHalfUlp = std::numeric_limits<double>::epsilon() / 2;
inline constexpr double kError3 = (7 + 56 * kHalfUlp) * kHalfUlp, kError2 = (3 + 16 * kHalfUlp) * kHalfUlp;
inline constexpr double kUnderflow = 1e-200;

// Larger than the error of some operations in single precision: relative to a number, or of coordinates in
// the unit frame, which are at most 1.
inline constexpr double kSingleRounding = 1e-6;
// Larger than the error of so many operations in double precision, relative to what they are computed from: a
// product, a sum and a root; differences and a product of vectors; a position that was moved, and what
// follows from it.
inline constexpr double kFewRoundings = 1e-15, kProductRounding = 1e-14, kDoubleRounding = 1e-12;
// Distances in the unit frame that differ by less count as equal.
inline constexpr double kUnitDistanceRounding = 1e-9;

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
