/// Numbers with their bounds: what every result that is not exact comes with.
///
/// Threads: plain values.
#pragma once

#include <sdm/names.h>
#include <sdm/types.h>

#include <array>
#include <optional>
#include <tuple>

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

template <>
inline constexpr std::tuple kFields<BoundedNumber>{
    Field{"value", &BoundedNumber::value, "The number."},
    Field{"certainty", &BoundedNumber::certainty,
          "'exact': computed from the triangles, accurate to 1e-6 of the diagonal of both bodies' box; "
          "'bounded': the true value lies between the bounds; 'estimate': no guarantee."},
    Field{"lower", &BoundedNumber::lower, "lower ≤ truth."},
    Field{"upper", &BoundedNumber::upper, "truth ≤ upper."}};

/// A length with its bounds.
struct BoundedLength : BoundedNumber {
  /// A point of O1 and a point of O2 that are `value` apart; nothing where no pair of points attains the
  /// value.
  std::optional<std::array<Vec3, 2>> witness{};
};

template <>
inline constexpr auto kFields<BoundedLength> = std::tuple_cat(
    kFields<BoundedNumber>,
    std::tuple{Field{"witness", &BoundedLength::witness,
                     "A point of O1 and a point of O2 that are that far apart; nothing where no pair of "
                     "points attains the value."}});

}  // namespace sdm
