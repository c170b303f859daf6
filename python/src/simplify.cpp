// Fewer triangles, with a certified deviation.
#include <sdm/simplify.h>

#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "objects.h"
#include "options.h"
#include "run.h"
#include "signatures.h"

namespace sdm::python {
namespace {

void warn(const LevelsOptions& options, std::size_t level) {
  const std::string same = level == 0 ? "the mesh itself" : "that of the level before";
  const std::string text =
      (level == 0 ? "" : "level " + std::to_string(level) + ": ") +
      (options.max_deviation
           ? "no mesh with fewer triangles was found that keeps the deviation: the result is " + same
           : "more triangles are left than asked for: no further collapse is possible");
  if (PyErr_WarnEx(PyExc_RuntimeWarning, text.c_str(), 1) < 0) throw nb::python_error();
}

/// The mesh of a file, and in `file` what else the file has; or any other form of a mesh.
PyMesh given_with_extras(nb::handle mesh, std::shared_ptr<MeshFile>& file) {
  if (!PyUnicode_Check(mesh.ptr()) && !nb::hasattr(mesh, "__fspath__")) return given_mesh(mesh, nb::none());
  const std::filesystem::path name = path_of(mesh);
  file = std::make_shared<MeshFile>();
  run(nb::none(), [&](const Progress&) { *file = read_mesh_file(name, {.attributes = true}); });
  std::erase_if(file->names, [](const FaceNames& names) {  // of CAD: each face would be a region
    return names.kind != "object" && names.kind != "group" && names.kind != "material";
  });
  return {std::move(file->mesh), file->tessellation ? file->tessellation->largest_deviation : 0};
}

std::shared_ptr<const PyExtras> carried(const std::shared_ptr<const MeshFile>& file, const Sites& sites,
                                        const Simplified& level, const Progress& progress) {
  auto extras = std::make_shared<PyExtras>();
  extras->file = file;
  extras->attributes = carried_attributes(sites, file->attributes, level.mesh, progress);
  extras->names = names_of_part(file->names, level.source_faces);
  if (!file->face_materials.empty())
    for (const std::uint32_t face : level.source_faces)
      extras->face_materials.push_back(file->face_materials[face]);
  return extras;
}

/// All levels. Each goes on from the one before.
nb::list simplified(nb::handle mesh, nb::handle progress, const nb::dict& given_options) {
  check_keywords("simplify", given_options);
  LevelsOptions options;
  set_options(given_options, options);
  std::shared_ptr<MeshFile> file;
  const PyMesh given = given_with_extras(mesh, file);
  std::vector<Simplified> levels;
  std::vector<std::shared_ptr<const PyExtras>> extras;
  run(progress, [&](const Progress& report) {
    options.progress = report;
    std::vector<std::uint32_t> regions;
    if (file) regions = face_regions(given.mesh.triangles.size(), file->face_materials, file->names);
    options.regions = regions;
    levels = simplify_levels(given.mesh, options).levels;
    extras.resize(levels.size());
    if (!file) return;
    const Sites sites(given.mesh);
    for (std::size_t i = 0; i < levels.size(); ++i) extras[i] = carried(file, sites, levels[i], report);
  });
  nb::list result;
  for (std::size_t level = 0; level < levels.size(); ++level) {
    if (levels[level].stopped) warn(options, level);
    const double deviation = given.deviation > 0 ? given.deviation + levels[level].deviation.upper : 0;
    result.append(nb::make_tuple(nb::cast(new PyMesh{std::move(levels[level].mesh), deviation, extras[level]},
                                          nb::rv_policy::take_ownership),
                                 levels[level].deviation));
  }
  return result;
}

std::string signature_of(const char* lods, const char* result) {
  return std::string("def simplify(mesh: object, *, ") + lods + option_signature("simplify", {"lods"}) +
         kProgress + result;
}

constexpr const char* kSimplify =
    R"(Returns a mesh with fewer triangles, and certified bounds on how far it is from the given one.

mesh: any form of a mesh (see Mesh). Vertices at the same position are welded.
)";
constexpr const char* kOfResult = R"(
Exactly one of max_deviation and triangles must be given. With lods, the result is a list of lods + 1 results, each certified
against the given mesh.
progress: called as progress(step, fraction), on this thread; False cancels.

The result of a file has its normals, colours, names and materials, which Mesh.attributes and Mesh.save() give; borders
between materials stay. With texture coordinates, vertices are vertices of the mesh, with theirs; seams stay. The
witness of the bounds is a point of the given mesh and one of the result. A RuntimeWarning says where the result is
the mesh itself, or has more triangles, as borders, seams, UVs and non-manifold edges permit no collapse. Raises Error for
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
                           several = signature_of("lods: int, ", "list[tuple[Mesh, BoundedLength]]"),
                           documentation = kSimplify + option_documentation("simplify") + kOfResult;
  module.def(
      "simplify",
      [](nb::handle mesh, nb::handle lods, nb::handle progress, nb::kwargs given) {
        given["lods"] = lods;
        return simplified(mesh, progress, given);
      },
      nb::arg("mesh").none(), nb::kw_only(), nb::arg("lods"), nb::arg("progress") = nb::none(),
      nb::arg("options"), nb::sig(several.c_str()), documentation.c_str());
  module.def(
      "simplify",
      [](nb::handle mesh, nb::handle progress, const nb::kwargs& given) {
        return nb::object(simplified(mesh, progress, given)[0]);
      },
      nb::arg("mesh").none(), nb::kw_only(), nb::arg("progress") = nb::none(), nb::arg("options"),
      nb::sig(one.c_str()));
}

}  // namespace sdm::python
