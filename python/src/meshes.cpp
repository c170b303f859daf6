// Meshes from Python objects and files.
#include <nanobind/stl/optional.h>
#include <sdm/map.h>
#include <sdm/mesh_edit.h>
#include <sdm/mesh_files.h>
#include <sdm/sites.h>
#include <sdm/surface.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "arrays.h"
#include "fields.h"
#include "objects.h"
#include "options.h"
#include "src/geometry/stretch.h"

namespace sdm::python {

nb::object positions_view(const Positions& positions) {
  const nb::capsule owner = detail::capsule_of(new Positions(positions));
  return view_of<double>(*positions, {positions->size(), 3}, owner);
}

nb::object faces_view(const Mesh& mesh, nb::handle owner) {
  return view_of<std::uint32_t>(mesh.triangles, {mesh.triangles.size(), 3}, owner);
}

PyMesh given_mesh(nb::handle mesh, nb::handle faces) {
  if (faces.is_none()) {
    if (nb::isinstance<PyMesh>(mesh)) return nb::cast<const PyMesh&>(mesh);
    if (nb::isinstance<PySites>(mesh)) {
      const auto& sites = nb::cast<const PySites&>(mesh);
      const auto lock = sites.access.use();
      return {sites.sites.mesh(), sites.deviation};
    }
    if (nb::isinstance<PySurface>(mesh)) {
      const auto& surface = nb::cast<const PySurface&>(mesh);
      const auto lock = surface.access.use();
      return {surface.surface.mesh(), surface.deviation};
    }
  }
  const nb::object parts = nb::module_::import_("sdm._meshes").attr("parts")(mesh, faces);
  if (nb::isinstance<PyMesh>(parts)) return nb::cast<const PyMesh&>(parts);
  const Points positions(parts[0], "the vertices");
  Mesh result{.positions = {positions.get().begin(), positions.get().end()},
              .triangles = triangles(parts[1], "the faces"),
              .corner_uvs = {}};
  if (!parts[2].is_none()) result.corner_uvs = corner_uvs(parts[2]);
  return {std::move(result)};
}

MeshExtras extras_to_write(const PyMesh& mesh) {
  if (!mesh.extras) return {};
  return {.attributes = mesh.extras->attributes,
          .materials = mesh.extras->file->materials,
          .textures = mesh.extras->file->textures,
          .face_materials = mesh.extras->face_materials,
          .names = mesh.extras->names};
}

Mesh mesh_of(nb::handle mesh, nb::handle faces) {
  return given_mesh(mesh, faces).mesh;
}

void move(PyMesh& mesh, const Transform& map) {
  transform(mesh.mesh, map);
  mesh.deviation *= largest_stretch(map);
}

// A row for each corner of each face, as transfer() takes them.
nb::object corner_values(const MeshAttribute& attribute) {
  const std::size_t n = attribute.components;
  std::vector<float> values(3 * attribute.rows->size() * n, std::numeric_limits<float>::quiet_NaN());
  float* to = values.data();
  for (const Triangle& rows : *attribute.rows)
    for (const std::uint32_t row : rows) {
      if (row != kNone) std::copy_n(&attribute.values[row * n], n, to);
      to += n;
    }
  if (n == 1) return array_of<float>(std::move(values), {attribute.rows->size(), 3});
  return array_of<float>(std::move(values), {attribute.rows->size(), 3, n});
}

// The name, with a number if it is there already: several arrays of a file may have one name, or names that
// are no UTF-8 and therefore look the same.
nb::object key_of(const std::string& name, const nb::dict& present) {
  const nb::object plain =
      nb::steal(PyUnicode_DecodeUTF8(name.data(), static_cast<Py_ssize_t>(name.size()), "replace"));
  nb::object key = plain;
  for (int i = 2; present.contains(key); ++i) key = nb::str("{}_{}").format(plain, i);
  return key;
}

void bind_arrays(nb::class_<PyMesh>& type) {
  type.def(
          "__init__",
          [](PyMesh* self, nb::handle mesh, nb::handle faces) {
            PyMesh value = given_mesh(mesh, faces);
            validate(value.mesh);
            new (self) PyMesh(std::move(value));
          },
          nb::arg("mesh").none(), nb::arg("faces") = nb::none(),
          nb::sig("def __init__(self, mesh: object, faces: object = None) -> None"))
      .def_prop_ro(
          "vertices",
          [](nb::handle self) {
            const auto& positions = nb::cast<const PyMesh&>(self).mesh.positions;
            return view_of<double>(positions, {positions.size(), 3}, self);
          },
          nb::sig("def vertices(self) -> numpy.typing.NDArray[numpy.float64]"),
          "The positions, (n, 3) float64, read-only.")
      .def_prop_ro(
          "faces", [](nb::handle self) { return faces_view(nb::cast<const PyMesh&>(self).mesh, self); },
          nb::sig("def faces(self) -> numpy.typing.NDArray[numpy.uint32]"),
          "The vertices of each face, (m, 3) uint32, read-only.")
      .def_prop_ro(
          "corner_uvs",
          [](nb::handle self) -> nb::object {
            const auto& uvs = nb::cast<const PyMesh&>(self).mesh.corner_uvs;
            if (uvs.empty()) return nb::none();
            return view_of<double>(uvs, {uvs.size(), 3, 2}, self);
          },
          nb::sig("def corner_uvs(self) -> numpy.typing.NDArray[numpy.float64] | None"),
          "Texture coordinates of the corners of each face, (m, 3, 2) float64, read-only; None if there are "
          "none.")
      .def_ro(
          "deviation", &PyMesh::deviation,
          "How far the triangles were found to be from the surface of a STEP or IGES file, an estimate, in "
          "units of the mesh; 0 for other meshes. Verdicts on a tolerance keep so far from its limits. "
          "weld(), "
          "remove_islands() and convex_hull() keep it, transformed() scales it, and simplify() adds its own.")
      .def(
          "__iter__",
          [](nb::handle self) { return nb::iter(nb::make_tuple(self.attr("vertices"), self.attr("faces"))); },
          nb::sig("def __iter__(self) -> collections.abc.Iterator[numpy.typing.NDArray[typing.Any]]"))
      .def(
          "transformed",
          [](const PyMesh& self, nb::handle matrix) {
            auto moved = std::make_unique<PyMesh>(self);
            moved->extras.reset();  // normals would not follow
            move(*moved, python::transform(matrix, "the transform"));
            return moved.release();
          },
          nb::rv_policy::take_ownership, nb::arg("matrix").none(),
          nb::sig("def transformed(self, matrix: object) -> Mesh"),
          R"(Returns the mesh moved by a 4 × 4 affine matrix, for column vectors. A reflection also
reverses the faces, so that they keep facing outwards.

>>> mesh = sdm.Mesh(box).transformed(np.diag([2, 1, 1, 1]))
>>> mesh.vertices.max(axis=0)
array([2., 1., 1.]))")
      .def(
          "save",
          [](const PyMesh& self, nb::handle file) {
            const std::filesystem::path name = path_of(file);
            run(nb::none(), [&](const Progress&) { write_mesh(name, self.mesh, extras_to_write(self)); });
          },
          nb::arg("file").none(), nb::sig("def save(self, file: str | os.PathLike[str]) -> None"),
          R"(Writes the mesh in the format of the extension: .ply and .obj keep all digits, .stl and .glb
single precision; .stl has no texture coordinates. Of the result of simplify() of a file, also what the format
has of normals, colours, names and materials, with pictures; .obj has these in files beside it.)")
      .def_prop_ro(
          "attributes",
          [](const PyMesh& self) {
            nb::dict result;
            if (self.extras)
              for (const MeshAttribute& attribute : self.extras->attributes)
                result[key_of(attribute.name, result)] = corner_values(attribute);
            return result;
          },
          nb::sig("def attributes(self) -> dict[str, numpy.typing.NDArray[numpy.float32]]"),
          "What the corners of faces have besides positions and texture coordinates, as of "
          "read_attributes(): of "
          "the result of simplify() of a file; otherwise empty.")
      .def("__repr__", [](const PyMesh& self) {
        return nb::str("sdm.Mesh({} vertices, {} faces)")
            .format(self.mesh.positions.size(), self.mesh.triangles.size());
      });
}

void bind_attributes(nb::module_& module) {
  module.def(
      "read_attributes",
      [](nb::handle file) {
        const std::filesystem::path name = path_of(file);
        MeshFile read;
        run(nb::none(), [&](const Progress&) { read = read_mesh_file(name, {.attributes = true}); });
        nb::dict result;
        for (MeshAttribute& attribute : read.attributes) {
          result[key_of(attribute.name, result)] = corner_values(attribute);
          attribute = {};
        }
        return result;
      },
      nb::arg("file").none(),
      nb::sig("def read_attributes(file: str | os.PathLike[str]) -> dict[str, "
              "numpy.typing.NDArray[numpy.float32]]"),
      R"(Returns what a mesh file has at the corners of the faces of read(), besides positions and texture
coordinates, by name: (faces, 3, components) float32, or (faces, 3) for one component; NaN where it has nothing.

``normal``: as in the file, moved as the faces are. ``color``: three or four components from 0 to 1 in linear light.
``uv1``, ``uv2``, ...: further texture coordinates of glTF. Other numbers of PLY and glTF by their names; of faces,
where vertices have numbers of that name too, as ``face_...``; the second array of a name as ``..._2``. From OBJ, PLY, glTF and GLB; empty for other formats.
The values are constant within faces where the file has one for each face. DistanceMap.transfer(values, 'corner')
takes them. Raises Error, naming the file and the fault.

>>> sdm.read_attributes('no such file.ply')
Traceback (most recent call last):
    ...
sdm.Error: ...
)");
}

void bind_weld(nb::module_& module) {
  nb::class_<WeldReport> type(module, "WeldReport", nb::is_weak_referenceable(), "What weld() did.");
  bind_fields(type).def("__repr__", [](const WeldReport& self) {
    return nb::str("sdm.WeldReport(joined_vertices={}, largest_move={:.3g}, boundary_edges={})")
        .format(self.joined_vertices, self.largest_move, self.boundary_edges);
  });
  static const std::string signature =
      "def weld(mesh: object, " + option_signature("weld") + ") -> tuple[Mesh, WeldReport]";
  static const std::string documentation =
      R"(Joins boundary edges that coincide but for rounding, so that a mesh that is closed but for rounding
has an inside. Returns the welded mesh, whose vertices keep their numbers, and what was done.

)" + option_documentation("weld") +
      R"(

No two vertices of one face are joined, nor the two sides of a thin wall. Raises Error for a tolerance that is not
positive.

>>> vertices, faces = sdm.Mesh(box)
>>> apart = vertices[faces].reshape(-1, 3) + np.linspace(0, 1e-7, 36)[:, None]
>>> welded, report = sdm.weld((apart, np.arange(36).reshape(-1, 3)))
>>> report.joined_vertices, report.boundary_edges
(28, 0)
)";
  module.def(
      "weld",
      [](nb::handle mesh, nb::handle tolerance) {
        const PyMesh given = given_mesh(mesh, nb::none());
        WeldOptions options;
        if (!tolerance.is_none()) set_option(option_of(&WeldOptions::tolerance), tolerance, options);
        Welded welded;
        run(nb::none(), [&](const Progress& progress) {
          options.progress = progress;
          welded = weld(given.mesh, options);
        });
        const WeldReport report = welded;
        return nb::make_tuple(
            nb::cast(new PyMesh{std::move(welded.mesh), given.deviation}, nb::rv_policy::take_ownership),
            report);
      },
      nb::arg("mesh").none(), nb::arg("tolerance") = nb::none(), nb::sig(signature.c_str()),
      documentation.c_str());
}

void bind_convex_hull(nb::module_& module) {
  module.def(
      "convex_hull",
      [](nb::handle mesh) {
        const PyMesh given = given_mesh(mesh, nb::none());
        Mesh hull;
        run(nb::none(), [&](const Progress&) { hull = convex_hull(given.mesh); });
        return nb::cast(new PyMesh{std::move(hull), given.deviation}, nb::rv_policy::take_ownership);
      },
      nb::arg("mesh").none(), nb::sig("def convex_hull(mesh: object) -> Mesh"),
      R"(The convex hull of the corners of all faces: a closed mesh, counter-clockwise from outside, whose
vertices are corners in their order. It is convex exactly, so that two hulls are compared in little time
by ProximityQuery, PoseQuery and MultiBodyQuery. Raises Error for a mesh whose corners are in one plane.

>>> hull = sdm.convex_hull(box)
>>> len(hull.faces), sdm.Shape(hull).convex
(12, True)
)");
}

void bind_islands(nb::module_& module) {
  nb::class_<IslandReport> type(module, "IslandReport", nb::is_weak_referenceable(),
                                "What remove_islands() removed.");
  bind_fields(type).def("__repr__", [](const IslandReport& self) {
    return nb::str("sdm.IslandReport(islands={}, faces={}, area={:.3g})")
        .format(self.islands, self.faces, self.area);
  });
  module.def(
      "remove_islands",
      [](nb::handle mesh, std::size_t faces, double area, double area_fraction) {
        const PyMesh given = given_mesh(mesh, nb::none());
        WithoutIslands rest;
        run(nb::none(), [&](const Progress&) {
          rest = remove_islands(given.mesh, {.faces = faces, .area = area, .area_fraction = area_fraction});
        });
        const IslandReport report = rest;
        return nb::make_tuple(
            nb::cast(new PyMesh{std::move(rest.mesh), given.deviation}, nb::rv_policy::take_ownership),
            report);
      },
      nb::arg("mesh").none(), nb::kw_only(), nb::arg("faces") = 0, nb::arg("area") = 0.0,
      nb::arg("area_fraction") = 0.0,
      nb::sig("def remove_islands(mesh: object, *, faces: int = 0, area: float = 0.0, area_fraction: float = "
              "0.0) -> tuple[Mesh, IslandReport]"),
      R"(Returns a mesh without its islands, such as the floating specks of a scan, and what was removed: the
components with less than ``faces`` faces, less than ``area``, or less than ``area_fraction`` of the area of the
mesh. A limit of 0 has no effect. Vertices keep their numbers.

Raises Error if nothing would be left, and for limits out of range.

>>> vertices, faces = sdm.Mesh(box)
>>> speck = (np.vstack([vertices, [[9, 0, 0], [9, 1, 0], [9, 0, 1]]]), np.vstack([faces, [[8, 9, 10]]]))
>>> sdm.remove_islands(speck, faces=2)[1].islands
1)");
}

void bind_reading(nb::module_& module) {
  module.def(
      "fit_to_unit", [](nb::handle mesh) { return matrix(fit_to_unit(mesh_of(mesh, nb::none()))); },
      nb::arg("mesh").none(), nb::sig("def fit_to_unit(mesh: object) -> numpy.typing.NDArray[numpy.float64]"),
      R"(Returns the uniform scaling and translation that make the longest side of a mesh's bounds 1 and
centre them at the origin, as a (4, 4) float64 matrix for column vectors.

>>> sdm.fit_to_unit(sdm.Mesh(box).transformed(np.diag([2, 2, 2, 1])))[0]
array([ 0.5,  0. ,  0. , -0.5]))");

  module.def(
      "read",
      [](nb::handle file, nb::handle deflection) {
        const std::filesystem::path name = path_of(file);
        MeshFileOptions options;
        if (!deflection.is_none())
          set_option(option_of(&TessellationOptions::deflection), deflection, options.tessellation);
        MeshFile read;
        run(nb::none(), [&](const Progress&) { read = read_mesh_file(name, options); });
        return new PyMesh{std::move(read.mesh), read.tessellation ? read.tessellation->largest_deviation : 0};
      },
      nb::rv_policy::take_ownership, nb::arg("file").none(), nb::arg("deflection") = nb::none(),
      nb::sig("def read(file: str | os.PathLike[str], deflection: float | None = None) -> Mesh"),
      R"(Reads a mesh file: OBJ, PLY, STL, OFF, glTF, GLB, 3DS, or STEP and IGES if the package was built with
SDM_BUILD_CAD.

The format is detected from the content, then from the extension. Polygons are triangulated, node
transforms are applied, and all meshes of the file are merged into one. Vertices used by faces keep their
order; bit-identical positions become one vertex. Raises Error, naming the file and the fault.

deflection: of STEP and IGES, whose coordinates are in millimetres: the distance that triangles may have
from the exact surface, as OpenCASCADE keeps it; by default 1/2000 of the diagonal. Other files consist of
polygons, and do not use it. Raises Error unless it is positive. Mesh.deviation is what was measured of it: verdicts on
a tolerance keep so far from the limits, so that a tenth of the tolerance is a good choice.

>>> sdm.read('no such file.ply')
Traceback (most recent call last):
    ...
sdm.Error: ...
)");
}

void bind_meshes(nb::module_& module) {
  nb::class_<PyMesh> type(
      module, "Mesh", nb::is_weak_referenceable(),
      R"(A triangle mesh: any triangle soup, open or closed, manifold or not. It does not change.

Accepts the same forms of a mesh as every function of this package:

- two arrays ``(vertices, faces)``: n × 3 numbers of any dtype, m × 3 integers
- the path of an OBJ, PLY, STL, OFF, glTF, GLB, 3DS, STEP or IGES file
- ``Mesh``, ``Sites``, ``Surface``
- ``trimesh.Trimesh``, ``open3d.geometry.TriangleMesh``, ``open3d.t.geometry.TriangleMesh``,
  ``pyvista.PolyData``, ``meshio.Mesh``

Faces are counter-clockwise seen from outside. Raises Error for an object that is no mesh, for
an index out of range, for coordinates that are NaN or beyond 1e37, and if no face has an area.

>>> mesh = sdm.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
>>> mesh.vertices.shape, mesh.faces.dtype
((3, 3), dtype('uint32'))
>>> vertices, faces = mesh)");
  bind_arrays(type);
  bind_reading(module);
  bind_attributes(module);
  bind_weld(module);
  bind_convex_hull(module);
  bind_islands(module);
}

}  // namespace sdm::python
