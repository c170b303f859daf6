// The tolerances of the faces of a surface.
#pragma once

#include <sdm/group_verdicts.h>
#include <sdm/part_statistics.h>
#include <sdm/tolerance.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace sdm::map {

/// No limit on either side.
inline Tolerance any_distance() {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  return {-kInfinity, kInfinity};
}

/// The tolerance of each face: what all those accept that it is judged by, which are that of the whole
/// surface and those of the rows of a table that name the face.
class FaceTolerances {
 public:
  /// `names`: of the faces. Cost: linear in faces and rows.
  FaceTolerances(const std::optional<Tolerance>& of_all, std::span<const FaceNames> names,
                 std::span<const GroupTolerance> table);

  /// any_distance() of a face that no tolerance judges. Of kNone, that of the whole surface.
  [[nodiscard]] const Tolerance& of(std::uint32_t face) const { return tolerances_[rows_of(face)]; }
  /// The same number for faces that the same rows name; 0 of those that no row names, and of kNone.
  [[nodiscard]] std::uint32_t rows_of(std::uint32_t face) const {
    return number_.empty() || face == kNone ? 0 : number_[face];
  }
  [[nodiscard]] bool has_any() const { return has_any_; }

 private:
  std::vector<Tolerance> tolerances_;  ///< the first is that of the whole surface
  std::vector<std::uint32_t> number_;  ///< of each face its tolerance; empty: all have the first
  bool has_any_;
};

}  // namespace sdm::map
