#include <fmt/format.h>
#include <sdm/error.h>
#include <sdm/mesh_files.h>

#include <new>
#include <optional>
#include <utility>

#include "core/checksum.h"
#include "core/memory.h"
#include "io/file/error_prefix.h"
#include "io/file/file_bytes.h"
#include "io/mesh/frames/changing_mesh.h"
#include "io/mesh/frames/frame_source.h"
#include "io/mesh/frames/welded_frames.h"
#include "io/mesh/read_polygons.h"

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

std::unique_ptr<FrameSource> open_file(const fs::path& file, const SequenceOptions& options) {
  const FileBytes contents = read_bytes(file);
  if (contents.view().starts_with("\x93NUMPY"))
    throw Error(
        fmt::format("holds positions without triangles; add the mesh that they belong to, as in mesh.obj+{}",
                    file.filename().string()));
  if (is_gltf(contents.view(), file))
    if (auto frames = gltf_frames(contents.view(), file, options.rate)) return frames;
  return single_file(file, options.tessellation);
}

// Existing files and folders take precedence over patterns, whatever characters their names contain.
std::unique_ptr<FrameSource> open_source(const std::string& input, const SequenceOptions& options) {
  std::error_code ignored;
  if (fs::is_directory(input, ignored)) return numbered_files_in(input, options.tessellation);
  if (fs::exists(input, ignored)) return open_file(input, options);
  if (const std::size_t plus = place_of_plus(input); plus != std::string::npos)
    return npy_frames(input.substr(0, plus), npy_file(input.substr(0, plus), input.substr(plus + 1)),
                      options.tessellation);
  if (fs::path(input).filename().string().find_first_of("%*") != std::string::npos)
    return numbered_files_like(input, options.tessellation);
  return open_file(input, options);
}

}  // namespace
}  // namespace sdm::io

namespace sdm {

struct MeshSequence::Impl {
  std::string input;
  std::unique_ptr<io::FrameSource> source;
  std::optional<io::WeldedFrames> welded;
  std::optional<io::ChangingMesh> changing;  // in its place, if the topology may change

  void open(const SequenceOptions& options);
};

void MeshSequence::Impl::open(const SequenceOptions& options) {
  source = io::open_source(input, options);
  io::PolygonMesh polygons = source->take_polygons();
  if (options.allow_topology && source->has_polygons()) {
    io::with_error_prefix(source->polygons_name(), [&] { changing.emplace(std::move(polygons)); });
    return;
  }
  io::with_error_prefix(source->polygons_name(), [&] { welded.emplace(*source, polygons); });
  io::with_error_prefix(source->count() > 1 ? source->name(0) : "", [&] { welded->begin(); });
}

MeshSequence::MeshSequence(const std::string& input, const SequenceOptions& options) try
    : impl_(std::make_unique<Impl>()) {
  check_options(options);
  impl_->input = input;
  io::with_error_prefix(input, [&] { impl_->open(options); });
} catch (const std::bad_alloc&) {
  throw out_of_memory("a sequence");
}
MeshSequence::~MeshSequence() = default;
MeshSequence::MeshSequence(MeshSequence&&) noexcept = default;
MeshSequence& MeshSequence::operator=(MeshSequence&&) noexcept = default;

const Mesh& MeshSequence::mesh() const {
  return impl_->changing ? impl_->changing->mesh() : impl_->welded->mesh();
}

const std::optional<Tessellation>& MeshSequence::tessellation() const {
  return impl_->source->tessellation();
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
  const std::string name = fmt::format("{}: frame {} ({})", impl_->input, frame, frame_name(frame));
  return io::with_error_prefix(name, [&]() -> std::span<const Vec3> {
    if (!impl_->changing) return impl_->welded->read(frame);
    impl_->changing->follow(impl_->source->polygons_of(frame));
    return mesh().positions;
  });
} catch (const std::bad_alloc&) {
  throw out_of_memory("a frame of a sequence");
}

}  // namespace sdm
