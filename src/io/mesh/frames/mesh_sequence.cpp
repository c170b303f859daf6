#include <fmt/format.h>
#include <sdm/error.h>
#include <sdm/sequence.h>

#include <cmath>
#include <new>
#include <optional>
#include <utility>

#include "core/checksum.h"
#include "core/memory.h"
#include "geometry/vec.h"
#include "io/file/error_prefix.h"
#include "io/file/file_bytes.h"
#include "io/file/file_xxh3.h"
#include "io/mesh/frames/changing_mesh.h"
#include "io/mesh/frames/frame_source.h"
#include "io/mesh/read_polygons.h"
#include "mesh/validate.h"

namespace sdm::io {
namespace {

namespace fs = std::filesystem;

// The position of the + in mesh.obj+motion.npy, or npos.
std::size_t place_of_plus(const std::string& input) {
  return input.ends_with(".npy") || input.ends_with(".NPY") ? input.rfind('+') : std::string::npos;
}

// Relative paths are looked up in the working directory, then in the folder of the mesh.
fs::path npy_file(const fs::path& mesh, const fs::path& npy) {
  std::error_code ignored;
  return fs::exists(npy, ignored) ? npy : mesh.parent_path() / npy;
}

std::unique_ptr<FrameSource> open_file(const fs::path& file, std::optional<double> rate) {
  const FileBytes contents = read_bytes(file);
  if (contents.view().starts_with("\x93NUMPY"))
    throw Error(
        fmt::format("holds positions without triangles; add the mesh that they belong to, as in mesh.obj+{}",
                    file.filename().string()));
  if (is_gltf(contents.view(), file))
    if (auto frames = gltf_frames(contents.view(), file, rate)) return frames;
  return single_file(file);
}

// Existing files and folders take precedence over patterns, whatever characters their names contain.
std::unique_ptr<FrameSource> open_source(const std::string& input, std::optional<double> rate) {
  std::error_code ignored;
  if (fs::is_directory(input, ignored)) return numbered_files_in(input);
  if (fs::exists(input, ignored)) return open_file(input, rate);
  if (const std::size_t plus = place_of_plus(input); plus != std::string::npos)
    return npy_frames(input.substr(0, plus), npy_file(input.substr(0, plus), input.substr(plus + 1)));
  if (fs::path(input).filename().string().find_first_of("%*") != std::string::npos)
    return numbered_files_like(input);
  return open_file(input, rate);
}

}  // namespace
}  // namespace sdm::io

namespace sdm {

struct MeshSequence::Impl {
  std::string input;
  std::unique_ptr<io::FrameSource> source;
  Mesh mesh;                              // the first frame
  std::vector<std::uint32_t> renumbered;  // the vertex of mesh for each vertex in the files, or kNone
  double weld_tolerance = 0;              // how far apart welded vertices may move
  std::vector<Vec3> file_positions, positions;
  std::optional<io::ChangingMesh> changing;  // instead of the above, if the topology may change

  void open(const SequenceOptions& options);
  void read(std::size_t frame);
};

void MeshSequence::Impl::open(const SequenceOptions& options) {
  source = io::open_source(input, options.rate);
  io::PolygonMesh polygons = source->take_polygons();
  if (options.allow_topology && source->has_polygons()) {
    io::with_error_prefix(source->polygons_name(), [&] { changing.emplace(std::move(polygons)); });
    return;
  }
  mesh = io::with_error_prefix(source->polygons_name(), [&] { return io::to_mesh(polygons, renumbered); });
  constexpr double kWeld = 1e-6;
  weld_tolerance = kWeld * diagonal(bounds(mesh));
  io::with_error_prefix(source->count() > 1 ? source->name(0) : "", [&] {
    read(0);
    mesh.positions = positions;
    validate(mesh);
  });
}

void MeshSequence::Impl::read(std::size_t frame) {
  source->read(frame, file_positions);
  positions.resize(mesh.positions.size());
  std::size_t found = 0;  // vertices are numbered in the order of the files
  for (std::size_t v = 0; v < file_positions.size(); ++v) {
    const std::uint32_t vertex = renumbered[v];
    if (vertex == kNone) continue;
    if (!finite(file_positions[v])) throw Error(fmt::format("vertex {} has a NaN or infinite coordinate", v));
    if (vertex == found)
      positions[found++] = file_positions[v];
    else if (norm(file_positions[v] - positions[vertex]) > weld_tolerance)
      throw Error(
          fmt::format("vertex {} has moved away from one that it coincides with in the first frame; such "
                      "vertices must stay "
                      "together",
                      v));
  }
  mesh::validate_positions(positions);
}

MeshSequence::MeshSequence(const std::string& input, const SequenceOptions& options) try
    : impl_(std::make_unique<Impl>()) {
  if (options.rate && !(*options.rate > 0 && std::isfinite(*options.rate)))
    throw Error("the rate of a sequence must be a number of frames per second greater than 0");
  impl_->input = input;
  io::with_error_prefix(input, [&] { impl_->open(options); });
} catch (const std::bad_alloc&) {
  throw out_of_memory("a sequence");
}
MeshSequence::~MeshSequence() = default;
MeshSequence::MeshSequence(MeshSequence&&) noexcept = default;
MeshSequence& MeshSequence::operator=(MeshSequence&&) noexcept = default;

const Mesh& MeshSequence::mesh() const {
  return impl_->changing ? impl_->changing->mesh() : impl_->mesh;
}

const TopologyChange& MeshSequence::change() const {
  static const TopologyChange kNoChange;
  return impl_->changing ? impl_->changing->change() : kNoChange;
}

std::size_t MeshSequence::frame_count() const {
  return impl_->source->count();
}

std::string MeshSequence::frame_name(std::size_t frame) const {
  return impl_->source->name(frame);
}

std::string MeshSequence::xxh3() const try {
  core::Checksum checksum;
  for (const std::filesystem::path& file : impl_->source->files()) io::add_file(checksum, file);
  return core::hex_text(checksum.value());
} catch (const std::bad_alloc&) {
  throw out_of_memory("the checksum of a sequence");
}

std::span<const Vec3> MeshSequence::positions(std::size_t frame) try {
  if (frame >= frame_count())
    throw Error(
        fmt::format("{}: there is no frame {}; the sequence has {}", impl_->input, frame, frame_count()));
  if (frame_count() == 1) return mesh().positions;
  io::with_error_prefix(fmt::format("{}: frame {} ({})", impl_->input, frame, frame_name(frame)), [&] {
    if (impl_->changing)
      impl_->changing->follow(impl_->source->polygons_of(frame));
    else
      impl_->read(frame);
  });
  return impl_->changing ? mesh().positions : impl_->positions;
} catch (const std::bad_alloc&) {
  throw out_of_memory("a frame of a sequence");
}

}  // namespace sdm
