// The points of a cloud by the named groups of their closest faces.
#pragma once

#include <sdm/sites.h>
#include <sdm/tolerance.h>
#include <sdm/verdict.h>

#include <cstdint>
#include <span>
#include <vector>

#include "summary/verdict/evidence.h"
#include "summary/verdict/group_rows.h"

namespace sdm::io {

/// Judges the groups of O2 by the points that are closest to their faces.
class CloudGroups {
 public:
  /// `faces`: the number of O2's. Throws sdm::Error for a tolerance that needs a sign where there is none.
  CloudGroups(std::span<const FaceNames> names, std::span<const GroupTolerance> table, std::size_t faces,
              const SignUsed& sign, DistanceKind measured);

  /// First, each point with a value.
  void add(std::uint32_t face, double d, bool has_sign);
  /// Also then, if walls are thin: its distance to the faces that face the same way, or NaN without one.
  void add_facing(std::uint32_t face, double d);
  /// Then, each once more, when the accuracy is known.
  void count(std::uint32_t face, double d, double accuracy);
  /// Whether a point is out of the tolerance of its group.
  [[nodiscard]] bool any_out(double accuracy) const;
  /// `like`: evidence with the accuracy, the guard band and the walls that all groups have.
  [[nodiscard]] GroupVerdicts verdicts(const PointsWithoutGroup& without_group, const Evidence& like,
                                       bool accept_doubts) const;

 private:
  /// What is found of a row.
  struct Found {
    std::uint64_t points = 0, below = 0, above = 0;
    summary::DistanceRange range;
    summary::SignedSamples signs;
    summary::DistanceRange facing;
    bool any_facing = false, unmatched = false;
  };

  template <class Visit>
  void for_each_row(std::uint32_t face, const Visit& visit);

  summary::GroupRows rows_;
  std::vector<std::vector<std::size_t>> row_of_;  ///< of each layer and number in it
  std::vector<Found> found_;
  SignMethod sign_;
  DistanceKind measured_;
};

/// The evidence of distances to faces that face the same way, with the accuracy of `like`.
[[nodiscard]] Evidence facing_evidence(const Evidence& like, const summary::DistanceRange& range,
                                       bool unmatched);

}  // namespace sdm::io
