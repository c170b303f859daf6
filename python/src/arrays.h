// NumPy and DLPack arrays in, NumPy arrays out.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <sdm/map.h>
#include <sdm/mesh_edit.h>
#include <sdm/types.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <limits>
#include <memory>
#include <span>
#include <vector>

namespace sdm::python {

namespace nb = nanobind;

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// The n × 3 numbers of an array: the caller's own if they are float64 in C order, otherwise a copy.
class Points {
 public:
  /// `name`: of the argument, for messages. Throws sdm::Error for anything but n × 3 real numbers.
  Points(nb::handle array, const char* name);

  [[nodiscard]] std::span<const Vec3> get() const;

 private:
  nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu> array_;
};

/// One number for each of several items.
class Lengths {
 public:
  /// `value`: a number for all items, or an array of `count`. Throws sdm::Error for anything else.
  Lengths(nb::handle value, const char* name, std::size_t count);

  [[nodiscard]] std::span<const double> get() const { return {array_.data(), array_.shape(0)}; }

 private:
  nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu> array_;
};

/// The name of a file: a str, bytes or os.PathLike. Throws sdm::Error for one that contains a NUL, where the
/// name of the system's calls would end, and a TypeError for anything else.
[[nodiscard]] std::filesystem::path path_of(nb::handle file);
/// An integer, of Python or NumPy. Throws a TypeError for anything else: a float is none, even without a
/// fraction. Throws sdm::Error for less than `least` or more than `most`.
[[nodiscard]] std::int64_t integer_of(nb::handle value, const char* name, std::int64_t least,
                                      std::int64_t most = 0xFFFFFFFE);
/// A number. Throws a TypeError for anything else, such as text.
[[nodiscard]] double real_of(nb::handle value);

/// Copies m × 3 integers. Throws sdm::Error for any other array, and for numbers that are no index.
[[nodiscard]] std::vector<Triangle> triangles(nb::handle array, const char* name);
/// Copies k integers. Throws sdm::Error as above.
[[nodiscard]] std::vector<std::uint32_t> indices(nb::handle array, const char* name);
/// Copies m × 3 × 2 numbers.
[[nodiscard]] std::vector<std::array<Vec2, 3>> corner_uvs(nb::handle array);
/// Reads a pose: a 4 × 4 matrix whose last row is (0, 0, 0, 1), or 7 numbers, a position x y z and a
/// quaternion w x y z of any length. Throws sdm::Error for any other array, and for a quaternion that is zero
/// or not finite.
[[nodiscard]] Transform transform(nb::handle pose, const char* name);
/// n poses: an array of the shape (n, 4, 4) or (n, 7).
class Poses {
 public:
  /// Throws sdm::Error as transform().
  Poses(nb::handle array, const char* name);

  [[nodiscard]] std::span<const Transform> get() const { return poses_; }

 private:
  nb::ndarray<const double, nb::shape<-1, 4, 4>, nb::c_contig, nb::device::cpu> array_;
  std::vector<Transform> of_quaternions_;
  std::span<const Transform> poses_;
};
/// Reads two poses, or one for both; None: the identity.
[[nodiscard]] std::array<Transform, 2> motion(nb::handle poses, const char* name);
[[nodiscard]] nb::object matrix(const Transform& transform);
[[nodiscard]] nb::object vector_of(const Vec3& vector);

namespace detail {
template <class Owned>
nb::capsule capsule_of(Owned* owned) {
  return {owned, [](void* p) noexcept { delete static_cast<Owned*>(p); }};
}
}  // namespace detail

/// A NumPy array of this shape that takes over the memory of `values`, whose elements consist of Scalars.
template <class Scalar, class Element>
nb::object array_of(std::vector<Element>&& values, std::initializer_list<std::size_t> shape) {
  auto owned = std::make_unique<std::vector<Element>>(std::move(values));
  auto* data = reinterpret_cast<Scalar*>(owned->data());
  const nb::capsule owner = detail::capsule_of(owned.release());
  return nb::cast(nb::ndarray<nb::numpy, Scalar>(data, shape, owner));
}

/// A read-only NumPy array of memory that belongs to `owner`.
template <class Scalar, class Element>
nb::object view_of(std::span<const Element> values, std::initializer_list<std::size_t> shape,
                   nb::handle owner) {
  const auto* data = reinterpret_cast<const Scalar*>(values.data());
  return nb::cast(nb::ndarray<nb::numpy, const Scalar>(data, shape, owner));
}
template <class Scalar, class Element>
nb::object view_of(const std::vector<Element>& values, std::initializer_list<std::size_t> shape,
                   nb::handle owner) {
  return view_of<Scalar>(std::span<const Element>(values), shape, owner);
}

/// The same for one Element per texel of a map: one Scalar each, or as many as it consists of.
template <class Scalar, class Element>
nb::object texels_of(const std::vector<Element>& values, const DistanceMap& map, nb::handle owner) {
  if constexpr (sizeof(Element) == sizeof(Scalar)) {
    return view_of<Scalar>(values, {map.rows(), map.resolution}, owner);
  } else {
    return view_of<Scalar>(values, {map.rows(), map.resolution, sizeof(Element) / sizeof(Scalar)}, owner);
  }
}

/// Calls body(begin, end) for parts of `count` items, on all cores if there are many. Needs no GIL.
void for_parts(std::size_t count, const std::function<void(std::size_t begin, std::size_t end)>& body);

/// A NumPy array with one row for each of `items`: get(item) returns a Scalar, or a std::array of them or of
/// arrays of them. Calls it concurrently, without the GIL.
template <class Items, class Get>
nb::object column(const Items& items, Get get) {
  using Row = std::remove_cvref_t<decltype(get(items[0]))>;
  auto rows = std::make_unique_for_overwrite<Row[]>(items.size());
  {
    const nb::gil_scoped_release released;
    for_parts(items.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) rows[i] = get(items[i]);
    });
  }
  const auto array = [&]<class Scalar>(Scalar*, std::initializer_list<std::size_t> shape) {
    auto* data = reinterpret_cast<Scalar*>(rows.get());
    const nb::capsule owner(rows.release(), [](void* p) noexcept { delete[] static_cast<Row*>(p); });
    return nb::cast(nb::ndarray<nb::numpy, Scalar>(data, shape, owner));
  };
  if constexpr (requires { typename Row::value_type::value_type; }) {
    using Inner = typename Row::value_type;
    return array(static_cast<typename Inner::value_type*>(nullptr),
                 {items.size(), std::tuple_size_v<Row>, std::tuple_size_v<Inner>});
  } else if constexpr (requires { typename Row::value_type; }) {
    return array(static_cast<typename Row::value_type*>(nullptr), {items.size(), std::tuple_size_v<Row>});
  } else {
    return array(static_cast<Row*>(nullptr), {items.size()});
  }
}

/// An array that is made by the first access.
class LazyArray {
 public:
  template <class Make>
  const nb::object& get(Make make) {
    if (!array_.is_valid()) array_ = make();
    return array_;
  }

 private:
  nb::object array_;
};

}  // namespace sdm::python
