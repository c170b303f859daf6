#include "bodies/convex/pose_packet.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bodies/convex/pose_packet.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string_view>

#include "bodies/convex/pose_lanes-inl.h"

#ifndef SDM_POSE_PACKET_ONCE
#define SDM_POSE_PACKET_ONCE
namespace sdm::convex {
namespace {

constexpr double kMostSkew = 3e-7;  // which poses in single precision have less of

// Steps of the searches, in their order: those that find most first. With more planes, a step takes so long
// that poses one by one take less.
constexpr char kApart = 'a', kCentres = 'c';  // others: at a point that may be inside
constexpr std::string_view kSteps = "aciaiaiaiaiiiaiiiaiiiaiiii", kFewSteps = "acaiaiai",
                           kFewestSteps = "aca";
constexpr std::size_t kManyPlanes = 150, kMostPlanes = 600;

// Poses by their entries. Of those that are not used, the offset is NaN, which decides nothing.
struct PoseEntries {
  alignas(64) double turn[3][3][PosePacket::kPoses];
  alignas(64) double offset[3][PosePacket::kPoses];

  explicit PoseEntries(std::span<const Transform> poses) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    for (std::size_t i = 0; i < PosePacket::kPoses; ++i) {
      const auto& rows = poses[std::min(i, poses.size() - 1)].rows;
      for (int j = 0; j < 3; ++j) {
        for (int k = 0; k < 3; ++k) turn[j][k][i] = rows[j][k];
        offset[j][i] = rows[j][3];
      }
      if (rows[3] != std::array<double, 4>{0, 0, 0, 1}) offset[0][i] = kNone;
    }
  }
};

}  // namespace
}  // namespace sdm::convex
#endif

HWY_BEFORE_NAMESPACE();
namespace sdm::convex::HWY_NAMESPACE {
namespace {

using Doubles = hn::CappedTag<double, 8>;

// Sets the entries of poses that are rotations and translations, to rounding; others have NaN.
HWY_INLINE void place(const PosePacket::Data& data, const PoseEntries& poses, OpenPoses& open) {
  const Doubles d;
  const hn::Rebind<float, Doubles> df;
  using Vec = hn::Vec<Doubles>;
  const Vec inverse = hn::Set(d, 1 / data.unit);
  for (std::size_t i = 0; i < PosePacket::kPoses; i += hn::Lanes(d)) {
    Vec r[3][3], skew = hn::Zero(d), far = hn::Zero(d), between[3];
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) r[j][k] = hn::Load(d, poses.turn[j][k] + i);
    for (int j = 0; j < 3; ++j)
      for (int k = j; k < 3; ++k) {
        const Vec along =
            hn::MulAdd(r[j][2], r[k][2], hn::MulAdd(r[j][1], r[k][1], hn::Mul(r[j][0], r[k][0])));
        skew = hn::Max(skew, hn::Abs(hn::Sub(along, hn::Set(d, j == k ? 1 : 0))));
      }
    Vec determinant = hn::Zero(d);
    for (int k = 0; k < 3; ++k) {
      const int l = (k + 1) % 3, m = (k + 2) % 3;
      determinant =
          hn::MulAdd(r[0][k], hn::Sub(hn::Mul(r[1][l], r[2][m]), hn::Mul(r[1][m], r[2][l])), determinant);
    }
    const Vec3& centre = data.moving->centre;
    for (int j = 0; j < 3; ++j) {
      const Vec offset = hn::Load(d, poses.offset[j] + i);
      far = hn::Add(far, hn::Abs(offset));
      Vec at = hn::Sub(offset, hn::Set(d, data.centre[j]));
      for (int k = 0; k < 3; ++k) at = hn::MulAdd(r[j][k], hn::Set(d, centre[k]), at);
      between[j] = hn::Mul(inverse, at);
    }
    const auto rigid =
        hn::And(hn::And(hn::Le(skew, hn::Set(d, data.most_skew)), hn::Le(far, hn::Set(d, data.farthest))),
                hn::Gt(determinant, hn::Zero(d)));
    const Vec none = hn::Set(d, std::numeric_limits<double>::quiet_NaN());
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k)
        hn::Store(hn::DemoteTo(df, r[j][k]), df, open.entry[OpenPoses::kTurn + 3 * j + k] + i);
      const auto at = hn::DemoteTo(df, hn::IfThenElse(rigid, between[j], none));
      hn::Store(at, df, open.entry[OpenPoses::kBetween + j] + i);
      hn::Store(at, df, open.entry[OpenPoses::kNearest + j] + i);
      hn::Store(at, df, open.entry[OpenPoses::kLast + j] + i);
    }
  }
}

}  // namespace

// A step of one search for all poses that are open. decide(lanes) returns a mask of those that are
// `relation`.
template <class Decide>
HWY_INLINE void take_step(const PosePacket::Data& data, OpenPoses& open, std::span<Relation> relations,
                          Relation relation, const Decide& decide) {
  const Floats d;
  std::uint64_t decided = 0;
  for (std::size_t first = 0; first < open.count; first += hn::Lanes(d)) {
    PoseLanes lanes(data, open, first);
    std::array<std::uint8_t, 8> bits{};
    hn::StoreMaskBits(d, decide(lanes), bits.data());
    decided |= (std::uint64_t{bits[0]} | std::uint64_t{bits[1]} << 8) << first;
  }
  if (decided == 0) return;
  for (std::size_t i = 0; i < open.count; ++i)
    if ((decided >> i & 1) != 0) relations[open.pose[i]] = relation;
  open.keep_if([&](std::size_t i) { return relations[open.pose[i]] == Relation::unknown; });
}

// Steps of both searches in turns; poses that are still open close up.
void DecidePoses(const PosePacket::Data& data, std::span<const Transform> poses,
                 std::span<Relation> relations) {
  OpenPoses open;
  place(data, PoseEntries(poses), open);
  open.count = poses.size();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    open.pose[i] = static_cast<std::uint8_t>(i);
    relations[i] = Relation::unknown;
  }
  for (const char step : data.steps) {
    if (open.count < data.least_open) return;
    if (step == kApart)
      take_step(data, open, relations, Relation::apart, [](PoseLanes& lanes) { return lanes.apart(); });
    else if (data.has_planes && step == kCentres)
      take_step(data, open, relations, Relation::overlap,
                [](PoseLanes& lanes) { return lanes.overlap_between_centres(); });
    else if (data.has_planes)
      take_step(data, open, relations, Relation::overlap,
                [](PoseLanes& lanes) { return lanes.overlap_at_inner_point(); });
  }
}

}  // namespace sdm::convex::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sdm::convex {

HWY_EXPORT(DecidePoses);

PosePacket::PosePacket(const ConvexMesh& moving, const ConvexMesh& resting, const mesh::Similarity& pose) {
  const double rest_size = pose.scale * resting.size, unit = moving.size + rest_size;
  const Vec3 centre = pose.map(resting.centre);
  data_ = {.moving = &moving,
           .resting = &resting,
           .turn = {},
           .centre = centre,
           .unit = unit,
           .moving_size = static_cast<float>(moving.size / unit),
           .rest_size = static_cast<float>(rest_size / unit),
           .most_skew = kMostSkew / (1 + norm(moving.centre) / unit),
           .farthest = 0,
           .least_inside = 0,
           .has_planes = !moving.planes[0].empty() && !resting.planes[0].empty(),
           .least_open = 1,
           .steps = {},
           .usable = true};
  for (int j = 0; j < 3; ++j)
    for (int k = 0; k < 3; ++k) data_.turn[j][k] = pose.map.rows[k][j] / pose.scale;
  // Beyond these, errors of centres in double precision or by the skew are not below 1e-7 units; as are
  // numbers that single precision does not have.
  constexpr double kFar = 1e6, kLeastUnit = 1e-20, kMostUnit = 1e20, kLeastSize = 1e-4;
  data_.farthest = kFar * unit;
  const double thickness = std::min(moving.inner_radius, pose.scale * resting.inner_radius) / unit;
  data_.least_inside = static_cast<float>(kPoseMargin / thickness);
  // A step costs as much as a pose by itself, for so many points.
  constexpr std::size_t kPerPose = 400, kMostPoints = 600;
  const std::size_t points = moving.points.size() + resting.points.size();
  data_.least_open = 1 + points / kPerPose;
  const std::size_t planes = moving.planes[0].size() + resting.planes[0].size();
  data_.steps = planes > kMostPlanes ? kFewestSteps : planes > kManyPlanes ? kFewSteps : kSteps;
  data_.usable = points <= kMostPoints && unit > kLeastUnit && unit < kMostUnit &&
                 norm(moving.centre) < kFar * unit && norm(centre) < kFar * unit &&
                 norm(pose.map.offset) < kFar * unit && std::min(moving.size, rest_size) > kLeastSize * unit;
}

void PosePacket::decide(std::span<const Transform> poses, std::span<Relation> relations) const {
  if (data_.usable && !poses.empty()) return HWY_DYNAMIC_DISPATCH(DecidePoses)(data_, poses, relations);
  std::ranges::fill(relations, Relation::unknown);
}

}  // namespace sdm::convex
#endif
