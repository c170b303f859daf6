/// Points and vectors with their arithmetic, triangles and boxes: what every header shares. Lengths are in
/// the units of the mesh.
///
/// Threads: plain values.
#pragma once

#include <sdm/names.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <tuple>
#include <type_traits>

// Export macro of the public API. All other symbols of a shared library are hidden.
#if defined(__GNUC__)
#define SDM_API __attribute__((visibility("default")))
#else
#define SDM_API
#endif

namespace sdm {

/// A point or a vector: an array of three numbers, without padding. All arithmetic is rounded in the order in
/// which it is written here.
struct Vec3 : std::array<double, 3> {};
/// A point or a vector of the plane, such as that of a texture.
struct Vec2 : std::array<double, 2> {};
/// A point or a vector in single precision, as maps store it.
struct Vec3f : std::array<float, 3> {};

/// Returns a + b.
[[nodiscard]] constexpr Vec3 operator+(const Vec3& a, const Vec3& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
/// Returns a − b.
[[nodiscard]] constexpr Vec3 operator-(const Vec3& a, const Vec3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
/// Returns −a.
[[nodiscard]] constexpr Vec3 operator-(const Vec3& a) {
  return {-a[0], -a[1], -a[2]};
}
/// Returns s a.
[[nodiscard]] constexpr Vec3 operator*(double s, const Vec3& a) {
  return {s * a[0], s * a[1], s * a[2]};
}
/// Adds b to a.
constexpr Vec3& operator+=(Vec3& a, const Vec3& b) {
  return a = a + b;
}
/// Returns a · b.
[[nodiscard]] constexpr double dot(const Vec3& a, const Vec3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
/// Returns a × b.
[[nodiscard]] constexpr Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
/// Returns |a|².
[[nodiscard]] constexpr double squared_norm(const Vec3& a) {
  return dot(a, a);
}
/// Returns |a|; 0 or infinite where its square is out of the range of double.
[[nodiscard]] inline double norm(const Vec3& a) {
  return std::sqrt(dot(a, a));
}
/// Returns a / |a|, or 0 if a is 0.
[[nodiscard]] inline Vec3 normalized(const Vec3& a) {
  const double length = norm(a);
  return length > 0 ? (1 / length) * a : Vec3{};
}

/// Returns a + b.
[[nodiscard]] constexpr Vec2 operator+(const Vec2& a, const Vec2& b) {
  return {a[0] + b[0], a[1] + b[1]};
}
/// Returns a − b.
[[nodiscard]] constexpr Vec2 operator-(const Vec2& a, const Vec2& b) {
  return {a[0] - b[0], a[1] - b[1]};
}
/// Returns s a.
[[nodiscard]] constexpr Vec2 operator*(double s, const Vec2& a) {
  return {s * a[0], s * a[1]};
}
/// Returns a · b.
[[nodiscard]] constexpr double dot(const Vec2& a, const Vec2& b) {
  return a[0] * b[0] + a[1] * b[1];
}
/// Returns the determinant of the columns a and b.
[[nodiscard]] constexpr double cross(const Vec2& a, const Vec2& b) {
  return a[0] * b[1] - a[1] * b[0];
}

/// Returns a + b.
[[nodiscard]] constexpr Vec3f operator+(const Vec3f& a, const Vec3f& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
/// Returns a − b.
[[nodiscard]] constexpr Vec3f operator-(const Vec3f& a, const Vec3f& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
/// Returns s a.
[[nodiscard]] constexpr Vec3f operator*(float s, const Vec3f& a) {
  return {s * a[0], s * a[1], s * a[2]};
}
/// Returns a · b.
[[nodiscard]] constexpr float dot(const Vec3f& a, const Vec3f& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

}  // namespace sdm

/// @cond
// Let structured bindings take the numbers of a vector.
template <>
struct std::tuple_size<sdm::Vec3> : std::tuple_size<std::array<double, 3>> {};
template <std::size_t I>
struct std::tuple_element<I, sdm::Vec3> : std::tuple_element<I, std::array<double, 3>> {};
template <>
struct std::tuple_size<sdm::Vec2> : std::tuple_size<std::array<double, 2>> {};
template <std::size_t I>
struct std::tuple_element<I, sdm::Vec2> : std::tuple_element<I, std::array<double, 2>> {};
template <>
struct std::tuple_size<sdm::Vec3f> : std::tuple_size<std::array<float, 3>> {};
template <std::size_t I>
struct std::tuple_element<I, sdm::Vec3f> : std::tuple_element<I, std::array<float, 3>> {};
/// @endcond

namespace sdm {

/// Three indices of vertices, counter-clockwise seen from outside.
using Triangle = std::array<std::uint32_t, 3>;

/// No limit.
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The index that represents "no face", "no site" and "no texel".
inline constexpr std::uint32_t kNone = 0xFFFFFFFFu;

/// A point of a face of a mesh.
struct SurfacePoint {
  std::uint32_t face = kNone;  ///< kNone: no point
  Vec3 barycentric{};          ///< weights of the face's corners; their sum is 1 up to rounding

  friend bool operator==(const SurfacePoint&, const SurfacePoint&) = default;
};

/// Axis-aligned box; empty while lower > upper.
struct Box {
  Vec3 lower{kInfinity, kInfinity, kInfinity};
  Vec3 upper{-kInfinity, -kInfinity, -kInfinity};
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
inline constexpr std::tuple kFields<Box>{
    Field{"lower", &Box::lower, "The corner with the least coordinates."},
    Field{"upper", &Box::upper, "The corner with the largest ones."}};

}  // namespace sdm
