#include "arrays.h"

#include <sdm/error.h>
#include <sdm/execution.h>

#include <algorithm>
#include <cstring>
#include <string>

namespace sdm::python {
namespace {

// The slow path, for all that is not float64 or uint32 in C order: python/sdm/_arrays.py.
// Arrays that the fast path may take as they are: not those of a subclass with a mask, which it would ignore.
bool may_be_used(nb::handle array) {
  return !nb::hasattr(array, "mask");
}

nb::object converted(const char* function, nb::handle array, const char* name) {
  return nb::module_::import_("sdm._arrays").attr(function)(array, name);
}

}  // namespace

std::filesystem::path path_of(nb::handle file) {
  const nb::bytes bytes(nb::module_::import_("os").attr("fsencode")(file));
  std::string name(static_cast<const char*>(bytes.data()), bytes.size());
  if (name.find('\0') != std::string::npos)
    throw Error("the name of a file contains a NUL character: " + std::string(nb::repr(file).c_str()));
  return name;
}

std::int64_t integer_of(nb::handle value, const char* name, std::int64_t least, std::int64_t most) {
  PyObject* index = PyNumber_Index(value.ptr());
  if (index == nullptr) {
    PyErr_Clear();
    const nb::str type(nb::borrow(value.type()).attr("__name__"));
    throw nb::type_error((std::string(name) + " must be an integer, not " + type.c_str()).c_str());
  }
  const nb::object owner = nb::steal(index);
  int overflow = 0;
  const long long result = PyLong_AsLongLongAndOverflow(index, &overflow);
  if (overflow == 0 && result >= least && result <= most) return result;
  // Larger limits are those of a type.
  constexpr std::int64_t kStated = 1'000'000'000;
  const std::string from = std::to_string(least), to = std::to_string(most);
  throw Error(std::string(name) + " is out of range; use " +
              (most <= kStated ? from + " to " + to : "at least " + from));
}

double real_of(nb::handle value) {
  const double result = PyFloat_AsDouble(value.ptr());
  if (result == -1 && PyErr_Occurred() != nullptr) nb::raise_python_error();
  return result;
}

void for_parts(std::size_t count, const std::function<void(std::size_t begin, std::size_t end)>& body) {
  constexpr std::size_t kPart = 1 << 15;
  if (count <= kPart) return body(0, count);
  std::vector<std::function<void()>> tasks;
  for (std::size_t begin = 0; begin < count; begin += kPart)
    tasks.emplace_back([&body, begin, end = std::min(count, begin + kPart)] { body(begin, end); });
  run_concurrently(tasks);
}

Points::Points(nb::handle array, const char* name) {
  if (!may_be_used(array) || !nb::try_cast(array, array_, false))
    array_ = nb::cast<decltype(array_)>(converted("points", array, name));
}

std::span<const Vec3> Points::get() const {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  return {reinterpret_cast<const Vec3*>(array_.data()), array_.shape(0)};
}

Lengths::Lengths(nb::handle value, const char* name, std::size_t count)
    : array_(nb::cast<decltype(array_)>(
          nb::module_::import_("sdm._arrays").attr("lengths")(value, name, count))) {}

std::vector<Triangle> triangles(nb::handle array, const char* name) {
  nb::ndarray<const std::uint32_t, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu> indices;
  if (!may_be_used(array) || !nb::try_cast(array, indices, false))
    indices = nb::cast<decltype(indices)>(converted("triangles", array, name));
  static_assert(sizeof(Triangle) == 3 * sizeof(std::uint32_t));
  const auto* first = reinterpret_cast<const Triangle*>(indices.data());
  return {first, first + indices.shape(0)};
}

std::vector<std::uint32_t> indices(nb::handle array, const char* name) {
  using Indices = nb::ndarray<const std::uint32_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
  const auto numbers = nb::cast<Indices>(converted("indices", array, name));
  return {numbers.data(), numbers.data() + numbers.shape(0)};
}

std::vector<std::array<Vec2, 3>> corner_uvs(nb::handle array) {
  using Uvs = nb::ndarray<const double, nb::shape<-1, 3, 2>, nb::c_contig, nb::device::cpu>;
  const auto uvs = nb::cast<Uvs>(converted("corner_uvs", array, "corner_uvs"));
  const auto* first = reinterpret_cast<const std::array<Vec2, 3>*>(uvs.data());
  return {first, first + uvs.shape(0)};
}

namespace {

void require_affine(const Transform& pose, const char* name) {
  if (pose.rows[3] != std::array<double, 4>{0, 0, 0, 1})
    throw Error(std::string(name) + " must be an affine matrix: its last row is not (0, 0, 0, 1)");
}

Transform affine(const double* numbers, const char* name) {
  Transform result;
  std::memcpy(result.rows.data(), numbers, sizeof(result.rows));
  require_affine(result, name);
  return result;
}

/// The pose of a position x y z and a quaternion w x y z.
Transform rigid(const double* n) {
  return Transform::translation({n[0], n[1], n[2]}) * Transform::quaternion({n[3], n[4], n[5], n[6]});
}

}  // namespace

Transform transform(nb::handle pose, const char* name) {
  using Matrix = nb::ndarray<const double, nb::shape<4, 4>, nb::c_contig, nb::device::cpu>;
  Matrix matrix;
  if (may_be_used(pose) && nb::try_cast(pose, matrix, false)) return affine(matrix.data(), name);
  using Numbers = nb::ndarray<const double, nb::c_contig, nb::device::cpu>;
  const auto numbers = nb::cast<Numbers>(converted("pose", pose, name));
  if (numbers.ndim() == 2) return affine(numbers.data(), name);
  try {
    return rigid(numbers.data());
  } catch (const Error& error) {
    throw Error(std::string(name) + ": " + error.what());
  }
}

Poses::Poses(nb::handle array, const char* name) {
  static_assert(sizeof(Transform) == 16 * sizeof(double));
  nb::object numbers;
  if (!may_be_used(array) || !nb::try_cast(array, array_, false)) {
    numbers = converted("poses", array, name);
    if (nb::cast<std::size_t>(numbers.attr("ndim")) == 3) array_ = nb::cast<decltype(array_)>(numbers);
  }
  if (array_.is_valid()) {
    poses_ = {reinterpret_cast<const Transform*>(array_.data()), array_.shape(0)};
    for (const Transform& pose : poses_) require_affine(pose, name);
    return;
  }
  using Rows = nb::ndarray<const double, nb::shape<-1, 7>, nb::c_contig, nb::device::cpu>;
  const auto rows = nb::cast<Rows>(numbers);
  for (std::size_t i = 0; i < rows.shape(0); ++i) {
    try {
      of_quaternions_.push_back(rigid(rows.data() + 7 * i));
    } catch (const Error& error) {
      throw Error(std::string(name) + " " + std::to_string(i) + ": " + error.what());
    }
  }
  poses_ = of_quaternions_;
}

std::array<Transform, 2> motion(nb::handle poses, const char* name) {
  const nb::object numbers = converted("motion", poses, name);
  const Poses two(numbers, name);
  return {two.get()[0], two.get()[1]};
}

nb::object matrix(const Transform& transform) {
  std::vector<std::array<std::array<double, 4>, 4>> rows{transform.rows};
  return array_of<double>(std::move(rows), {4, 4});
}

nb::object vector_of(const Vec3& vector) {
  std::vector<Vec3> rows{vector};
  return array_of<double>(std::move(rows), {3});
}

}  // namespace sdm::python
