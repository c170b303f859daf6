// What a mesh looks like, as python/sdm/_looks.py describes it.
#pragma once

#include <nanobind/nanobind.h>
#include <sdm/bake.h>
#include <sdm/mesh_files.h>

#include <vector>

namespace sdm::python {

namespace nb = nanobind;

/// What O2 looks like.
struct Look {
  MeshFile file;
  std::vector<Image> pictures;

  [[nodiscard]] MeshLook get() const {
    return {file.materials, file.face_materials, pictures, file.attributes};
  }
};

/// Adds a dictionary of _looks.py to a look, whose mesh is set. Throws sdm::Error where arrays do not fit it.
void add_look(const nb::dict& from, Look& look);

}  // namespace sdm::python
