#include "closest/single_point.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "closest/single_point.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "closest/candidates-inl.h"
#include "closest/exact.h"
#include "closest/face_distances-inl.h"
#include "closest/far_search-inl.h"
#include "core/nothing_found.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::closest::HWY_NAMESPACE {
namespace {

// What a search may find: all faces, or those that a point does not exclude.
struct AllFaces {
  static constexpr bool kAll = true;
  // Whether a face does not count for a point.
  bool excludes(size_t, uint32_t) const { return false; }
  // The children of a node below which there are faces that count.
  uint32_t open_children(uint32_t) const { return ~0u; }

  // What counts of a leaf.
  struct Leaf {
    Leaf(const AllFaces&, const sites::FaceFrames&) {}
    // The points for which any face counts, as bits.
    uint32_t points() const { return ~0u; }
    // The lanes from this one on that count for a point.
    BlockMask kept(size_t, size_t, BlockMask mask) const { return mask; }
  };
};
struct NotExcluded {
  static constexpr bool kAll = false;
  const ExcludedFaces& excluded;

  bool excludes(size_t point, uint32_t face) const { return excluded.excludes(point, face); }
  uint32_t open_children(uint32_t node) const { return ~uint32_t{excluded.closed[node]}; }

  class Leaf {
   public:
    Leaf(const NotExcluded& faces, const sites::FaceFrames& frames) {
      for (size_t lane = 0; lane < sites::FaceFrames::kWidth; ++lane) {
        const uint32_t face = frames.face[lane];
        by_[lane] = face == kNone ? ~0u : faces.excluded.by[faces.excluded.group_of[face]];
        all_ &= by_[lane];
      }
    }
    uint32_t points() const { return ~all_; }
    HWY_INLINE BlockMask kept(size_t point, size_t i, BlockMask mask) const {
      const hn::RebindToUnsigned<Block> d;
      const auto excluded = hn::TestBit(hn::Load(d, by_ + i), hn::Set(d, 1u << point));
      return hn::AndNot(hn::RebindMask(Block(), excluded), mask);
    }

   private:
    alignas(32) uint32_t by_[sites::FaceFrames::kWidth];  // of each lane: the points that exclude it
    uint32_t all_ = ~0u;                                  // those that exclude all
  };
};

// Searches for one point at a time; the policy of its search of the tree, nearest box first.
template <class Faces>
class PointSearch {
 public:
  PointSearch(const sites::SitesData& sites, const Faces& faces, double max_distance,
              SinglePointMemory& memory)
      : sites_(sites),
        faces_(faces),
        frames_(sites.frames, frame_source(sites)),
        settled_(sites),
        max_distance_(max_distance),
        m_(memory) {}

  // `number`: of the point in the packet that excludes faces; `known`: points of O2 in the unit frame, which
  // may be close to the query.
  ClosestPoint operator()(const Vec3& query, size_t number, std::span<const float[3]> known = {}) {
    number_ = number;
    const ClosestPoint found = search(query, known);
    if constexpr (Faces::kAll)
      if (found.type == SiteType::none && max_distance_ == kInfinity) throw_nothing_found();
    return found;
  }

  static bool before(float first, float second) { return first < second; }
  bool enter(const tree::OpenNode& open) const { return open.bound <= squared_limit_; }
  uint32_t bound(const tree::OpenNode& open, const tree::WideTree::Node& node, float* squared) const {
    return near_children(node, point_, squared_limit_, squared) & faces_.open_children(open.child);
  }
  bool leaf(const tree::OpenNode& open) {
    const sites::FaceFrames& faces = frames_[open.leaf_number()];
    const typename Faces::Leaf counted(faces_, faces);
    compare_faces(
        faces, point_, error_, squared_limit_,
        [&](size_t i, BlockMask mask) HWY_ATTR { return counted.kept(number_, i, mask); },
        [&](float squared, size_t lane) {
          m_.candidates.push_back({squared, faces.face[lane], open.leaf_number(), 0});
        });
    return squared_limit_ > squared_enough_;
  }
  // The search ends with a point that is as close as this.
  void end_within(double distance) { enough_ = distance; }

 private:
  ClosestPoint search(const Vec3& query, std::span<const float[3]> known) {
    const Vec3 unit = sites_.frame.to_unit(query);
    if (!is_near(unit)) return from_afar(query, unit, known);
    for (int k = 0; k < 3; ++k) point_[k] = static_cast<float>(unit[k]);
    error_ = distance_error(std::max({std::abs(point_[0]), std::abs(point_[1]), std::abs(point_[2])}),
                            sites_.regions.largest_radius);
    const float limit = sites_.frame.unit_limit(max_distance_) + error_;
    squared_limit_ = limit * limit;
    // The limit of a face at this distance or less, in spite of rounding.
    const float enough = static_cast<float>((1 - 1e-5) * enough_ * sites_.frame.scale) - error_;
    squared_enough_ = enough > 0 ? enough * enough : -1;
    m_.candidates.clear();
    tree::visit(sites_.wide, m_.stack, *this);
    settled_.compare({&query, 1}, &squared_limit_, m_.candidates, Settled::Equal::in_order);
    return settled_.closest(0, max_distance_);
  }

  // The result of exact_closest().
  ClosestPoint from_afar(const Vec3& query, const Vec3& unit, std::span<const float[3]> known) {
    if constexpr (!Faces::kAll)
      return exact_closest(
          sites_, query, max_distance_, [](uint32_t) { return true; },
          [&](uint32_t face) { return !faces_.excludes(number_, face); });
    if (!(squared_norm(unit) <= kFarthest * kFarthest)) return exact_closest(sites_, query, max_distance_);
    if (lower_bound(sites_.tree.box(0), unit) > max_distance_ * sites_.frame.scale) return {};
    m_.candidates.clear();
    FarSearch search(frames_, unit, m_.candidates);
    search.start_from(known);
    tree::visit(sites_.wide, m_.stack, search);
    settled_.compare({&query, 1}, &search.limit(), m_.candidates, Settled::Equal::by_name);
    return settled_.closest(0, max_distance_);
  }

  const sites::SitesData& sites_;
  const Faces faces_;
  sites::LeafFrames::View frames_;
  Settled settled_;
  const double max_distance_;
  SinglePointMemory& m_;
  size_t number_ = 0;
  float point_[3] = {};      // the query in the unit frame
  float error_ = 0;          // see distance_error()
  float squared_limit_ = 0;  // nothing beyond this in the unit frame is closest
  double enough_ = 0;        // see end_within()
  float squared_enough_ = -1;
};

// Searches for a packet of points that are near each other; the policy of its search of the tree. The node
// nearest to the centre of the points comes first, boxes are compared with all points at once, and the faces
// of a leaf with each point that is near enough to its box.
template <class Faces>
class PacketSearch {
 public:
  static constexpr size_t kSize = SinglePointMemory::kPacket;

  PacketSearch(const sites::SitesData& sites, const Faces& faces, double max_distance,
               SinglePointMemory& memory)
      : sites_(sites),
        faces_(faces),
        frames_(sites.frames, frame_source(sites)),
        settled_(sites),
        alone_(sites, faces, max_distance, memory),
        max_distance_(max_distance),
        m_(memory) {}

  void operator()(std::span<const Vec3> queries, std::span<const uint32_t> order,
                  std::span<ClosestPoint> found) {
    const size_t count = order.size();
    Vec3 packet[kSize];
    for (size_t i = 0; i < kSize; ++i) packet[i] = queries[order[std::min(i, count - 1)]];
    place(packet, count);
    limit();
    m_.candidates.clear();
    if (used_ != 0) tree::visit(sites_.wide, m_.open, *this);
    settled_.compare({packet, count}, squared_limit_, m_.candidates, Settled::Equal::in_order);
    work_.far += static_cast<size_t>(std::popcount(far_ & ((1u << count) - 1)));
    const uint32_t together = far_together(packet, count), alone = (far_ & ~together) | settled_.tied();
    for (size_t i = 0; i < count; ++i) {
      if ((together >> i & 1) != 0) continue;
      ClosestPoint& closest = found[order[i]];
      closest =
          (alone >> i & 1) != 0 ? alone_(packet[i], i, {last_, known_}) : settled_.closest(i, max_distance_);
      if (closest.type != SiteType::none) remember(i, closest);
    }
    if (together != 0) search_from_afar({packet, count}, together, order, found);
  }

  // The closest points that are found from now on are near these.
  void remember(std::span<const ClosestPoint> found) {
    for (const ClosestPoint& closest : found)
      if (closest.type != SiteType::none) remember(known_, closest);
  }

  [[nodiscard]] const PacketWork& work() const { return work_; }

  using Open = SinglePointMemory::Open;
  static bool before(float first, float second) { return first < second; }
  bool enter(const Open& open) {
    if (open.above == nullptr) return true;
    if (!(open.bound <= squared_max_distance_)) return false;
    const Points d;
    const tree::WideTree::Node& node = *open.above;
    const auto side = [&](const float(&rows)[3][tree::WideTree::kWidth]) HWY_ATTR {
      return Vec3Of<PointVec>{hn::Set(d, rows[0][open.slot]), hn::Set(d, rows[1][open.slot]),
                              hn::Set(d, rows[2][open.slot])};
    };
    near_ = 0;
    for (size_t i = 0; i < kSize; i += hn::Lanes(d)) {
      const PointVec least = squared_to_boxes(d, load(d, point_, i), side(node.lower), side(node.upper));
      near_ |= bits_of(d, hn::Le(least, hn::Load(d, squared_limit_ + i))) << i;
    }
    return near_ != 0;
  }
  uint32_t bound(const Open& open, const tree::WideTree::Node& node, float* squared) const {
    return near_children(node, centre_, squared_max_distance_, squared) & faces_.open_children(open.child);
  }
  void leaf(const Open& open) {
    const sites::FaceFrames& faces = frames_[open.leaf_number()];
    const typename Faces::Leaf counted(faces_, faces);
    const uint32_t compared = near_ & counted.points();
    work_.leaves += 1;
    work_.pairs += static_cast<size_t>(std::popcount(compared));
    find_distances(faces, counted, compared);
    const uint32_t nearer = reduce_limits();
    for (uint32_t near = nearer & compared; near != 0; near &= near - 1) {
      const auto i = static_cast<uint32_t>(std::countr_zero(near));
      for (uint32_t lanes = within_limit(i); lanes != 0; lanes &= lanes - 1) {
        const auto lane = static_cast<uint32_t>(std::countr_zero(lanes));
        m_.candidates.push_back({squared_[i][lane], faces.face[lane], open.leaf_number(), i});
      }
    }
  }

 private:
  // Compares the faces of a leaf with the points: as compare_faces(), but in three steps for all of the
  // points, none of which waits for the limit of one point. First, the distances of those faces that are
  // within the limits.
  template <class Leaf>
  HWY_INLINE void find_distances(const sites::FaceFrames& faces, const Leaf& counted, uint32_t points) {
    const Block d;
    std::fill_n(least_, kSize, std::numeric_limits<float>::infinity());
    for (; points != 0; points &= points - 1) {
      const auto i = static_cast<size_t>(std::countr_zero(points));
      const float point[3] = {point_[0][i], point_[1][i], point_[2][i]};
      BlockVec least = hn::Inf(d);
      for (size_t first = 0; first < SiteBlock::kWidth; first += hn::Lanes(d)) {
        const BlockVec squared = squared_to_faces(faces, first, point);
        const auto near = hn::Le(squared, hn::Set(d, squared_limit_[i]));  // false in unused lanes
        const BlockVec counting = hn::IfThenElse(counted.kept(i, first, near), squared, hn::Inf(d));
        hn::Store(counting, d, squared_[i] + first);
        least = hn::Min(least, counting);
      }
      least_[i] = hn::GetLane(hn::MinOfLanes(d, least));
    }
  }

  // Reduces the limits by the least distances; returns the points that have any.
  HWY_INLINE uint32_t reduce_limits() {
    const Points d;
    uint32_t nearer = 0, reduced = 0;
    for (size_t i = 0; i < kSize; i += hn::Lanes(d)) {
      const PointVec least = hn::Load(d, least_ + i), before = hn::Load(d, squared_limit_ + i);
      const PointVec limit = hn::MulAdd(hn::Sqrt(least), hn::Set(d, kFarther), hn::Set(d, error_));
      const PointVec squared = hn::Mul(limit, limit);
      nearer |= bits_of(d, hn::Lt(least, hn::Inf(d))) << i;
      reduced |= bits_of(d, hn::Lt(squared, before)) << i;
      hn::Store(hn::Min(squared, before), d, squared_limit_ + i);
    }
    if (reduced != 0) find_max_distance();
    return nearer;
  }

  // The faces of a leaf that are within the limit of a point, as bits.
  HWY_INLINE uint32_t within_limit(size_t point) const {
    const Block d;
    uint32_t lanes = 0;
    for (size_t i = 0; i < SiteBlock::kWidth; i += hn::Lanes(d))
      lanes |= bits_of(d, hn::Le(hn::Load(d, squared_[point] + i), hn::Set(d, squared_limit_[point]))) << i;
    return lanes;
  }

  // Maps the points into the unit frame. Points that are far away or beyond `count` are near nothing.
  void place(const Vec3* packet, size_t count) {
    far_ = used_ = 0;
    float lo[3], hi[3], most = 0;
    std::fill_n(lo, 3, std::numeric_limits<float>::infinity());
    std::fill_n(hi, 3, -std::numeric_limits<float>::infinity());
    for (size_t i = 0; i < kSize; ++i) {
      const Vec3 unit = sites_.frame.to_unit(packet[i]);
      const bool near = is_near(unit);
      far_ |= (near ? 0u : 1u) << i;
      used_ |= (near && i < count ? 1u : 0u) << i;
      for (int k = 0; k < 3; ++k) {
        const float x = point_[k][i] = near ? static_cast<float>(unit[k]) : 0;
        if (near) {
          lo[k] = std::min(lo[k], x);
          hi[k] = std::max(hi[k], x);
        }
        most = std::max(most, std::abs(x));
      }
    }
    for (int k = 0; k < 3; ++k) centre_[k] = used_ != 0 ? 0.5f * (lo[k] + hi[k]) : 0;
    error_ = distance_error(most, sites_.regions.largest_radius);
  }

  // The far points that are searched together, as bits: those that single precision serves, if there are
  // several, and that O2 may be near enough to.
  HWY_NOINLINE uint32_t far_together(const Vec3* packet, size_t count) const {
    if (!Faces::kAll || far_ == 0) return 0;
    uint32_t together = 0;
    for (size_t i = 0; i < count; ++i) {
      if ((far_ >> i & 1) == 0) continue;
      const Vec3 unit = sites_.frame.to_unit(packet[i]);
      const bool near_enough = lower_bound(sites_.tree.box(0), unit) <= max_distance_ * sites_.frame.scale;
      if (squared_norm(unit) <= kFarthest * kFarthest && near_enough) together |= 1u << i;
    }
    return std::popcount(together) > 1 ? together : 0;
  }

  // The results of exact_closest().
  HWY_NOINLINE void search_from_afar(std::span<const Vec3> packet, uint32_t far,
                                     std::span<const uint32_t> order, std::span<ClosestPoint> found) {
    Vec3 unit[kSize];
    for (size_t i = 0; i < packet.size(); ++i) unit[i] = sites_.frame.to_unit(packet[i]);
    m_.candidates.clear();
    FarPacketSearch search(frames_, unit, far, m_.candidates);
    search.start_from({last_, known_});
    tree::visit(sites_.wide, m_.open, search);
    settled_.compare(packet, search.limits(), m_.candidates, Settled::Equal::by_name);
    for (; far != 0; far &= far - 1) {
      const auto i = static_cast<size_t>(std::countr_zero(far));
      const ClosestPoint closest = found[order[i]] = settled_.closest(i, max_distance_);
      if (closest.type != SiteType::none) remember(i, closest);
    }
  }

  // The squared distances of points from one point.
  HWY_INLINE PointVec squared_from(const float (&p)[3], size_t i) const {
    const Points d;
    const Vec3Of<PointVec> r = sub(load(d, point_, i), splat(d, p));
    return square_norm(d, r.x, r.y, r.z);
  }

  // Sets the limits by the maximum distance and by the closest points of the packet before.
  void limit() {
    const Points d;
    const float within = sites_.frame.unit_limit(max_distance_) + error_;
    for (size_t i = 0; i < kSize; i += hn::Lanes(d)) {
      hn::Store(hn::Sqrt(squared_from(centre_, i)), d, from_centre_ + i);
      PointVec least = hn::Inf(d);
      for (size_t k = 0; k < known_; ++k) {
        PointVec squared = squared_from(last_[k], i);
        if constexpr (!Faces::kAll) {
          const uint32_t excluding =
              uint32_t{faces_.excluded.by[faces_.excluded.group_of[last_face_[k]]]} >> i;
          const uint8_t bytes[8] = {static_cast<uint8_t>(excluding), static_cast<uint8_t>(excluding >> 8)};
          squared = hn::IfThenElse(hn::LoadMaskBits(d, bytes), hn::Inf(d), squared);
        }
        least = hn::Min(least, squared);
      }
      const PointVec limit =
          hn::Min(hn::MulAdd(hn::Sqrt(least), hn::Set(d, kFarther), hn::Set(d, error_)), hn::Set(d, within));
      hn::Store(hn::Mul(limit, limit), d, squared_limit_ + i);
    }
    for (size_t i = 0; i < kSize; ++i)
      if ((used_ >> i & 1) == 0) squared_limit_[i] = -1;
    find_max_distance();
  }

  // No box farther than this from the centre is within the limit of any point.
  void find_max_distance() {
    const Points d;
    PointVec most = hn::Zero(d);
    for (size_t i = 0; i < kSize; i += hn::Lanes(d)) {
      const PointVec squared = hn::Load(d, squared_limit_ + i);
      const PointVec max_distance =
          hn::Add(hn::Sqrt(hn::Max(squared, hn::Zero(d))), hn::Load(d, from_centre_ + i));
      most = hn::Max(most, hn::IfThenElseZero(hn::Ge(squared, hn::Zero(d)), max_distance));
    }
    const float max_distance = hn::GetLane(hn::MaxOfLanes(d, most)) * kFarther;
    squared_max_distance_ = max_distance * max_distance;
  }

  void remember(size_t i, const ClosestPoint& closest) {
    const Vec3 unit = sites_.frame.to_unit(closest.point);
    for (int k = 0; k < 3; ++k) last_[i][k] = static_cast<float>(unit[k]);
    last_face_[i] = closest.face;
    if (i == known_) ++known_;
  }

  const sites::SitesData& sites_;
  const Faces faces_;
  sites::LeafFrames::View frames_;
  Settled settled_;
  PointSearch<Faces> alone_;
  const double max_distance_;
  SinglePointMemory& m_;
  alignas(64) float point_[3][kSize];       // in the unit frame
  alignas(64) float squared_limit_[kSize];  // nothing beyond this is closest
  alignas(64) float from_centre_[kSize];
  alignas(64) float squared_[kSize][SiteBlock::kWidth];  // of the faces of a leaf
  alignas(64) float least_[kSize];                       // of these
  float centre_[3], squared_max_distance_, error_;
  uint32_t used_, far_, near_;  // points, as bits
  float last_[kSize][3];        // closest points found before
  uint32_t last_face_[kSize];
  size_t known_ = 0;
  PacketWork work_;
};

}  // namespace

ClosestPoint SearchOne(const sites::SitesData& sites, const Vec3& query, double max_distance, double enough,
                       SinglePointMemory& memory) {
  PointSearch search(sites, AllFaces(), max_distance, memory);
  search.end_within(enough);
  return search(query, 0);
}

PacketWork SearchEach(const sites::SitesData& sites, std::span<const Vec3> queries,
                      std::span<const uint32_t> order, double max_distance, std::span<ClosestPoint> found,
                      SinglePointMemory& memory) {
  PacketSearch search(sites, AllFaces(), max_distance, memory);
  constexpr size_t kSize = SinglePointMemory::kPacket;
  for (size_t i = 0; i < order.size(); i += kSize)
    search(queries, order.subspan(i, std::min(kSize, order.size() - i)), found);
  return search.work();
}

void SearchPacket(const sites::SitesData& sites, std::span<const Vec3> points, double max_distance,
                  const ExcludedFaces& excluded, std::span<ClosestPoint> found, SinglePointMemory& memory) {
  static constexpr std::array<uint32_t, SinglePointMemory::kPacket> kOrder{0, 1, 2,  3,  4,  5,  6,  7,
                                                                           8, 9, 10, 11, 12, 13, 14, 15};
  PacketSearch search(sites, NotExcluded{excluded}, max_distance, memory);
  search.remember(found);
  search(points, std::span(kOrder).first(points.size()), found);
}

}  // namespace sdm::closest::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sdm::closest {

HWY_EXPORT(SearchOne);
HWY_EXPORT(SearchEach);
HWY_EXPORT(SearchPacket);

ClosestPoint closest_point(const sites::SitesData& sites, const Vec3& query, double max_distance) {
  thread_local SinglePointMemory memory;
  return HWY_DYNAMIC_DISPATCH(SearchOne)(sites, query, max_distance, 0, memory);
}

ClosestPoint close_point(const sites::SitesData& sites, const Vec3& query, double max_distance,
                         double enough) {
  thread_local SinglePointMemory memory;
  return HWY_DYNAMIC_DISPATCH(SearchOne)(sites, query, max_distance, enough, memory);
}

PacketWork closest_of_each(const sites::SitesData& sites, std::span<const Vec3> queries,
                           std::span<const std::uint32_t> order, double max_distance,
                           std::span<ClosestPoint> found) {
  thread_local SinglePointMemory memory;
  return HWY_DYNAMIC_DISPATCH(SearchEach)(sites, queries, order, max_distance, found, memory);
}

void closest_of_packet(const sites::SitesData& sites, std::span<const Vec3> points, double max_distance,
                       const ExcludedFaces& excluded, std::span<ClosestPoint> found) {
  thread_local SinglePointMemory memory;
  HWY_DYNAMIC_DISPATCH(SearchPacket)(sites, points, max_distance, excluded, found, memory);
}

}  // namespace sdm::closest
#endif
