// The objects of Python that hold those of the library.
#pragma once

#include <nanobind/nanobind.h>
#include <sdm/mesh_files.h>
#include <sdm/sdm.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "run.h"

namespace sdm::python {

namespace nb = nanobind;

using Positions = std::shared_ptr<const std::vector<Vec3>>;

/// What a simplified mesh has besides its geometry.
struct PyExtras {
  std::vector<MeshAttribute> attributes;
  std::vector<std::uint32_t> face_materials;
  std::vector<FaceNames> names;
  std::shared_ptr<const MeshFile> file;  ///< that has the materials and textures
};

/// A mesh, which does not change: arrays may refer to its memory.
struct PyMesh {
  Mesh mesh;
  double deviation = 0;                      ///< how far it may be from the surface that is meant: of CAD
  std::shared_ptr<const PyExtras> extras{};  ///< or null
};

/// Its extras as write_mesh() takes them.
[[nodiscard]] MeshExtras extras_to_write(const PyMesh& mesh);

/// Sites until they are edited. Results and arrays that refer to their faces and edges share this, and an
/// edit leaves them what they refer to.
struct SitesVersion {
  const Sites* present;          ///< of the PySites; null once it was edited
  std::optional<Sites> earlier;  ///< what it had before

  [[nodiscard]] const Sites& get() const { return earlier ? *earlier : *present; }
};

struct PySites {
  explicit PySites(PyMesh given)
      : deviation(given.deviation),
        positions(std::make_shared<std::vector<Vec3>>(given.mesh.positions)),
        first(positions),
        sites(std::move(given.mesh)),
        version(std::make_shared<SitesVersion>(SitesVersion{&sites, {}})) {}

  double deviation;     ///< as of PyMesh; a refit and an edit leave it
  Positions positions;  ///< of the present shape; results and arrays keep it
  Positions first;      ///< of the shape that the tree was built for; null once edited
  Sites sites;
  std::shared_ptr<SitesVersion> version;
  std::uint64_t shape = 0;  ///< the number of refits and edits
  Access access;

  /// Returns the new positions, to be kept with the GIL, which this does not need. Throws sdm::Error, and
  /// changes nothing, as Sites::edit does.
  [[nodiscard]] Positions edit(const MeshEdit& edit);
};

struct PySurface {
  PySurface(PyMesh given, const AtlasOptions& layout)
      : deviation(given.deviation),
        positions(std::make_shared<std::vector<Vec3>>(given.mesh.positions)),
        first(positions),
        options(layout),
        surface(std::move(given.mesh), layout) {
    options.progress = {};
  }

  double deviation;            ///< as of PySites
  Positions positions, first;  ///< of the present shape, and of the one that was laid out
  AtlasOptions options;
  Surface surface;
  std::uint64_t shape = 0, edits = 0;  ///< the numbers of refits and edits, and of edits
  Access access;
  // Copies for arrays, made by their first access, as an edit changes what the surface has.
  mutable std::shared_ptr<const std::vector<Triangle>> faces;
  mutable std::shared_ptr<const std::vector<std::uint32_t>> texel_faces;

  /// As PySites::edit().
  [[nodiscard]] Positions edit(const MeshEdit& edit);
};

/// Accepts whatever python/sdm/_meshes.py does. `faces`: None, or the second array of a mesh given as two.
[[nodiscard]] PyMesh given_mesh(nb::handle mesh, nb::handle faces);
/// The same without its deviation.
[[nodiscard]] Mesh mesh_of(nb::handle mesh, nb::handle faces);

/// (faces, 3, components) float32, or (faces, 3): a row for each corner of each face, NaN where there is
/// none.
[[nodiscard]] nb::object corner_values(const MeshAttribute& attribute);

// Options by their names in Python. All throw sdm::Error for an unknown one.
[[nodiscard]] std::shared_ptr<const Engine> engine_of(const char* name);
template <Worded Enum>
[[nodiscard]] Enum enum_of(const std::string& argument, std::string_view word) {
  if (const auto value = sdm::value_of<Enum>(word)) return *value;
  std::string all;
  for (const char* known : kWords<Enum>) all += (all.empty() ? "" : ", ") + std::string(known);
  throw Error(argument + " must be one of " + all + ", not '" + std::string(word) + "'");
}

/// Moves a mesh by an affine map.
void move(PyMesh& mesh, const Transform& map);

/// Adds the method edit().
void bind_edit(nb::class_<PySites>& sites);
void bind_edit(nb::class_<PySurface>& surface);

/// A view of positions that keeps them: it does not change with the object.
[[nodiscard]] nb::object positions_view(const Positions& positions);
[[nodiscard]] nb::object faces_view(const Mesh& mesh, nb::handle owner);

/// Adds pickling to the types above and to those of proximity.h and map.h, after all are bound.
void bind_pickle();
/// The same for results that are values of the library.
void bind_result_states();

void bind_baking(nb::module_& module);
void bind_batches(nb::module_& module);
void bind_errors(nb::module_& module);
void bind_meshes(nb::module_& module);
void bind_metrics(nb::module_& module);
void bind_sites(nb::module_& module);
void bind_surface(nb::module_& module);
void bind_groups(nb::module_& module);
void bind_map(nb::module_& module);
void bind_matches(nb::module_& module);
void bind_parts(nb::module_& module);
void bind_proximity(nb::module_& module);
void bind_bodies(nb::module_& module);
void bind_alignments(nb::module_& module);
void bind_poses(nb::module_& module);
void bind_simplify(nb::module_& module);
void bind_surfaces(nb::module_& module);
void bind_time_of_contact(nb::module_& module);
void bind_volume(nb::module_& module);
void bind_points(nb::module_& module);
void bind_scenes(nb::module_& module);
void bind_result_tables(nb::module_& module);

}  // namespace sdm::python
