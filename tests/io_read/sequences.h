// Sequence files, built in memory.
#pragma once

#include <sdm/mesh.h>

#include <bit>
#include <string>
#include <vector>

namespace sdm::test {

/// The frames of a moving mesh.
using Frames = std::vector<std::vector<Vec3>>;

/// `count` frames of the mesh, each stretched and moved differently; coordinates are exact in single
/// precision where the mesh's are multiples of 1/8.
[[nodiscard]] Frames frames_of(const Mesh& mesh, std::size_t count);

/// The layout of the array in an NPY file.
struct NpyLayout {
  std::size_t number_bytes = 4;
  bool fortran_order = false;
  std::endian order = std::endian::little;
};
[[nodiscard]] std::string npy(const Frames& frames, const NpyLayout& layout = {});
/// An NPY header of version 1 with this dictionary.
[[nodiscard]] std::string npy_header(const std::string& dictionary);

/// A channel of an animation: `values` has the weights of all targets key by key; for CUBICSPLINE three rows
/// per key.
struct WeightChannel {
  std::string interpolation = "LINEAR";
  std::vector<float> times, values;
};
/// A node with `transform` (JSON members) that shows a mesh with morph targets: the displacements of each
/// vertex. `sparse`: they are stored as differences from nothing.
[[nodiscard]] std::string morph_gltf(const Mesh& mesh, const Frames& targets, const WeightChannel& channel,
                                     const std::string& transform = "", bool sparse = false);

}  // namespace sdm::test
