// Tests cylinders around the nodes of one tree, one per lane, against a cylinder of the other. Included once
// for each set of vector instructions.
#if defined(SDM_PROXIMITY_CYLINDER_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SDM_PROXIMITY_CYLINDER_LANES_INL_H
#undef SDM_PROXIMITY_CYLINDER_LANES_INL_H
#else
#define SDM_PROXIMITY_CYLINDER_LANES_INL_H
#endif

#include "bodies/pairs/box_lanes-inl.h"
#include "sites/bounding_cylinders.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::pairs::HWY_NAMESPACE {

struct Cylinder {
  float centre[3], axis[3], radius, half_height;

  Cylinder(const sites::BoundingCylinders& all, size_t i)
      : radius(all.radius[i]), half_height(all.half_height[i]) {
    for (int k = 0; k < 3; ++k) {
      centre[k] = all.centre[k][i];
      axis[k] = all.axis[k][i];
    }
  }
};

// Half the extent of cylinders in a direction, given the cosines of their axes with it times its length, and
// the square of this length.
HWY_INLINE Vec half_extent(Vec radius, Vec half_height, Vec cosine, Vec squared) {
  const Lanes d;
  // More than the difference is rounded, which matters where it is small.
  const Vec enlarged = hn::Mul(squared, hn::Set(d, 1 + 1e-6f));
  const Vec sine = hn::Sqrt(hn::Max(hn::NegMulAdd(cosine, cosine, enlarged), hn::Zero(d)));
  return hn::MulAdd(radius, sine, hn::Mul(half_height, hn::Abs(cosine)));
}

// Lower bounds on the distances of cylinders to one cylinder, from axes that may separate them: their own,
// the line through their centres, and the direction between the closest points found so far. Negative where
// none does.
class CylinderDistances {
 public:
  // Distances of cylinders of the tree of `side` to one of the other tree, in the other tree's frame.
  CylinderDistances(const UnitMaps& maps, const Direction& direction, int side, const Cylinder& other)
      : maps_(maps), direction_(direction), side_(side), other_(other) {
    const FrameMap& map = maps.to[side];
    float squared = 0;
    for (int k = 0; k < 3; ++k) {
      seen_centre_[k] = map.offset[k];
      seen_axis_[k] = 0;
      for (int j = 0; j < 3; ++j) {
        seen_centre_[k] += map.row[k][j] * other.centre[j];
        seen_axis_[k] += map.row[k][j] * other.axis[j];
      }
      squared += seen_axis_[k] * seen_axis_[k];
    }
    const float inverse = squared > 1e-30f ? 1 / std::sqrt(squared) : 0;
    for (int k = 0; k < 3; ++k) along_[k] = inverse * seen_axis_[k];
    extent_along_ = extent_of_other(along_, map);
  }

  HWY_INLINE Vec operator()(const sites::BoundingCylinders& all, size_t i) const {
    return distances(all, hn::Load(Lanes(), all.half_height + i), i);
  }
  // The distances of the discs of a leaf's faces. `thin`: some normals may be unreliable.
  HWY_INLINE Vec operator()(const sites::FaceBounds& all, bool thin, size_t i) const {
    return distances(all, thin ? hn::Load(Lanes(), all.radius + i) : hn::Zero(Lanes()), i);
  }

 private:
  template <class Bounds>
  HWY_INLINE Vec distances(const Bounds& all, Vec half_height, size_t i) const {
    const Lanes d;
    const FrameMap& map = maps_.to[side_];
    const Vec radius = hn::Load(d, all.radius + i);
    const Vec one = hn::Set(d, 1.0f), stretched = hn::Set(d, map.stretch * map.stretch);
    const Vec other_radius = hn::Set(d, other_.radius), other_half_height = hn::Set(d, other_.half_height);
    Vec centre[3], axis[3], from[3];
    load(d, all.centre, i, centre);
    load(d, axes(all), i, axis);
    for (int k = 0; k < 3; ++k) from[k] = hn::Sub(centre[k], hn::Set(d, seen_centre_[k]));

    // Along the axes of these cylinders.
    const Vec cosine = dot(d, axis, seen_axis_);
    Vec gap = hn::Sub(hn::Sub(hn::Abs(dot(from, axis)), half_height),
                      half_extent(other_radius, other_half_height, cosine, stretched));
    // Along that of the other one.
    const Vec across = half_extent(radius, half_height, dot(d, axis, along_), one);
    gap = hn::Max(gap, hn::Sub(hn::Sub(hn::Abs(dot(d, from, along_)), across), hn::Set(d, extent_along_)));
    // Along the line through their centres.
    const Vec distance = hn::Sqrt(dot(from, from));
    const Vec inverse = hn::Div(one, hn::Max(distance, hn::Set(d, 1e-18f)));
    const Vec extent = half_extent(radius, half_height, hn::Mul(inverse, dot(from, axis)), one);
    const Vec others =
        half_extent(other_radius, other_half_height, hn::Mul(inverse, dot(d, from, seen_axis_)), stretched);
    gap = hn::Max(gap, hn::Sub(hn::Sub(distance, extent), others));
    Vec least = hn::Mul(hn::Set(d, maps_.unit[side_]), hn::Sub(gap, hn::Set(d, map.error)));
    if (!direction_.known) return least;

    const float(&u)[3] = direction_.along[side_], (&v)[3] = direction_.along[1 - side_];
    float rest = direction_.offset - maps_.to[0].error, squared_v = 0, cosine_v = 0, squared_u = 0;
    for (int k = 0; k < 3; ++k) {
      rest += v[k] * other_.centre[k];
      squared_v += v[k] * v[k];
      squared_u += u[k] * u[k];
      cosine_v += v[k] * other_.axis[k];
    }
    rest -= extent_of_other(cosine_v, squared_v);
    const Vec mine = half_extent(radius, half_height, dot(d, axis, u), hn::Set(d, squared_u));
    const Vec along = hn::Add(hn::Sub(dot(d, centre, u), mine), hn::Set(d, rest));
    return hn::Max(least, hn::Mul(hn::Set(d, maps_.unit[0]), along));
  }

  static const float (&axes(const sites::BoundingCylinders& all))[3][kWidth] { return all.axis; }
  static const float (&axes(const sites::FaceBounds& all))[3][kWidth] { return all.normal; }
  float extent_of_other(float cosine, float squared) const {
    const float sine = std::sqrt(std::max((1 + 1e-6f) * squared - cosine * cosine, 0.0f));
    return other_.radius * sine + other_.half_height * std::abs(cosine);
  }

  // Half the extent of the other cylinder along u, a direction in the frame of `side`.
  float extent_of_other(const float (&u)[3], const FrameMap& map) const {
    float cosine = 0, squared = 0;
    for (int j = 0; j < 3; ++j) {
      const float v = u[0] * map.row[0][j] + u[1] * map.row[1][j] + u[2] * map.row[2][j];
      cosine += v * other_.axis[j];
      squared += v * v;
    }
    return extent_of_other(cosine, squared);
  }

  const UnitMaps& maps_;
  const Direction& direction_;
  int side_;
  Cylinder other_;                       // in its own frame
  float seen_centre_[3], seen_axis_[3];  // in the frame of `side`
  float along_[3], extent_along_;        // its axis, normalized, and half its extent along it
};

}  // namespace sdm::pairs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
