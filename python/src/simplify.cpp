// Fewer triangles, with a certified deviation.
#include <nanobind/stl/optional.h>
#include <sdm/io.h>
#include <sdm/simplify.h>

#include <optional>
#include <string>
#include <utility>

#include "arrays.h"
#include "signatures.h"

namespace sdm::python {
namespace {

nb::tuple simplified_mesh(nb::handle mesh, std::optional<double> max_deviation, nb::handle triangles,
                          nb::handle progress) {
  if (max_deviation.has_value() != triangles.is_none())
    throw Error("simplify() takes either max_deviation or triangles");
  const std::size_t count =
      triangles.is_none() ? 1 : static_cast<std::size_t>(integer_of(triangles, "triangles", 1));
  const Mesh given = mesh_of(mesh, nb::none());
  Simplified result;
  run(progress, [&](const Progress& report) {
    Simplifier simplifier(given);
    const SimplifyOptions options{.progress = report};
    result = max_deviation ? simplifier.to_deviation(*max_deviation, options)
                           : simplifier.to_triangles(count, options);
  });
  if (result.stopped) {
    const char* const text = max_deviation
                                 ? "no collapse of edges keeps the deviation: the result is the mesh itself"
                                 : "more triangles are left than asked for: no further collapse is possible";
    if (PyErr_WarnEx(PyExc_RuntimeWarning, text, 1) < 0) throw nb::python_error();
  }
  return nb::make_tuple(nb::cast(new PyMesh{std::move(result.mesh)}, nb::rv_policy::take_ownership),
                        result.deviation);
}

}  // namespace

void bind_simplify(nb::module_& module) {
  static const std::string signature = std::string(
                                           "def simplify(mesh: object, *, max_deviation: float | None = "
                                           "None, triangles: int | None = None, ") +
                                       kProgress + "tuple[Mesh, BoundedLength]";
  module.def("simplify", &simplified_mesh, nb::arg("mesh").none(), nb::kw_only(),
             nb::arg("max_deviation") = nb::none(), nb::arg("triangles").none() = nb::none(),
             nb::arg("progress") = nb::none(), nb::sig(signature.c_str()),
             R"(Returns a mesh with fewer triangles, and certified bounds on how far it is from the given one.

mesh: any form of a mesh (see Mesh). Vertices at the same position are welded.
max_deviation: the symmetric Hausdorff distance of both is certified to be at most this, > 0, in units of the mesh;
with about as few triangles as the simplifier reaches.
triangles: at most so many are left. Exactly one of the two must be given.
progress: called as progress(step, fraction), on this thread; False cancels.

The vertices of the result are vertices of the mesh, with their texture coordinates; seams and borders stay. The
witness of the bounds is a point of the given mesh and one of the result. A RuntimeWarning says where the result is
the mesh itself, or has more triangles, as borders, seams and non-manifold edges permit no collapse. Raises Error for
an unusable mesh, or a limit that is not positive.

>>> coarse, deviation = sdm.simplify(sphere, triangles=100)
>>> len(coarse.faces) <= 100 and deviation.upper > 0
True
>>> coarse, deviation = sdm.simplify(sphere, max_deviation=0.3)
>>> deviation.upper <= 0.3 and len(coarse.faces) < len(sdm.Mesh(sphere).faces)
True)");
}

}  // namespace sdm::python
