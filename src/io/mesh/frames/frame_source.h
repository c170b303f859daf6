// Sources of the frames of a sequence, one implementation for each kind of input.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/mesh/read_polygons.h"

namespace sdm::io {

/// All functions throw sdm::Error; the message does not name the frame.
class FrameSource {
 public:
  explicit FrameSource(const TessellationOptions& tessellation = {})
      : options_{.tessellation = tessellation} {}
  virtual ~FrameSource() = default;

  /// Returns the polygons, which all frames share, with the positions of the first frame: vertices that
  /// coincide in it are welded. Called once.
  [[nodiscard]] virtual PolygonMesh take_polygons() = 0;
  /// Returns the name of the file that contains the polygons; empty if it is the input itself.
  [[nodiscard]] virtual std::string polygons_name() const { return {}; }
  [[nodiscard]] virtual std::size_t count() const = 0;
  [[nodiscard]] virtual std::string name(std::size_t frame) const = 0;
  /// Returns the files of all frames, in their order; without those that are missing.
  [[nodiscard]] virtual std::vector<std::filesystem::path> files() const = 0;
  /// Reads the positions of all vertices in the file. Only their number is checked.
  virtual void read(std::size_t frame, std::vector<Vec3>& positions) = 0;
  /// Whether frames have polygons of their own, which may differ from those of the first.
  [[nodiscard]] virtual bool has_polygons() const { return false; }
  /// Reads the polygons of a frame. Only if has_polygons().
  [[nodiscard]] virtual PolygonMesh polygons_of(std::size_t) { return {}; }
  /// The tessellation of the CAD file that was read last; nothing for other files.
  [[nodiscard]] const std::optional<Tessellation>& tessellation() const { return tessellation_; }

 protected:
  /// Reads a mesh file.
  [[nodiscard]] PolygonMesh read_file(const std::filesystem::path& file);

 private:
  PolygonOptions options_;
  std::optional<Tessellation> tessellation_;
};

/// Mesh files in a folder, mesh files whose names match a pattern, or one mesh file.
[[nodiscard]] std::unique_ptr<FrameSource> numbered_files_in(const std::filesystem::path& folder,
                                                             const TessellationOptions& tessellation);
[[nodiscard]] std::unique_ptr<FrameSource> numbered_files_like(const std::filesystem::path& pattern,
                                                               const TessellationOptions& tessellation);
[[nodiscard]] std::unique_ptr<FrameSource> single_file(const std::filesystem::path& file,
                                                       const TessellationOptions& tessellation);

/// The vertices of a mesh file, moved to the positions in an NPY file.
[[nodiscard]] std::unique_ptr<FrameSource> npy_frames(const std::filesystem::path& mesh,
                                                      const std::filesystem::path& npy,
                                                      const TessellationOptions& tessellation);

/// The first animation of a glTF file that changes nodes or weights of morph targets; null if the file has no
/// animation.
[[nodiscard]] std::unique_ptr<FrameSource> gltf_frames(std::string_view bytes,
                                                       const std::filesystem::path& file,
                                                       std::optional<double> rate);

}  // namespace sdm::io
