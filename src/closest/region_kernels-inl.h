// Vectorised tests of sites' regions, and distances to sites. Included once for each set of vector
// instructions.
#if defined(SDM_REGION_KERNELS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SDM_REGION_KERNELS_INL_H
#undef SDM_REGION_KERNELS_INL_H
#else
#define SDM_REGION_KERNELS_INL_H
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>

#include "closest/point_group.h"
#include "closest/site_lists.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::closest::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Lanes over the points of a packet, and over the sites or boxes of a block.
using Points = hn::CappedTag<float, PointGroup::kPacket>;
using Block = hn::CappedTag<float, SiteBlock::kWidth>;
using PointVec = hn::Vec<Points>;
using BlockVec = hn::Vec<Block>;
using BlockMask = hn::Mask<Block>;

template <class D>
HWY_INLINE hn::Vec<D> square_norm(D, hn::Vec<D> x, hn::Vec<D> y, hn::Vec<D> z) {
  return hn::MulAdd(z, z, hn::MulAdd(y, y, hn::Mul(x, x)));
}

// The rounding error of points and of heights over planes: a few units in the last place of the coordinates.
// O2 lies in the cube [−1, 1]³.
inline float coordinate_error(const Ball& ball) {
  const auto& [x, y, z] = ball.centre;
  return 2e-6f * std::max({1.0f, std::abs(x), std::abs(y), std::abs(z)});
}

// The radius of a ball that meets all regions that `ball` meets, despite rounding in the tests.
inline float enlarged_radius(const Ball& ball) {
  return 1.0001f * ball.radius + coordinate_error(ball);
}

// Which pieces of O2 can contain the closest point of any point x of the ball (c, r). Let a be a point of O2,
// B a convex piece of it, and b the point of B closest to c. If some b' of B is closer to x than a is, then
//   |c − b'|² ≤ |c − a|² + 2 r |b' − a|,  and  |c − b'|² ≥ |c − b|² + |b − b'|²,  since B is convex;
// with |b' − a| ≤ |b − a| + |b − b'| it follows that
//   |c − b|² ≤ |c − a|² + 2 r |b − a| + r².
// Far from O2 this is much tighter than |c − b| ≤ |c − a| + 2r: the closer b is to a, the less their
// distances to x can differ.
struct CandidateBound {
  float centre[3], radius;  // of the ball; enlarged by the rounding error of the region tests
  float from_a[3];          // c − a
  float squared;            // |c − a|² + r², enlarged by the rounding error of squares
  float squared_limit;      // beyond this, a site is outside the limit for all x

  CandidateBound(const Ball& ball, float squared_to_a, const float (&a)[3], float limit) {
    for (int k = 0; k < 3; ++k) {
      centre[k] = ball.centre[k];
      from_a[k] = ball.centre[k] - a[k];
    }
    radius = enlarged_radius(ball);
    squared =
        squared_to_a + radius * radius + 4 * coordinate_error(ball) * (std::sqrt(squared_to_a) + radius);
    squared_limit = (limit + radius) * (limit + radius);
  }

  // Whether the bound holds for squared = |c − b|² and c − b = (x, y, z).
  template <class D>
  HWY_INLINE hn::Mask<D> holds(D d, hn::Vec<D> squared_to_b, hn::Vec<D> x, hn::Vec<D> y, hn::Vec<D> z) const {
    const auto a_to_b = square_norm(d, hn::Sub(hn::Set(d, from_a[0]), x), hn::Sub(hn::Set(d, from_a[1]), y),
                                    hn::Sub(hn::Set(d, from_a[2]), z));
    const auto bound = hn::MulAdd(hn::Set(d, 2 * radius), hn::Sqrt(a_to_b), hn::Set(d, squared));
    return hn::Le(squared_to_b, hn::Min(bound, hn::Set(d, squared_limit)));
  }
};

// plane·(p, −1) for a block of planes, four rows, and one point.
HWY_INLINE BlockVec height(Block d, const SiteBlock::Row* plane, size_t i, const float* p) {
  BlockVec h = hn::MulSub(hn::Load(d, plane[0] + i), hn::Set(d, p[0]), hn::Load(d, plane[3] + i));
  h = hn::MulAdd(hn::Load(d, plane[1] + i), hn::Set(d, p[1]), h);
  return hn::MulAdd(hn::Load(d, plane[2] + i), hn::Set(d, p[2]), h);
}

// plane·(p, −1) for one plane and many points.
HWY_INLINE PointVec height(Points d, const SiteBlock::Row* plane, uint32_t lane, PointVec x, PointVec y,
                           PointVec z) {
  PointVec h = hn::MulSub(hn::Set(d, plane[0][lane]), x, hn::Set(d, plane[3][lane]));
  h = hn::MulAdd(hn::Set(d, plane[1][lane]), y, h);
  return hn::MulAdd(hn::Set(d, plane[2][lane]), z, h);
}

// For each kind of site:
//   may_be_closest  whether the region meets the ball and the CandidateBound holds;
//   squared         the squared distances of one point to a block of sites, or of many points to one site:
//                   infinite outside the prism of a face or beyond the ends of an edge, where the plane or
//                   line is closer than the site. The rest of the region needs no test, since a site is
//                   never closer than O2 is;
//   closest         the point of one site that is closest to p.

HWY_INLINE BlockMask may_be_closest(Block d, const sites::FaceBounds& bounds, size_t i,
                                    const CandidateBound& bound) {
  BlockVec r[3], h = hn::Zero(d);
  for (int k = 0; k < 3; ++k) {
    r[k] = hn::Sub(hn::Set(d, bound.centre[k]), hn::Load(d, bounds.centre[k] + i));
    h = hn::MulAdd(r[k], hn::Load(d, bounds.normal[k] + i), h);
  }
  const BlockVec squared = square_norm(d, r[0], r[1], r[2]), h2 = hn::Mul(h, h);
  const BlockVec radius = hn::Load(d, bounds.radius + i), reach_radius = hn::Set(d, bound.radius);
  // The distance from the disc's axis, reduced by the cancellation error in the difference of squares.
  const BlockVec beside =
      hn::Sqrt(hn::Max(hn::NegMulAdd(squared, hn::Set(d, 1e-6f), hn::Sub(squared, h2)), hn::Zero(d)));
  const BlockVec slope = hn::Load(d, bounds.slope + i);
  const BlockVec most = hn::MulAdd(slope, hn::Add(hn::Abs(h), reach_radius), hn::Add(radius, reach_radius));
  // c − b = h normal + s (r − h normal), where the convex piece B is the disc.
  const BlockVec beyond = hn::Max(hn::Sub(beside, radius), hn::Zero(d));
  const BlockVec s = hn::Div(beyond, hn::Max(beside, hn::Set(d, 1e-30f)));
  const BlockVec along = hn::NegMulAdd(s, h, h);
  const auto from = [&](int k) HWY_ATTR {
    return hn::MulAdd(s, r[k], hn::Mul(along, hn::Load(d, bounds.normal[k] + i)));
  };
  return hn::And(hn::Le(beside, most),
                 bound.holds(d, hn::MulAdd(beyond, beyond, h2), from(0), from(1), from(2)));
}

HWY_INLINE BlockMask may_be_closest(Block d, const FaceBlock& block, size_t i, const CandidateBound& bound) {
  const BlockVec inner = hn::Set(d, -bound.radius);
  const SiteBlock::Row* plane = block.row + FaceBlock::kPlane;
  BlockMask pass = hn::Ge(height(d, block.row + FaceBlock::wall(0), i, bound.centre), inner);
  pass = hn::And(pass, hn::Ge(height(d, block.row + FaceBlock::wall(1), i, bound.centre), inner));
  pass = hn::And(pass, hn::Ge(height(d, block.row + FaceBlock::wall(2), i, bound.centre), inner));
  // The convex piece B is the whole plane of the face.
  const BlockVec h = height(d, plane, i, bound.centre);
  const auto from = [&](int k) HWY_ATTR { return hn::Mul(h, hn::Load(d, plane[k] + i)); };
  return hn::And(pass, bound.holds(d, hn::Mul(h, h), from(0), from(1), from(2)));
}

HWY_INLINE BlockVec squared(Block d, const FaceBlock& block, size_t i, const float* p) {
  const BlockVec h = height(d, block.row + FaceBlock::kPlane, i, p);
  const BlockVec inner = hn::Min(hn::Min(height(d, block.row + FaceBlock::wall(0), i, p),
                                         height(d, block.row + FaceBlock::wall(1), i, p)),
                                 height(d, block.row + FaceBlock::wall(2), i, p));
  return hn::IfThenElse(hn::Ge(inner, hn::Zero(d)), hn::Mul(h, h), hn::Inf(d));
}

HWY_INLINE PointVec squared(Points d, const FaceBlock& block, uint32_t lane, PointVec x, PointVec y,
                            PointVec z) {
  const PointVec h = height(d, block.row + FaceBlock::kPlane, lane, x, y, z);
  const PointVec inner = hn::Min(hn::Min(height(d, block.row + FaceBlock::wall(0), lane, x, y, z),
                                         height(d, block.row + FaceBlock::wall(1), lane, x, y, z)),
                                 height(d, block.row + FaceBlock::wall(2), lane, x, y, z));
  return hn::IfThenElse(hn::Ge(inner, hn::Zero(d)), hn::Mul(h, h), hn::Inf(d));
}

inline void closest(const FaceBlock& block, size_t lane, const float* p, float (&out)[3]) {
  float h = -block.row[FaceBlock::kPlane + 3][lane];
  for (int k = 0; k < 3; ++k) h += block.row[FaceBlock::kPlane + k][lane] * p[k];
  for (int k = 0; k < 3; ++k) out[k] = p[k] - h * block.row[FaceBlock::kPlane + k][lane];
}

HWY_INLINE BlockMask may_be_closest(Block d, const EdgeBlock& block, size_t i, const CandidateBound& bound) {
  BlockVec r[3], t = hn::Zero(d);
  for (int k = 0; k < 3; ++k) {
    r[k] = hn::Sub(hn::Set(d, bound.centre[k]), hn::Load(d, block.row[EdgeBlock::kStart + k] + i));
    t = hn::MulAdd(r[k], hn::Load(d, block.row[EdgeBlock::kDirection + k] + i), t);
  }
  const BlockVec radius = hn::Set(d, bound.radius), length = hn::Load(d, block.row[EdgeBlock::kLength] + i);
  BlockMask pass = hn::And(hn::Ge(t, hn::Neg(radius)), hn::Le(t, hn::Add(length, radius)));
  for (size_t k = 0; k < 2; ++k)
    pass = hn::And(pass, hn::Le(height(d, block.row + EdgeBlock::wall(k), i, bound.centre), radius));
  const BlockVec s = hn::Min(hn::Max(t, hn::Zero(d)), length);
  for (int k = 0; k < 3; ++k)
    r[k] = hn::NegMulAdd(s, hn::Load(d, block.row[EdgeBlock::kDirection + k] + i), r[k]);
  return hn::And(pass, bound.holds(d, square_norm(d, r[0], r[1], r[2]), r[0], r[1], r[2]));
}

HWY_INLINE BlockVec squared(Block d, const EdgeBlock& block, size_t i, const float* p) {
  BlockVec r[3], t = hn::Zero(d);
  for (int k = 0; k < 3; ++k) {
    r[k] = hn::Sub(hn::Set(d, p[k]), hn::Load(d, block.row[EdgeBlock::kStart + k] + i));
    t = hn::MulAdd(r[k], hn::Load(d, block.row[EdgeBlock::kDirection + k] + i), t);
  }
  const auto between =
      hn::And(hn::Ge(t, hn::Zero(d)), hn::Le(t, hn::Load(d, block.row[EdgeBlock::kLength] + i)));
  for (int k = 0; k < 3; ++k)
    r[k] = hn::NegMulAdd(t, hn::Load(d, block.row[EdgeBlock::kDirection + k] + i), r[k]);
  return hn::IfThenElse(between, square_norm(d, r[0], r[1], r[2]), hn::Inf(d));
}

HWY_INLINE PointVec squared(Points d, const EdgeBlock& block, uint32_t lane, PointVec x, PointVec y,
                            PointVec z) {
  const PointVec ux = hn::Set(d, block.row[EdgeBlock::kDirection][lane]),
                 uy = hn::Set(d, block.row[EdgeBlock::kDirection + 1][lane]),
                 uz = hn::Set(d, block.row[EdgeBlock::kDirection + 2][lane]);
  x = hn::Sub(x, hn::Set(d, block.row[EdgeBlock::kStart][lane]));
  y = hn::Sub(y, hn::Set(d, block.row[EdgeBlock::kStart + 1][lane]));
  z = hn::Sub(z, hn::Set(d, block.row[EdgeBlock::kStart + 2][lane]));
  PointVec t = hn::MulAdd(z, uz, hn::MulAdd(y, uy, hn::Mul(x, ux)));
  const auto between =
      hn::And(hn::Ge(t, hn::Zero(d)), hn::Le(t, hn::Set(d, block.row[EdgeBlock::kLength][lane])));
  const PointVec s =
      square_norm(d, hn::NegMulAdd(t, ux, x), hn::NegMulAdd(t, uy, y), hn::NegMulAdd(t, uz, z));
  return hn::IfThenElse(between, s, hn::Inf(d));
}

inline void closest(const EdgeBlock& block, size_t lane, const float* p, float (&out)[3]) {
  float t = 0;
  for (int k = 0; k < 3; ++k)
    t += (p[k] - block.row[EdgeBlock::kStart + k][lane]) * block.row[EdgeBlock::kDirection + k][lane];
  t = std::min(std::max(t, 0.0f), block.row[EdgeBlock::kLength][lane]);
  for (int k = 0; k < 3; ++k)
    out[k] = block.row[EdgeBlock::kStart + k][lane] + t * block.row[EdgeBlock::kDirection + k][lane];
}

HWY_INLINE BlockMask may_be_closest(Block d, const VertexBlock& block, size_t i,
                                    const CandidateBound& bound) {
  BlockVec r[3];
  for (int k = 0; k < 3; ++k)
    r[k] = hn::Sub(hn::Set(d, bound.centre[k]), hn::Load(d, block.row[VertexBlock::kPoint + k] + i));
  BlockMask pass = bound.holds(d, square_norm(d, r[0], r[1], r[2]), r[0], r[1], r[2]);
  for (size_t ray = 0; ray < sites::VertexRegion::kRays; ++ray) {
    const SiteBlock::Row* direction = block.row + VertexBlock::ray(ray);
    BlockVec along = hn::Mul(r[0], hn::Load(d, direction[0] + i));
    along = hn::MulAdd(r[1], hn::Load(d, direction[1] + i), along);
    along = hn::MulAdd(r[2], hn::Load(d, direction[2] + i), along);
    pass = hn::And(pass, hn::Le(along, hn::Set(d, bound.radius)));
  }
  return pass;
}

HWY_INLINE BlockVec squared(Block d, const VertexBlock& block, size_t i, const float* p) {
  return square_norm(d, hn::Sub(hn::Set(d, p[0]), hn::Load(d, block.row[VertexBlock::kPoint] + i)),
                     hn::Sub(hn::Set(d, p[1]), hn::Load(d, block.row[VertexBlock::kPoint + 1] + i)),
                     hn::Sub(hn::Set(d, p[2]), hn::Load(d, block.row[VertexBlock::kPoint + 2] + i)));
}

HWY_INLINE PointVec squared(Points d, const VertexBlock& block, uint32_t lane, PointVec x, PointVec y,
                            PointVec z) {
  return square_norm(d, hn::Sub(x, hn::Set(d, block.row[VertexBlock::kPoint][lane])),
                     hn::Sub(y, hn::Set(d, block.row[VertexBlock::kPoint + 1][lane])),
                     hn::Sub(z, hn::Set(d, block.row[VertexBlock::kPoint + 2][lane])));
}

inline void closest(const VertexBlock& block, size_t lane, const float*, float (&out)[3]) {
  for (int k = 0; k < 3; ++k) out[k] = block.row[VertexBlock::kPoint + k][lane];
}

}  // namespace sdm::closest::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
