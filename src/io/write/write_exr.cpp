#include "core/memory.h"
#include "core/parallel.h"
#include "geometry/vec.h"
#include "io/write/atomic_file.h"
#include "io/write/compression/deflate.h"
#include "io/write/gutter.h"

#include <OpenEXR/openexr.h>
#include <fmt/format.h>
#include <sdm/closest_points.h>
#include <sdm/error.h>
#include <sdm/io.h>
#include <sdm/version.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <limits>
#include <new>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace sdm {

using namespace io;

namespace {

// A channel of the texels, which are structures whose members all have four bytes and which therefore have no
// padding. Files store channels in the order of their names.
struct Channel {
  const char* name;
  exr_pixel_type_t type;
  std::size_t offset;
};

using Attributes = std::vector<std::pair<std::string, std::string>>;

// Of a file compressed with ZIP.
constexpr std::uint32_t kRowsPerChunk = 16;

// A file that is written in chunks. Chunks are compressed by the caller, by all threads at once: OpenEXR's
// own compression with zlib takes twice as long.
class ExrFile {
 public:
  ExrFile(const std::filesystem::path& file, std::uint32_t columns, std::uint32_t rows,
          std::span<const Channel> channels, const Attributes& attributes)
      : file_(file), name_(file.string()) {
    exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
    settings.user_data = this;
    settings.error_handler_fn = take_message;
    settings.write_fn = write;
    check(exr_start_write(&context_, name_.c_str(), EXR_WRITE_FILE_DIRECTLY, &settings));
    try {
      write_header(static_cast<std::int32_t>(columns), static_cast<std::int32_t>(rows), channels, attributes);
    } catch (...) {
      exr_finish(&context_);
      throw;
    }
  }
  ~ExrFile() { exr_finish(&context_); }
  ExrFile(const ExrFile&) = delete;
  ExrFile& operator=(const ExrFile&) = delete;

  // Chunks must come in the order of their rows.
  void write_chunk(std::uint32_t first_row, std::span<const std::uint8_t> bytes) {
    check(exr_write_scanline_chunk(context_, 0, static_cast<int>(first_row), bytes.data(), bytes.size()));
  }
  void commit() {
    check(exr_finish(&context_));
    file_.commit();
  }

 private:
  void write_header(std::int32_t columns, std::int32_t rows, std::span<const Channel> channels,
                    const Attributes& attributes) {
    int part = 0;
    check(exr_add_part(context_, nullptr, EXR_STORAGE_SCANLINE, &part));
    check(exr_initialize_required_attr_simple(context_, part, columns, rows, EXR_COMPRESSION_ZIP));
    for (const Channel& channel : channels)
      check(exr_add_channel(context_, part, channel.name, channel.type, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1));
    const std::string comment = fmt::format("surface distance map, sdm {}", kVersion);
    check(exr_attr_set_string(context_, part, "comments", comment.c_str()));
    for (const auto& [name, value] : attributes)
      check(exr_attr_set_string(context_, part, name.c_str(), value.c_str()));
    check(exr_write_header(context_));
  }

  void check(exr_result_t result) const {
    if (result == EXR_ERR_SUCCESS) return;
    if (result == EXR_ERR_OUT_OF_MEMORY) throw std::bad_alloc();
    file_.check();
    throw Error("cannot write " + name_ + ": " +
                (message_.empty() ? exr_get_default_error_message(result) : message_));
  }

  // The library is C, through which no exception may pass.
  static void take_message(exr_const_context_t context, exr_result_t, const char* message) try {
    void* self = nullptr;
    if (exr_get_user_data(context, &self) == EXR_ERR_SUCCESS) static_cast<ExrFile*>(self)->message_ = message;
  } catch (...) {
  }
  static std::int64_t write(exr_const_context_t, void* self, const void* bytes, std::uint64_t count,
                            std::uint64_t offset, exr_stream_error_func_ptr_t) try {
    std::ostream& stream = static_cast<ExrFile*>(self)->file_.stream();
    if (static_cast<std::uint64_t>(stream.tellp()) != offset)
      stream.seekp(static_cast<std::streamoff>(offset));
    stream.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(count));
    return stream ? static_cast<std::int64_t>(count) : -1;
  } catch (...) {
    return -1;
  }

  AtomicFile file_;
  std::string name_, message_;
  exr_context_t context_ = nullptr;
};

// A chunk's bytes: for each row, the values of each channel.
template <class Texel>
std::vector<std::uint8_t> interleaved(std::span<const Texel> texels, std::uint32_t n,
                                      std::span<const Channel> channels) {
  std::vector<std::uint8_t> bytes(texels.size() * channels.size() * 4);
  std::uint8_t* to = bytes.data();
  for (std::size_t row = 0; row < texels.size(); row += n)
    for (const Channel& channel : channels)
      for (std::size_t x = 0; x < n; ++x, to += 4)
        std::memcpy(to, reinterpret_cast<const std::uint8_t*>(&texels[row + x]) + channel.offset, 4);
  return bytes;
}

// What OpenEXR's ZIP compresses: all even bytes of those above, then all odd ones, each as its difference
// from the byte before, plus 128.
template <class Texel>
std::vector<std::uint8_t> differences(std::span<const Texel> texels, std::uint32_t n,
                                      std::span<const Channel> channels) {
  const std::size_t half = texels.size() * channels.size() * 2;
  std::vector<std::uint8_t> split(2 * half), result(2 * half);
  std::uint8_t *even = split.data(), *odd = even + half;
  for (std::size_t row = 0; row < texels.size(); row += n)
    for (const Channel& channel : channels)
      for (std::size_t x = 0; x < n; ++x, even += 2, odd += 2) {
        std::array<std::uint8_t, 4> value;
        std::memcpy(value.data(), reinterpret_cast<const std::uint8_t*>(&texels[row + x]) + channel.offset,
                    4);
        even[0] = value[0], even[1] = value[2];
        odd[0] = value[1], odd[1] = value[3];
      }
  result[0] = split[0];
  for (std::size_t i = 1; i < split.size(); ++i)
    result[i] = static_cast<std::uint8_t>(split[i] - split[i - 1] + 128);
  return result;
}

// A chunk as it is stored: compressed, or as it is if it would not get smaller.
template <class Texel>
std::vector<std::uint8_t> packed(std::span<const Texel> texels, std::uint32_t n,
                                 std::span<const Channel> channels) {
  std::vector<std::uint8_t> bytes = zlib_compressed(differences(texels, n, channels));
  return bytes.empty() ? interleaved(texels, n, channels) : bytes;
}

// Writes the texels that texel(source, covered) returns. `source` is the owned texel whose values are used, a
// neighbour's in gutters; kNone if there is none.
template <class Texel, class Get>
void write_texels(const std::filesystem::path& file, const Surface& surface,
                  std::span<const Channel> channels, const Attributes& attributes, const Get& texel) {
  static_assert(std::endian::native == std::endian::little, "the order of bytes in the file");
  const std::uint32_t n = surface.resolution();
  const Gutter gutter(n, surface.texel_faces(), std::max(kGutter, surface.gutter()));
  ExrFile exr(file, n, surface.rows(), channels, attributes);
  const auto chunk = [&](std::uint32_t first_row) {
    const std::uint32_t rows = std::min(kRowsPerChunk, surface.rows() - first_row);
    std::vector<Texel> texels(std::size_t{n} * rows);
    for (std::uint32_t y = 0; y < rows; ++y)
      for (std::uint32_t x = 0; x < n; ++x) {
        const std::uint32_t source = gutter.source(x, first_row + y);
        texels[std::size_t{y} * n + x] = texel(source, source == (first_row + y) * n + x);
      }
    return packed<Texel>(texels, n, channels);
  };
  // Groups of chunks, so that memory does not grow with the number of rows.
  constexpr std::uint32_t kGroup = 16;
  const std::uint32_t chunks = (surface.rows() + kRowsPerChunk - 1) / kRowsPerChunk;
  std::array<std::vector<std::uint8_t>, kGroup> group;
  for (std::uint32_t first = 0; first < chunks; first += kGroup) {
    const std::uint32_t count = std::min(kGroup, chunks - first);
    parallel_for(count, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        group[i] = chunk((first + static_cast<std::uint32_t>(i)) * kRowsPerChunk);
    });
    for (std::uint32_t i = 0; i < count; ++i) exr.write_chunk((first + i) * kRowsPerChunk, group[i]);
  }
  exr.commit();
}

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

struct MapTexel {
  float distance = kNaN;
  Vec3f vector{kNaN, kNaN, kNaN};
  std::uint32_t site = kNone, site_type = kNone, face = kNone;
  float coverage = 0, boundary = 0;
};

// With the layers that are written on request.
struct FullTexel {
  MapTexel map;
  Vec3f position{kNaN, kNaN, kNaN}, normal{kNaN, kNaN, kNaN};
  std::uint32_t closest_face = kNone;
  float u = kNaN, v = kNaN;
};

struct TemporalTexel {
  float least = kNaN, mean = kNaN, largest = kNaN, coverage = 0;
};

}  // namespace

namespace {

// The channels of the layers, in the order of their names. Offsets are those in FullTexel, which begins with
// MapTexel.
std::vector<Channel> channels_of(const ExrLayers& layers, bool with_boundary) {
  std::vector<Channel> channels;
  const auto add = [&](bool wanted, const char* name, exr_pixel_type_t type, std::size_t offset) {
    if (wanted) channels.push_back({name, type, offset});
  };
  const auto add_vector = [&](bool wanted, std::array<const char*, 3> names, std::size_t offset) {
    for (std::size_t k = 0; k < 3; ++k) add(wanted, names[k], EXR_PIXEL_FLOAT, offset + k * sizeof(float));
  };
  add(with_boundary, "boundary.M", EXR_PIXEL_FLOAT, offsetof(MapTexel, boundary));
  add(layers.closest, "closest.U", EXR_PIXEL_FLOAT, offsetof(FullTexel, u));
  add(layers.closest, "closest.V", EXR_PIXEL_FLOAT, offsetof(FullTexel, v));
  add(layers.closest, "closest.face", EXR_PIXEL_UINT, offsetof(FullTexel, closest_face));
  add(true, "coverage.A", EXR_PIXEL_FLOAT, offsetof(MapTexel, coverage));
  add(layers.distance, "distance.D", EXR_PIXEL_FLOAT, offsetof(MapTexel, distance));
  add(layers.face, "face.id", EXR_PIXEL_UINT, offsetof(MapTexel, face));
  add_vector(layers.normal, {"normal.X", "normal.Y", "normal.Z"}, offsetof(FullTexel, normal));
  add_vector(layers.position, {"position.X", "position.Y", "position.Z"}, offsetof(FullTexel, position));
  add(layers.site, "site.id", EXR_PIXEL_UINT, offsetof(MapTexel, site));
  add(layers.site, "site.type", EXR_PIXEL_UINT, offsetof(MapTexel, site_type));
  add_vector(layers.vector, {"vector.X", "vector.Y", "vector.Z"}, offsetof(MapTexel, vector));
  return channels;
}

Vec3f to_float(const Vec3& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

Vec3f unit_normal(const Mesh& mesh, std::uint32_t face) {
  const auto& [a, b, c] = mesh.triangles[face];
  const Vec3 first = mesh.positions[b] - mesh.positions[a], second = mesh.positions[c] - mesh.positions[a];
  const Vec3 normal = cross(first, second);
  return to_float((1 / norm(normal)) * normal);
}

}  // namespace

void write_exr(const std::filesystem::path& file, const Surface& surface, const DistanceMap& map,
               std::span<const std::uint8_t> boundary) {
  write_exr(file, surface, map, ExrOptions{.boundary = boundary});
}

void write_exr(const std::filesystem::path& file, const Surface& surface, const DistanceMap& map,
               const ExrOptions& options) try {
  const std::span<const std::uint8_t> boundary = options.boundary;
  if (!boundary.empty() && boundary.size() != map.distance.size())
    throw Error("cannot write " + file.string() + ": the mask of the boundary belongs to another map");
  const ExrLayers& layers = options.layers;
  if (layers.closest && options.sites == nullptr)
    throw Error("cannot write " + file.string() + ": the layer `closest` needs the sites of the map");
  const std::vector<Channel> channels = channels_of(layers, !boundary.empty());
  const auto owners = surface.texel_faces();
  const auto map_texel = [&](std::uint32_t source, bool covered) -> MapTexel {
    if (source == kNone) return {};
    const SiteType type = map.site_type[source];
    return {map.distance[source],
            map.vector[source],
            map.site[source],
            type == SiteType::none ? kNone : static_cast<std::uint32_t>(type),
            owners[source],
            covered ? 1.f : 0.f,
            !boundary.empty() && boundary[source] ? 1.f : 0.f};
  };
  if (!layers.position && !layers.normal && !layers.closest) {
    write_texels<MapTexel>(file, surface, channels, options.attributes, map_texel);
    return;
  }
  write_texels<FullTexel>(
      file, surface, channels, options.attributes, [&](std::uint32_t source, bool covered) {
        FullTexel texel{.map = map_texel(source, covered)};
        if (source == kNone) return texel;
        const Vec3 point = surface.texel_point(source);
        texel.position = to_float(point);
        if (layers.normal) texel.normal = unit_normal(surface.mesh(), owners[source]);
        if (layers.closest && map.site_type[source] != SiteType::none) {
          const FacePoint closest =
              point_on_face(*options.sites, map.site_type[source], map.site[source], point);
          texel.closest_face = closest.face;
          texel.u = static_cast<float>(closest.u), texel.v = static_cast<float>(closest.v);
        }
        return texel;
      });
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing " + file.string());
}

void write_exr(const std::filesystem::path& file, const Surface& surface, const TemporalMaps& maps) try {
  if (maps.resolution() != surface.resolution() || maps.least().size() != surface.texel_faces().size())
    throw Error("cannot write " + file.string() + ": the maps belong to another surface");
  const Channel channels[] = {{"coverage.A", EXR_PIXEL_FLOAT, offsetof(TemporalTexel, coverage)},
                              {"max.D", EXR_PIXEL_FLOAT, offsetof(TemporalTexel, largest)},
                              {"mean.D", EXR_PIXEL_FLOAT, offsetof(TemporalTexel, mean)},
                              {"min.D", EXR_PIXEL_FLOAT, offsetof(TemporalTexel, least)}};
  const std::vector<float> mean = maps.mean();
  write_texels<TemporalTexel>(
      file, surface, channels, {}, [&](std::uint32_t source, bool covered) -> TemporalTexel {
        if (source == kNone) return {};
        return {maps.least()[source], mean[source], maps.largest()[source], covered ? 1.f : 0.f};
      });
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing " + file.string());
}

}  // namespace sdm
