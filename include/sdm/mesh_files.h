/// Meshes in files: reading and writing them, and sequences of deforming ones, which are positions for each
/// frame and triangles that change only if this is asked for. Every function throws an sdm::Error that names
/// the file, the frame and the fault.
///
/// Threads: the functions may be called concurrently, unless two of them write the same file; an object is
/// used by one thread at a time.
#pragma once

#include <sdm/mesh.h>
#include <sdm/mesh_attributes.h>
#include <sdm/mesh_edit.h>
#include <sdm/options.h>
#include <sdm/types.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <vector>

namespace sdm {

/// Reads OBJ, PLY, STL, OFF, glTF/GLB, 3DS, or STEP and IGES if sdm was built with SDM_BUILD_CAD. The format
/// is detected from the content, then from the extension. Polygons are triangulated, all meshes of the file
/// are merged into one, and glTF's nodes, instances, default morph weights and skins are applied. Vertices
/// used by faces keep their order; bit-identical positions are welded. The result is valid in the sense of
/// validate(). It has texture coordinates if every corner of the file has; what else was left out is in
/// MeshFile::notes. STEP and IGES are tessellated as MeshFileOptions has it, in millimetres, see
/// MeshFile::tessellation; one such file is read at a time, and a deflection or an angle that is not positive
/// is an error, too.
[[nodiscard]] SDM_API Mesh read_mesh(const std::filesystem::path& file);

/// The vertices and polygons of a file as they are stored, before welding and triangulation. Those of the
/// nodes of glTF are transformed and concatenated; every corner of a triangle of STL is a vertex.
struct FileVertices {
  std::vector<Vec3> positions;
  std::vector<std::uint32_t> mesh_vertex;  ///< of each, the vertex of the mesh; kNone if no face uses it
  std::vector<std::uint32_t> corners;      ///< the vertex of each corner, polygon after polygon
  std::vector<std::uint32_t> ends;         ///< for each polygon, one past its last corner
};

/// A mesh, and what its file says about it.
struct MeshFile {
  Mesh mesh;                     ///< as of read_mesh()
  std::vector<FaceNames> names;  ///< one entry for each kind that the file has
  /// What was left out or may be wrong, a sentence each: texture coordinates that some corners lack, a count
  /// that is not that of the file, text without its end.
  std::vector<std::string> notes{};
  std::optional<FileVertices> vertices{};
  std::optional<Tessellation> tessellation{};  ///< of STEP and IGES
  std::string xxh3{};                          ///< as of file_xxh3()
  std::vector<MeshAttribute> attributes{};     ///< of glTF, OBJ and PLY
  std::vector<Material> materials{};           ///< of glTF, and of the MTL files of OBJ
  std::vector<TextureFile> textures{};         ///< that these refer to
  /// The number of each triangle's material, or kNone; empty if there are no materials.
  std::vector<std::uint32_t> face_materials{};
};

/// Options of read_mesh_file().
struct MeshFileOptions {
  bool vertices = false;  ///< keep the vertices of the file: up to six times the memory of the mesh for STL
  TessellationOptions tessellation{};  ///< of STEP and IGES; other files consist of polygons
  bool attributes = false;             ///< read MeshFile::attributes, materials and textures
};

/// Reads a mesh as read_mesh() does, with the names of its faces.
[[nodiscard]] SDM_API MeshFile read_mesh_file(const std::filesystem::path& file,
                                              const MeshFileOptions& options = {});

/// Returns XXH3 with 64 bits of the bytes of a file, as 16 hexadecimal digits: what `xxhsum -H3` prints.
/// Files that it refers to, such as the .bin of glTF, do not take part. Cost: linear, less than that of
/// reading.
[[nodiscard]] SDM_API std::string file_xxh3(const std::filesystem::path& file);

/// The names of the formats that read_mesh supports, separated by commas, for messages and help texts.
[[nodiscard]] SDM_API std::string mesh_format_names();

/// Reads a 4×4 matrix, row by row, with the last row 0 0 0 1: 16 numbers as text, separated by spaces, commas
/// or line ends, with comments after '#'; an NPY array of shape (4, 4), float32 or float64; or JSON with the
/// rows as "matrix", such as alignment.json, or the same in an object "alignment", as in report.json. Also
/// throws sdm::Error for numbers that are not finite, and for a singular matrix.
[[nodiscard]] SDM_API Transform read_matrix(const std::filesystem::path& file);

/// What write_mesh() writes besides positions and texture coordinates: of a MeshFile its arrays.
struct MeshExtras {
  std::span<const MeshAttribute> attributes{};
  std::span<const Material> materials{};
  std::span<const TextureFile> textures{};
  std::span<const std::uint32_t> face_materials{};  ///< empty: no face has a material
  std::span<const FaceNames> names{};
  /// The name of the MTL file of an OBJ file in the same folder that has the materials. Empty: it is written,
  /// beside the file.
  std::string library{};
};

/// Writes a mesh in the format that the extension names. Files keep:
///  - .ply: positions and texture coordinates of corners in double precision, which read_mesh returns
///    bit-identical; normals, and colours in 8 bits
///  - .obj: all digits; normals, colours, names of objects and groups; materials as NAME.mtl, with pictures
///    as NAME_0.png and so on: colours, opacity, metal and roughness, normal maps
///  - .stl: positions, in single precision
///  - .glb: positions, texture coordinates of all sets, normals and colours in single precision, names of
///    objects, materials with their pictures
/// Also throws sdm::Error for another extension, unless validate() accepts the mesh, and if the extras do not
/// belong to its faces.
SDM_API void write_mesh(const std::filesystem::path& file, const Mesh& mesh, const MeshExtras& extras = {});
/// Whether write_mesh() rounds positions to float. Throws sdm::Error as it does for another extension.
[[nodiscard]] SDM_API bool is_written_in_single_precision(const std::filesystem::path& file);

/// Options of a MeshSequence.
struct SequenceOptions {
  /// Frames per second of glTF animations, from the first key to the last, > 0; by default one frame per key.
  std::optional<double> rate{};
  /// Vertices and faces may be added and removed between numbered files; see MeshSequence::change.
  bool allow_topology = false;
  TessellationOptions tessellation{};  ///< of CAD
};

template <>
inline constexpr auto kOptions<SequenceOptions> = std::tuple{
    Option{.name = "rate",
           .member = &SequenceOptions::rate,
           .text = "glTF animations: frames per second; by default one frame per key.",
           .range = kPositive,
           .value = "FPS"},
    Option{.name = "allow_topology",
           .member = &SequenceOptions::allow_topology,
           .text = "Vertices and faces may be added and removed between the files of a sequence."}};

/// How a frame differs from the one that was read before.
struct TopologyChange {
  /// Leads from the mesh before to that of the frame, moved vertices included. Empty if the triangles are the
  /// same; the vertices may have moved then.
  MeshEdit edit{};
  /// Too little stays for an edit: the mesh of the frame is another one, with numbers of its own.
  bool replaced = false;

  /// Whether the triangles are those of the frame before.
  [[nodiscard]] bool none() const {
    return !replaced && edit.removed_faces.empty() && edit.reconnected_faces.empty() &&
           edit.added_vertices.empty() && edit.added_faces.empty();
  }
};

/// Reads a sequence in one of these forms:
///   frames/                      mesh files whose names differ only in a number at the end
///   walk_%04d.ply, walk_*.ply    the same, by a pattern; * matches digits only
///   walk.obj+motion.npy          positions of shape (T, V, 3), float32 or float64, for all V vertices
///                                listed in the mesh file, used or not; an NPY file that does not exist
///                                is looked up beside the mesh file
///   walk.glb                     glTF with an animation of nodes, skins or morph targets
///   part.stl                     any other mesh file: a single frame
/// Files are ordered by number. Numbers may start anywhere and increase in equal steps (the largest step that
/// reaches every file); a missing number is a frame that cannot be read.
///
/// Polygons are triangulated, vertices welded and unused ones dropped as in read_mesh, for all frames as in
/// the first one (NPY: as in the mesh file). Holds one frame in memory at a time; for glTF, what moves, with
/// its morph targets and joints.
class SDM_API MeshSequence {
 public:
  /// Lists the frames and reads the first. Throws if there is none, or if it is unusable (see validate).
  explicit MeshSequence(const std::string& input, const SequenceOptions& options = {});
  ~MeshSequence();
  MeshSequence(MeshSequence&&) noexcept;
  MeshSequence& operator=(MeshSequence&&) noexcept;

  /// The first frame, whose triangles are those of all frames. With SequenceOptions::allow_topology: the
  /// frame that was read last, initially the first one.
  [[nodiscard]] const Mesh& mesh() const;
  /// How the surfaces of the CAD file that was read last became triangles: that of a frame, or the one that
  /// all frames have their triangles from. Nothing for other files.
  [[nodiscard]] const std::optional<Tessellation>& tessellation() const;
  /// The number of frames.
  [[nodiscard]] std::size_t frame_count() const;
  /// The name of a frame in [0, frame_count()), for messages: "walk_0007.ply", "frame 7 of motion.npy", ...
  [[nodiscard]] std::string frame_name(std::size_t frame) const;
  /// The XXH3 checksum, of 64 bits in hexadecimal, of the bytes of all files of the sequence, one file after
  /// the other in the order of their numbers; of a mesh file with an NPY file, that of the mesh first. Of one
  /// file it is file_xxh3(). Reads all files again; throws if one cannot be read.
  [[nodiscard]] std::string xxh3() const;

  /// Reads the positions of a frame, one for each vertex of mesh(); they are valid until the next call.
  /// Frames may be read in any order. Throws if the frame is out of range, missing or damaged, if a
  /// coordinate is not finite or beyond 1e37, and, unless SequenceOptions::allow_topology is set, if its
  /// vertices or faces differ from those of the first frame or if vertices that are welded there have
  /// different positions; other frames can still be read. NPY and glTF allocate nothing. Cost: linear in the
  /// size of the frame's file; for NPY, in that of the frame.
  [[nodiscard]] std::span<const Vec3> positions(std::size_t frame);

  /// How mesh() has changed in the last successful call of positions(), with SequenceOptions::allow_topology.
  /// Vertices and faces that stay keep their numbers, as MeshEdit describes. What stays:
  ///  - A vertex is the one with the same number in the file before, so files must only add vertices at the
  ///    end of their lists. If a list has become shorter, or if no face of the file before shares a vertex
  ///    with another (STL), numbers mean nothing: then a vertex is the one that was at the same position.
  ///  - A face stays if the file before has one of the same vertices in the same order, wherever it is in the
  ///    list and with whichever vertex it begins. Polygons that stay are not triangulated again.
  ///  - Vertices at the same position are one, as in read_mesh, and stay one up to 1e-6 of the diagonal of
  ///    the mesh. If they part, faces are reconnected: to tear a mesh, let its faces refer to copies of
  ///    vertices that are at the same position in the frame in which they appear.
  ///  - If fewer than half of the faces stay, of this frame or the one before, the mesh is replaced.
  /// Texture coordinates of added faces are zero.
  [[nodiscard]] const TopologyChange& change() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Writes positions frame by frame to an NPY file of shape (T, V, 3), float32. The complete file appears at
/// commit(); without it, no file appears. Together with a mesh file it can be read by MeshSequence.
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
