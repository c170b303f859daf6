// Edits of meshes: faces and vertices that are added, removed and moved.
#include <sdm/error.h>
#include <sdm/mesh_edit.h>

#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "objects.h"
#include "proximity.h"

namespace sdm::python {
namespace {

struct EditArguments {
  nb::handle removed_faces, reconnected_faces, moved_vertices, added_vertices, added_faces, added_corner_uvs;
};

// The two arrays of an argument, or none for None.
std::optional<std::pair<nb::object, nb::object>> pair_of(nb::handle argument, const char* name) {
  if (argument.is_none()) return {};
  if (!nb::isinstance<nb::tuple>(argument) && !nb::isinstance<nb::list>(argument))
    throw Error(std::string(name) + " must be a pair: (indices, new values)");
  if (nb::len(argument) != 2) throw Error(std::string(name) + " must be a pair: (indices, new values)");
  return std::pair(nb::object(argument[0]), nb::object(argument[1]));
}

void require_equal(std::size_t indices, std::size_t values, const char* name) {
  if (indices != values)
    throw Error(std::string(name) + " has " + std::to_string(indices) + " indices for " +
                std::to_string(values) + " new values");
}

MeshEdit edit_of(const EditArguments& given) {
  MeshEdit edit;
  if (!given.removed_faces.is_none()) edit.removed_faces = indices(given.removed_faces, "removed_faces");
  if (const auto pair = pair_of(given.reconnected_faces, "reconnected_faces")) {
    const auto faces = indices(pair->first, "reconnected_faces");
    const auto corners = triangles(pair->second, "reconnected_faces");
    require_equal(faces.size(), corners.size(), "reconnected_faces");
    for (std::size_t i = 0; i < faces.size(); ++i) edit.reconnected_faces.push_back({faces[i], corners[i]});
  }
  if (const auto pair = pair_of(given.moved_vertices, "moved_vertices")) {
    const auto vertices = indices(pair->first, "moved_vertices");
    const Points positions(pair->second, "moved_vertices");
    require_equal(vertices.size(), positions.get().size(), "moved_vertices");
    for (std::size_t i = 0; i < vertices.size(); ++i)
      edit.moved_vertices.push_back({vertices[i], positions.get()[i]});
  }
  if (!given.added_vertices.is_none()) {
    const Points positions(given.added_vertices, "added_vertices");
    edit.added_vertices.assign(positions.get().begin(), positions.get().end());
  }
  if (!given.added_faces.is_none()) edit.added_faces = triangles(given.added_faces, "added_faces");
  if (!given.added_corner_uvs.is_none()) edit.added_corner_uvs = corner_uvs(given.added_corner_uvs);
  return edit;
}

template <class Class>
void bind_edit_of(nb::class_<Class>& bound, const char* doc) {
  bound.def(
      "edit",
      [](Class& self, nb::handle removed_faces, nb::handle reconnected_faces, nb::handle moved_vertices,
         nb::handle added_vertices, nb::handle added_faces, nb::handle added_corner_uvs) {
        const MeshEdit edit = edit_of({removed_faces, reconnected_faces, moved_vertices, added_vertices,
                                       added_faces, added_corner_uvs});
        const auto lock = self.access.change();
        self.positions = run_short([&] { return self.edit(edit); });
      },
      nb::kw_only(), nb::arg("removed_faces") = nb::none(), nb::arg("reconnected_faces") = nb::none(),
      nb::arg("moved_vertices") = nb::none(), nb::arg("added_vertices") = nb::none(),
      nb::arg("added_faces") = nb::none(), nb::arg("added_corner_uvs") = nb::none(),
      nb::sig(
          "def edit(self, *, removed_faces: object = None, reconnected_faces: tuple[object, object] | None "
          "= None, moved_vertices: tuple[object, object] | None = None, added_vertices: object = None, "
          "added_faces: object = None, added_corner_uvs: object = None) -> None"),
      doc);
}

Positions positions_of(const Mesh& mesh) {
  return std::make_shared<std::vector<Vec3>>(mesh.positions);
}

}  // namespace

Positions PySites::edit(const MeshEdit& edit) {
  if (version.use_count() > 1) {
    Mesh mesh = sites.mesh();
    apply(mesh, edit);
    Sites edited(std::move(mesh));
    auto next = std::make_shared<SitesVersion>(SitesVersion{&sites, {}});
    version->earlier.emplace(std::move(sites));
    sites = std::move(edited);
    version = std::move(next);
  } else {
    sites.edit(edit);
  }
  first = nullptr;
  ++shape;
  return positions_of(sites.mesh());
}

Positions PySurface::edit(const MeshEdit& edit) {
  surface.edit(edit);
  faces = {};
  texel_faces = {};
  ++shape;
  ++edits;
  return positions_of(surface.mesh());
}

void bind_edit(nb::class_<PySites>& sites) {
  bind_edit_of(sites, R"(Changes the topology, and keeps the numbers of all faces and vertices that stay.

removed_faces: (k,) integers. reconnected_faces: a pair (k,) faces, (k, 3) new corners. moved_vertices: a pair
(k,) vertices, (k, 3) positions. added_vertices: (k, 3) numbers, which follow the present ones. added_faces:
(k, 3) integers, likewise; they may refer to added vertices. added_corner_uvs: (k, 3, 2) numbers, for meshes
with texture coordinates.

Numbers are never used twice: a removed face keeps its place, with three equal corners. Queries have the results
of a new Sites of the mesh. Earlier results and arrays do not change. Raises Error, and changes nothing, for an
index out of range, a face that is removed or reconnected twice, or if nothing with an area is left, and while
another call uses the object. Cost: linear, two thirds to nine tenths of building anew; all of it while earlier
results or arrays of faces and edges exist.

>>> sites = sdm.Sites(box)
>>> sites.edit(removed_faces=[6, 7])
>>> sites.closed, sites.closest_points([[0.5, -1, 0.5]]).distance
(False, array([1.])))");
}

void bind_edit(nb::class_<PySurface>& surface) {
  bind_edit_of(surface, R"(Changes the topology, and keeps the atlas of all faces that stay.

The arguments are those of Sites.edit(). Added faces form charts of their own, in free texels; if there are too
few, the atlas grows at the bottom. Maps computed before keep their distances; a map computed afterwards is
bit-identical where faces did not change. Raises Error, and changes nothing, as Sites.edit() does, and if the
atlas has no room. Cost: by the size of the edit, and a pass over the texels; the first edit also rasterises all
faces.

>>> surface = sdm.Surface(box, resolution=64)
>>> surface.edit(removed_faces=[0])
>>> bool((surface.texel_faces == 0).any())
False)");
}

void bind_edit(nb::class_<PyProximityQuery>& query) {
  query.def(
      "edit",
      [](PyProximityQuery& self, int body, nb::handle removed_faces, nb::handle reconnected_faces,
         nb::handle moved_vertices, nb::handle added_vertices, nb::handle added_faces,
         nb::handle added_corner_uvs) {
        const MeshEdit edit = edit_of({removed_faces, reconnected_faces, moved_vertices, added_vertices,
                                       added_faces, added_corner_uvs});
        const auto lock = self.access.change();
        run_short([&] { self.query.edit(body, edit); });
      },
      nb::arg("body"), nb::kw_only(), nb::arg("removed_faces") = nb::none(),
      nb::arg("reconnected_faces") = nb::none(), nb::arg("moved_vertices") = nb::none(),
      nb::arg("added_vertices") = nb::none(), nb::arg("added_faces") = nb::none(),
      nb::arg("added_corner_uvs") = nb::none(),
      nb::sig("def edit(self, body: int, *, removed_faces: object = None, reconnected_faces: tuple[object, "
              "object] | None = None, moved_vertices: tuple[object, object] | None = None, added_vertices: "
              "object = None, added_faces: object = None, added_corner_uvs: object = None) -> None"),
      R"(Changes the mesh of a body, 0 or 1, in its frame, and keeps the numbers of all faces and vertices that
stay. The other arguments are those of Sites.edit(). All results are those of the edited mesh, to the bit; the
ids of contacts may change. Raises Error, and changes nothing, as Sites.edit() does, and for a body whose Shape
is shared. Cost: that of new Sites.

>>> query = sdm.ProximityQuery(box, box)
>>> query.set_pose(1, [[1, 0, 0, 3], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
>>> query.edit(1, added_vertices=[[-1, 0, 0], [-1, 1, 0], [-1, 0, 1]], added_faces=[[8, 9, 10]])
>>> query.separation()
sdm.BoundedLength(1, exact))");
}

}  // namespace sdm::python
