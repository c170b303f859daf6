// What the queries of two bodies, of many, and of one and itself have in common.
#pragma once

#include <nanobind/nanobind.h>
#include <sdm/sdm.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "arrays.h"
#include "fields.h"
#include "run.h"

namespace sdm::python {

/// Contacts, with the bodies that they belong to if there are many; arrays are made by the first access.
struct PyContacts {
  std::vector<Contact> contacts;
  std::vector<std::array<std::uint32_t, 2>> bodies;
  std::vector<PartPair> parts;
  bool has_bodies = false;
  Columns<Contact> columns;
  LazyArray faces, barycentric, body, part;
};

struct PyProximityQuery {
  ProximityQuery query;
  Access access;
};

struct PyMultiBodyQuery {
  MultiBodyQuery query;
  Access access;
};

/// The number of faces of all bodies.
[[nodiscard]] std::size_t faces_of(const MultiBodyQuery& query);

/// The number of faces of what `sites` returns; 0 if it throws, as for a shape without a mesh.
template <class SitesOf>
[[nodiscard]] std::size_t faces_at(const SitesOf& sites) try {
  return sites().mesh().triangles.size();
} catch (const Error&) {
  return 0;
}
[[nodiscard]] inline std::size_t faces_of(const Shape& shape) {
  return shape.has_mesh() ? shape.sites().mesh().triangles.size() : 0;
}

/// A mesh prepared for proximity queries, as of sdm.Shape.
/// A solid without a mesh, as its function of Shape takes it. It is stored by its bytes: there is no padding.
struct Primitive {
  enum class Kind : std::uint64_t { sphere, capsule, cylinder, half_space };
  Kind kind = Kind::sphere;
  std::array<double, 4> sizes{};

  /// Throws sdm::Error as that function does, and for another kind.
  [[nodiscard]] Shape shape() const;
};

struct PyShape {
  PyShape(const Mesh& mesh, std::optional<std::uint32_t> side, const Progress& progress);
  explicit PyShape(Shape shape);
  explicit PyShape(const Primitive& made) : PyShape(made.shape()) { primitive = made; }
  /// Throws sdm::Error as Shape::with_margin() does.
  [[nodiscard]] PyShape with_margin(double radius) const;

  std::optional<std::uint32_t> resolution;  ///< of the atlas, if it has one
  Shape shape;
  std::optional<Primitive> primitive{};  ///< if it is none of a mesh
  std::vector<double> margins{};         ///< one after another
};

/// Several shapes that are one body, as of sdm.Compound.
struct PyCompound {
  std::vector<BodyPart> parts;
  nb::tuple shapes;  ///< the Shape of each part
};

/// The shape of a Shape, or a new one of any other mesh.
[[nodiscard]] Shape shape_of(nb::handle body);

/// The parts of a Compound, or the one of any other body.
[[nodiscard]] std::vector<BodyPart> parts_of(nb::handle body);

/// Positions for a refit; none for None.
class OptionalPoints {
 public:
  OptionalPoints(nb::handle array, const char* name) {
    if (array.is_none()) return;
    points_.emplace(array, name);
    // An empty span would leave the body unchanged.
    if (points_->get().empty()) throw Error(std::string(name) + " has no vertices");
  }
  [[nodiscard]] std::span<const Vec3> get() const {
    return points_ ? points_->get() : std::span<const Vec3>();
  }

 private:
  std::optional<Points> points_;
};

struct PyNearestMap {
  NearestMap nearest;
  LazyArray valid;
};

/// Adds the method edit().
void bind_edit(nb::class_<PyProximityQuery>& query);
/// Adds the method time_of_contact().
void bind_moving_bodies(nb::module_& module, nb::class_<PyMultiBodyQuery>& query);
void bind_compound(nb::module_& module);
void bind_contacts(nb::module_& module);
void bind_self_proximity(nb::module_& module);
void bind_nearest_map(nb::module_& module);

}  // namespace sdm::python
