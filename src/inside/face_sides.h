// The sides of its surface on which a solid lies.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>

#include "sites/sites_data.h"

namespace sdm::inside {

/// The sides of a piece of surface that lie inside the solid, those with a winding number other than 0: it is
/// w on the outer side of the piece, and w + 1 on its inner side.
enum class Sides : std::uint8_t {
  unknown,
  boundary,  ///< w = 0: the inner side, as of every face of a mesh that does not intersect itself
  reversed,  ///< w = −1: the outer side
  buried,    ///< any other w: both
  mixed      ///< not the same everywhere, because other faces intersect the piece or are too near
};

/// How far beside a face that no other one meets its sides are determined: more than rounding, less than the
/// distance of other faces. 0 if no such length exists, in a mesh that is far from the origin.
[[nodiscard]] double offset_beside_faces(const sites::SitesData& sites);

/// The sides of a face, by the winding number w on its outer side.
[[nodiscard]] inline Sides sides_by_winding(int outer) {
  return outer == 0 ? Sides::boundary : outer == -1 ? Sides::reversed : Sides::buried;
}

/// The sides of the faces of a solid, each found on first use, and those of all once a thirty-second of them
/// was asked for: all together take less time. The winding number is constant on one side of a face that no
/// other face meets, and passes to neighbours across their common edge. Thread-safe; signs do not depend on
/// the order of calls.
class FaceSides {
 public:
  /// `solid` must be a solid, outlive this object, and not change until renew().
  explicit FaceSides(const sites::SitesData& solid);
  /// Starts anew, for other positions. Reuses the memory.
  void renew();

  /// Cost: O(log n) for the first call, constant for others.
  [[nodiscard]] Sides of_face(std::uint32_t face) const;
  /// Whether the winding number of a query beside this face is to be found without the sides of the face.
  /// Sides cost as much as several winding numbers, and the sides of all faces as much as twice as many as
  /// there are faces: they are found after so many calls of this. Answers do not depend on it.
  [[nodiscard]] bool direct(std::uint32_t face) const;
  /// Whether the winding numbers of so many queries, which are near each other, are to be found one from the
  /// other (WindingWalk), as far as that decides them: until the sides of all faces are known, or would have
  /// cost less, after four queries a face. Answers do not depend on it.
  [[nodiscard]] bool walked(std::size_t queries) const;
  /// offset_beside_faces(); if 0, all sides are `mixed`.
  [[nodiscard]] double offset() const { return offset_; }
  /// The sides of the faces around a site, if they are all the same: then the pseudonormal of the site
  /// separates these sides. Otherwise `mixed`, also for a vertex where several fans of faces touch.
  [[nodiscard]] Sides of_site(SiteType type, std::uint32_t site) const;

 private:
  [[nodiscard]] Sides find(std::uint32_t face) const;
  void find_all() const;
  [[nodiscard]] Sides beside(std::uint32_t face) const;
  [[nodiscard]] Sides known_to_neighbour(std::uint32_t face) const;

  const sites::SitesData* solid_;
  double offset_ = 0;
  std::unique_ptr<std::atomic<Sides>[]> sides_;
  mutable std::atomic<std::size_t> found_ = 0;   ///< one by one
  mutable std::atomic<std::size_t> direct_ = 0;  ///< queries without sides
  mutable std::atomic<std::size_t> walked_ = 0;  ///< queries from one to the next
  mutable std::atomic<bool> known_ = false;
};

}  // namespace sdm::inside
