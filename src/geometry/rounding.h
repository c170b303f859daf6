// The rounding errors of determinants, for predicates that compute exactly only where rounding could decide.
#pragma once

#include <limits>

namespace sdm::core {

// J. R. Shewchuk, Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates, 1997:
// the rounding error of a determinant of differences is at most this fraction of the sum of the magnitudes of
// its terms, plus what underflows: far less than kUnderflow for coordinates up to 1e40.
inline constexpr double kHalfUlp = std::numeric_limits<double>::epsilon() / 2;
inline constexpr double kError3 = (7 + 56 * kHalfUlp) * kHalfUlp, kError2 = (3 + 16 * kHalfUlp) * kHalfUlp;
inline constexpr double kUnderflow = 1e-200;

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
