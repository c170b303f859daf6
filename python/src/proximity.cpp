// Proximity of two bodies.
#include "proximity.h"
#include "fields.h"
#include "objects.h"
#include "options.h"
#include "stored.h"

#include <nanobind/stl/optional.h>
#include <sdm/error.h>
#include <sdm/map_files.h>

#include <filesystem>
#include <memory>
#include <string>

namespace sdm::python {
namespace {

int checked(int body) {
  if (body != 0 && body != 1)
    throw Error("there is no body " + std::to_string(body) + "; the bodies are 0 and 1");
  return body;
}

void bind_lengths(nb::module_& module) {
  nb::class_<BoundedLength> length(
      module, "BoundedLength", nb::is_weak_referenceable(),
      "A length with its bounds, in units of the meshes. ``float()`` of it is the value.");
  bind_fields(length)
      .def("__float__", [](const BoundedLength& self) { return self.value; })
      .def("__repr__", [](const BoundedLength& self) {
        if (self.certainty == Certainty::exact)
          return nb::str("sdm.BoundedLength({:.9g}, exact)").format(self.value);
        return nb::str("sdm.BoundedLength({:.9g}, in [{:.9g}, {:.9g}])")
            .format(self.value, self.lower, self.upper);
      });
}

void bind_separating_translation(nb::module_& module) {
  using T = SeparatingTranslation;
  nb::class_<T> translation(
      module, "SeparatingTranslation", nb::is_weak_referenceable(),
      R"(How far O1 must be moved to leave O2, in units of the meshes. ``float()`` of it is the
value.)");
  bind_fields(translation)
      .def("__float__", [](const T& self) { return self.value; })
      .def("__repr__", [](const T& self) {
        return nb::str("sdm.SeparatingTranslation({:.9g}, in [{:.9g}, {:.9g}])")
            .format(self.value, self.lower, self.upper);
      });
}

void bind_shape_files(nb::class_<PyShape>& shape) {
  shape
      .def(
          "save",
          [](const PyShape& self, nb::handle file) {
            const std::filesystem::path name = path_of(file);
            run_sized(faces_of(self.shape), [&] { write_shape(name, self.shape); });
          },
          nb::arg("file").none(), nb::sig("def save(self, file: str | os.PathLike[str]) -> None"),
          R"(Writes the shape, some twenty times the size of its mesh, for load(). The complete file appears, or
none. Raises Error, naming the file and the fault.)")
      .def_static(
          "load",
          [](nb::handle file, bool trusted) {
            const std::filesystem::path name = path_of(file);
            return run_sized(std::size_t{1} << 20, [&] { return PyShape(read_shape(name, {trusted})); });
          },
          nb::arg("file").none(), nb::kw_only(), nb::arg("trusted") = false,
          nb::sig("def load(file: str | os.PathLike[str], *, trusted: bool = False) -> Shape"),
          R"(The shape that save() wrote, in a small part of the time of making it, with the same results to
the bit. Its arrays are those of the file, which processes share; it may be deleted or saved again, but not be
changed in place. The file may come from anyone, as all of it is checked; trusted: only for damage. Raises
Error, naming the file and the fault, if another version of sdm wrote it, or if it is incomplete or damaged:
make the shape again from its mesh.)");
}

Vec3 vector_of(nb::handle value, const char* name) {
  const Lengths numbers(value, name, 3);
  return {numbers.get()[0], numbers.get()[1], numbers.get()[2]};
}

void bind_primitives(nb::class_<PyShape>& shape) {
  using Kind = Primitive::Kind;
  shape
      .def_static(
          "sphere",
          [](double radius) {
            return PyShape(Primitive{Kind::sphere, {radius}});
          },
          nb::arg("radius"), nb::sig("def sphere(radius: float) -> Shape"),
          R"(The ball of that radius about the origin, exactly, without faces. Raises Error unless the radius is
finite and above 0, as all primitives do.

>>> round(float(sdm.ProximityQuery(sdm.Shape.sphere(1), sdm.Shape.box([1, 1, 1])).separating_translation()), 6)
1.5)")
      .def_static(
          "capsule",
          [](double radius, double length) {
            return PyShape(Primitive{Kind::capsule, {radius, length}});
          },
          nb::arg("radius"), nb::arg("length"), nb::sig("def capsule(radius: float, length: float) -> Shape"),
          R"(The points within the radius of a segment of that length, about the origin, along z.)")
      .def_static(
          "cylinder",
          [](double radius, double length) {
            return PyShape(Primitive{Kind::cylinder, {radius, length}});
          },
          nb::arg("radius"), nb::arg("length"),
          nb::sig("def cylinder(radius: float, length: float) -> Shape"),
          R"(The cylinder of that radius and length, about the origin, along z.)")
      .def_static(
          "box", [](nb::handle sides) { return PyShape(Shape::box(vector_of(sides, "sides"))); },
          nb::arg("sides").none(), nb::sig("def box(sides: object) -> Shape"),
          R"(The box with sides of these three lengths, or of one, about the origin, a mesh of 12 faces.)")
      .def_static(
          "half_space",
          [](nb::handle normal, double offset) {
            const Vec3 n = vector_of(normal, "normal");
            return PyShape(Primitive{Kind::half_space, {n[0], n[1], n[2], offset}});
          },
          nb::arg("normal").none(), nb::arg("offset") = 0.0,
          nb::sig("def half_space(normal: object, offset: float = 0.0) -> Shape"),
          R"(The points x with n · x ≤ offset, n the normal divided by its length, as a floor. Two half-spaces are
no pair of bodies.)")
      .def("with_margin", &PyShape::with_margin, nb::arg("radius"),
           nb::sig("def with_margin(self, radius: float) -> Shape"),
           R"(The points within that radius of this shape, without its atlas. Raises Error for a shape that is
not convex.)")
      .def_prop_ro(
          "has_mesh", [](const PyShape& self) { return self.shape.has_mesh(); },
          "Whether it is a mesh, without or with a margin. Others have no faces, and no maps.")
      .def_prop_ro(
          "margin", [](const PyShape& self) { return self.shape.margin(); },
          "The radius around the mesh, or that of a sphere or a capsule; otherwise 0.");
}

void bind_shape(nb::module_& module) {
  nb::class_<PyShape> shape(
      module, "Shape", nb::is_weak_referenceable(),
      R"(A mesh prepared for proximity queries, which any number of bodies can share: a thousand bodies of
one shape need the memory of one.

mesh, faces: as Mesh. resolution: texels per side of an atlas, for maps of the body; None: no
atlas. Raises Error for a mesh that cannot be used.

>>> shape = sdm.Shape(box)
>>> query = sdm.ProximityQuery(shape, shape))");
  shape
      .def(
          "__init__",
          [](PyShape* self, nb::handle mesh, nb::handle faces, std::optional<std::uint32_t> resolution,
             nb::handle progress) {
            const Mesh value = mesh_of(mesh, faces);
            InPlace<PyShape> made(self);
            run(progress, [&](const Progress& report) {
              made.make([&] { return PyShape(value, resolution, report); });
            });
            made.release();
          },
          nb::arg("mesh").none(), nb::arg("faces") = nb::none(), nb::kw_only(),
          nb::arg("resolution") = nb::none(), nb::arg("progress") = nb::none(),
          nb::sig("def __init__(self, mesh: object, faces: object = None, *, resolution: int | None = None, "
                  "progress: collections.abc.Callable[[str, float], bool | None] | None = None) -> None"))
      .def_prop_ro(
          "faces",
          [](nb::handle self) {
            return faces_view(nb::cast<const PyShape&>(self).shape.sites().mesh(), self);
          },
          nb::sig("def faces(self) -> numpy.typing.NDArray[numpy.uint32]"),
          "The vertices of each face, (m, 3) uint32, read-only.")
      .def_prop_ro(
          "convex", [](const PyShape& self) { return self.shape.convex(); },
          "Whether the mesh bounds a convex solid, exactly: two such shapes are compared in less time, with "
          "the "
          "same results. See convex_hull().")
      .def("__repr__", [](const PyShape& self) {
        if (!self.shape.has_mesh()) return nb::str("sdm.Shape(without faces)");
        const Mesh& mesh = self.shape.sites().mesh();
        return nb::str("sdm.Shape({} vertices, {} faces)")
            .format(mesh.positions.size(), mesh.triangles.size());
      });
  bind_primitives(shape);
  bind_shape_files(shape);
}

std::size_t faces_of(const ProximityQuery& query) {
  return faces_at([&]() -> const Sites& { return query.sites(0); }) +
         faces_at([&]() -> const Sites& { return query.sites(1); });
}

}  // namespace

PyShape::PyShape(const Mesh& mesh, std::optional<std::uint32_t> side, const Progress& progress)
    : resolution(side),
      shape(side ? Shape(mesh, {.resolution = *side, .progress = progress}) : Shape(mesh)) {}

namespace {

std::optional<std::uint32_t> resolution_of(const Shape& shape) {
  if (!shape.has_surface()) return {};
  return shape.surface().resolution();
}

}  // namespace

Shape Primitive::shape() const {
  switch (kind) {
    case Kind::sphere:
      return Shape::sphere(sizes[0]);
    case Kind::capsule:
      return Shape::capsule(sizes[0], sizes[1]);
    case Kind::cylinder:
      return Shape::cylinder(sizes[0], sizes[1]);
    case Kind::half_space:
      return Shape::half_space({sizes[0], sizes[1], sizes[2]}, sizes[3]);
  }
  throw Error("no such primitive");
}

PyShape PyShape::with_margin(double radius) const {
  PyShape result(shape.with_margin(radius));
  result.primitive = primitive;
  result.margins = margins;
  result.margins.push_back(radius);
  return result;
}

PyShape::PyShape(Shape made) : resolution(resolution_of(made)), shape(std::move(made)) {}

Shape shape_of(nb::handle body) {
  if (nb::isinstance<PyShape>(body)) return nb::cast<const PyShape&>(body).shape;
  const Mesh mesh = mesh_of(body, nb::none());
  return run_sized(mesh.triangles.size(), [&] { return Shape(mesh); });
}

void bind_motion(nb::class_<PyProximityQuery>& query) {
  static const std::string signature =
      "def __init__(self, o1: object, o2: object, *, " + option_signature("ProximityQuery") + ") -> None";
  query
      .def(
          "__init__",
          [](PyProximityQuery* self, nb::handle o1, nb::handle o2, const nb::kwargs& given) {
            check_keywords("ProximityQuery", given);
            ProximityOptions options;
            set_options(given, options);
            new (self) PyProximityQuery{ProximityQuery(shape_of(o1), shape_of(o2), options), {}};
          },
          nb::arg("o1").none(), nb::arg("o2").none(), nb::arg("options"), nb::sig(signature.c_str()))
      .def(
          "set_pose",
          [](PyProximityQuery& self, int body, nb::handle pose) {
            const Transform matrix = transform(pose, "pose");
            const auto lock = self.access.change();
            self.query.set_pose(checked(body), matrix);
          },
          nb::arg("body"), nb::arg("pose").none(),
          nb::sig("def set_pose(self, body: int, pose: object) -> None"),
          R"(Sets the pose of a body, 0 or 1: a 4 × 4 matrix from the frame of its mesh to space, for
column vectors, of a rotation, a uniform scale and a translation; or 7 numbers, a position x y z and a
quaternion w x y z. Initially the identity. Raises Error, and changes nothing, if the matrix differs from such
a one by more than 1e-5 of the scale. Cost: constant.)")
      .def(
          "pose",
          [](const PyProximityQuery& self, int body) {
            const auto lock = self.access.use();
            return matrix(self.query.pose(checked(body)));
          },
          nb::arg("body"), nb::sig("def pose(self, body: int) -> numpy.typing.NDArray[numpy.float64]"),
          "The pose of a body, (4, 4) float64.")
      .def(
          "refit",
          [](PyProximityQuery& self, nb::handle o1, nb::handle o2) {
            const OptionalPoints first(o1, "o1"), second(o2, "o2");
            const auto lock = self.access.change();
            run_short([&] { self.query.refit(first.get(), second.get()); });
          },
          nb::arg("o1") = nb::none(), nb::arg("o2") = nb::none(),
          nb::sig("def refit(self, o1: object = None, o2: object = None) -> None"),
          R"(Moves the vertices of the bodies, (n, 3) numbers each; None leaves a body unchanged. Raises
Error, and changes nothing, for another number of vertices, coordinates that are not finite, or a body
whose Shape is shared. Cost: linear.)");
}

void bind_answers(nb::class_<PyProximityQuery>& query) {
  query
      .def(
          "separation",
          [](PyProximityQuery& self) {
            const auto lock = self.access.change();
            return run_sized(faces_of(self.query), [&] { return self.query.separation(); });
          },
          "Returns the smallest distance between the two surfaces: exact, and 0 if they intersect.")
      .def(
          "colliding",
          [](PyProximityQuery& self) {
            const auto lock = self.access.change();
            return run_sized(faces_of(self.query), [&] { return self.query.colliding(); });
          },
          "Returns whether the surfaces intersect or one body is a solid that contains part of the other. "
          "Exact.")
      .def(
          "penetration_depth",
          [](PyProximityQuery& self) {
            const auto lock = self.access.change();
            return run_sized(faces_of(self.query), [&] { return self.query.penetration_depth(); });
          },
          nb::sig("def penetration_depth(self) -> BoundedLength | None"),
          R"(Returns the largest distance from a surface point of either body that lies inside the other to
the boundary of that other body: exactly 0 if they do not collide, otherwise bounded; None if neither body
is a solid.)")
      .def(
          "separating_translation",
          [](PyProximityQuery& self) {
            const auto lock = self.access.change();
            return run_sized(faces_of(self.query), [&] { return self.query.separating_translation(); });
          },
          nb::sig("def separating_translation(self) -> SeparatingTranslation"),
          R"(Returns the shortest translation of O1 after which the bodies do not collide, with bounds on its
length: 0 if they do not collide. It is not a path: linked rings that do not touch have 0. Exact for two
convex solids; otherwise the upper bound is verified by the exact test of collision, and the lower one is 0
if neither body is a solid. penetration_depth() is that of the deepest point, and at most as large.

>>> query = sdm.ProximityQuery(box, box)
>>> query.set_pose(0, [[1, 0, 0, 0.75], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
>>> found = query.separating_translation()
>>> round(found.value, 6), found.certainty, round(float(found.translation[0]), 6)
(0.25, 'exact', 0.25))");
}

void bind_contact_answer(nb::class_<PyProximityQuery>& query) {
  query.def(
      "contacts",
      [](PyProximityQuery& self) {
        const auto lock = self.access.change();
        auto result = std::make_unique<PyContacts>();
        run_sized(faces_of(self.query), [&] {
          const auto contacts = self.query.contacts();
          result->contacts.assign(contacts.begin(), contacts.end());
        });
        return result.release();
      },
      nb::rv_policy::take_ownership,
      R"(Returns the contacts of both bodies: none if they are farther apart than the margin.

>>> query = sdm.ProximityQuery(box, box, contact_margin=0.1)
>>> query.set_pose(0, [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 1.05], [0, 0, 0, 1]])
>>> contacts = query.contacts()
>>> float(contacts.depth.max().round(6))
-0.05)");
}

void bind_separating_contacts(nb::class_<PyProximityQuery>& query) {
  query.def(
      "separating_contacts",
      [](PyProximityQuery& self, std::optional<std::size_t> most_per_patch) {
        const auto lock = self.access.change();
        auto result = std::make_unique<PyContacts>();
        run_sized(faces_of(self.query), [&] {
          const auto contacts = self.query.separating_contacts(most_per_patch);
          result->contacts.assign(contacts.begin(), contacts.end());
        });
        return result.release();
      },
      nb::kw_only(), nb::arg("most_per_patch") = nb::none(), nb::rv_policy::take_ownership,
      nb::sig("def separating_contacts(self, *, most_per_patch: int | None = None) -> Contacts"),
      R"(Returns contacts along which the bodies leave each other, for solvers: where they overlap by much,
contacts() are of single points, and may push in all directions. These are the contacts after the
separating_translation() of O1, moved back by it: depth = normal · (point2 - point1), how far O1 must be
moved along the normal until this contact only touches, but at most separating_translation().upper, even if
the points of the contact along the translation are farther apart. Two convex solids have the contacts of a
patch, all along the translation: see docs/proximity.md. If the bodies do not collide, they are contacts().

most_per_patch: so many contacts of each patch are kept, ≥ 1: the deepest one and those farthest apart.

>>> query = sdm.ProximityQuery(box, box)
>>> query.set_pose(0, [[1, 0, 0, 0.75], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
>>> contacts = query.separating_contacts(most_per_patch=4)
>>> float(contacts.depth.max().round(6)), float(contacts.normal[:, 0].min().round(6))
(0.25, 1.0))");
}

void bind_proximity(nb::module_& module) {
  bind_lengths(module);
  bind_separating_translation(module);
  bind_contacts(module);
  bind_shape(module);
  static const std::string documentation =
      R"(Proximity of two bodies that move and deform: separation, collision, penetration depth, contacts.

o1, o2: each any form of a mesh (see Mesh), or a Shape.
)" + option_documentation("ProximityQuery") +
      R"(

A closed, orientable body is a solid; any other one is a surface without an inside. All results are
in space, with both bodies in their poses, and are computed by the first call after a body has moved.
A call raises Error while another thread uses the object.

>>> query = sdm.ProximityQuery(box, box)
>>> query.set_pose(1, [[1, 0, 0, 3], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
>>> query.separation()
sdm.BoundedLength(2, exact)
>>> query.colliding()
False)";
  nb::class_<PyProximityQuery> query(module, "ProximityQuery", nb::is_weak_referenceable(),
                                     documentation.c_str());
  bind_motion(query);
  bind_edit(query);
  bind_answers(query);
  bind_contact_answer(query);
  bind_separating_contacts(query);
  bind_no_state<PyProximityQuery>(
      "a ProximityQuery cannot be pickled or copied; pickle its meshes or Shapes, and make another one");
  bind_self_proximity(module);
}

}  // namespace sdm::python
