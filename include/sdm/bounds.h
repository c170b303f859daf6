/// Numbers with their bounds: what every result that is not exact comes with.
///
/// Threads: plain values.
#pragma once

#include <sdm/names.h>
#include <sdm/types.h>

#include <array>
#include <optional>

namespace sdm {

/// How reliable a number is.
enum class Certainty {
  exact,    ///< as its query states; for lengths to 1e-6 of the diagonal of the box of all meshes
  bounded,  ///< the true value lies between the given bounds
  estimate  ///< no guarantee; no query of proximity returns it
};

template <>
inline constexpr std::array kWords<Certainty>{"exact", "bounded", "estimate"};

/// A number with its bounds.
struct BoundedNumber {
  double value = 0;
  Certainty certainty = Certainty::bounded;
  double lower = 0, upper = 0;  ///< lower ≤ truth ≤ upper, unless an estimate
};

/// A length with its bounds.
struct BoundedLength : BoundedNumber {
  /// A point of O1 and a point of O2 that are `value` apart; nothing where no pair of points attains the
  /// value.
  std::optional<std::array<Vec3, 2>> witness{};
};

}  // namespace sdm
