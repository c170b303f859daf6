// Simplification with vertices that are placed freely, to a certified deviation.
#pragma once

#include <sdm/simplify.h>
#include <sdm/sites.h>

#include <cstdint>
#include <span>
#include <vector>

#include "simplify/collapse_sequence.h"

namespace sdm::simplify {

/// Results of one sequence of collapses: for each rung of a ladder of deviations, the mesh whose collapses
/// keep it, and a few others in which some of them are undone where that mesh deviates by more. The result
/// for a limit is the one with the fewest faces of those that are certified to keep it, of rungs up to the
/// limit. None of these meshes depends on the limit: a larger one never leaves more faces.
class FreePlacement {
 public:
  /// Begins with the input, the mesh of the sites, or with another mesh that it was simplified to. Both must
  /// outlive this object.
  FreePlacement(const Mesh& start, const Sites& input, double size);

  /// Whether the surface is a manifold, up to few vertices: it is not simplified otherwise.
  [[nodiscard]] bool is_possible() const { return sequence_.is_possible(); }
  /// Returns the mesh, which face of the start each of its faces was, and its deviation; no faces: none with
  /// fewer of them is found.
  [[nodiscard]] Simplified to_deviation(double limit, const SimplifyOptions& options, SimplifyReport& report);

 private:
  [[nodiscard]] Simplified first_within(double limit, int rung, std::size_t fewer_than,
                                        const SimplifyOptions& options, SimplifyReport& report);
  /// Whether a point that was too far from another result is farther than the limit from this one.
  [[nodiscard]] bool is_far_at_known(const Mesh& result, double limit) const;
  void hold_back(const CollapsedMesh& mesh, const std::vector<std::uint32_t>& vertices, int levels,
                 std::span<const CollapseOfEdge> collapses, std::vector<bool>& held) const;

  const Mesh& start_;
  const Sites& input_;
  Ladder ladder_;
  CollapseSequence sequence_;
  std::vector<Vec3> far_;  // points of the input at which results were too far from it
};

}  // namespace sdm::simplify
