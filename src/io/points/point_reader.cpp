#include <sdm/error.h>
#include <sdm/points.h>

#include <random>
#include <string>

#include "core/intact.h"
#include "geometry/vec.h"
#include "io/file/error_prefix.h"
#include "io/points/cloud_file.h"

namespace sdm {

using namespace io;

struct PointReader::Impl {
  Impl(const std::filesystem::path& path, const TextDialect& text) : name(path.string()), file(path, text) {}

  std::string name;
  CloudFile file;
  Intact intact{"a point reader"};  // a row that cannot be read would be left out of later reads
};

PointReader::PointReader(const std::filesystem::path& file, const TextDialect& text)
    : impl_(with_error_prefix(file.string(), [&] { return std::make_unique<Impl>(file, text); })) {}
PointReader::~PointReader() = default;
PointReader::PointReader(PointReader&&) noexcept = default;
PointReader& PointReader::operator=(PointReader&&) noexcept = default;

std::string PointReader::format() const {
  return impl_->file.format;
}

std::optional<TextDialect> PointReader::dialect() const {
  return impl_->file.dialect;
}

bool PointReader::has_normals() const {
  return impl_->file.has_normals;
}

std::optional<std::uint64_t> PointReader::count() const {
  return impl_->file.count;
}

bool PointReader::read(std::size_t most, std::vector<Vec3>& points, std::vector<Vec3>& normals) {
  points.clear();
  normals.clear();
  with_error_prefix(impl_->name,
                    [&] { impl_->intact.change([&] { impl_->file.source->read(most, points, normals); }); });
  return !points.empty();
}

std::string point_format_names() {
  return "PLY, PCD, LAS, PTX, PTS, text in columns (XYZ, CSV)";
}

PointSample sample_points(const std::filesystem::path& file, std::size_t most,
                          const PointSampleOptions& options) {
  constexpr std::size_t kChunk = 1 << 16;
  PointReader reader(file, options.text);
  PointSample sample;
  std::mt19937_64 random;  // its sequence is that of the standard
  std::uint64_t seen = 0, number = 0;
  std::vector<Vec3> points, normals;
  while (reader.read(kChunk, points, normals)) {
    if (options.progress && !options.progress("sample", 0))
      throw Cancelled();  // of a number that may not be known
    with_error_prefix(file.string(), [&] {
      for (std::size_t i = 0; i < points.size(); ++i, ++number) {
        const Vec3& p = points[i];
        if (!finite(p) || (options.islands && options.islands->contains(p))) continue;
        require_near(p, number);
        // Reservoir sampling, Waterman's algorithm R.
        const std::uint64_t place = seen < most ? seen : random() % (seen + 1);
        ++seen;
        if (place >= most) continue;
        if (place == sample.points.size()) {
          sample.points.emplace_back();
          sample.normals.emplace_back();
        }
        sample.points[place] = p;
        if (!normals.empty()) sample.normals[place] = normals[i];
      }
    });
  }
  if (!reader.has_normals()) sample.normals.clear();
  return sample;
}

}  // namespace sdm
