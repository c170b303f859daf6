#include <sdm/closest_points.h>
#include <sdm/error.h>
#include <sdm/execution.h>
#include <sdm/measure.h>
#include <sdm/points.h>
#include <sdm/sites.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <new>
#include <string>

#include "core/memory.h"
#include "geometry/vec.h"
#include "io/file/atomic_file.h"
#include "io/file/byte_scanner.h"
#include "io/file/error_prefix.h"
#include "io/file/input_files.h"
#include "io/file/little_endian.h"
#include "io/image/pictures/color_scale.h"
#include "io/points/cloud_file.h"
#include "io/points/cloud_groups.h"
#include "io/points/cloud_places.h"
#include "io/points/measured_rows.h"
#include "io/points/point_cells.h"
#include "map/closest_measure.h"
#include "map/measures/walls.h"
#include "map/statistics/tolerance_limits.h"
#include "map/statistics/weighted_statistics.h"
#include "summary/verdict/evidence.h"
#include "summary/wall_note.h"

namespace sdm {

using namespace io;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr char kIsland = 1;  // in place of a colour, until points are coloured

/// Points of a cloud, and what is found for them.
struct Chunk {
  std::vector<Vec3> points, normals;
  std::vector<float> distances;
  std::vector<std::uint32_t> faces;
  std::vector<std::uint8_t> unmatched;
  std::vector<float> facing;           // distances to the faces that face the same way; empty: not needed
  std::vector<std::uint8_t> island;    // empty: none is of one
  std::vector<std::uint8_t> has_sign;  // empty: all have one, or none has
};

class Measurement {
 public:
  Measurement(const std::filesystem::path& cloud, const Sites& sites, const PointDistancesOptions& options)
      : reader_(cloud, options.text), cloud_(cloud.string()), sites_(sites), options_(options) {
    if (options.chunk == 0) throw Error("the number of points in memory must be greater than 0");
    if (options.placement.orientation() == 0)
      throw Error("the placement of the points is singular: it would flatten them");
    result_.has_normals = reader_.has_normals();
    result_.format = reader_.format();
    result_.text = reader_.dialect();
    choose_distance();
    if (options.picture.tolerance && options.picture.tolerance->needs_sign() &&
        result_.sign.method == SignMethod::none)
      throw Error("the tolerance depends on the sign of the distances, which are unsigned: " +
                  result_.sign.reason);
    row_.has_normals = result_.has_normals;
    if (!options.table.empty())
      groups_.emplace(options.names, options.table, sites.mesh().triangles.size(), result_.sign,
                      result_.measured.kind);
    find_thin_walls();
  }

  PointDistances write(const std::filesystem::path& ply) {
    require_other_file(ply, cloud_);
    if (!reader_.count()) count_points();
    if (options_.islands) {
      result_.islands = options_.islands->found(options_.placement);
      result_.islands->points = 0;  // counted again, as the file is read
    }
    AtomicFile file(ply);
    write_header(file.stream());
    const auto rows_begin = static_cast<std::uint64_t>(file.stream().tellp());
    measure_all(file);
    if (result_.points == 0) throw Error(cloud_ + ": there are no points");
    file.stream().flush();
    file.check();
    find_statistics(file.temporary(), rows_begin);
    result_.accuracy = accuracy();
    finish(file.temporary(), rows_begin);
    file.commit();
    return result_;
  }

 private:
  // What is measured, and its sign.
  void choose_distance() {
    const MapOptions& map = options_.map;
    if (map.facing && !result_.has_normals)
      throw Error(cloud_ + ": the cloud has no normals, by which the faces that face its points are chosen");
    if (!options_.along) {
      result_.sign = choose_sign(sites_, map);
      result_.measured = measured_distance(map);
      return;
    }
    if (map.facing || map.engine || map.sign != SignMethod::automatic)
      throw Error(
          "distances along lines have a sign and an engine of their own, and do not combine with facing");
    if (!options_.along->direction && !result_.has_normals)
      throw Error(cloud_ + ": the cloud has no normals to measure along; give a direction");
    result_.sign = {SignMethod::side, "the side of the face that the line hits"};
    result_.measured = measured_distance(*options_.along, "point");
  }

  // Whether walls of O2 are so thin that a point within the limits may be out of them on its own skin.
  void find_thin_walls() {
    if (!may_cross_walls(result_.measured.kind)) return;
    double largest = options_.picture.tolerance ? largest_limit(*options_.picture.tolerance) : 0;
    for (const GroupTolerance& row : options_.table)
      largest = std::max(largest, largest_limit(row.tolerance));
    if (largest == 0) return;
    const std::vector<double> walls = thickness::wall_lengths(sites_);
    result_.thin_walls = thickness::thin_walls(walls);
    result_.note_on_walls = summary::note_on_walls(walls, options_.picture.tolerance, options_.names,
                                                   options_.table, options_.picture.units);
    by_facing_ = 2 * largest > result_.thin_walls && result_.has_normals;
  }

  // The accuracy, the guard band, the walls and the sign of all samples.
  [[nodiscard]] Evidence common_evidence() const {
    return {.accuracy = result_.accuracy,
            .guard = options_.guard + options_.uncertainty,
            .uncertainty = options_.uncertainty,
            .is_signed = result_.sign.method != SignMethod::none,
            .thin_walls = result_.thin_walls};
  }

  // Text without a header has to be read for its number of points, which the header of the result needs.
  void count_points() {
    PointReader again(cloud_, options_.text);
    Chunk chunk;
    while (again.read(options_.chunk, chunk.points, chunk.normals)) {
      counted_ += chunk.points.size();
      report("count", 0);  // of a number that is not known
    }
  }

  void report(const char* step, double fraction) const {
    if (options_.map.progress && !options_.map.progress(step, fraction)) throw Cancelled();
  }

  void write_header(std::ostream& out) const {
    out << "ply\nformat binary_little_endian 1.0\nelement vertex " << reader_.count().value_or(counted_)
        << "\nproperty double x\nproperty double y\nproperty double z\n";
    if (result_.has_normals) out << "property float nx\nproperty float ny\nproperty float nz\n";
    out << "property float distance\nproperty int face\n"
           "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
  }

  void measure_all(AtomicFile& file) {
    Chunk current, next;
    bool more = reader_.read(options_.chunk, current.points, current.normals);
    const std::uint64_t all = reader_.count().value_or(counted_);
    while (more) {
      run_concurrently({[&] { measure(current); },
                        [&] { more = reader_.read(options_.chunk, next.points, next.normals); }});
      append(file.stream(), current);
      file.check();
      std::swap(current, next);
      report("points",
             static_cast<double>(result_.points) / static_cast<double>(std::max<std::uint64_t>(all, 1)));
    }
  }

  void measure(Chunk& chunk) const {
    chunk.island.clear();
    if (options_.islands)
      for (const Vec3& p : chunk.points) chunk.island.push_back(options_.islands->contains(p) ? 1 : 0);
    for (Vec3& p : chunk.points) p = options_.placement(p);
    for (Vec3& n : chunk.normals) n = options_.placement.normal(n);
    with_error_prefix(cloud_, [&] {
      for (std::size_t i = 0; i < chunk.points.size(); ++i)  // those before the chunk are in the result
        if (!is_island(chunk, i)) require_near(chunk.points[i], result_.points + i);
    });
    // Points without a measurement are replaced by a point of O2, which costs nothing.
    std::vector<Vec3> queries = chunk.points;
    const Vec3 anywhere = sites_.mesh().positions[sites_.mesh().triangles[0][0]];
    for (std::size_t i = 0; i < queries.size(); ++i)
      if (!finite(queries[i]) || is_island(chunk, i)) queries[i] = anywhere;
    MapOptions map = options_.map;
    map.progress = {};
    const FacingPoints found = find(queries, chunk.normals, map);
    const std::vector<ClosestPoint>& closest = found.closest;
    const std::vector<std::uint8_t>& inside = found.behind;
    chunk.unmatched = found.unmatched;
    chunk.has_sign = signs_of(closest);
    chunk.distances.assign(queries.size(), static_cast<float>(kNan));
    chunk.faces.assign(queries.size(), kNone);
    for (std::size_t i = 0; i < queries.size(); ++i) {
      if (!finite(chunk.points[i]) || closest[i].type == SiteType::none || is_island(chunk, i)) continue;
      chunk.distances[i] = static_cast<float>(inside[i] ? -closest[i].distance : closest[i].distance);
      chunk.faces[i] = closest[i].face;
    }
    chunk.facing.clear();
    if (!by_facing_) return;
    const FacingPoints facing =
        closest_facing_points(sites_, queries, chunk.normals, 90, map::point_options(map));
    const bool is_signed = result_.sign.method != SignMethod::none;
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const double d = facing.closest[i].distance;
      chunk.facing.push_back(facing.closest[i].type == SiteType::none
                                 ? static_cast<float>(kNan)
                                 : static_cast<float>(is_signed && facing.behind[i] ? -d : d));
    }
  }

  static bool is_island(const Chunk& chunk, std::size_t i) {
    return !chunk.island.empty() && chunk.island[i] != 0;
  }

  // Whether the points have a sign, which those that are closest to the boundary of O2 lack.
  [[nodiscard]] std::vector<std::uint8_t> signs_of(std::span<const ClosestPoint> closest) const {
    if (!lacks_boundary_signs(result_.measured.kind, result_.sign.method)) return {};
    DistanceMap map;
    map.site.resize(closest.size());
    map.site_type.resize(closest.size());
    for (std::size_t i = 0; i < closest.size(); ++i) {
      map.site[i] = closest[i].site;
      map.site_type[i] = closest[i].type;
    }
    std::vector<std::uint8_t> flags = boundary_mask(sites_, map);
    for (std::uint8_t& flag : flags) flag = flag == 0 ? 1 : 0;
    return flags;
  }

  // The matches of the points, and whether their distances are negative.
  [[nodiscard]] FacingPoints find(std::span<const Vec3> queries, std::span<const Vec3> normals,
                                  const MapOptions& map) const {
    if (options_.along) {
      AlongOptions along = *options_.along;
      along.max_distance = map.max_distance;
      along.progress = {};
      return closest_points_along(sites_, queries, normals, along);
    }
    if (map.facing) {
      FacingPoints found =
          closest_facing_points(sites_, queries, normals, *map.facing, map::point_options(map));
      if (result_.sign.method == SignMethod::none) std::ranges::fill(found.behind, std::uint8_t{0});
      return found;
    }
    FacingPoints found{closest_points(sites_, queries, map::point_options(map)),
                       {},
                       std::vector<std::uint8_t>(queries.size())};
    found.behind = inside_flags(sites_, queries, found.closest, result_.sign.method);
    return found;
  }

  // Adds the chunk to the sums, and its rows, without colours, to the file.
  void append(std::ostream& out, const Chunk& chunk) {
    std::string bytes;
    bytes.reserve(chunk.points.size() * row_.size());
    for (std::size_t i = 0; i < chunk.points.size(); ++i) {
      add(chunk, i);
      for (const double x : chunk.points[i]) append_little_endian(bytes, x);
      if (result_.has_normals)
        for (const double x : chunk.normals[i]) append_little_endian(bytes, static_cast<float>(x));
      append_little_endian(bytes, chunk.distances[i]);
      append_little_endian(bytes, static_cast<std::int32_t>(chunk.faces[i]));
      bytes.append(3, is_island(chunk, i) ? kIsland : '\0');
    }
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  }

  void add(const Chunk& chunk, std::size_t i) {
    const std::uint64_t index = result_.points++;
    const Vec3& point = chunk.points[i];
    const float d = chunk.distances[i];
    const bool valid = finite(point), has_value = !std::isnan(d), unmatched = chunk.unmatched[i] != 0;
    result_.invalid += !valid;
    if (is_island(chunk, i)) {
      ++result_.islands->points;
      return;
    }
    if (valid) {
      extend(result_.bounds, point);
      usual_.add(point);
    }
    result_.beyond_max_distance += valid && !has_value && !unmatched;
    result_.without_match += valid && unmatched;
    if (!has_value) return;
    const bool has_sign = chunk.has_sign.empty() || chunk.has_sign[i] != 0;
    signs_.add(d, has_sign);
    if (groups_) groups_->add(chunk.faces[i], d, has_sign);
    if (by_facing_) add_facing(chunk.faces[i], chunk.facing[i]);
    sums_.add(d, 1);
    if (!result_.min || d < result_.min->distance) result_.min = {d, point, index};
    if (!result_.max || d > result_.max->distance) result_.max = {d, point, index};
  }

  void add_facing(std::uint32_t face, float d) {
    if (std::isnan(d))
      without_facing_ = true;
    else
      facing_.add(d);
    if (groups_) groups_->add_facing(face, d);
  }

  // Calls visit(row) for the rows from `begin` to `end` of the file.
  template <class Stream, class Visit>
  void for_each_row(Stream& file, std::uint64_t rows_begin, std::uint64_t begin, std::uint64_t end,
                    const Visit& visit) const {
    constexpr std::uint64_t kRows = 1 << 14;
    std::string bytes;
    for (std::uint64_t first = begin; first < end; first += kRows) {
      const auto place = static_cast<std::streamoff>(rows_begin + first * row_.size());
      bytes.resize(static_cast<std::size_t>(std::min(kRows, end - first)) * row_.size());
      file.seekg(place);
      if (!file.read(bytes.data(), static_cast<std::streamsize>(bytes.size())))
        throw Error(cloud_ + ": the distances cannot be read back");
      for (std::size_t at = 0; at < bytes.size(); at += row_.size()) visit(bytes.data() + at);
      if constexpr (std::is_same_v<Stream, std::fstream>) {
        file.seekp(place);
        file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
      }
    }
  }

  void find_statistics(const std::filesystem::path& written, std::uint64_t rows_begin) {
    constexpr std::size_t kParts = 16;
    result_.distance = map::statistics_of(sums_, [&](bool magnitudes, std::span<const double> shares) {
      const auto for_each = [&](std::size_t part, const auto& visit) {
        std::ifstream file(written, std::ios::binary);
        for_each_row(file, rows_begin, part * result_.points / kParts, (part + 1) * result_.points / kParts,
                     [&](const char* row) {
                       const auto d = load<float>(row + row_.distance_at());
                       if (!std::isnan(d)) visit(magnitudes ? std::abs(d) : d, 1.0f);
                     });
      };
      return map::WeightedPercentiles::find(kParts, for_each, shares);
    });
  }

  // Relative to the box of both, which is known once all points are read.
  [[nodiscard]] double accuracy() const {
    const EngineInfo& engine = options_.map.engine ? engine_info(*options_.map.engine) : engines().front();
    Box box = sdm::bounds(sites_.mesh());
    if (result_.invalid < result_.points) extend(box, result_.bounds);
    return engine.relative_error * diagonal(box);
  }

  // Colours the rows, counts those out of the tolerance, and finds the places where they are.
  void finish(const std::filesystem::path& written, std::uint64_t rows_begin) {
    PictureOptions picture = options_.picture;
    picture.accuracy = result_.accuracy;
    const ColorScale scale = color_scale(fixed_colors(picture, result_.distance));
    const double accuracy = result_.accuracy + options_.guard + options_.uncertainty;
    const map::ToleranceLimits limits(picture.tolerance.value_or(Tolerance()), accuracy);
    if (picture.tolerance) result_.beyond_tolerance = result_.beyond_max_distance + result_.without_match;
    CloudPlaces places(result_, options_, groups_ && groups_->any_out(accuracy), usual_.box());
    std::uint64_t number = 0;
    std::fstream file(written, std::ios::binary | std::ios::in | std::ios::out);
    for_each_row(file, rows_begin, 0, result_.points, [&](char* row) {
      const auto d = load<float>(row + row_.distance_at());
      const auto face = load<std::int32_t>(row + row_.face_at());
      if (groups_ && !std::isnan(d)) groups_->count(static_cast<std::uint32_t>(face), d, accuracy);
      if (row[row_.colour_at()] != kIsland)
        places.add({.point = {load<double>(row), load<double>(row + sizeof(double)),
                              load<double>(row + 2 * sizeof(double))},
                    .distance = d,
                    .face = static_cast<std::uint32_t>(face)},
                   number);
      ++number;
      const Rgb rgb = std::isnan(d) ? kNoValue : scale(d);
      result_.beyond_tolerance += picture.tolerance && (limits.below(d) || limits.above(d));
      row[row_.colour_at()] = static_cast<char>(rgb.r);
      row[row_.colour_at() + 1] = static_cast<char>(rgb.g);
      row[row_.colour_at() + 2] = static_cast<char>(rgb.b);
    });
    file.close();
    if (picture.tolerance) {
      result_.beyond_with_either_sign = signs_.any_out(*picture.tolerance, accuracy);
      result_.missing_signs_matter = signs_.missing_signs_matter(*picture.tolerance, accuracy);
    }
    if (groups_)
      result_.groups = groups_->verdicts({result_.beyond_max_distance, result_.without_match},
                                         common_evidence(), options_.accept_doubts);
    if (by_facing_) result_.by_facing = facing_evidence(common_evidence(), facing_, without_facing_);
    if (result_.min || places.by_tolerance()) result_.places = places.places(options_.names);
    if (!file) throw Error(cloud_ + ": the colours cannot be written; the disk may be full");
  }

  PointReader reader_;
  std::string cloud_;
  const Sites& sites_;
  const PointDistancesOptions& options_;
  RowLayout row_;
  PointDistances result_;
  UsualBox usual_;
  summary::SignedSamples signs_;
  bool by_facing_ = false;  // distances to the faces that face the same way are needed
  summary::DistanceRange facing_;
  bool without_facing_ = false;
  std::optional<CloudGroups> groups_;
  std::uint64_t counted_ = 0;
  map::WeightedSums sums_;
};

}  // namespace

PointDistances measure_points(const std::filesystem::path& cloud, const Sites& sites,
                              const std::filesystem::path& ply, const PointDistancesOptions& options) try {
  return Measurement(cloud, sites, options).write(ply);
} catch (const std::bad_alloc&) {
  throw out_of_memory("the points of " + cloud.string());
}

}  // namespace sdm
