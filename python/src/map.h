// A map, with what it was computed from.
#pragma once

#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <sdm/error.h>
#include <sdm/measure.h>
#include <sdm/sdm.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "objects.h"

namespace sdm::python {

struct PyMap {
  nb::object surface_object, sites_object;
  const PySurface* on = nullptr;
  const PySites* to = nullptr;
  // When the map was computed:
  std::uint64_t surface_shape = 0, surface_edits = 0, sites_shape = 0;
  MapOptions options;
  std::string engine;  ///< its name
  /// What each face excludes in a map of a surface to itself; otherwise null.
  std::shared_ptr<const Exclusion> exclusion;
  std::optional<std::pair<ThicknessMethod, double>> thickness;  ///< the method and the angle of such a map
  std::optional<AlongOptions> along;                            ///< of a map along lines
  DistanceMap map;
  double ms = 0;  ///< that it took

  [[nodiscard]] std::size_t texels() const { return map.texels(); }
  [[nodiscard]] std::size_t rows() const { return map.rows(); }

  /// Locks the surface, and throws if it has another shape than that of the map.
  [[nodiscard]] auto use_surface() const {
    auto lock = on->access.use();
    if (on->shape != surface_shape)
      throw Error(
          "the surface has been refitted or edited since the map was computed; compute the map again");
    return lock;
  }
  /// Locks the surface, and throws if its texels have other owners than those of the map.
  [[nodiscard]] auto use_texels() const {
    auto lock = on->access.use();
    if (on->edits != surface_edits)
      throw Error("the surface has been edited since the map was computed; compute the map again");
    return lock;
  }
  [[nodiscard]] auto use_sites() const {
    auto lock = to->access.use();
    if (to->shape != sites_shape)
      throw Error("the sites have been refitted or edited since the map was computed; compute the map again");
    return lock;
  }
  /// Whether the map is of a surface alone.
  [[nodiscard]] bool of_itself() const { return exclusion || thickness; }
  /// Throws for a map of a surface to itself, whose texels say nothing about the points between them.
  void require_other_mesh() const {
    if (along)
      throw Error(
          "distances along lines jump between faces, so that texels do not bound them; check() judges the "
          "texels");
    if (thickness)
      throw Error(
          "the thickness of a part jumps between faces, so that texels do not bound it; check() judges the "
          "texels");
    if (exclusion)
      throw Error(
          "the distances of a surface to itself jump between faces, so that texels do not bound them; "
          "SelfProximityQuery.separation() is exact");
  }
  /// Also throws for distances to other points than the closest one, which bound nothing between texels.
  void require_bounds() const {
    require_other_mesh();
    if (!is_lipschitz(map.measured.kind))
      throw Error("the map is the " + map.measured.text +
                  ", which may jump, so that texels do not bound it; check() judges the texels");
  }
  /// The accuracy of a distance, for the present shapes. Self maps are exact but for rounding to float.
  [[nodiscard]] double accuracy() const {
    if (thickness) return thickness_accuracy(on->surface.mesh());
    const EngineInfo& info = options.engine ? engine_info(*options.engine) : engines().front();
    return engine_accuracy(info, on->surface.mesh(), to->sites.mesh());
  }
  /// How far both meshes may be from the surfaces that are meant; of a thickness, both ends.
  [[nodiscard]] double guard() const { return on->deviation + (thickness ? on->deviation : to->deviation); }
  /// What the map was measured by, to measure again.
  [[nodiscard]] Measure measure(const Progress& progress) const;
  /// The distance at each vertex of the surface.
  [[nodiscard]] std::vector<float> vertex_distances(const Progress& progress) const;
};

/// The accepted distances: a number, or the least and the most. Throws sdm::Error for others, and for a
/// tolerance that needs signs if distances have none.
[[nodiscard]] Tolerance tolerance_of(nb::handle value, SignMethod sign);
/// Throws sdm::Error for a tolerance that needs signs if distances have none.
void require_sign(const Tolerance& tolerance, SignMethod sign);
/// Throws sdm::Error unless it is a finite number of at least 0.
void require_uncertainty(double uncertainty);

/// Rows of values to transfer.
using TransferRows = nb::ndarray<const float, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
/// The array of rows of the domain 'vertex', 'face' or 'corner'. Throws sdm::Error for another one.
[[nodiscard]] AttributeArray attribute_of(const TransferRows& rows, const char* domain);

void bind_channels(nb::module_& module);
void bind_computation(nb::module_& module);
void bind_map_numbers(nb::module_& module, nb::class_<PyMap>& map);
void bind_map_files(nb::module_& module, nb::class_<PyMap>& map);
void bind_map_transfer(nb::class_<PyMap>& map);

}  // namespace sdm::python
