// The gl engine with some of its corrections to Algorithm 1, and the errors of its maps.
#pragma once

#include <sdm/map.h>

#include <string>
#include <vector>

#include "research/literal/corrections.h"

namespace sdm::figures {

/// A set of corrections with a name.
struct Variant {
  std::string name;
  literal::Corrections corrections;
};

/// All corrections, the algorithm as printed, each correction added alone to the latter, and tiles with each
/// of region walls and affine vectors.
[[nodiscard]] std::vector<Variant> added_corrections();
/// Each correction removed alone from all, with and without confirmation.
[[nodiscard]] std::vector<Variant> removed_corrections();

/// Errors of a map, compared with one by the reference engine.
struct MapErrors {
  double largest = 0,
         mean = 0;  ///< of |distance| where there is a value, relative to the diagonal of both meshes
  /// Percentages of texels: `wrong`: the distance, vector or site is wrong by more than the accuracy of the
  /// gl engine, or there is no value; `none`: no value.
  double wrong = 0, none = 0;
  std::vector<std::uint32_t> wrong_texels{};
};

[[nodiscard]] MapErrors errors_of(const DistanceMap& map, const DistanceMap& reference,
                                  const Surface& surface, const Sites& sites);

}  // namespace sdm::figures
