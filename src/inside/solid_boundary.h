// The boundary of a solid whose faces may intersect each other: those parts of the faces that have the solid
// on one side only.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "inside/face_sides.h"

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
  /// along the planes of the others, at the first call that comes near them. Thread-safe; results do not
  /// depend on the order of calls. Cost: O(log n), and at most that of some thousand pieces.
  [[nodiscard]] Closest closest(const Vec3& p) const;

  /// Bounds on the volume of the solid, equal unless many faces meet in a point or nearly coincide, by the
  /// divergence theorem over the parts of the boundary. Cost: linear: where dividing the faces that intersect
  /// others would take more, bounds are farther apart; all cores.
  struct Volume {
    double lower = 0, upper = 0;
  };
  [[nodiscard]] Volume volume() const;

 private:
  /// Part of a face, in the unit frame.
  struct Piece {
    std::uint32_t face = 0;
    Corners at{};
    Sides sides = Sides::unknown;
    std::uint32_t number = 0;  ///< in MixedFace::parts, if unknown

    void append_parts(std::vector<Piece>& parts) const;  ///< halves or quarters
  };
  struct Plane;
  class ClosestSearch;
  class VolumeSum;
  /// The winding numbers of points that do not lie on the surface, each from the last one where it is near.
  class Windings {
   public:
    [[nodiscard]] int of(const sites::SitesData& solid, const Vec3& point);

   private:
    bool known_ = false;
    Vec3 last_{};
    int number_ = 0;
  };
  /// The division of a piece, into pieces that have the solid on one side, some that may have (`mixed`), and
  /// unknown ones.
  struct Division {
    bool known = false;
    std::vector<Piece> pieces;
    std::vector<std::uint32_t> near;  ///< the faces that may intersect unknown pieces
    std::size_t work = 0;             ///< about as many comparisons of triangles
  };
  /// A face that others may intersect, and how it, its parts, and those of them have been divided.
  struct MixedFace {
    struct Part {
      std::uint32_t whole = kNone;  ///< that this is a piece of
      Division division;
    };
    std::vector<std::uint32_t> near;  ///< the faces that may intersect it
    std::mutex mutex;
    Windings windings;
    std::vector<Part> parts{1};
  };
  [[nodiscard]] Piece whole_face(std::uint32_t face) const;
  [[nodiscard]] MixedFace& mixed(std::uint32_t face) const { return mixed_[mixed_number_[face]]; }
  /// Divides an unknown piece. `near`: the faces that may intersect it; `windings`: beside its face.
  void divide(const Piece& piece, std::span<const std::uint32_t> near, Windings& windings,
              Division& division) const;
  [[nodiscard]] const Division& divide(const Piece& piece, MixedFace& face) const;  ///< unless known
  /// The planes of faces that intersect or touch the piece, as far as they divide it, until there are more
  /// than `most`; whether one of these faces lies in its own plane.
  [[nodiscard]] bool find_cuts(const Piece& piece, std::span<const std::uint32_t> faces, std::size_t most,
                               std::vector<Plane>& cuts) const;
  [[nodiscard]] Vec3 from_unit(const Vec3& point) const {
    return solid_.frame.origin + (1 / solid_.frame.scale) * point;
  }
  [[nodiscard]] bool is_inside(const Vec3& point) const;  ///< the solid; in the unit frame
  /// The sides at a point of the face; `covered` if others may coincide with it there.
  [[nodiscard]] Sides sides_beside(const Vec3& point, std::uint32_t face, bool covered,
                                   Windings& windings) const;
  /// Whether a face with a smaller number, of those near, contains the piece.
  [[nodiscard]] bool repeats_earlier_face(const Piece& piece, std::span<const std::uint32_t> near) const;

  const sites::SitesData& solid_;
  std::vector<Sides> sides_;                 ///< of each face
  std::vector<std::uint32_t> mixed_number_;  ///< of each face: its number below, or kNone
  std::unique_ptr<MixedFace[]> mixed_;
  double beside_;  ///< FaceSides::offset()
};

}  // namespace sdm::inside
