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
#include <exception>
#include <string>
#include <vector>

namespace sdm {
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

// One texel of the file. Every member has four bytes, so that the channels interleave without padding.
struct Pixel {
  float distance;
  Vec3f vector;
  std::uint32_t site, site_type, face;
  float coverage;
};
static_assert(sizeof(Pixel) == 32);

Imf::Header header(std::uint32_t n) {
  Imf::Header result(static_cast<int>(n), static_cast<int>(n));
  // Level 1: three times as fast as the default for a few percent of size.
  result.compression() = Imf::ZIP_COMPRESSION;
  result.zipCompressionLevel() = 1;
  for (const char* name : {"distance.D", "vector.X", "vector.Y", "vector.Z", "coverage.A"})
    result.channels().insert(name, Imf::Channel(Imf::FLOAT));
  for (const char* name : {"site.id", "site.type", "face.id"})
    result.channels().insert(name, Imf::Channel(Imf::UINT));
  Imf::addComments(result, std::string("surface distance map, sdm ") + kVersion);
  return result;
}

// The channels of rows y and up, stored at `pixels`.
Imf::FrameBuffer frame_buffer(Pixel* pixels, std::uint32_t n, std::uint32_t y, std::uint32_t rows) {
  Imf::FrameBuffer result;
  const auto insert = [&](const char* name, Imf::PixelType type, void* first) {
    result.insert(name, Imf::Slice::Make(type, first, Imath::V2i(0, static_cast<int>(y)), n, rows,
                                         sizeof(Pixel), n * sizeof(Pixel)));
  };
  insert("distance.D", Imf::FLOAT, &pixels->distance);
  insert("vector.X", Imf::FLOAT, &pixels->vector[0]);
  insert("vector.Y", Imf::FLOAT, &pixels->vector[1]);
  insert("vector.Z", Imf::FLOAT, &pixels->vector[2]);
  insert("site.id", Imf::UINT, &pixels->site);
  insert("site.type", Imf::UINT, &pixels->site_type);
  insert("face.id", Imf::UINT, &pixels->face);
  insert("coverage.A", Imf::FLOAT, &pixels->coverage);
  return result;
}

Pixel pixel(const Surface& surface, const DistanceMap& map, std::uint32_t x, std::uint32_t y) {
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  const auto owners = surface.texel_faces();
  const std::uint32_t source = gutter_source(map.resolution, owners, x, y);
  if (source == kNone) return {kNaN, {kNaN, kNaN, kNaN}, kNone, kNone, kNone, 0};
  const SiteType type = map.site_type[source];
  const bool covered = source == std::size_t{y} * map.resolution + x;
  return {map.distance[source], map.vector[source],
          map.site[source],     type == SiteType::none ? kNone : static_cast<std::uint32_t>(type),
          owners[source],       covered ? 1.f : 0.f};
}

}  // namespace

void write_exr(const std::filesystem::path& file, const Surface& surface, const DistanceMap& map) {
  const std::uint32_t n = map.resolution;
  // Blocks of rows bound the memory; they are multiples of the 16 rows that are compressed together.
  constexpr std::uint32_t kRows = 256;
  std::vector<Pixel> pixels(std::size_t{n} * std::min(kRows, n));
  // OpenEXR has no threads of its own until someone asks for them.
  if (Imf::globalThreadCount() == 0) Imf::setGlobalThreadCount(static_cast<int>(thread_count()));
  AtomicFile out(file);
  ExrStream stream(out, file.string());
  try {
    Imf::OutputFile exr(stream, header(n), static_cast<int>(thread_count()));
    for (std::uint32_t y = 0; y < n; y += kRows) {
      const std::uint32_t rows = std::min(kRows, n - y);
      parallel_for(rows, 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row)
          for (std::uint32_t x = 0; x < n; ++x)
            pixels[row * n + x] = pixel(surface, map, x, y + static_cast<std::uint32_t>(row));
      });
      exr.setFrameBuffer(frame_buffer(pixels.data(), n, y, rows));
      exr.writePixels(static_cast<int>(rows));
    }
  } catch (const std::exception&) {
    out.check();  // OpenEXR wraps the stream's error in its own words
    throw;
  }
  out.commit();
}

}  // namespace sdm
