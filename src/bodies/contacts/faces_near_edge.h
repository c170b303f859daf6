// The faces of a mesh that are near an edge of another one.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sites/sites_data.h"
#include "tree/visit.h"

namespace sdm::contacts {

/// Finds the faces near an edge in single precision, so that some of those returned are farther away. Memory
/// is reused: what is returned is valid until the next call.
class FacesNearEdge {
 public:
  /// Part of an edge, in the frame of the sites.
  struct Segment {
    Vec3 a{}, b{};
  };
  /// The faces within `max_distance` of the segment. Cost: of the leaves whose boxes are.
  [[nodiscard]] std::span<const std::uint32_t> find(const sites::SitesData& sites, const Segment& segment,
                                                    double max_distance);

  /// The faces that have part of the segment above them within `margin` or below them within `max_depth`, are
  /// nearly parallel to it and do not face `sides`, directions from the edge along the faces beside it. Cost:
  /// of the leaves within both.
  [[nodiscard]] std::span<const std::uint32_t> find_supporting(const sites::SitesData& sites,
                                                               const Segment& segment,
                                                               std::span<const Vec3> sides, double margin,
                                                               double max_distance);

  /// Rounding in single precision of distances, relative to coordinates, and of squares, relative to their
  /// sum.
  static constexpr float kSegmentRounding = 2e-6f;

  /// The part of the segment near the mesh, in the unit frame and in single precision.
  struct UnitSegment {
    std::array<float, 3> start{}, end{};
    std::array<float, 3> direction{};
    float length = 0;
    float rounding = 0;  ///< of distances from it
  };
  /// The conditions of find_supporting(), in the unit frame.
  struct Supporting {
    std::array<std::array<float, 3>, 2> sides{};  ///< of length 1, or 0
    float margin = 0, max_depth = 0;
  };

 private:
  std::vector<tree::OpenNode> stack_;
  std::vector<std::uint32_t> faces_;
};

}  // namespace sdm::contacts
