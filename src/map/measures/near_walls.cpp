#include "map/measures/near_walls.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "map/measures/near_walls.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "closest/face_distances-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::thickness::HWY_NAMESPACE {
namespace {

using namespace closest::HWY_NAMESPACE;

// The policy of a search of the tree. A box at a distance of at least d from p, and at most h above the plane
// of the ball, is reached at r = |q − p|² / (2 n·(q − p)) ≥ d² / 2h: the smallest of these bounds first.
// Boxes and faces are then compared with the ball of the least radius so far, R: they are reached by a
// smaller one if they are within R of its centre.
class NearWalls {
 public:
  NearWalls(const sites::SitesData& sites, const WallNormals& normals, const Touching& ball,
            double least_turn, double radius, const StopByFace& stop)
      : sites_(sites),
        normals_(normals),
        frames_(sites.frames, closest::frame_source(sites)),
        stop_(stop),
        unit_(sites.frame.to_unit(ball.p)),
        n_(ball.n),
        least_turn_(static_cast<float>(least_turn) - 1e-6f) {
    for (int k = 0; k < 3; ++k) {
      point_[k] = static_cast<float>(unit_[k]);
      normal_[k] = static_cast<float>(n_[k]);
    }
    limit(radius);
  }

  static bool before(float first, float second) { return first < second; }
  bool enter(const tree::OpenNode& open) const { return open.bound <= radius_; }
  uint32_t bound(const tree::OpenNode& open, const tree::WideTree::Node& node, float* least) const {
    const Block d;
    const EightVectors &lo_turn = normals_.lower[open.child], &hi_turn = normals_.upper[open.child];
    uint32_t near = 0;
    for (size_t i = 0; i < tree::WideTree::kWidth; i += hn::Lanes(d)) {
      BlockVec squared = hn::Zero(d), height = hn::Zero(d), turn = hn::Zero(d), from_centre = hn::Zero(d);
      for (int k = 0; k < 3; ++k) {
        const BlockVec n = hn::Set(d, normal_[k]);
        const BlockVec lo = hn::Load(d, node.lower[k] + i), hi = hn::Load(d, node.upper[k] + i);
        const auto gap = [&](float x) HWY_ATTR {
          return hn::Max(hn::Max(hn::Sub(lo, hn::Set(d, x)), hn::Sub(hn::Set(d, x), hi)), hn::Zero(d));
        };
        const BlockVec to_box = gap(point_[k]), to_centre = gap(centre_[k]);
        squared = hn::MulAdd(to_box, to_box, squared);
        from_centre = hn::MulAdd(to_centre, to_centre, from_centre);
        const bool up = normal_[k] >= 0;
        height = hn::MulAdd(hn::Sub(up ? hi : lo, hn::Set(d, point_[k])), n, height);
        turn = hn::MulAdd(hn::Load(d, (up ? hi_turn : lo_turn).at[k] + i), n, turn);
      }
      const BlockVec distance = hn::Max(hn::Sub(hn::Sqrt(squared), hn::Set(d, error_)), hn::Zero(d));
      const BlockVec above = hn::Max(hn::Add(height, hn::Set(d, error_)), hn::Set(d, 1e-30f));
      hn::Store(hn::Div(hn::Mul(hn::Mul(distance, distance), hn::Set(d, 0.5f - 1e-5f)), above), d, least + i);
      const auto turns = hn::Ge(turn, hn::Set(d, least_turn_));
      const auto met = hn::And(hn::Ge(height, hn::Set(d, -error_)), hn::Le(from_centre, hn::Set(d, reach_)));
      near |= closest::HWY_NAMESPACE::bits_of(d, hn::And(turns, met)) << i;
    }
    return near & ((1u << node.count) - 1);
  }
  void leaf(const tree::OpenNode& open) {
    const uint32_t leaf = open.leaf_number();
    const sites::FaceFrames& faces = frames_[leaf];
    uint32_t near = near_faces(faces, normals_.of_leaf[leaf]) &
                    ((1u << (sites_.regions.leaves[leaf + 1] - sites_.regions.leaves[leaf])) - 1);
    while (near != 0) {
      const double radius = stop_.stop(stop_.data, faces.face[std::countr_zero(near)]);
      near &= near - 1;
      if (!(radius < least_)) continue;
      limit(radius);
      if (near != 0) near &= near_faces(faces, normals_.of_leaf[leaf]);
    }
  }

 private:
  // Beyond this radius in the unit frame, all boxes and faces are within reach.
  static constexpr double kLarge = 8;

  // The faces that may stop the ball, as bits; unused lanes too.
  uint32_t near_faces(const sites::FaceFrames& faces, const EightVectors& normals) const {
    const Block d;
    uint32_t near = 0;
    for (size_t i = 0; i < sites::FaceFrames::kWidth; i += hn::Lanes(d)) {
      const auto turns = hn::Ge(dot(load(d, normals.at, i), splat(d, normal_)), hn::Set(d, least_turn_));
      const auto met = hn::Le(squared_to_faces(faces, i, centre_), hn::Set(d, reach_));
      near |= closest::HWY_NAMESPACE::bits_of(d, hn::And(turns, met)) << i;
    }
    return near;
  }

  // Sets the ball to the least radius so far.
  void limit(double radius) {
    least_ = radius;
    const double unit = sites_.frame.scale * radius;
    float most = 0;
    const bool large = !(unit < kLarge);
    for (int k = 0; k < 3; ++k) {
      centre_[k] = large ? point_[k] : static_cast<float>(unit_[k] + unit * n_[k]);
      most = std::max({most, std::abs(point_[k]), std::abs(centre_[k])});
    }
    error_ = closest::distance_error(most, sites_.regions.largest_radius) + 2e-6f;
    radius_ = static_cast<float>(unit) * closest::kFarther + error_;
    reach_ = large ? std::numeric_limits<float>::max() : radius_ * radius_;
  }

  const sites::SitesData& sites_;
  const WallNormals& normals_;
  sites::LeafFrames::View frames_;
  const StopByFace& stop_;
  const Vec3 unit_, n_;  // p and n
  float point_[3], normal_[3], centre_[3];
  const float least_turn_;
  double least_;                  // radius so far, and in the unit frame:
  float radius_, reach_, error_;  // more than it; the square of that; the error of distances and heights
};

}  // namespace

void ForEachNearWall(const sites::SitesData& sites, const WallNormals& normals, const Touching& ball,
                     double least_turn, double radius, const StopByFace& stop,
                     std::vector<tree::OpenNode>& stack) {
  tree::visit(sites.wide, stack, NearWalls(sites, normals, ball, least_turn, radius, stop));
}

}  // namespace sdm::thickness::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sdm::thickness {

HWY_EXPORT(ForEachNearWall);

void for_each_near_wall(const sites::SitesData& sites, const WallNormals& normals, const Touching& ball,
                        double least_turn, double radius, const StopByFace& stop,
                        std::vector<tree::OpenNode>& stack) {
  HWY_DYNAMIC_DISPATCH(ForEachNearWall)(sites, normals, ball, least_turn, radius, stop, stack);
}

}  // namespace sdm::thickness
#endif
