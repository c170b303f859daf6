// The way out of a solid for a surface that lies along one of its faces.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "bodies/contacts/support.h"
#include "bodies/contacts/surface_point.h"
#include "mesh/similarity.h"

namespace sdm::contacts {

/// The surface of a body around a vertex or an edge of it.
struct SurfaceAround {
  const sites::SitesData* sites = nullptr;
  const mesh::Similarity *to_other = nullptr, *from_other = nullptr;
  std::span<const std::uint32_t> faces{};           ///< around the vertex or beside the edge
  std::array<std::uint32_t, 2> ends{kNone, kNone};  ///< of the edge; twice the vertex
};

/// Where a face is the nearest way out for a surface.
struct WayOut {
  enum class Place : std::uint8_t {
    none,
    here,   ///< at the point asked for: as deep as it is below the face
    beside  ///< at `point`, which is less deep: the surface is tilted
  };
  Place place = Place::none;
  SurfacePoint point{};
  std::uint32_t own_face = kNone;  ///< which contains the point
};

/// Finds the way out of points below a face. Memory is reused.
///
/// A point on the side of a solid has its nearest way out there, whatever lies on the top of the solid with
/// its other points: of a box on a table, flush with it or across its edge, the points at the side of the
/// table. The depth of such a point below the top is one of the body only if the surface around the point is
/// as deep below the top somewhere, and no closer to the side. So the surface is followed, away from whatever
/// is closest, until the face is.
class WayOutFinder {
 public:
  /// `around`: the surface around a point of a vertex or an edge that a face of `other`, a solid, supports
  /// from above: support.height < 0. Only those of its faces that lie along that face, or edges if no face
  /// does, are followed. `tolerance`: of depths. Cost: no search if the face is closest to the point, usually
  /// one otherwise.
  [[nodiscard]] WayOut find(const SurfaceAround& around, const shape::Body& other, const Support& support,
                            const SurfacePoint& point, double tolerance);

 private:
  /// A face, or an edge of it, in the frame of the other body.
  struct Piece {
    std::uint32_t face = kNone;
    bool is_edge = false;
    std::array<Vec3, 2> edge{};
  };
  struct OnPiece {
    Vec3 at{};
    std::uint32_t face = kNone;
  };
  void find_pieces(const SurfaceAround& around, const Vec3& normal);
  [[nodiscard]] OnPiece closest_on_pieces(const SurfaceAround& around, const Vec3& at) const;

  std::vector<Piece> pieces_;
};

}  // namespace sdm::contacts
