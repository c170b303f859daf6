/// Plain types shared by every public header. Lengths are in the units of the mesh.
///
/// Threads: plain values.
#pragma once

#include <sdm/names.h>
#include <sdm/vec.h>

#include <array>
#include <cstdint>
#include <limits>
#include <tuple>
#include <type_traits>

namespace sdm {

/// Three indices of vertices, counter-clockwise seen from outside.
using Triangle = std::array<std::uint32_t, 3>;

/// The index that represents "no face", "no site" and "no texel".
inline constexpr std::uint32_t kNone = 0xFFFFFFFFu;

/// A point of a face of a mesh.
struct SurfacePoint {
  std::uint32_t face = kNone;  ///< kNone: no point
  Vec3 barycentric{};          ///< weights of the face's corners; their sum is 1 up to rounding

  friend bool operator==(const SurfacePoint&, const SurfacePoint&) = default;
};

/// Axis-aligned box; empty while lo > hi.
struct Box {
  Vec3 lo{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
          std::numeric_limits<double>::infinity()};
  Vec3 hi{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
          -std::numeric_limits<double>::infinity()};
};

/// Whether a field is an index, and there is none.
template <class Struct, class Value>
[[nodiscard]] constexpr bool is_no_index(const Field<Struct, Value>& field, const Value& value) {
  if constexpr (std::is_same_v<Value, std::uint32_t> || std::is_same_v<Value, std::uint64_t>)
    return field.index && value == kNone;
  else
    return false;
}

template <>
inline constexpr std::tuple kFields<Box>{Field{"lo", &Box::lo, "The corner with the least coordinates."},
                                         Field{"hi", &Box::hi, "The corner with the largest ones."}};

}  // namespace sdm
