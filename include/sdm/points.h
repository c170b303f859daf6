/// Point clouds in files, of any size: read in parts, and measured without ever being in memory as a whole.
///
/// Threads: the functions may be called concurrently, unless two of them write the same file; an object is
/// used by one thread at a time.
#pragma once

#include <sdm/api.h>
#include <sdm/io.h>
#include <sdm/map.h>
#include <sdm/sites.h>
#include <sdm/statistics.h>
#include <sdm/transform.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace sdm {

/// Reads a point cloud from front to back: PLY (the element vertex; faces are ignored), PCD 0.7, LAS
/// 1.0 to 1.4 (not LAZ), or text with three or more numbers a line, separated by spaces, commas or semicolons
/// ("XYZ"). The format is detected from the content. Normals are the properties nx, ny, nz or normal_x,
/// normal_y, normal_z; in XYZ, columns 4 to 6 if they have length 1 in all of the first lines.
/// Binary_compressed PCD is one block, which is in memory as a whole.
class SDM_API PointReader {
 public:
  /// Opens the file and reads its header. Throws sdm::Error, as read() does, with the name of the file and
  /// the fault.
  explicit PointReader(const std::filesystem::path& file);
  ~PointReader();
  PointReader(PointReader&&) noexcept;
  PointReader& operator=(PointReader&&) noexcept;

  /// Whether the file has normals.
  [[nodiscard]] bool has_normals() const;
  /// The number of points, where the header has it.
  [[nodiscard]] std::optional<std::uint64_t> count() const;
  /// Replaces `points` by the next points, at most `most`, and `normals` by theirs, if the file has them. NaN
  /// marks points without a measurement, as PCD has them. Returns whether there were any.
  bool read(std::size_t most, std::vector<Vec3>& points, std::vector<Vec3>& normals);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The names of the formats that PointReader supports, for messages and help texts.
[[nodiscard]] SDM_API std::string point_format_names();

/// A pseudorandom sample of at most `most` of the finite points of a file, each with the same probability.
struct PointSample {
  std::vector<Vec3> points, normals;  ///< `normals` is empty if there are none
};
/// Draws such a sample. Throws sdm::Error as PointReader does. Cost: reads the file once.
[[nodiscard]] SDM_API PointSample sample_points(const std::filesystem::path& file, std::size_t most);

/// Options of measure_points().
struct PointDistancesOptions {
  MapOptions map{};
  Transform placement{};        ///< of the points, before they are measured and written
  PictureOptions picture{};     ///< colours; `units`, `accuracy` and `largest` have no meaning here
  std::size_t chunk = 1 << 18;  ///< points in memory at a time, greater than 0
};

/// The distance of a point and the place of that point in the file, from 0.
struct PointExtreme {
  double distance = 0;  ///< NaN if there is none
  Vec3 point{};
  std::uint64_t index = 0;
};

/// The distances of the points of a file, in numbers.
struct PointDistances {
  std::uint64_t points = 0;
  std::uint64_t invalid = 0;              ///< with a coordinate that is NaN or infinite
  std::uint64_t beyond_max_distance = 0;  ///< without a value, besides the invalid ones
  bool has_normals = false;
  SignUsed sign;
  DistanceStatistics
      distance;  ///< of the points with a value, each with the same weight; `texels`: their number
  PointExtreme min, max;
  std::uint64_t beyond_tolerance = 0;  ///< points whose |distance| exceeds picture.tolerance, or is unknown
  Box bounds;                          ///< of the finite points
};

/// Computes the distance of each point of a file to O2, and writes the points in their order as binary PLY:
/// x, y, z (double), nx, ny, nz (float, if the file has normals), distance (float; NaN if there is none),
/// face (int; -1 if there is none), red, green, blue. Throws sdm::Error as PointReader, closest_points and
/// compute_map do, if the file cannot be written, and for a cloud without points; Cancelled. Cost: a search
/// per point, and reading the distances back three times; memory for `chunk` points.
[[nodiscard]] SDM_API PointDistances measure_points(const std::filesystem::path& cloud, const Sites& sites,
                                                    const std::filesystem::path& ply,
                                                    const PointDistancesOptions& options = {});

/// report.html of a cloud, as write_html() makes it of a map: verdict and numbers of `report`, the JSON text
/// of the report of `sdm points`, and the points in 3D. `ply` and `found`: what measure_points() wrote and
/// returned. Distribution and worst places are of all points; the page shows up to 150,000 of them, one of
/// each of as many runs of the file, at a pseudorandom place of the run, and besides those with the largest
/// |distance| of each neighbourhood, at most 5832, and both extremes. It states how many. Points without
/// normals are shaded by the normal of their closest face of options.other; options.largest and .triangles
/// have no meaning here. Also throws sdm::Error if `ply` does not have these points, and if can_write_html()
/// is false. Cost: reads the file twice; some megabytes of memory.
SDM_API void write_points_html(const std::filesystem::path& file, const std::filesystem::path& ply,
                               const PointDistances& found, const std::string& report,
                               const HtmlOptions& options = {});

}  // namespace sdm
