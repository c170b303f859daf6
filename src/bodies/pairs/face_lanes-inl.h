// Tests the faces of two leaves against each other, one per lane. Included once for each set of vector
// instructions.
#if defined(SDM_PROXIMITY_FACE_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SDM_PROXIMITY_FACE_LANES_INL_H
#undef SDM_PROXIMITY_FACE_LANES_INL_H
#else
#define SDM_PROXIMITY_FACE_LANES_INL_H
#endif

#include "bodies/pairs/box_lanes-inl.h"
#include "sites/sites_data.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::pairs::HWY_NAMESPACE {

// The interval that something covers along an axis.
struct Extent {
  Vec lower, upper;

  static HWY_INLINE Extent of(Vec a, Vec b, Vec c) {
    return {hn::Min(hn::Min(a, b), c), hn::Max(hn::Max(a, b), c)};
  }
  static HWY_INLINE Extent of(const Vec (&corner)[3][3], const Vec (&axis)[3]) {
    return of(dot(corner[0], axis), dot(corner[1], axis), dot(corner[2], axis));
  }
};
HWY_INLINE Vec gap(const Extent& a, const Extent& b) {
  return hn::Max(hn::Sub(a.lower, b.upper), hn::Sub(b.lower, a.upper));
}

// The faces of a leaf, in O1's frame.
class LeafFaces {
 public:
  void load(const sites::SitesData& sites, std::uint32_t leaf) {
    const sites::Regions& regions = sites.regions;
    placed_ = kNone;
    first_ = regions.leaves[leaf];
    count_ = regions.leaves[leaf + 1] - first_;
    for (uint32_t lane = 0; lane < kWidth; ++lane) {
      const Triangle& corners = regions.places.corners[first_ + std::min(lane, count_ - 1)];
      for (int c = 0; c < 3; ++c)
        for (int k = 0; k < 3; ++k) corner_[c][k][lane] = regions.points[corners[c]].point[k];
    }
  }

  // Loads the faces and their normals, unless it did so for the same leaf last. `to_o1`: from the frame of
  // O2, for its leaves; null for those of O1.
  void place(const sites::SitesData& sites, std::uint32_t leaf, const FrameMap* to_o1) {
    if (placed_ == leaf) return;
    load(sites, leaf);
    if (to_o1 != nullptr) move(*to_o1);
    find_normals();
    placed_ = leaf;
  }

  // Transforms the faces from O2's frame.
  void move(const FrameMap& map) {
    const Lanes d;
    for (auto& corner : corner_)
      for (size_t i = 0; i < kWidth; i += hn::Lanes(d)) {
        Vec from[3];
        HWY_NAMESPACE::load(d, corner, i, from);
        for (int k = 0; k < 3; ++k)
          hn::Store(hn::Add(dot(d, from, map.row[k]), hn::Set(d, map.offset[k])), d, corner[k] + i);
      }
  }

  void find_normals() {
    const Lanes d;
    for (size_t i = 0; i < kWidth; i += hn::Lanes(d)) {
      Vec corner[3][3], u[3], v[3], normal[3];
      corners(i, corner);
      for (int k = 0; k < 3; ++k) u[k] = hn::Sub(corner[1][k], corner[0][k]);
      for (int k = 0; k < 3; ++k) v[k] = hn::Sub(corner[2][k], corner[0][k]);
      for (int k = 0; k < 3; ++k)
        normal[k] = hn::MulSub(u[(k + 1) % 3], v[(k + 2) % 3], hn::Mul(u[(k + 2) % 3], v[(k + 1) % 3]));
      // Any axis of length at most 1 gives a valid bound, so rounding of the axis of a needle is harmless.
      const Vec squared = dot(normal, normal), least = hn::Set(d, 1e-37f);
      const Vec inverse =
          hn::IfThenElseZero(hn::Gt(squared, least), hn::Div(hn::Set(d, 1.0f), hn::Sqrt(squared)));
      for (int k = 0; k < 3; ++k) hn::Store(hn::Mul(normal[k], inverse), d, normal_[k] + i);
    }
  }

  // Gathers faces of several leaves: copies one to a lane.
  void set(size_t lane, const LeafFaces& from, size_t face) {
    for (int c = 0; c < 3; ++c)
      for (int k = 0; k < 3; ++k) corner_[c][k][lane] = from.corner_[c][k][face];
  }

  [[nodiscard]] uint32_t first() const { return first_; }
  [[nodiscard]] uint32_t count() const { return count_; }

  HWY_INLINE void corners(size_t i, Vec (&corner)[3][3]) const {
    for (int c = 0; c < 3; ++c) HWY_NAMESPACE::load(Lanes(), corner_[c], i, corner[c]);
  }
  HWY_INLINE void normals(size_t i, Vec (&normal)[3]) const {
    HWY_NAMESPACE::load(Lanes(), normal_, i, normal);
  }
  // One face, in all lanes.
  HWY_INLINE void corners_of(uint32_t face, Vec (&corner)[3][3]) const {
    for (int c = 0; c < 3; ++c)
      for (int k = 0; k < 3; ++k) corner[c][k] = hn::Set(Lanes(), corner_[c][k][face]);
  }
  HWY_INLINE void normal_of(uint32_t face, Vec (&normal)[3]) const {
    for (int k = 0; k < 3; ++k) normal[k] = hn::Set(Lanes(), normal_[k][face]);
  }

 private:
  alignas(64) float corner_[3][3][kWidth];  // by corner and axis
  alignas(64) float normal_[3][kWidth];
  uint32_t first_ = 0, count_ = 0;
  uint32_t placed_ = kNone;  // the leaf whose faces and normals these are, in O1's frame
};

// Lower bounds on the distances of the faces of `a`, from lane i on, to a face of `b`: from their boxes,
// along both normals, and in the direction between the closest points found so far (a zero vector if there
// are none, which excludes nothing).
HWY_INLINE Vec face_distances(const LeafFaces& a, size_t i, const LeafFaces& b, uint32_t face,
                              const Direction& direction) {
  const Lanes d;
  Vec corner1[3][3], corner2[3][3], apart[3], axis[3];
  a.corners(i, corner1);
  b.corners_of(face, corner2);
  for (int k = 0; k < 3; ++k)
    apart[k] = gap(Extent::of(corner1[0][k], corner1[1][k], corner1[2][k]),
                   Extent::of(corner2[0][k], corner2[1][k], corner2[2][k]));
  Vec least = distance_of_gaps(d, apart);
  const auto try_axis = [&] HWY_ATTR {
    least = hn::Max(least, gap(Extent::of(corner1, axis), Extent::of(corner2, axis)));
  };
  a.normals(i, axis);
  try_axis();
  b.normal_of(face, axis);
  try_axis();
  for (int k = 0; k < 3; ++k) axis[k] = hn::Set(d, direction.along[0][k]);
  try_axis();
  return least;
}

// A box in O1's frame: its centre, and its half sides as vectors.
struct PlacedBox {
  float centre[3], side[3][3] = {};

  explicit PlacedBox(const CentredBox& box) {
    for (int k = 0; k < 3; ++k) {
      centre[k] = box.centre[k];
      side[k][k] = box.half[k];
    }
  }
  // Transforms a box from O2's frame.
  PlacedBox(const CentredBox& box, const FrameMap& map) {
    for (int i = 0; i < 3; ++i) {
      centre[i] = map.offset[i];
      for (int k = 0; k < 3; ++k) {
        centre[i] += map.row[i][k] * box.centre[k];
        side[k][i] = map.row[i][k] * box.half[k];
      }
    }
  }
  HWY_INLINE Extent along(const Vec (&axis)[3]) const {
    const Lanes d;
    const Vec middle = dot(d, axis, centre);
    Vec half = hn::Abs(dot(d, axis, side[0]));
    for (int k = 1; k < 3; ++k) half = hn::Add(half, hn::Abs(dot(d, axis, side[k])));
    return {hn::Sub(middle, half), hn::Add(middle, half)};
  }
};

// A lower bound on the distance between the faces of a leaf and a box, from the boxes of the faces and along
// their normals.
inline float least_distance(const LeafFaces& faces, const PlacedBox& box) {
  const Lanes d;
  Vec least = hn::Inf(d);
  for (size_t i = 0; i < faces.count(); i += hn::Lanes(d)) {
    Vec corner[3][3], apart[3], axis[3];
    faces.corners(i, corner);
    for (int k = 0; k < 3; ++k) {
      for (int j = 0; j < 3; ++j) axis[j] = hn::Set(d, j == k ? 1.0f : 0.0f);
      apart[k] = gap(Extent::of(corner[0][k], corner[1][k], corner[2][k]), box.along(axis));
    }
    faces.normals(i, axis);
    const Vec distance = hn::Max(distance_of_gaps(d, apart), gap(Extent::of(corner, axis), box.along(axis)));
    // Lanes beyond the last face repeat it.
    least = hn::Min(least, distance);
  }
  return hn::GetLane(hn::MinOfLanes(d, least));
}

// A lower bound on x·u over the faces of a leaf, from the discs around them; in the leaf's frame.
inline float least_along(const sites::Regions& regions, uint32_t leaf, const float (&u)[3]) {
  const sites::FaceBounds& bounds = regions.bounds[leaf];
  const uint32_t count = regions.leaves[leaf + 1] - regions.leaves[leaf];
  // Enlarged by more than the rounding of what is subtracted from it.
  const float squared = (1 + 1e-6f) * (u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
  const Lanes d;
  Vec least = hn::Inf(d);
  for (size_t i = 0; i < count; i += hn::Lanes(d)) {
    Vec centre[3], normal[3];
    load(d, bounds.centre, i, centre);
    load(d, bounds.normal, i, normal);
    // A disc extends by its radius times the length of u's component in its plane, or times |u| where the
    // normal may be rounding noise.
    const auto flat = hn::Lt(hn::Load(d, bounds.slope + i), hn::Set(d, sites::FaceBounds::kOpen));
    const Vec across = hn::IfThenElseZero(flat, dot(d, normal, u));
    const Vec within = hn::Sqrt(hn::Max(hn::NegMulAdd(across, across, hn::Set(d, squared)), hn::Zero(d)));
    const Vec lowest = hn::NegMulAdd(within, hn::Load(d, bounds.radius + i), dot(d, centre, u));
    least = hn::Min(least, hn::IfThenElse(hn::FirstN(d, count - i), lowest, hn::Inf(d)));
  }
  return hn::GetLane(hn::MinOfLanes(d, least));
}

}  // namespace sdm::pairs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
