// Proximity of a mesh to itself.
#include <nanobind/stl/optional.h>
#include <sdm/error.h>

#include "objects.h"
#include "options.h"
#include "proximity.h"
#include "signatures.h"
#include "stored.h"

namespace sdm::python {
namespace {

struct PySelfProximityQuery {
  SelfProximityQuery query;
  Access access;
};

void bind_mesh(nb::class_<PySelfProximityQuery>& query) {
  static const std::string signature =
      "def __init__(self, rest: object, *, " + option_signature("SelfProximityQuery") + kProgress + "None";
  query
      .def(
          "__init__",
          [](PySelfProximityQuery* self, nb::handle rest, nb::handle progress, const nb::kwargs& given) {
            check_keywords("SelfProximityQuery", given);
            SelfProximityOptions options;
            set_options(given, options);
            set_options(given, options.exclusion);
            Mesh mesh = mesh_of(rest, nb::none());
            InPlace<PySelfProximityQuery> made(self);
            run(progress, [&](const Progress& report) {
              options.progress = report;
              made.make([&] {
                return PySelfProximityQuery{SelfProximityQuery(std::move(mesh), options), {}};
              });
            });
            made.release();
          },
          nb::arg("rest").none(), nb::kw_only(), nb::arg("progress") = nb::none(), nb::arg("options"),
          nb::sig(signature.c_str()))
      .def(
          "refit",
          [](PySelfProximityQuery& self, nb::handle vertices) {
            const Points positions(vertices, "vertices");
            const auto lock = self.access.change();
            run_short([&] { self.query.refit(positions.get()); });
          },
          nb::arg("vertices").none(), nb::sig("def refit(self, vertices: object) -> None"),
          R"(Moves the vertices, (n, 3) numbers; the excluded faces stay the same. Raises Error, and
changes nothing, for another number of vertices or coordinates that are not finite or beyond 1e37. Cost:
linear.)");
}

void bind_answers(nb::class_<PySelfProximityQuery>& query) {
  query
      .def(
          "separation",
          [](PySelfProximityQuery& self) {
            const auto lock = self.access.change();
            return run_sized(self.query.sites().mesh().triangles.size(),
                             [&] { return self.query.separation(); });
          },
          nb::sig("def separation(self) -> BoundedLength | None"),
          R"(Returns the smallest distance between two faces that do not exclude each other, 0 if they
intersect; None if there are none within max_distance. The witness is a point on each, the face of lower
index first.)")
      .def(
          "contacts",
          [](PySelfProximityQuery& self, double margin) {
            const auto lock = self.access.change();
            auto result = std::make_unique<PyContacts>();
            run_sized(self.query.sites().mesh().triangles.size(), [&] {
              const auto contacts = self.query.contacts(margin);
              result->contacts.assign(contacts.begin(), contacts.end());
            });
            return result.release();
          },
          nb::rv_policy::take_ownership, nb::arg("margin"),
          R"(Returns the contacts of faces within ``margin``, in units of the mesh, of a face that they do
not exclude, with the nearest such face. depth is -|point2 - point1|, as a surface has no inside.)")
      .def("__repr__", [](const PySelfProximityQuery& self) {
        const Mesh& mesh = self.query.sites().mesh();
        return nb::str("sdm.SelfProximityQuery({} vertices, {} faces)")
            .format(mesh.positions.size(), mesh.triangles.size());
      });
}

}  // namespace

void bind_self_proximity(nb::module_& module) {
  static const std::string documentation =
      R"(Proximity of a deforming mesh to itself. Results are exact: computed from the triangles.

rest: any form of a mesh (see Mesh), at rest.
)" + option_documentation("SelfProximityQuery") +
      R"(
progress: called as progress(step, fraction), on this thread; False cancels.

A call raises Error while another thread uses the object.

>>> query = sdm.SelfProximityQuery(sphere, geodesic=1.5)
>>> 1 < query.separation().value < 2
True)";
  nb::class_<PySelfProximityQuery> query(module, "SelfProximityQuery", nb::is_weak_referenceable(),
                                         documentation.c_str());
  bind_mesh(query);
  bind_answers(query);
  bind_no_state<PySelfProximityQuery>(
      "a SelfProximityQuery cannot be pickled or copied; pickle its mesh, and make another one");
}

}  // namespace sdm::python
