/// Point clouds in files, of any size: read in parts, and measured without ever being in memory as a whole.
///
/// Threads: the functions may be called concurrently, unless two of them write the same file; an object is
/// used by one thread at a time.
#pragma once

#include <sdm/execution.h>
#include <sdm/map.h>
#include <sdm/map_files.h>
#include <sdm/measure.h>
#include <sdm/mesh_attributes.h>
#include <sdm/mesh_edit.h>
#include <sdm/names.h>
#include <sdm/options.h>
#include <sdm/places.h>
#include <sdm/sites.h>
#include <sdm/statistics.h>
#include <sdm/summary.h>
#include <sdm/tolerance.h>
#include <sdm/types.h>
#include <sdm/verdict.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <vector>

namespace sdm {

/// What separates the columns of a text.
enum class TextSeparator {
  automatic,
  blank,      ///< spaces and tabs, any number of them
  tab,        ///< each tab: columns may be empty or contain spaces
  comma,      ///< each comma
  semicolon,  ///< each semicolon
};

template <>
inline constexpr std::array kWords<TextSeparator>{"automatic", "blank", "tab", "comma", "semicolon"};

/// What stands between the whole and the fractional part of the numbers of a text.
enum class DecimalMark { automatic, point, comma };

template <>
inline constexpr std::array kWords<DecimalMark>{"automatic", "point", "comma"};

/// How the rows of a text without a format of its own ("XYZ", CSV, PTS) are read. Fields that are automatic
/// or empty follow from the file: from its header, if it has one, and from its first rows, of which 1000 in
/// 256 KiB are examined. All rows are then read in the same way.
struct TextDialect {
  TextSeparator separator = TextSeparator::automatic;
  DecimalMark decimal = DecimalMark::automatic;
  /// What each column holds: each of x, y and z once, all or none of nx, ny and nz, and for a column that is
  /// ignored any other name, such as "_". As in a header, case does not matter, and easting, northing and
  /// elevation (or height) stand for x, y and z. Columns after the last are ignored.
  std::vector<std::string> columns{};
  /// The line of the header in a file that was opened, from 1; nothing if it has none.
  std::optional<std::uint64_t> header_line{};
};

template <>
inline constexpr auto kOptions<TextDialect> = std::tuple{
    Option{.name = "columns",
           .member = &TextDialect::columns,
           .text =
               "What the columns of a cloud in text are: x, y and z, perhaps nx, ny and nz, and any other "
               "name, such as _, where a column is ignored; by default as the file names them, or the "
               "first three are x, y, z.",
           .value = "NAME,..."},
    Option{.name = "separator", .member = &TextDialect::separator, .text = "What separates these columns."},
    Option{.name = "decimal", .member = &TextDialect::decimal, .text = "The decimal mark of their numbers."}};

template <>
inline constexpr std::tuple kFields<TextDialect>{
    Field{"separator", &TextDialect::separator, "What separates columns."},
    Field{"decimal", &TextDialect::decimal, "What stands before the fraction of a number."},
    Field{"columns", &TextDialect::columns, "What each column holds."},
    Field{"header_line", &TextDialect::header_line, "The line of the header, from 1; nothing without one."}};

/// Throws sdm::Error if no file can be read in this way, as its columns are not as TextDialect requires.
SDM_API void validate(const TextDialect& dialect);

/// Reads a point cloud from front to back: PLY (the element vertex; faces are ignored), PCD 0.7, LAS
/// 1.0 to 1.4 (not LAZ), PTX, or text. The format is detected from the content; meshes of other formats are
/// refused. Normals are the properties nx, ny, nz or normal_x, normal_y, normal_z. Binary_compressed PCD is
/// one block, which is in memory as a whole.
///
/// The points of a scan in a PTX file are moved by its matrix; (0, 0, 0), a direction without a measurement,
/// becomes NaN.
///
/// Text has a point a row, and a TextDialect. Before the rows there may be a header, which names the columns,
/// and the number of rows; after these rows, another number and its rows (PTS). A header may follow "#" or
/// "//"; all else that follows these at the start of a line, or after a blank, is a comment. Without a header
/// the first three columns are x, y, z, and the next three a normal if they have length 1 in all rows that
/// are examined. A row with another number of columns, or with something else than a number for a coordinate,
/// is an error, as is a file that can be read in several ways, or a line longer than 64 KiB.
class SDM_API PointReader {
 public:
  /// Opens the file and reads its header. `text` decides how text is read, and is an error for other formats;
  /// its columns also make text of what begins like a mesh. Throws sdm::Error, as read() does, with the name
  /// of the file, the fault and, in text, the line.
  explicit PointReader(const std::filesystem::path& file, const TextDialect& text = {});
  ~PointReader();
  PointReader(PointReader&&) noexcept;
  PointReader& operator=(PointReader&&) noexcept;

  /// "PLY", "PCD", "LAS", "PTX" or "text".
  [[nodiscard]] std::string format() const;
  /// How a text is read, without automatic fields and with a name for each column, "_" if it is ignored.
  [[nodiscard]] std::optional<TextDialect> dialect() const;
  /// Whether the file has normals.
  [[nodiscard]] bool has_normals() const;
  /// The number of points, where the header has it.
  [[nodiscard]] std::optional<std::uint64_t> count() const;
  /// Replaces `points` by the next points, at most `most`, and `normals` by theirs, if the file has them. NaN
  /// marks points without a measurement, as PCD has them. Returns whether there were any. Throws
  /// sdm::Error, which names the file and the fault; the object is then broken (see sdm/error.h).
  bool read(std::size_t most, std::vector<Vec3>& points, std::vector<Vec3>& normals);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The names of the formats that PointReader supports, for messages and help texts.
[[nodiscard]] SDM_API std::string point_format_names();

/// The islands of a cloud, as they are after a placement.
struct PointIslands {
  std::uint64_t islands = 0, points = 0;
  double apart = 0;  ///< lower bound of the distance between a point of an island and one of none
  double reach = 0;  ///< points farther apart are in separate clusters, unless others are between them
};

template <>
inline constexpr std::tuple kFields<PointIslands>{
    Field{"islands", &PointIslands::islands, "The number of islands that were left out."},
    Field{"points", &PointIslands::points, "The number of their points."},
    Field{"apart", &PointIslands::apart, "The least distance between a point of an island and one of none."},
    Field{"reach", &PointIslands::reach,
          "Points farther apart are of separate clusters, unless others are between them."}};

/// Options of CloudIslands.
struct CloudIslandsOptions {
  TextDialect text{};           ///< of a cloud in text, as of PointReader
  std::size_t chunk = 1 << 18;  ///< points in memory at a time, greater than 0
  Progress progress{};
};

/// The *islands* of a cloud: its clusters of few points. Points are of one cluster if they are in cells of a
/// grid that touch. These are four times as wide as points would be apart if they were spread evenly over the
/// box of all but the outermost of them, and at least 1/512 of its diagonal; twice as wide as often as more
/// than 2^18 cells have points.
class SDM_API CloudIslands {
 public:
  /// Finds the clusters of fewer than `points` points. Throws sdm::Error as PointReader does; Cancelled.
  /// Cost: reads the file twice; memory for `chunk` points and 2^18 cells.
  CloudIslands(const std::filesystem::path& cloud, std::uint64_t points,
               const CloudIslandsOptions& options = {});
  ~CloudIslands();
  CloudIslands(CloudIslands&&) noexcept;
  CloudIslands& operator=(CloudIslands&&) noexcept;

  /// Whether a point of the file, as it is in it, is of an island; not of one that is not finite.
  [[nodiscard]] bool contains(const Vec3& point) const;
  /// What is found, with bounds after a placement that is not singular: equal to the lengths in the grid for
  /// similarities.
  [[nodiscard]] PointIslands found(const Transform& placement = {}) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Options of sample_points().
struct PointSampleOptions {
  TextDialect text{};  ///< of a cloud in text, as of PointReader
  Progress progress{};
  const CloudIslands* islands = nullptr;  ///< of this cloud: their points are left out
};
/// A pseudorandom sample of at most `most` of the finite points of a file, each with the same probability.
struct PointSample {
  std::vector<Vec3> points, normals;  ///< `normals` is empty if there are none
};
/// Draws such a sample. Throws sdm::Error as PointReader does; Cancelled. Cost: reads the file once.
[[nodiscard]] SDM_API PointSample sample_points(const std::filesystem::path& file, std::size_t most,
                                                const PointSampleOptions& options = {});

/// Options of measure_points().
struct PointDistancesOptions {
  MapOptions map{};
  /// Instead of to the closest point, along lines: as of closest_points_along(), with the normals of the
  /// cloud if it has any, which AlongOptions without a direction need. The maximum distance and the progress
  /// are those of `map`, whose sign, engine and facing have to be as by default.
  std::optional<AlongOptions> along{};
  Transform placement{};               ///< of the points, before they are measured and written; not singular
  PictureOptions picture{};            ///< colours; `accuracy` and `largest` have no meaning here
  std::size_t chunk = 1 << 18;         ///< points in memory at a time, greater than 0
  TextDialect text{};                  ///< of a cloud in text, as of PointReader
  std::span<const FaceNames> names{};  ///< of the faces of O2
  std::span<const GroupTolerance> table{};  ///< tolerances of these names
  double guard = 0;                         ///< how far O2 may be from the surface that is meant
  double uncertainty = 0;                   ///< Evidence::uncertainty
  bool accept_doubts = false;               ///< those of thin walls leave a pass one
  /// Islands of this cloud, whose points have no value and only add to a count.
  const CloudIslands* islands = nullptr;
};

template <>
inline constexpr std::tuple kOptions<PointDistancesOptions>{
    Option{.name = "uncertainty",
           .member = &PointDistancesOptions::uncertainty,
           .text = kUncertaintyText,
           .range = {.least = 0},
           .unit = "length",
           .value = "U"}};

/// The distance of a point and the place of that point in the file, from 0.
struct PointExtreme {
  double distance = 0;
  Vec3 point{};
  std::uint64_t index = 0;
};

template <>
inline constexpr std::tuple kFields<PointExtreme>{
    Field{"distance", &PointExtreme::distance, "In units of the mesh."},
    Field{"point", &PointExtreme::point, "The point."},
    Field{"index", &PointExtreme::index, "Its place in the file, from 0."}};

/// The distances of the points of a file, in numbers.
struct PointDistances {
  std::uint64_t points = 0;
  std::uint64_t invalid = 0;              ///< with a coordinate that is NaN or infinite
  std::uint64_t beyond_max_distance = 0;  ///< without a value, besides the invalid and the next ones
  std::uint64_t without_match = 0;        ///< for which no face of O2 faces as they do
  bool has_normals = false;
  std::string format;               ///< as PointReader has it
  std::optional<TextDialect> text;  ///< its dialect
  SignUsed sign;
  MeasuredDistance measured;
  DistanceStatistics
      distance;  ///< of the points with a value, each with the same weight; `texels`: their number
  std::optional<PointExtreme> min, max;  ///< nothing if no point has a value
  /// Points whose distance is out of picture.tolerance by more than the accuracy, or that are beyond the
  /// maximum distance.
  std::uint64_t beyond_tolerance = 0;
  /// SignMethod::side: some point is out of picture.tolerance whatever its sign. Points that are closest to
  /// the boundary of an open O2 have no side, and |d|.
  bool beyond_with_either_sign = true;
  /// SignMethod::side: some of these is not within it with either sign.
  bool missing_signs_matter = true;
  std::optional<PointIslands> islands;  ///< if they were looked for
  std::optional<Places> places;         ///< nothing if no point has a value, or has to have one
  /// The verdicts on the groups of options.table: each point with a value is of the groups of its closest
  /// face; those without one are of no group, and fail. Doubts are not considered.
  std::optional<GroupVerdicts> groups;
  double accuracy = 0;            ///< of a distance: that of the engine for the box of O2 and the points
  double thin_walls = kInfinity;  ///< Evidence::thin_walls, with a tolerance
  std::optional<std::string> note_on_walls{};  ///< note_on_walls() of all tolerances
  /// The evidence of the distances to faces that face the same way, where walls are thin and there are
  /// normals.
  std::optional<Evidence> by_facing{};
  Box bounds;  ///< of the finite points

  /// All points with coordinates but those of islands: what fractions of points are of.
  [[nodiscard]] std::uint64_t counted() const { return points - invalid - (islands ? islands->points : 0); }
};

template <>
inline constexpr std::tuple kFields<PointDistances>{
    Field{"points", &PointDistances::points, "The number of points of the file."},
    Field{"invalid", &PointDistances::invalid,
          "The number of those with a coordinate that is NaN or infinite."},
    Field{"beyond_max_distance", &PointDistances::beyond_max_distance,
          "The number of those without a value, besides the invalid ones and those without a match."},
    Field{"without_match", &PointDistances::without_match,
          "The number of those without a value, as no face of the mesh faces as they do."},
    Field{"beyond_tolerance", &PointDistances::beyond_tolerance,
          "The number of points that are out of the tolerance, or without a value."},
    Field{"has_normals", &PointDistances::has_normals, "Whether the file has normals."},
    Field{"format", &PointDistances::format, "The format of the file: 'PLY', 'PCD', 'LAS', 'PTX' or 'text'."},
    Field{
        "text", &PointDistances::text,
        "How text was read: ``separator``, ``decimal``, ``columns`` ('_': ignored) and ``header_line`` (from "
        "1; nothing without a header). Nothing for other formats."},
    Field{"min", &PointDistances::min, "The point with the smallest distance; nothing if no point has one."},
    Field{"max", &PointDistances::max, "The point with the largest distance; nothing if no point has one."},
    Field{"places", &PointDistances::places, "Where it deviates most; nothing if no point has a value."},
    Field{"groups", &PointDistances::groups,
          "The verdicts on the groups of the table of tolerances; nothing without one."}};

/// Computes the distance of each point of a file to O2, and writes the points in their order as binary PLY:
/// x, y, z (double), nx, ny, nz (float, if the file has normals), distance (float; NaN if there is none),
/// face (int; -1 if there is none), red, green, blue. Throws sdm::Error as PointReader, closest_points and
/// compute_map do, if the file cannot be written or is the cloud itself, and for a cloud without points;
/// Cancelled. Cost: a search per point, and reading the distances back three times; memory for `chunk`
/// points.
[[nodiscard]] SDM_API PointDistances measure_points(const std::filesystem::path& cloud, const Sites& sites,
                                                    const std::filesystem::path& ply,
                                                    const PointDistancesOptions& options = {});

/// Sums up what measure_points() returned with these options. Errors as of color_range(). Cost: O(1).
[[nodiscard]] SDM_API Summary summarize(const PointDistances& found, const PointDistancesOptions& options);

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
