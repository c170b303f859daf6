#include "sites/cone_rays.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sites/cone_rays.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

#include <limits>
#include <vector>

HWY_BEFORE_NAMESPACE();
namespace sdm::sites::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, 8>;

// Unit vectors to the neighbours, padded to whole SIMD vectors; padding is never chosen.
struct Directions {
  float *x, *y, *z;
  float* handicap;  // infinite for those chosen
  size_t size;
};

void place(std::span<const Vec3> positions, double scale, uint32_t vertex,
           std::span<const uint32_t> neighbours, Directions& to) {
  const Vec3& v = positions[vertex];
  for (size_t i = 0; i < to.size; ++i) {
    const bool filler = i >= neighbours.size();
    const Vec3 away = scale * (positions[neighbours[filler ? 0 : i]] - v);
    to.x[i] = static_cast<float>(away[0]);
    to.y[i] = static_cast<float>(away[1]);
    to.z[i] = static_cast<float>(away[2]);
    to.handicap[i] = filler ? std::numeric_limits<float>::infinity() : 0;
  }
  const Floats d;
  for (size_t i = 0; i < to.size; i += hn::Lanes(d)) {
    const auto x = hn::LoadU(d, to.x + i), y = hn::LoadU(d, to.y + i), z = hn::LoadU(d, to.z + i);
    const auto squared = hn::MulAdd(z, z, hn::MulAdd(y, y, hn::Mul(x, x)));
    const auto inverse =
        hn::IfThenElseZero(hn::Gt(squared, hn::Zero(d)), hn::Div(hn::Set(d, 1.0f), hn::Sqrt(squared)));
    hn::StoreU(hn::Mul(inverse, x), d, to.x + i);
    hn::StoreU(hn::Mul(inverse, y), d, to.y + i);
    hn::StoreU(hn::Mul(inverse, z), d, to.z + i);
  }
}

// The first that is most opposed to (x, y, z); to.size if all are chosen.
size_t most_opposed(const Directions& to, float x, float y, float z) {
  const Floats d;
  size_t best = to.size;
  float least = std::numeric_limits<float>::infinity();
  for (size_t i = 0; i < to.size; i += hn::Lanes(d)) {
    auto along = hn::MulAdd(hn::LoadU(d, to.x + i), hn::Set(d, x), hn::LoadU(d, to.handicap + i));
    along = hn::MulAdd(hn::LoadU(d, to.y + i), hn::Set(d, y), along);
    along = hn::MulAdd(hn::LoadU(d, to.z + i), hn::Set(d, z), along);
    const auto smallest = hn::MinOfLanes(d, along);
    if (!(hn::GetLane(smallest) < least)) continue;
    least = hn::GetLane(smallest);
    best = i + static_cast<size_t>(hn::FindFirstTrue(d, hn::Eq(along, smallest)));
  }
  return best;
}

std::array<uint32_t, VertexRegion::kRays> SpreadNeighbours(std::span<const Vec3> positions, double scale,
                                                           uint32_t vertex,
                                                           std::span<const uint32_t> neighbours) {
  constexpr size_t kUsual = 16;  // up to this many neighbours, nothing is allocated
  const size_t lanes = hn::Lanes(Floats());
  const size_t size = (neighbours.size() + lanes - 1) / lanes * lanes;
  float usual[4 * kUsual];
  std::vector<float> many;
  if (size > kUsual) many.resize(4 * size);
  float* memory = size > kUsual ? many.data() : usual;
  Directions to{memory, memory + size, memory + 2 * size, memory + 3 * size, size};
  place(positions, scale, vertex, neighbours, to);

  std::array<uint32_t, VertexRegion::kRays> chosen;
  chosen.fill(neighbours[0]);
  float x = 0, y = 0, z = 0;
  for (uint32_t& choice : chosen) {
    const size_t i = most_opposed(to, x, y, z);
    if (i == size) break;
    choice = neighbours[i];
    to.handicap[i] = std::numeric_limits<float>::infinity();
    x += to.x[i];
    y += to.y[i];
    z += to.z[i];
  }
  return chosen;
}

}  // namespace sdm::sites::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sdm::sites {

HWY_EXPORT(SpreadNeighbours);

std::array<std::uint32_t, VertexRegion::kRays> choose_cone_rays(std::span<const Vec3> positions, double scale,
                                                                std::uint32_t vertex,
                                                                std::span<const std::uint32_t> neighbours) {
  return HWY_DYNAMIC_DISPATCH(SpreadNeighbours)(positions, scale, vertex, neighbours);
}

}  // namespace sdm::sites
#endif
