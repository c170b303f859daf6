#include "rays/hemisphere_rays.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sdm::rays {
namespace {

// S. Vigna's splitmix64: the next of a sequence of well-mixed numbers.
std::uint64_t next(std::uint64_t& state) {
  std::uint64_t z = state += 0x9E3779B97F4A7C15u;
  z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
  z = (z ^ z >> 27) * 0x94D049BB133111EBu;
  return z ^ z >> 31;
}

// The bits as a number in [0, 1).
double fraction(std::uint32_t bits) {
  return 0x1p-32 * bits;
}

std::uint32_t reversed(std::uint32_t x) {
  x = x >> 16 | x << 16;
  x = (x & 0xFF00FF00u) >> 8 | (x & 0x00FF00FFu) << 8;
  x = (x & 0xF0F0F0F0u) >> 4 | (x & 0x0F0F0F0Fu) << 4;
  x = (x & 0xCCCCCCCCu) >> 2 | (x & 0x33333333u) << 2;
  return (x & 0xAAAAAAAAu) >> 1 | (x & 0x55555555u) << 1;
}

}  // namespace

void cosine_hemisphere(const Vec3& normal, std::uint64_t seed, std::uint64_t index,
                       std::span<Vec3> directions) {
  std::uint64_t state = seed;
  state = next(state) ^ index;
  const std::uint64_t random = next(state);
  const double shift = fraction(static_cast<std::uint32_t>(random >> 32));
  const auto turn = static_cast<std::uint32_t>(random);
  // T. Duff et al., Building an Orthonormal Basis, Revisited, 2017.
  const double sign = std::copysign(1.0, normal[2]);
  const double a = -1 / (sign + normal[2]), b = normal[0] * normal[1] * a;
  const Vec3 x{1 + sign * normal[0] * normal[0] * a, sign * b, -sign * normal[0]};
  const Vec3 y{b, sign + normal[1] * normal[1] * a, -normal[1]};
  const double count = static_cast<double>(directions.size());
  for (std::uint32_t i = 0; i < directions.size(); ++i) {
    const double squared = (i + shift) / count;  // of the radius on the disc
    const double angle = 2 * std::numbers::pi * fraction(reversed(i) + turn);
    const double radius = std::sqrt(squared), height = std::sqrt(std::max(0.0, 1 - squared));
    directions[i] = radius * std::cos(angle) * x + radius * std::sin(angle) * y + height * normal;
  }
}

void uniform_hemisphere(std::uint64_t seed, std::span<Vec3> directions) {
  const std::uint64_t random = next(seed);
  for (std::uint32_t i = 0; i < directions.size(); ++i) {
    std::uint32_t second = 0;
    for (std::uint32_t bits = i, column = 1u << 31; bits != 0; bits >>= 1, column ^= column >> 1)
      if ((bits & 1) != 0) second ^= column;
    const double height = fraction(reversed(i) ^ static_cast<std::uint32_t>(random));
    const double angle = 2 * std::numbers::pi * fraction(second ^ static_cast<std::uint32_t>(random >> 32));
    const double radius = std::sqrt(1 - height * height);
    directions[i] = {radius * std::cos(angle), radius * std::sin(angle), height};
  }
}

void HemisphereRays::resize(std::size_t count) {
  directions_.resize(count);
  rays_.resize(count);
  occluded_.resize(count);
}

float HemisphereRays::visibility(const sites::SitesData& sites, const Ray& first, const Vec3& normal,
                                 std::uint64_t seed, std::uint32_t texel) {
  cosine_hemisphere(normal, seed, texel, directions_);
  for (std::size_t i = 0; i < rays_.size(); ++i) {
    rays_[i] = first;
    rays_[i].direction = directions_[i];
  }
  occluded(sites, rays_, scratch_, occluded_.data());
  const auto hits = std::count(occluded_.begin(), occluded_.end(), 1);
  return static_cast<float>(1 - static_cast<double>(hits) / static_cast<double>(rays_.size()));
}

}  // namespace sdm::rays
