#include "core/memory.h"
#include "core/parallel.h"
#include "io/write/atomic_file.h"
#include "io/write/gutter.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfThreading.h>
#include <sdm/error.h>
#include <sdm/io.h>
#include <sdm/version.h>

#include <algorithm>
#include <cstddef>
#include <exception>
#include <limits>
#include <new>
#include <span>
#include <string>
#include <vector>

namespace sdm {

using namespace io;

namespace {

class ExrStream : public Imf::OStream {
 public:
  ExrStream(AtomicFile& file, const std::string& name) : OStream(name.c_str()), file_(file) {}

  void write(const char bytes[], int count) override {
    file_.stream().write(bytes, count);
    file_.check();
  }
  std::uint64_t tellp() override { return static_cast<std::uint64_t>(file_.stream().tellp()); }
  void seekp(std::uint64_t position) override { file_.stream().seekp(static_cast<std::streamoff>(position)); }

 private:
  AtomicFile& file_;
};

// A channel of the texels, which are structures whose members all have four bytes and which therefore have no
// padding.
struct Channel {
  const char* name;
  Imf::PixelType type;
  std::size_t offset;
};

Imf::Header header(std::uint32_t n, std::span<const Channel> channels) {
  Imf::Header result(static_cast<int>(n), static_cast<int>(n));
  // Level 1: three times as fast as the default for a few percent of size.
  result.compression() = Imf::ZIP_COMPRESSION;
  result.zipCompressionLevel() = 1;
  for (const Channel& channel : channels) result.channels().insert(channel.name, Imf::Channel(channel.type));
  Imf::addComments(result, std::string("surface distance map, sdm ") + kVersion);
  return result;
}

// Writes the texels that texel(source, covered) returns. `source` is the owned texel whose values are used, a
// neighbour's in gutters; kNone if there is none.
template <class Texel, class Get>
void write_texels(const std::filesystem::path& file, const Surface& surface,
                  std::span<const Channel> channels, const Get& texel) {
  const std::uint32_t n = surface.resolution();
  const auto owners = surface.texel_faces();
  // Writing groups of rows bounds the memory. OpenEXR compresses 16 rows together, so groups are multiples of
  // that.
  constexpr std::uint32_t kRows = 256;
  std::vector<Texel> texels(std::size_t{n} * std::min(kRows, n));
  // OpenEXR creates no threads by default.
  if (Imf::globalThreadCount() == 0) Imf::setGlobalThreadCount(static_cast<int>(thread_count()));
  AtomicFile out(file);
  ExrStream stream(out, file.string());
  try {
    Imf::OutputFile exr(stream, header(n, channels), static_cast<int>(thread_count()));
    for (std::uint32_t y = 0; y < n; y += kRows) {
      const std::uint32_t rows = std::min(kRows, n - y);
      parallel_for(rows, 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row)
          for (std::uint32_t x = 0; x < n; ++x) {
            const auto here = y + static_cast<std::uint32_t>(row);
            const std::uint32_t source = gutter_source(n, owners, x, here);
            texels[row * n + x] = texel(source, source == here * n + x);
          }
      });
      Imf::FrameBuffer buffer;
      for (const Channel& channel : channels)
        buffer.insert(
            channel.name,
            Imf::Slice::Make(channel.type, reinterpret_cast<char*>(texels.data()) + channel.offset,
                             Imath::V2i(0, static_cast<int>(y)), n, rows, sizeof(Texel), n * sizeof(Texel)));
      exr.setFrameBuffer(buffer);
      exr.writePixels(static_cast<int>(rows));
    }
  } catch (const std::exception&) {
    out.check();  // OpenEXR replaces the message of the stream's error
    throw;
  }
  out.commit();
}

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

struct MapTexel {
  float distance = kNaN;
  Vec3f vector{kNaN, kNaN, kNaN};
  std::uint32_t site = kNone, site_type = kNone, face = kNone;
  float coverage = 0, boundary = 0;
};

struct TemporalTexel {
  float least = kNaN, mean = kNaN, largest = kNaN, coverage = 0;
};

}  // namespace

void write_exr(const std::filesystem::path& file, const Surface& surface, const DistanceMap& map,
               std::span<const std::uint8_t> boundary) try {
  if (!boundary.empty() && boundary.size() != map.distance.size())
    throw Error("cannot write " + file.string() + ": the mask of the boundary belongs to another map");
  constexpr std::size_t kVector = offsetof(MapTexel, vector);
  const Channel channels[] = {{"distance.D", Imf::FLOAT, offsetof(MapTexel, distance)},
                              {"vector.X", Imf::FLOAT, kVector},
                              {"vector.Y", Imf::FLOAT, kVector + sizeof(float)},
                              {"vector.Z", Imf::FLOAT, kVector + 2 * sizeof(float)},
                              {"site.id", Imf::UINT, offsetof(MapTexel, site)},
                              {"site.type", Imf::UINT, offsetof(MapTexel, site_type)},
                              {"face.id", Imf::UINT, offsetof(MapTexel, face)},
                              {"coverage.A", Imf::FLOAT, offsetof(MapTexel, coverage)},
                              {"boundary.M", Imf::FLOAT, offsetof(MapTexel, boundary)}};
  const std::span used = std::span(channels).first(std::size(channels) - (boundary.empty() ? 1 : 0));
  const auto owners = surface.texel_faces();
  write_texels<MapTexel>(file, surface, used, [&](std::uint32_t source, bool covered) -> MapTexel {
    if (source == kNone) return {};
    const SiteType type = map.site_type[source];
    return {map.distance[source],
            map.vector[source],
            map.site[source],
            type == SiteType::none ? kNone : static_cast<std::uint32_t>(type),
            owners[source],
            covered ? 1.f : 0.f,
            !boundary.empty() && boundary[source] ? 1.f : 0.f};
  });
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing " + file.string());
}

void write_exr(const std::filesystem::path& file, const Surface& surface, const TemporalMaps& maps) try {
  if (maps.resolution() != surface.resolution())
    throw Error("cannot write " + file.string() + ": the maps belong to another surface");
  const Channel channels[] = {{"min.D", Imf::FLOAT, offsetof(TemporalTexel, least)},
                              {"mean.D", Imf::FLOAT, offsetof(TemporalTexel, mean)},
                              {"max.D", Imf::FLOAT, offsetof(TemporalTexel, largest)},
                              {"coverage.A", Imf::FLOAT, offsetof(TemporalTexel, coverage)}};
  const std::vector<float> mean = maps.mean();
  write_texels<TemporalTexel>(
      file, surface, channels, [&](std::uint32_t source, bool covered) -> TemporalTexel {
        if (source == kNone) return {};
        return {maps.least()[source], mean[source], maps.largest()[source], covered ? 1.f : 0.f};
      });
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing " + file.string());
}

}  // namespace sdm
