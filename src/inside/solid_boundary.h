// The boundary of a solid whose faces may intersect each other: those parts of the faces that have the solid
// on one side only.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/rows.h"
#include "inside/face_sides.h"
#include "inside/near_faces.h"

namespace sdm::inside {

class SolidBoundary {
 public:
  /// Both must outlive this object and not change. Cost: O(n log n), all cores.
  SolidBoundary(const sites::SitesData& solid, const FaceSides& sides);

  /// Bounds on the distance of the closest point, and a point of the boundary at the distance `upper`, if one
  /// was found.
  struct Closest {
    double lower = 0, upper = 0;
    std::optional<Vec3> point{};
    std::uint32_t face = kNone;  ///< which contains the point
  };
  /// The closest point of the boundary to a point inside the solid. Faces that others intersect are divided
  /// into pieces, which are boundary or not. Cost: O(log n) where no faces intersect nearby, at most that of
  /// some thousand pieces elsewhere.
  [[nodiscard]] Closest closest(const Vec3& p) const;

  /// Bounds on the volume of the solid, equal if no face intersects others, by the divergence theorem over
  /// the parts of the boundary. Cost: linear, plus that of dividing the faces that intersect others; all
  /// cores.
  struct Volume {
    double lower = 0, upper = 0;
  };
  [[nodiscard]] Volume volume() const;

 private:
  /// Part of a face, in the unit frame.
  struct Piece {
    std::uint32_t face = 0;
    Corners at{};

    [[nodiscard]] std::array<Piece, 4> divided() const;
  };
  [[nodiscard]] Piece whole_face(std::uint32_t face) const;
  /// `mixed` if others may intersect it.
  [[nodiscard]] Sides sides_of(const Piece& piece) const;
  [[nodiscard]] Sides sides_beside(const Vec3& point, const Vec3& outwards) const;
  /// Whether a face with a smaller number contains the piece.
  [[nodiscard]] bool repeats_earlier_face(const Piece& piece) const;

  const sites::SitesData& solid_;
  std::vector<Sides> sides_;                      ///< of each face
  std::vector<std::uint32_t> mixed_number_;       ///< of each face: its row below, or kNone
  std::vector<std::vector<std::uint32_t>> near_;  ///< of each mixed face, the faces that may intersect it
};

}  // namespace sdm::inside
