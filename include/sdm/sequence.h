/// Deforming meshes in files: fixed connectivity, positions for each frame. All functions throw an sdm::Error
/// that names the file, the frame and the fault.
///
/// Threads: an object is used by one thread at a time; different objects may be used concurrently.
#pragma once

#include <sdm/api.h>
#include <sdm/mesh.h>

#include <filesystem>
#include <memory>
#include <span>
#include <string>

namespace sdm {

struct SequenceOptions {
  /// For glTF animations: frames per second, from the first key to the last; 0: one frame per key.
  double rate = 0;
};

/// Reads a sequence in one of these forms:
///   frames/                      mesh files whose names differ only in a number at the end
///   walk_%04d.ply, walk_*.ply    the same, by a pattern; * matches digits only
///   walk.obj+motion.npy          positions of shape (T, V, 3), float32 or float64, for all V vertices
///                                listed in the mesh file, used or not; an NPY file that does not exist
///                                is looked up beside the mesh file
///   walk.glb                     glTF with morph targets: the first animation that has weights
///   part.stl                     any other mesh file: a single frame
/// Files are ordered by number. Numbers may start anywhere and increase in equal steps (the largest step that
/// reaches every file); a missing number is a frame that cannot be read.
///
/// Polygons are triangulated, vertices welded and unused ones dropped as in read_mesh, for all frames as in
/// the first one (NPY: as in the mesh file). Holds one frame in memory at a time; for glTF, all morph
/// targets.
class SDM_API MeshSequence {
 public:
  /// Lists the frames and reads the first. Throws if there is none, or if it is unusable (see validate).
  explicit MeshSequence(const std::string& input, const SequenceOptions& options = {});
  ~MeshSequence();
  MeshSequence(MeshSequence&&) noexcept;
  MeshSequence& operator=(MeshSequence&&) noexcept;

  /// The first frame. Its triangles are those of all frames.
  [[nodiscard]] const Mesh& mesh() const;
  [[nodiscard]] std::size_t frame_count() const;
  /// The name of a frame in [0, frame_count()), for messages: "walk_0007.ply", "frame 7 of motion.npy", ...
  [[nodiscard]] std::string frame_name(std::size_t frame) const;

  /// Reads the positions of a frame, one for each vertex of mesh(); they are valid until the next call.
  /// Frames may be read in any order. Throws if the frame is out of range, missing or damaged, if its
  /// vertices or faces differ from those of the first frame, if a coordinate is not finite or beyond 1e37,
  /// and if vertices that are welded in the first frame have different positions; other frames can still be
  /// read. NPY and glTF allocate nothing. Cost: linear in the size of the frame's file; for NPY, in that of
  /// the frame.
  [[nodiscard]] std::span<const Vec3> positions(std::size_t frame);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Writes positions frame by frame to an NPY file of shape (T, V, 3), float32. The complete file appears at
/// commit(); without it, no file appears. Together with a mesh file (see write_ply) it can be read by
/// MeshSequence.
class SDM_API SequenceWriter {
 public:
  /// Throws if the file cannot be written.
  SequenceWriter(const std::filesystem::path& file, std::size_t vertices);
  ~SequenceWriter();
  SequenceWriter(SequenceWriter&&) noexcept;
  SequenceWriter& operator=(SequenceWriter&&) noexcept;

  /// Adds a frame. Throws if the number of positions differs from `vertices`, for a coordinate out of the
  /// range of float32, and if the disk is full.
  void add(std::span<const Vec3> positions);
  /// Completes the file. Throws as add() does.
  void commit();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sdm
