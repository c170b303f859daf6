// O1 with its textures: the object that bake() returns.
#pragma once

#include <nanobind/nanobind.h>
#include <sdm/bake.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace sdm::python {

namespace nb = nanobind;

/// A channel of O2's geometry: values, NaN where there are none, or whole numbers, or kNone.
struct BakedGeometry {
  GeometryChannel channel = GeometryChannel::normal;
  std::vector<float> values{};           ///< components_of() for each texel, unless is_number()
  std::vector<std::uint32_t> numbers{};  ///< one for each texel, if is_number()
};

/// What a model with a normal map is drawn with.
struct DrawnFrames {
  MeshAttribute normals, tangents;

  explicit DrawnFrames(const Surface& surface)
      : normals(smooth_normals(surface.mesh(), kDrawnCrease)), tangents(sdm::tangents(surface, normals)) {}
};

struct PyBaked {
  AtlasOptions atlas;      ///< of the surface
  Surface surface;         ///< its texels are the samples
  std::uint32_t side = 1;  ///< of a texel, in samples
  // One entry a texel:
  std::vector<MatchKind> kinds;
  std::vector<float> coverage;  ///< the share of its samples that have a point
  std::vector<BakedChannel> channels;
  std::vector<BakedGeometry> geometry;
  std::optional<DrawnFrames> frames;  ///< if the channel `normal` is baked
  Material material;
  std::vector<std::string> material_names;  ///< of O2
  std::vector<std::string> notes;

  /// Texels per row and per column.
  [[nodiscard]] std::uint32_t columns() const { return surface.resolution() / side; }
  [[nodiscard]] std::uint32_t rows() const { return surface.rows() / side; }

  /// Null if the channel is not baked.
  [[nodiscard]] const BakedChannel* find_look(const std::string& name) const;
  [[nodiscard]] const BakedGeometry* find_geometry(const std::string& name) const;
  /// A channel of textures, of directions or of shares, as textures have it, with values in all texels.
  /// Throws sdm::Error for a channel that is not baked, and for one of lengths, points or numbers.
  [[nodiscard]] Image image(const std::string& name) const;
  [[nodiscard]] std::vector<std::string> names() const;
};

void bind_baked(nb::module_& module);

}  // namespace sdm::python
