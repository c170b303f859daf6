// Fewer triangles, with a certified deviation.
#include <nanobind/stl/optional.h>
#include <sdm/error.h>
#include <sdm/simplify.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "objects.h"
#include "run.h"
#include "signatures.h"

namespace sdm::python {
namespace {

/// What one level has at most: a deviation, or triangles.
struct Limit {
  std::optional<double> deviation;
  std::size_t triangles = 1;

  Limit(std::optional<double> max_deviation, nb::handle count) : deviation(max_deviation) {
    if (max_deviation.has_value() != count.is_none())
      throw Error("simplify() takes either max_deviation or triangles");
    if (!count.is_none()) triangles = static_cast<std::size_t>(integer_of(count, "triangles", 1));
  }
  /// Makes a level, 0 for the finest one: each has twice the deviation, or half of the triangles.
  [[nodiscard]] Simplified apply(Simplifier& simplifier, std::size_t level,
                                 const SimplifyOptions& options) const {
    const double factor = std::ldexp(1, static_cast<int>(level));
    if (deviation) return simplifier.to_deviation(factor * *deviation, options);
    const double count = std::max(1.0, static_cast<double>(triangles) / factor);
    return simplifier.to_triangles(static_cast<std::size_t>(count), options);
  }
  void warn(std::size_t level) const {
    const std::string same = level == 0 ? "the mesh itself" : "that of the level before";
    const std::string text =
        (level == 0 ? "" : "level " + std::to_string(level) + ": ") +
        (deviation ? "no collapse of edges keeps the deviation: the result is " + same
                   : "more triangles are left than asked for: no further collapse is possible");
    if (PyErr_WarnEx(PyExc_RuntimeWarning, text.c_str(), 1) < 0) throw nb::python_error();
  }
};

/// `lods` levels after the finest one. Each goes on from the one before.
nb::list simplified_levels(nb::handle mesh, const Limit& limit, std::size_t lods, nb::handle progress) {
  const PyMesh given = given_mesh(mesh, nb::none());
  std::vector<Simplified> levels;
  levels.reserve(lods + 1);
  run(progress, [&](const Progress& report) {
    Simplifier simplifier(given.mesh);
    for (std::size_t level = 0; level <= lods; ++level)
      levels.push_back(limit.apply(simplifier, level,
                                   {.from = levels.empty() ? nullptr : &levels.back(), .progress = report}));
  });
  nb::list result;
  for (std::size_t level = 0; level < levels.size(); ++level) {
    if (levels[level].stopped) limit.warn(level);
    const double deviation = given.deviation > 0 ? given.deviation + levels[level].deviation.upper : 0;
    result.append(nb::make_tuple(
        nb::cast(new PyMesh{std::move(levels[level].mesh), deviation}, nb::rv_policy::take_ownership),
        levels[level].deviation));
  }
  return result;
}

std::string signature_of(const char* lods, const char* result) {
  return std::string(
             "def simplify(mesh: object, *, max_deviation: float | None = None, triangles: int | None = "
             "None, ") +
         lods + kProgress + result;
}

constexpr const char* kSimplify =
    R"(Returns a mesh with fewer triangles, and certified bounds on how far it is from the given one.

mesh: any form of a mesh (see Mesh). Vertices at the same position are welded.
max_deviation: the symmetric Hausdorff distance of both is certified to be at most this, > 0, in units of the mesh;
with about as few triangles as the simplifier reaches.
triangles: at most so many are left. Exactly one of the two must be given.
lods: so many levels of detail after the first one, each with twice the deviation or half of the triangles, made from the
one before: a list of lods + 1 results, each certified against the given mesh.
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
True
>>> [len(m.faces) <= 200 // 2**k for k, (m, _) in enumerate(sdm.simplify(sphere, triangles=200, lods=2))]
[True, True, True])";

}  // namespace

void bind_simplify(nb::module_& module) {
  static const std::string one = signature_of("", "tuple[Mesh, BoundedLength]"),
                           several = signature_of("lods: int, ", "list[tuple[Mesh, BoundedLength]]");
  module.def(
      "simplify",
      [](nb::handle mesh, std::optional<double> max_deviation, nb::handle triangles, nb::handle progress) {
        const nb::list levels = simplified_levels(mesh, {max_deviation, triangles}, 0, progress);
        return nb::object(levels[0]);
      },
      nb::arg("mesh").none(), nb::kw_only(), nb::arg("max_deviation") = nb::none(),
      nb::arg("triangles").none() = nb::none(), nb::arg("progress") = nb::none(), nb::sig(one.c_str()),
      kSimplify);
  module.def(
      "simplify",
      [](nb::handle mesh, std::optional<double> max_deviation, nb::handle triangles, nb::handle lods,
         nb::handle progress) {
        constexpr std::int64_t kMost = 32;
        const std::int64_t count = integer_of(lods, "lods", 0);
        if (count > kMost) throw Error("lods must be at most 32");
        return simplified_levels(mesh, {max_deviation, triangles}, static_cast<std::size_t>(count), progress);
      },
      nb::arg("mesh").none(), nb::kw_only(), nb::arg("max_deviation") = nb::none(),
      nb::arg("triangles").none() = nb::none(), nb::arg("lods"), nb::arg("progress") = nb::none(),
      nb::sig(several.c_str()));
}

}  // namespace sdm::python
