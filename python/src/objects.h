// The objects of Python that hold those of the library.
#pragma once

#include <nanobind/nanobind.h>
#include <sdm/sdm.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "run.h"

namespace sdm::python {

namespace nb = nanobind;

using Positions = std::shared_ptr<const std::vector<Vec3>>;

/// A mesh, which does not change: arrays may refer to its memory.
struct PyMesh {
  Mesh mesh;
};

struct PySites {
  explicit PySites(Mesh mesh)
      : positions(std::make_shared<std::vector<Vec3>>(mesh.positions)), sites(std::move(mesh)) {}

  Positions positions;  ///< of the present shape; results and arrays keep it
  Sites sites;
  std::uint64_t shape = 0;  ///< the number of refits
  Access access;
};

struct PySurface {
  PySurface(Mesh mesh, const AtlasOptions& options)
      : positions(std::make_shared<std::vector<Vec3>>(mesh.positions)), surface(std::move(mesh), options) {}

  Positions positions;
  Surface surface;
  std::uint64_t shape = 0;
  Access access;
};

/// Accepts whatever python/sdm/_meshes.py does. `faces`: None, or the second array of a mesh given as two.
[[nodiscard]] Mesh mesh_of(nb::handle mesh, nb::handle faces);

// Options by their names in Python. All throw sdm::Error for an unknown one.
[[nodiscard]] std::shared_ptr<const Engine> engine_of(const char* name);
[[nodiscard]] SignMethod sign_of(const char* name);
[[nodiscard]] const char* name_of(SignMethod method);
[[nodiscard]] AtlasKind atlas_of(const char* name);
[[nodiscard]] const char* name_of(AtlasKind kind);

/// A view of positions that keeps them: it does not change with the object.
[[nodiscard]] nb::object positions_view(const Positions& positions);
[[nodiscard]] nb::object faces_view(const Mesh& mesh, nb::handle owner);

void bind_errors(nb::module_& module);
void bind_meshes(nb::module_& module);
void bind_sites(nb::module_& module);
void bind_surface(nb::module_& module);
void bind_map(nb::module_& module);
void bind_parts(nb::module_& module);
void bind_proximity(nb::module_& module);
void bind_bodies(nb::module_& module);
void bind_surfaces(nb::module_& module);

}  // namespace sdm::python
