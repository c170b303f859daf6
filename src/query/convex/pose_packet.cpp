#include "query/convex/pose_packet.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "query/convex/pose_packet.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>

#include "geometry/vec.h"

// Lengths are in units of the size of both bodies, so that no vertex is farther from the centre of its body
// than 1. Errors, of that unit: 4e-7 of vertices and centres, as they are rounded to single precision and
// turned, 1e-6 by the skew of a pose, and 5e-7 · |v| of a product of them with v. kMargin is more than all.
#ifndef SDM_POSE_PACKET_ONCE
#define SDM_POSE_PACKET_ONCE
namespace sdm::convex {
namespace {

constexpr float kMargin = 4e-6F;
constexpr double kMostSkew = 3e-7;   // which poses in single precision have less of
constexpr float kInside = 0.999F;    // of the heights of planes: how far inside both a point is looked for
constexpr float kRelaxation = 1.9F;  // of the way to a plane, by which a point is moved: almost a reflection

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

// Poses that are not decided, in units.
struct OpenPoses {
  static constexpr std::size_t kColumns = 21;
  std::size_t count = 0;
  std::array<std::uint8_t, PosePacket::kPoses> pose{};
  /// Rotations by rows, the centre of the body relative to that of the body at rest; what searches have come
  /// to: a point of the difference of the bodies, the last vertex of it, and a point that may be inside both.
  alignas(64) float entry[kColumns][PosePacket::kPoses];
  static constexpr int kTurn = 0, kBetween = 9, kNearest = 12, kLast = 15, kInner = 18;

  /// Keeps those for which keep(i), and some others, too, as it takes longer to move all than to compare
  /// these once more.
  template <class Keep>
  void keep_if(const Keep& keep) {
    constexpr std::size_t kFew = 4;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) kept += keep(i) ? 1 : 0;
    if (kept > 0 && count - kept < kFew) return;
    kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (!keep(i)) continue;
      pose[kept] = pose[i];
      for (auto& column : entry) column[kept] = column[i];
      ++kept;
    }
    count = kept;
  }
};

}  // namespace
}  // namespace sdm::convex
#endif

HWY_BEFORE_NAMESPACE();
namespace sdm::convex::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {

using Doubles = hn::CappedTag<double, 8>;
using Floats = hn::CappedTag<float, 16>;
using Lanes = hn::Vec<Floats>;
using LaneMask = hn::Mask<Floats>;
using Coordinates = std::array<std::vector<float>, 3>;

struct LaneVec {
  Lanes x, y, z;
};

HWY_INLINE Lanes product(const LaneVec& a, const LaneVec& b) {
  return hn::MulAdd(a.z, b.z, hn::MulAdd(a.y, b.y, hn::Mul(a.x, b.x)));
}
HWY_INLINE LaneVec sum(const LaneVec& a, Lanes t, const LaneVec& b) {
  return {hn::MulAdd(t, b.x, a.x), hn::MulAdd(t, b.y, a.y), hn::MulAdd(t, b.z, a.z)};
}
HWY_INLINE LaneVec difference(const LaneVec& a, const LaneVec& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}

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

// The bodies in the poses of the lanes.
class PoseLanes {
 public:
  PoseLanes(const PosePacket::Data& data, OpenPoses& open, std::size_t first)
      : data_(data), open_(open), first_(first) {
    for (int j = 0; j < 3; ++j) turn_[j] = load(OpenPoses::kTurn + 3 * j);
    between_ = load(OpenPoses::kBetween);
  }

  // Whether a point of the line between the centres is inside both: the part of it in a body is 1 / k long,
  // where k is the largest height of the other centre above a plane of it, relative to that of the plane.
  [[nodiscard]] HWY_INLINE LaneMask overlap_between_centres() {
    const Lanes length = hn::Sqrt(product(between_, between_));
    const LaneVec back = to_moving(between_);
    const Lanes rest = above(*data_.resting, to_resting(between_), data_.rest_size, length).most;
    const Lanes move =
        above(*data_.moving, {hn::Neg(back.x), hn::Neg(back.y), hn::Neg(back.z)}, data_.moving_size, length)
            .most;
    const Lanes sum_of_both = hn::Add(rest, move);
    const Lanes part = hn::Div(move, hn::Max(sum_of_both, hn::Set(d_, 1e-6F)));
    store(OpenPoses::kInner,
          {hn::Mul(part, between_.x), hn::Mul(part, between_.y), hn::Mul(part, between_.z)});
    return hn::Ge(hn::Mul(hn::Set(d_, 1 - data_.least_inside), sum_of_both), hn::Mul(rest, move));
  }

  // Whether a point is inside both. It is moved to the plane of each body that it is farthest above, and a
  // little beyond (Agmon 1954).
  [[nodiscard]] HWY_INLINE LaneMask overlap_at_inner_point() {
    LaneVec p = load(OpenPoses::kInner);
    const Lanes one = hn::Set(d_, 1), two = hn::Set(d_, 2);
    const Above rest = above(*data_.resting, to_resting(p), data_.rest_size, two);
    const Above move = above(*data_.moving, to_moving(difference(p, between_)), data_.moving_size, two);
    const LaneMask inside = hn::And(hn::Lt(rest.most, one), hn::Lt(move.most, one));
    const LaneVec by_rest = from_resting(down(rest, data_.rest_size)),
                  by_move = posed(down(move, data_.moving_size));
    const LaneMask farther = hn::Gt(move.most, rest.most);
    p = {hn::Sub(p.x, hn::IfThenElse(farther, by_move.x, by_rest.x)),
         hn::Sub(p.y, hn::IfThenElse(farther, by_move.y, by_rest.y)),
         hn::Sub(p.z, hn::IfThenElse(farther, by_move.z, by_rest.z))};
    store(OpenPoses::kInner, p);
    return inside;
  }

  // Gilbert 1966: v is a point of the difference of the bodies, towards the one that is nearest to the
  // origin. A step takes the nearest one of the triangle of v, the farthest point against it, and that of the
  // step before. The bodies are apart if all of the difference is on the side of v.
  [[nodiscard]] HWY_INLINE LaneMask apart() {
    const LaneVec v = load(OpenPoses::kNearest), w = lowest(v);
    const Lanes margin =
        hn::Mul(hn::Set(d_, kMargin), hn::Add(hn::Set(d_, 1), hn::Sqrt(product(between_, between_))));
    const Lanes height = product(v, w), squared = product(v, v);
    store(OpenPoses::kNearest, nearest_of_triangle(v, w, load(OpenPoses::kLast)));
    store(OpenPoses::kLast, w);
    return hn::And(hn::Gt(height, hn::Zero(d_)),
                   hn::Gt(hn::Mul(height, height), hn::Mul(hn::Mul(margin, margin), squared)));
  }

 private:
  [[nodiscard]] HWY_INLINE LaneVec load(int column) const {
    return {hn::Load(d_, open_.entry[column] + first_), hn::Load(d_, open_.entry[column + 1] + first_),
            hn::Load(d_, open_.entry[column + 2] + first_)};
  }
  HWY_INLINE void store(int column, const LaneVec& v) {
    hn::Store(v.x, d_, open_.entry[column] + first_);
    hn::Store(v.y, d_, open_.entry[column + 1] + first_);
    hn::Store(v.z, d_, open_.entry[column + 2] + first_);
  }

  [[nodiscard]] HWY_INLINE LaneVec to_moving(const LaneVec& v) const {
    const auto along = [&](Lanes LaneVec::*k) {
      return hn::MulAdd(turn_[2].*k, v.z, hn::MulAdd(turn_[1].*k, v.y, hn::Mul(turn_[0].*k, v.x)));
    };
    return {along(&LaneVec::x), along(&LaneVec::y), along(&LaneVec::z)};
  }
  [[nodiscard]] HWY_INLINE LaneVec to_resting(const LaneVec& v) const {
    const auto along = [&](const Vec3& row) { return product({set(row[0]), set(row[1]), set(row[2])}, v); };
    return {along(data_.turn[0]), along(data_.turn[1]), along(data_.turn[2])};
  }
  [[nodiscard]] HWY_INLINE Lanes set(double x) const { return hn::Set(d_, static_cast<float>(x)); }

  [[nodiscard]] HWY_INLINE LaneVec from_resting(const LaneVec& v) const {
    const auto along = [&](int j) {
      return product({set(data_.turn[0][j]), set(data_.turn[1][j]), set(data_.turn[2][j])}, v);
    };
    return {along(0), along(1), along(2)};
  }
  [[nodiscard]] HWY_INLINE LaneVec posed(const LaneVec& v) const {
    return {product(turn_[0], v), product(turn_[1], v), product(turn_[2], v)};
  }

  // The largest height above a plane, relative to that of the plane: at most, but for `nearly`. A point is
  // inside if it is below 1.
  struct Above {
    Lanes most, nearly;
    LaneVec plane;
  };
  // The support along u, about the centre; `length`: at least that of u. `size`: of the body, in units.
  [[nodiscard]] HWY_INLINE Above above(const ConvexMesh& mesh, const LaneVec& u, float size,
                                       Lanes length) const {
    const hn::RebindToSigned<Floats> di;
    const float *x = mesh.planes[0].data(), *y = mesh.planes[1].data(), *z = mesh.planes[2].data();
    const Lanes scale = hn::Set(d_, 1 / size);
    const LaneVec v{hn::Mul(u.x, scale), hn::Mul(u.y, scale), hn::Mul(u.z, scale)};
    Lanes most = hn::Zero(d_);
    auto at = hn::Zero(di);
    for (std::size_t i = 0; i < mesh.planes[0].size(); ++i) {
      const Lanes height = product({hn::Set(d_, x[i]), hn::Set(d_, y[i]), hn::Set(d_, z[i])}, v);
      const auto higher = hn::Gt(height, most);
      most = hn::Max(most, height);
      at = hn::IfThenElse(hn::RebindMask(di, higher), hn::Set(di, static_cast<std::int32_t>(i)), at);
    }
    const double thickness = mesh.inner_radius / mesh.size * size;
    return {hn::MulAdd(length, set(kMargin / thickness), most),
            most,
            {hn::GatherIndex(d_, x, at), hn::GatherIndex(d_, y, at), hn::GatherIndex(d_, z, at)}};
  }
  // The way from there to the plane, and a little beyond.
  [[nodiscard]] HWY_INLINE LaneVec down(const Above& above, float size) const {
    const Lanes t =
        hn::Mul(hn::Set(d_, kRelaxation * size),
                hn::Div(hn::Sub(above.nearly, hn::Set(d_, kInside)), product(above.plane, above.plane)));
    return {hn::Mul(t, above.plane.x), hn::Mul(t, above.plane.y), hn::Mul(t, above.plane.z)};
  }

  // The point of the segments from w to v and to u, or of the triangle, that is nearest to the origin.
  [[nodiscard]] HWY_INLINE LaneVec nearest_of_triangle(const LaneVec& v, const LaneVec& w,
                                                       const LaneVec& u) const {
    const Lanes zero = hn::Zero(d_), one = hn::Set(d_, 1), least = hn::Set(d_, 1e-20F);
    const LaneVec a = difference(v, w), b = difference(u, w);
    const Lanes aa = hn::Max(product(a, a), least), bb = hn::Max(product(b, b), least), ab = product(a, b);
    const Lanes wa = hn::Neg(product(w, a)), wb = hn::Neg(product(w, b));
    const auto part = [&](Lanes x, Lanes length) { return hn::Min(hn::Max(hn::Div(x, length), zero), one); };
    const LaneVec on_a = sum(w, part(wa, aa), a), on_b = sum(w, part(wb, bb), b);
    const LaneMask b_nearer = hn::Lt(product(on_b, on_b), product(on_a, on_a));
    LaneVec best = choose(b_nearer, on_b, on_a);
    const Lanes determinant = hn::Max(hn::Sub(hn::Mul(aa, bb), hn::Mul(ab, ab)), least);
    const Lanes s = hn::Div(hn::Sub(hn::Mul(wa, bb), hn::Mul(wb, ab)), determinant);
    const Lanes t = hn::Div(hn::Sub(hn::Mul(wb, aa), hn::Mul(wa, ab)), determinant);
    const LaneMask within = hn::And(hn::And(hn::Ge(s, zero), hn::Ge(t, zero)), hn::Le(hn::Add(s, t), one));
    return choose(within, sum(sum(w, s, a), t, b), best);
  }
  static HWY_INLINE LaneVec choose(LaneMask which, const LaneVec& a, const LaneVec& b) {
    return {hn::IfThenElse(which, a.x, b.x), hn::IfThenElse(which, a.y, b.y),
            hn::IfThenElse(which, a.z, b.z)};
  }

  // The point of the difference with the least height along v.
  [[nodiscard]] HWY_INLINE LaneVec lowest(const LaneVec& v) const {
    const LaneVec m = to_moving(v);
    const LaneVec rest = from_resting(farthest(*data_.resting, to_resting(v), data_.rest_size));
    const LaneVec move =
        posed(farthest(*data_.moving, {hn::Neg(m.x), hn::Neg(m.y), hn::Neg(m.z)}, data_.moving_size));
    return difference({hn::Add(between_.x, move.x), hn::Add(between_.y, move.y), hn::Add(between_.z, move.z)},
                      rest);
  }
  // The vertex that is farthest along u, in units about the centre.
  [[nodiscard]] HWY_INLINE LaneVec farthest(const ConvexMesh& mesh, const LaneVec& u, float size) const {
    const hn::RebindToSigned<Floats> di;
    const float *x = mesh.along[0].data(), *y = mesh.along[1].data(), *z = mesh.along[2].data();
    Lanes most = hn::Set(d_, -std::numeric_limits<float>::infinity());
    auto at = hn::Zero(di);
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
      const Lanes height = product({hn::Set(d_, x[i]), hn::Set(d_, y[i]), hn::Set(d_, z[i])}, u);
      const auto higher = hn::Gt(height, most);
      most = hn::Max(most, height);
      at = hn::IfThenElse(hn::RebindMask(di, higher), hn::Set(di, static_cast<std::int32_t>(i)), at);
    }
    const Lanes scale = hn::Set(d_, size);
    return {hn::Mul(scale, hn::GatherIndex(d_, x, at)), hn::Mul(scale, hn::GatherIndex(d_, y, at)),
            hn::Mul(scale, hn::GatherIndex(d_, z, at))};
  }

  const PosePacket::Data& data_;
  OpenPoses& open_;
  const std::size_t first_;
  Floats d_;
  LaneVec turn_[3];  // rows
  LaneVec between_;
};

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
  for (std::size_t i = 0; i < poses.size(); ++i)
    open.pose[i] = static_cast<std::uint8_t>(i), relations[i] = Relation::unknown;
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
  data_.least_inside = static_cast<float>(kMargin / thickness);
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
