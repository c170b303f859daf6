#include "map/measures/near_walls.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "map/measures/near_walls.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <limits>

#include "closest/face_distances-inl.h"
#include "map/measures/thickness_measure.h"
#include "map/measures/touching_ball-inl.h"
#include "tree/visit.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::thickness::HWY_NAMESPACE {
namespace {

using namespace closest::HWY_NAMESPACE;

// Searches for a packet of balls; the policy of its search of the tree. A wall within the ball of the least
// radius so far, R, stops a smaller one: boxes and faces are compared with the balls around c = p + R n. The
// node nearest to the centre of all these comes first; boxes are compared with all balls at once, and the
// faces of a leaf with each ball that is near enough to its box. Faces that are near in single precision are
// compared in double precision, several at a time.
class BallSearch {
 public:
  static constexpr size_t kSize = BallMemory::kPacket;

  BallSearch(const Walls& walls, std::span<const WallStart> starts, std::span<const WallEnd> known,
             std::span<WallEnd> ends)
      : walls_(walls),
        sites_(walls.sites()),
        frames_(sites_.frames, closest::frame_source(sites_)),
        starts_(starts),
        ends_(ends),
        least_turn_(static_cast<float>(walls.least_turn()) - 1e-6f) {
    static_assert(kSize == closest::PointGroup::kPacket);
    std::fill_n(lower_, 3, std::numeric_limits<float>::infinity());
    std::fill_n(upper_, 3, -std::numeric_limits<float>::infinity());
    for (size_t i = 0; i < kSize; ++i) {
      const WallStart& start = starts[std::min(i, starts.size() - 1)];
      n_[i] = walls.inward(start.face);
      one_solid_ = one_solid_ && walls.component(start.face) == walls.component(starts[0].face);
      const Vec3 unit = sites_.frame.to_unit(start.point);
      for (int k = 0; k < 3; ++k) {
        point_[k][i] = static_cast<float>(unit[k]);
        normal_[k][i] = static_cast<float>(n_[i][k]);
        lower_[k] = std::min(lower_[k], normal_[k][i]);
        upper_[k] = std::max(upper_[k], normal_[k][i]);
      }
      radius_[i] = i < starts.size() ? unit_radius(ends[i].thickness / 2) : -1;  // near nothing
    }
    for (const WallEnd& end : known) offer(end);
    find_balls();
    for (int k = 0; k < 3; ++k) {
      const auto [least, most] = std::minmax_element(centre_[k], centre_[k] + kSize);
      middle_[k] = 0.5f * (*least + *most);
    }
    find_reach();
  }

  using Open = closest::SinglePointMemory::Open;
  static bool before(float first, float second) { return first < second; }
  bool enter(const Open& open) {
    if (open.above == nullptr) return true;
    if (!(open.bound <= squared_reach_)) return false;
    const Points d;
    const auto side = [&](const float(&rows)[3][tree::WideTree::kWidth]) HWY_ATTR {
      return Vec3Of<PointVec>{hn::Set(d, rows[0][open.slot]), hn::Set(d, rows[1][open.slot]),
                              hn::Set(d, rows[2][open.slot])};
    };
    const tree::WideTree::Node& node = *open.above;
    const Vec3Of<PointVec> lo = side(node.lower), hi = side(node.upper);
    near_ = 0;
    for (size_t i = 0; i < kSize; i += hn::Lanes(d)) {
      const PointVec squared = squared_to_boxes(d, load(d, centre_, i), lo, hi);
      near_ |= closest::HWY_NAMESPACE::bits_of(d, hn::Le(squared, hn::Load(d, reach_ + i))) << i;
    }
    return near_ != 0;
  }
  uint32_t bound(const Open& open, const tree::WideTree::Node& node, float* squared) const {
    const uint32_t near = near_children(node, middle_, squared_reach_, squared);
    const Block d;
    const EightVectors &lo_turn = walls_.normals().lower[open.child],
                       &hi_turn = walls_.normals().upper[open.child];
    uint32_t turning = 0;
    for (size_t i = 0; i < tree::WideTree::kWidth; i += hn::Lanes(d)) {
      BlockVec turn = hn::Zero(d);
      for (int k = 0; k < 3; ++k) {
        const BlockVec lo = hn::Load(d, lo_turn.at[k] + i), hi = hn::Load(d, hi_turn.at[k] + i);
        const BlockVec least = hn::Set(d, lower_[k]), most = hn::Set(d, upper_[k]);
        turn = hn::Add(turn, hn::Max(hn::Max(hn::Mul(least, lo), hn::Mul(least, hi)),
                                     hn::Max(hn::Mul(most, lo), hn::Mul(most, hi))));
      }
      turning |= closest::HWY_NAMESPACE::bits_of(d, hn::Ge(turn, hn::Set(d, least_turn_))) << i;
    }
    return near & turning;
  }
  void leaf(const Open& open) {
    const uint32_t leaf = open.leaf_number();
    const sites::FaceFrames& faces = frames_[leaf];
    const EightVectors& normals = walls_.normals().of_leaf[leaf];
    for (uint32_t near = near_ & near_balls(walls_.normals().leaves[leaf]); near != 0; near &= near - 1) {
      const auto i = static_cast<uint32_t>(std::countr_zero(near));
      for (uint32_t lanes = near_faces(faces, normals, i); lanes != 0; lanes &= lanes - 1)
        compare(i, faces.face[std::countr_zero(lanes)]);
    }
  }
  // Compares what has not been compared.
  void finish() {
    if (waiting_ == 0) return;
    for (size_t lane = waiting_; lane < kLanes; ++lane) set(lane, pairs_[0]);
    take();
  }

 private:
  // Beyond this radius in the unit frame, all boxes and faces are within reach.
  static constexpr float kLarge = 8;

  struct Pair {
    uint32_t ball, face;
  };

  // A radius in the unit frame, rounded up.
  float unit_radius(double radius) const {
    return static_cast<float>(std::min((1 + 1e-6) * sites_.frame.scale * radius, 1e18));
  }

  // Reduces the radii by a point of a wall. In the unit frame, p, n and the point are off by less than kOff
  // together, so that the radius at which the ball reaches the point is not too small.
  void offer(const WallEnd& end) {
    uint32_t stopped = 0xFFFF;
    if (!one_solid_)
      for (size_t i = 0; i < starts_.size(); ++i)
        if (!walls_.same_solid(starts_[i].face, end.face)) stopped &= ~(1u << i);
    if (one_solid_ && !walls_.same_solid(starts_[0].face, end.face)) return;
    constexpr float kOff = 4e-6f;
    const Points d;
    const Vec3 unit = sites_.frame.to_unit(end.point), outward = walls_.outward(end.face);
    const auto rounded = [](const Vec3& v) {
      return std::array{static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
    };
    const Vec3Of<PointVec> at = splat(d, rounded(unit)), away = splat(d, rounded(outward));
    for (size_t i = 0; i < kSize; i += hn::Lanes(d)) {
      const Vec3Of<PointVec> q = sub(at, load(d, point_, i)), n = load(d, normal_, i);
      const PointVec height = hn::Sub(lanes::HWY_NAMESPACE::dot(n, q), hn::Set(d, kOff)),
                     distance = hn::Add(hn::Sqrt(lanes::HWY_NAMESPACE::dot(q, q)), hn::Set(d, kOff)),
                     radius = hn::Div(hn::Mul(hn::Mul(distance, distance), hn::Set(d, 0.5f + 1e-6f)), height),
                     turn = lanes::HWY_NAMESPACE::dot(n, away), before = hn::Load(d, radius_ + i);
      const uint8_t bytes[8] = {static_cast<uint8_t>(stopped >> i), static_cast<uint8_t>(stopped >> i >> 8)};
      const auto reached =
          hn::And(hn::Gt(height, hn::Zero(d)), hn::Ge(turn, hn::Set(d, least_turn_ + 2e-6f)));
      const auto less = hn::And(hn::LoadMaskBits(d, bytes), hn::And(reached, hn::Lt(radius, before)));
      hn::Store(hn::IfThenElse(less, radius, before), d, radius_ + i);
    }
  }

  // The balls that faces of a leaf may stop, as bits. Axes are orthonormal up to 2e-7, which is less than
  // what reach is larger by.
  uint32_t near_balls(const LeafWalls& walls) const {
    const Points d;
    uint32_t near = 0;
    for (size_t i = 0; i < kSize; i += hn::Lanes(d)) {
      const Vec3Of<PointVec> c = load(d, centre_, i);
      PointVec squared = hn::Zero(d), turn = hn::Zero(d);
      for (int k = 0; k < 3; ++k) {
        const PointVec x = lanes::HWY_NAMESPACE::dot(c, splat(d, walls.axis[k])),
                       n = hn::Load(d, normal_[k] + i);
        const PointVec off =
            hn::Sub(x, hn::Min(hn::Max(x, hn::Set(d, walls.lower[k])), hn::Set(d, walls.upper[k])));
        squared = hn::MulAdd(off, off, squared);
        turn = hn::Add(turn, hn::Max(hn::Mul(n, hn::Set(d, walls.normals.lower[k])),
                                     hn::Mul(n, hn::Set(d, walls.normals.upper[k]))));
      }
      const auto met =
          hn::And(hn::Le(squared, hn::Load(d, reach_ + i)), hn::Ge(turn, hn::Set(d, least_turn_)));
      near |= closest::HWY_NAMESPACE::bits_of(d, met) << i;
    }
    return near;
  }

  // The faces that may stop the ball, as bits.
  uint32_t near_faces(const sites::FaceFrames& faces, const EightVectors& normals, uint32_t ball) const {
    const Block d;
    const float centre[3] = {centre_[0][ball], centre_[1][ball], centre_[2][ball]};
    const float normal[3] = {normal_[0][ball], normal_[1][ball], normal_[2][ball]};
    uint32_t near = 0;
    for (size_t i = 0; i < sites::FaceFrames::kWidth; i += hn::Lanes(d)) {
      const auto turns = hn::Ge(lanes::HWY_NAMESPACE::dot(load(d, normals.at, i), splat(d, normal)),
                                hn::Set(d, least_turn_));
      const auto met =  // false in unused lanes
          hn::Le(squared_to_faces(faces, i, centre), hn::Set(d, reach_[ball]));
      near |= closest::HWY_NAMESPACE::bits_of(d, hn::And(turns, met)) << i;
    }
    return near;
  }

  void set(size_t lane, const Pair& pair) {
    balls_.set(lane, starts_[pair.ball].point, n_[pair.ball], corners_of(sites_.mesh, pair.face));
  }

  void compare(uint32_t ball, uint32_t face) {
    if (!walls_.stops(starts_[ball].face, face)) return;
    pairs_[waiting_] = {ball, face};
    set(waiting_, pairs_[waiting_]);
    if (++waiting_ == kLanes) take();
  }

  void take() {
    balls_.compute(waiting_);
    bool reduced = false;
    for (size_t lane = 0; lane < waiting_; ++lane) {
      const auto [ball, face] = pairs_[lane];
      WallEnd& end = ends_[ball];
      const double thickness = 2 * balls_.radius[lane];
      // The first one by (radius, face), so that the order of the search does not matter.
      if (!(thickness < end.thickness ||
            (thickness == end.thickness && end.face != kNone && face < end.face)))
        continue;
      end = {thickness, {balls_.point[0][lane], balls_.point[1][lane], balls_.point[2][lane]}, face};
      const float radius = unit_radius(balls_.radius[lane]);
      if (!(radius < radius_[ball])) continue;
      radius_[ball] = radius;
      offer(end);
      reduced = true;
    }
    waiting_ = 0;
    if (!reduced) return;
    find_balls();
    find_reach();
  }

  // Sets the balls by their radii.
  void find_balls() {
    const Points d;
    const PointVec large = hn::Set(d, kLarge), one = hn::Set(d, 1.0f);
    const PointVec error = hn::Set(d, closest::distance_error(0, sites_.regions.largest_radius) + 2e-6f);
    for (size_t i = 0; i < kSize; i += hn::Lanes(d)) {
      const PointVec radius = hn::Load(d, radius_ + i);
      const auto is_large = hn::Ge(radius, large);
      const PointVec height = hn::IfThenZeroElse(is_large, radius);
      const Vec3Of<PointVec> centre = add_mul(load(d, point_, i), height, load(d, normal_, i));
      hn::Store(centre.x, d, centre_[0] + i);
      hn::Store(centre.y, d, centre_[1] + i);
      hn::Store(centre.z, d, centre_[2] + i);
      const PointVec most =
          hn::Max(hn::Max(hn::Abs(centre.x), hn::Abs(centre.y)), hn::Max(hn::Abs(centre.z), one));
      // See closest::distance_error(); the centre is off by 1e-6 of its coordinates at most.
      const PointVec off = hn::MulAdd(most, hn::Set(d, 1.5e-6f), error);
      const PointVec reach = hn::MulAdd(radius, hn::Set(d, closest::kFarther), off);
      const PointVec squared =
          hn::IfThenElse(is_large, hn::Set(d, std::numeric_limits<float>::max()), hn::Mul(reach, reach));
      hn::Store(hn::IfThenElse(hn::Lt(radius, hn::Zero(d)), hn::Set(d, -1.0f), squared), d, reach_ + i);
    }
  }

  // No box farther than this from the middle is within the reach of any ball.
  void find_reach() {
    const Points d;
    PointVec most = hn::Zero(d);
    for (size_t i = 0; i < kSize; i += hn::Lanes(d)) {
      const Vec3Of<PointVec> r = sub(load(d, centre_, i), splat(d, middle_));
      const PointVec squared = hn::Load(d, reach_ + i);
      const PointVec reach =
          hn::Add(hn::Sqrt(hn::Max(squared, hn::Zero(d))), hn::Sqrt(lanes::HWY_NAMESPACE::dot(r, r)));
      most = hn::Max(most, hn::IfThenElseZero(hn::Ge(squared, hn::Zero(d)), reach));
    }
    const float reach = hn::GetLane(hn::MaxOfLanes(d, most)) * closest::kFarther;
    squared_reach_ = reach * reach;
  }

  const Walls& walls_;
  const sites::SitesData& sites_;
  sites::LeafFrames::View frames_;
  const std::span<const WallStart> starts_;
  const std::span<WallEnd> ends_;
  const float least_turn_;
  Vec3 n_[kSize];
  bool one_solid_ = true;  // whether all start on one component
  // In the unit frame:
  alignas(64) float point_[3][kSize], normal_[3][kSize];
  alignas(64) float radius_[kSize];  // the balls are stopped within it; negative: there is no ball
  alignas(64) float centre_[3][kSize];
  alignas(64) float reach_[kSize];  // the square of more than the radius; negative: there is no ball
  float lower_[3], upper_[3];       // of the normals
  float middle_[3], squared_reach_;
  uint32_t near_ = 0;  // balls, as bits
  SmallestBalls balls_;
  Pair pairs_[kLanes];  // that wait to be compared
  size_t waiting_ = 0;
};

}  // namespace

void FindBallEnds(const Walls& walls, std::span<const WallStart> starts, std::span<const WallEnd> known,
                  std::span<WallEnd> ends, BallMemory& memory) {
  BallSearch search(walls, starts, known, ends);
  tree::visit(walls.sites().wide, memory.stack, search);
  search.finish();
}

}  // namespace sdm::thickness::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sdm::thickness {

HWY_EXPORT(FindBallEnds);

void find_ball_ends(const Walls& walls, std::span<const WallStart> starts, std::span<const WallEnd> known,
                    std::span<WallEnd> ends, BallMemory& memory) {
  HWY_DYNAMIC_DISPATCH(FindBallEnds)(walls, starts, known, ends, memory);
}

}  // namespace sdm::thickness
#endif
