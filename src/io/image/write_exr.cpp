#include "atlas/gutter.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "io/file/atomic_file.h"
#include "io/file/deflate.h"

#include <OpenEXR/openexr.h>
#include <fmt/format.h>
#include <sdm/channels.h>
#include <sdm/error.h>
#include <sdm/io.h>
#include <sdm/version.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <limits>
#include <map>
#include <new>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace sdm {

using namespace io;

namespace {

// A channel of the file. Files store them in the order of their names.
struct Plane {
  std::string name;
  exr_pixel_type_t type;
};

using Attributes = std::vector<std::pair<std::string, std::string>>;

// OpenEXR's number of rows in a chunk of a file compressed with ZIP.
constexpr std::uint32_t kRowsPerChunk = 16;

// A file that is written in chunks. Chunks are compressed by the caller, by all threads at once: OpenEXR's
// own compression with zlib takes twice as long.
class ExrFile {
 public:
  ExrFile(const std::filesystem::path& file, std::uint32_t columns, std::uint32_t rows,
          std::span<const Plane> planes, const Attributes& attributes)
      : file_(file), name_(file.string()) {
    exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
    settings.user_data = this;
    settings.error_handler_fn = take_message;
    settings.write_fn = write;
    check(exr_start_write(&context_, name_.c_str(), EXR_WRITE_FILE_DIRECTLY, &settings));
    try {
      write_header(static_cast<std::int32_t>(columns), static_cast<std::int32_t>(rows), planes, attributes);
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
  void write_header(std::int32_t columns, std::int32_t rows, std::span<const Plane> planes,
                    const Attributes& attributes) {
    int part = 0;
    check(exr_add_part(context_, nullptr, EXR_STORAGE_SCANLINE, &part));
    check(exr_initialize_required_attr_simple(context_, part, columns, rows, EXR_COMPRESSION_ZIP));
    for (const Plane& plane : planes)
      check(exr_add_channel(context_, part, plane.name.c_str(), plane.type, EXR_PERCEPTUALLY_LOGARITHMIC, 1,
                            1));
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

// What OpenEXR's ZIP compresses: all even bytes of the values, then all odd ones, each as its difference from
// the byte before, plus 128.
std::vector<std::uint8_t> differences(std::span<const std::uint32_t> values) {
  const std::size_t half = 2 * values.size();
  std::vector<std::uint8_t> split(2 * half), result(2 * half);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto value = std::bit_cast<std::array<std::uint8_t, 4>>(values[i]);
    split[2 * i] = value[0], split[2 * i + 1] = value[2];
    split[half + 2 * i] = value[1], split[half + 2 * i + 1] = value[3];
  }
  result[0] = split[0];
  for (std::size_t i = 1; i < split.size(); ++i)
    result[i] = static_cast<std::uint8_t>(split[i] - split[i - 1] + 128);
  return result;
}

// A chunk as it is stored: compressed, or as it is if it would not get smaller.
std::vector<std::uint8_t> packed(std::span<const std::uint32_t> values) {
  std::vector<std::uint8_t> bytes = zlib_compressed(differences(values));
  if (bytes.empty()) {
    bytes.resize(values.size_bytes());
    std::memcpy(bytes.data(), values.data(), bytes.size());
  }
  return bytes;
}

// Writes the values that read(sources, first, row) puts into each row of texels, one plane after another.
// `sources`: the owned texels whose values the texels from `first` on have, a neighbour's in gutters; kNone
// where there is none.
template <class Read>
void write_planes(const std::filesystem::path& file, const Surface& surface, std::span<const Plane> planes,
                  const Attributes& attributes, const Read& read) {
  static_assert(std::endian::native == std::endian::little, "the order of bytes in the file");
  const std::uint32_t n = surface.resolution();
  const atlas::Gutter gutter(n, surface.texel_faces(), std::max(atlas::kGutter, surface.gutter()));
  ExrFile exr(file, n, surface.rows(), planes, attributes);
  const auto chunk = [&](std::uint32_t first_row) {
    const std::uint32_t rows = std::min(kRowsPerChunk, surface.rows() - first_row);
    const std::size_t of_row = planes.size() * n;
    std::vector<std::uint32_t> values(of_row * rows), sources(n);
    for (std::uint32_t y = 0; y < rows; ++y) {
      for (std::uint32_t x = 0; x < n; ++x) sources[x] = gutter.source(x, first_row + y);
      read(std::span<const std::uint32_t>(sources), (first_row + y) * n,
           std::span(values).subspan(y * of_row, of_row));
    }
    return packed(values);
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

// Where a plane of the file comes from.
struct Component {
  std::size_t channel;  // of those that are read
  std::size_t index;    // of the value's components
};

// What a file contains: the channels that are read, and the components of these, in the order of their names.
struct Contents {
  std::vector<Channel> channels;
  std::vector<Plane> planes;
  std::vector<Component> components;  // of each plane
};

exr_pixel_type_t pixel_type(ChannelType type) {
  return type == ChannelType::float32 || type == ChannelType::float64 ? EXR_PIXEL_FLOAT : EXR_PIXEL_UINT;
}

Contents contents_of(const ExrOptions& options) {
  Contents contents;
  std::map<std::string, Component> by_name;
  for (const Channel& channel : channels()) {
    const bool chosen = *channel.layer == '\0' || std::ranges::count(options.layers, channel.layer) > 0;
    if (!chosen || (channel.needs_boundary && options.boundary.empty())) continue;
    for (std::size_t k = 0; k < channel.components(); ++k)
      by_name[channel.planes[k]] = {contents.channels.size(), k};
    contents.channels.push_back(channel);
  }
  for (const auto& [name, component] : by_name) {
    contents.planes.push_back({name, pixel_type(contents.channels[component.channel].type)});
    contents.components.push_back(component);
  }
  return contents;
}

// The bits of the number at `from` as the file has them.
template <class T>
std::uint32_t bits_of(const std::byte* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  if constexpr (std::is_same_v<T, double>) return std::bit_cast<std::uint32_t>(static_cast<float>(value));
  if constexpr (std::is_same_v<T, std::uint8_t>) return value == 0xFF ? kNone : value;
  if constexpr (sizeof(T) == 4) return std::bit_cast<std::uint32_t>(value);
}

template <class T>
void put(std::span<std::uint32_t> plane, const std::byte* values, std::size_t components, std::size_t k) {
  for (std::size_t i = 0; i < plane.size(); ++i)
    plane[i] = bits_of<T>(values + (i * components + k) * sizeof(T));
}

// Puts component k of a channel into a plane.
void put(std::span<std::uint32_t> plane, const Channel& channel, std::span<const std::byte> values,
         std::size_t k) {
  const auto put_as = [&]<class T>(T) { put<T>(plane, values.data(), channel.components(), k); };
  switch (channel.type) {
    case ChannelType::float64:
      return put_as(double{});
    case ChannelType::uint8:
      return put_as(std::uint8_t{});
    case ChannelType::float32:
    case ChannelType::uint32:
      return put_as(std::uint32_t{});
  }
}

void check(const ExrOptions& options, const DistanceMap& map, const Contents& contents,
           const std::filesystem::path& file) {
  const auto fail = [&](const std::string& why) {
    throw Error("cannot write " + file.string() + ": " + why);
  };
  if (!options.boundary.empty() && options.boundary.size() != map.distance.size())
    fail("the mask of the boundary belongs to another map");
  const std::vector<std::string> layers = channel_layers();
  for (const std::string& layer : options.layers)
    if (std::ranges::count(layers, layer) == 0) fail("there is no layer `" + layer + "`");
  for (const Channel& channel : contents.channels)
    if (channel.needs_sites && options.sites == nullptr)
      fail(std::string("the layer `") + channel.layer + "` needs the sites of the map");
}

}  // namespace

void write_exr(const std::filesystem::path& file, const Surface& surface, const DistanceMap& map,
               const ExrOptions& options) try {
  const Contents contents = contents_of(options);
  check(options, map, contents, file);
  const ChannelSource source{&map, &surface, options.sites, options.boundary};
  const std::uint32_t n = surface.resolution();
  write_planes(
      file, surface, contents.planes, options.attributes,
      [&](std::span<const std::uint32_t> sources, std::uint32_t first, std::span<std::uint32_t> row) {
        const auto values = read_channels(contents.channels, source, sources, first);
        for (std::size_t p = 0; p < contents.planes.size(); ++p) {
          const auto [channel, index] = contents.components[p];
          put(row.subspan(p * n, n), contents.channels[channel], values[channel], index);
        }
      });
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing " + file.string());
}

void write_exr(const std::filesystem::path& file, const Surface& surface, const TemporalMaps& maps) try {
  if (maps.resolution() != surface.resolution() || maps.least().size() != surface.texel_faces().size())
    throw Error("cannot write " + file.string() + ": the maps belong to another surface");
  constexpr std::size_t kPlanes = 4;
  const std::array<Plane, kPlanes> planes{{{"coverage.A", EXR_PIXEL_FLOAT},
                                           {"max.D", EXR_PIXEL_FLOAT},
                                           {"mean.D", EXR_PIXEL_FLOAT},
                                           {"min.D", EXR_PIXEL_FLOAT}}};
  const std::vector<float> mean = maps.mean();
  const std::array<std::span<const float>, kPlanes> values{{{}, maps.largest(), mean, maps.least()}};
  const std::uint32_t n = surface.resolution();
  write_planes(
      file, surface, planes, {},
      [&](std::span<const std::uint32_t> sources, std::uint32_t first, std::span<std::uint32_t> row) {
        for (std::uint32_t x = 0; x < n; ++x) {
          const bool is_own = sources[x] == first + x;
          row[x] = std::bit_cast<std::uint32_t>(is_own ? 1.f : 0.f);
          for (std::size_t p = 1; p < kPlanes; ++p)
            row[p * n + x] = std::bit_cast<std::uint32_t>(
                sources[x] == kNone ? std::numeric_limits<float>::quiet_NaN() : values[p][sources[x]]);
        }
      });
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing " + file.string());
}

}  // namespace sdm
