/// Deforming meshes in files: one connectivity, positions frame by frame. All functions throw sdm::Error that
/// names the file, the frame and the fault.
#pragma once

#include <sdm/api.h>
#include <sdm/mesh.h>

#include <filesystem>
#include <memory>
#include <span>
#include <string>

namespace sdm {

struct SequenceOptions {
  /// Of glTF animations: frames a second, from the first key to the last; 0: one frame at every key.
  double rate = 0;
};

/// Reads a sequence in one of these forms:
///   frames/                      mesh files whose names end in a number and are else the same
///   walk_%04d.ply, walk_*.ply    the same by a pattern; * stands for digits only
///   walk.obj+motion.npy          positions of shape (T, V, 3), float32 or float64, of the V vertices that
///   the
///                                mesh file lists, used or not; where there is no such NPY file, the one of
///                                that name beside the mesh
///   walk.glb                     glTF with morph targets: the first animation that has weights
///   part.stl                     any other mesh file: one frame, a body at rest
/// Files are taken in the order of their numbers; numbers may start anywhere and go up in equal steps (the
/// greatest that meets every file). A number that is left out is a frame that cannot be read.
///
/// Polygons are triangulated, vertices welded and unused ones dropped as in read_mesh, all as the first frame
/// (of NPY: the mesh file) has it. Holds one frame in memory at a time, of glTF all morph targets.
class SDM_API MeshSequence {
 public:
  /// Lists the frames and reads the first. Throws where there is none, or it is unusable (see validate).
  explicit MeshSequence(const std::string& input, const SequenceOptions& options = {});
  ~MeshSequence();
  MeshSequence(MeshSequence&&) noexcept;
  MeshSequence& operator=(MeshSequence&&) noexcept;

  /// The first frame. Its triangles are those of all frames.
  [[nodiscard]] const Mesh& mesh() const;
  [[nodiscard]] std::size_t frame_count() const;
  /// Of a frame in [0, frame_count()), for messages: "walk_0007.ply", "frame 7 of motion.npy", ...
  [[nodiscard]] std::string frame_name(std::size_t frame) const;

  /// Reads the positions of a frame, one for each vertex of mesh(); they are valid until the next call.
  /// Throws when the frame is out of range, missing or damaged, when it has other vertices or faces than the
  /// first, when a coordinate is not finite or beyond 1e37, and when vertices that are one in the first frame
  /// are apart; other frames can be read all the same. Any order will do. NPY and glTF allocate nothing.
  /// Cost: linear in the size of the frame's file; of NPY, of the frame.
  [[nodiscard]] std::span<const Vec3> positions(std::size_t frame);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Writes positions frame by frame to an NPY file of shape (T, V, 3), float32, that appears whole at commit()
/// or not at all. Together with a mesh file (see write_ply) it is what MeshSequence reads.
class SDM_API SequenceWriter {
 public:
  /// Throws when the file cannot be written.
  SequenceWriter(const std::filesystem::path& file, std::size_t vertices);
  ~SequenceWriter();
  SequenceWriter(SequenceWriter&&) noexcept;
  SequenceWriter& operator=(SequenceWriter&&) noexcept;

  /// Throws when the number of positions differs from `vertices`, for a coordinate that float32 does not
  /// hold, and for a full disk.
  void add(std::span<const Vec3> positions);
  /// Ends the file. Throws as add() does.
  void commit();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sdm
