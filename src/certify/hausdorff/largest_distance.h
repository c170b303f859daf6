// The largest distance of the points of A, or whether it exceeds a limit.
#pragma once

#include <sdm/execution.h>

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "certify/hausdorff/matching.h"
#include "certify/hausdorff/vertex_search.h"

namespace sdm::hausdorff {

/// Lengths that rounding depends on.
struct Scale {
  double size = 0;        ///< the diagonal of the box of both meshes
  double coordinate = 0;  ///< the largest of A
  double precision = 0;   ///< no bounds are closer: 1e-12 of the size and of the largest coordinate of both
};

/// `box`: of B.
[[nodiscard]] Scale scale_of(const Mesh& a, const Box& box);

/// A question that can be answered before the largest distance is known.
struct Decision {
  double limit = 0;  ///< ≥ 0: what happens below does not matter
  /// ≥ limit: once a distance above the limit is known, what happens below this does not matter either; once
  /// one above this is known, nothing does.
  double forgiven = 0;
};

/// How closely the largest distance is to be bounded, and which points count.
struct Question {
  double precision = 0;  ///< of the bounds; that of the scale is the least
  std::optional<Decision> decision{};
  const Side* side = nullptr;          ///< null: points on both sides of B count
  const Matching* matching = nullptr;  ///< null: all faces of B count
  std::size_t most_parts = std::numeric_limits<std::size_t>::max();  ///< to examine
};

/// Bounds. With a decision: the faces of `lower` are kNone if no distance above the limit was found; `upper`
/// is at least the limit, or `forgiven` if one was found.
struct LargestDistance {
  LowerBound lower;
  double upper = 0;
  std::vector<std::uint32_t> unmatched{};  ///< faces of A that are left out, as no face of B counts for them
};

[[nodiscard]] LargestDistance largest_distance(const Mesh& a, const sites::SitesData& b, const Scale& scale,
                                               const Question& question, const Progress& progress);

}  // namespace sdm::hausdorff
