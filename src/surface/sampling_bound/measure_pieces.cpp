#include "surface/sampling_bound/measure_pieces.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surface/sampling_bound/measure_pieces.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sdm::surface::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::CappedTag<double, 4>;  // corners of one piece
using Vec = hn::Vec<Doubles>;

void MeasurePieces(std::span<const Piece> pieces, const Vec3& origin, const std::array<Vec3, 2>& edges,
                   std::span<const Vec3> points, std::span<double> squared) {
  const Doubles d;
  const hn::Rebind<float, Doubles> f;
  Vec e[2][3];
  for (int i = 0; i < 2; ++i)
    for (int k = 0; k < 3; ++k) e[i][k] = hn::Set(d, edges[i][k]);
  for (size_t p = 0; p < pieces.size(); ++p) {
    const Vec3& sample = points[pieces[p].sample];
    Vec largest = hn::Zero(d);
    for (size_t i = 0; i < 4; i += hn::Lanes(d)) {
      const Vec a = hn::PromoteTo(d, hn::LoadU(f, pieces[p].weights[0].data() + i));
      const Vec b = hn::PromoteTo(d, hn::LoadU(f, pieces[p].weights[1].data() + i));
      Vec sum = hn::Zero(d);
      for (int k = 0; k < 3; ++k) {
        const Vec from_sample = hn::Set(d, origin[k] - sample[k]);
        const Vec x = hn::MulAdd(b, e[1][k], hn::MulAdd(a, e[0][k], from_sample));
        sum = hn::MulAdd(x, x, sum);
      }
      largest = hn::Max(largest, sum);
    }
    squared[p] = hn::GetLane(hn::MaxOfLanes(d, largest));
  }
}

}  // namespace sdm::surface::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sdm::surface {

HWY_EXPORT(MeasurePieces);

void measure_pieces(std::span<const Piece> pieces, const Vec3& origin, const std::array<Vec3, 2>& edges,
                    std::span<const Vec3> points, std::span<double> squared) {
  HWY_DYNAMIC_DISPATCH(MeasurePieces)(pieces, origin, edges, points, squared);
}

}  // namespace sdm::surface
#endif
