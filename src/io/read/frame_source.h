// Where the frames of a sequence come from: one implementation a form of input.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "io/read/polygon_mesh.h"

namespace sdm::io {

/// All throw sdm::Error that names the fault, not the frame.
class FrameSource {
 public:
  virtual ~FrameSource() = default;

  /// The polygons of all frames over the vertices of the file; taken once, with positions that tell which of
  /// these are one vertex.
  [[nodiscard]] virtual PolygonMesh take_polygons() = 0;
  /// The file that they come from, where it is not the input itself.
  [[nodiscard]] virtual std::string polygons_name() const { return {}; }
  [[nodiscard]] virtual std::size_t count() const = 0;
  [[nodiscard]] virtual std::string name(std::size_t frame) const = 0;
  /// The positions of all vertices of the file, unchecked but for their number.
  virtual void read(std::size_t frame, std::vector<Vec3>& positions) = 0;
};

/// Mesh files that a pattern, a folder or a name stands for.
[[nodiscard]] std::unique_ptr<FrameSource> numbered_files_in(const std::filesystem::path& folder);
[[nodiscard]] std::unique_ptr<FrameSource> numbered_files_like(const std::filesystem::path& pattern);
[[nodiscard]] std::unique_ptr<FrameSource> single_file(const std::filesystem::path& file);

/// The positions of a mesh file's vertices in an NPY file.
[[nodiscard]] std::unique_ptr<FrameSource> npy_frames(const std::filesystem::path& mesh,
                                                      const std::filesystem::path& npy);

/// Morph targets that a glTF file animates; null where it has no animation.
[[nodiscard]] std::unique_ptr<FrameSource> gltf_frames(std::string_view bytes,
                                                       const std::filesystem::path& file, double rate);

}  // namespace sdm::io
