/// What a map or a measured cloud is summed up to: numbers, verdict, range of colours and notes. Everything
/// that states results shows these: the command, report.json, the pages and Python.
///
/// Threads: the functions may be called concurrently, also with the same map; an object is used by one thread
/// at a time.
#pragma once

#include <sdm/doubts.h>
#include <sdm/execution.h>
#include <sdm/map.h>
#include <sdm/mesh.h>
#include <sdm/mesh_attributes.h>
#include <sdm/names.h>
#include <sdm/options.h>
#include <sdm/places.h>
#include <sdm/sites.h>
#include <sdm/statistics.h>
#include <sdm/surface.h>
#include <sdm/tolerance.h>
#include <sdm/types.h>
#include <sdm/verdict.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <vector>

namespace sdm {

/// Colour scales for distances.
enum class Colormap {
  /// Bands with a tolerance; otherwise viridis if no distance is negative, sequential if less than 5 % of
  /// the area is on one side of 0, or nothing there farther than a tenth of the 99th percentile of
  /// |distance|, and diverging if neither.
  automatic,
  viridis,
  sequential,  ///< viridis from 0 to the end of the one side, reds for the other one
  diverging,   ///< blue (negative) – white – red (positive), centred on zero
  paper2006,   ///< red (near) to green (far), as in the paper's figures
};

template <>
inline constexpr std::array kWords<Colormap>{"automatic", "viridis", "sequential", "diverging", "paper2006"};

/// What a user chose of the colours, and what they depend on.
struct ColorChoice {
  Colormap colormap = Colormap::automatic;
  std::optional<std::array<double, 2>> range{};  ///< the distances at the ends
  std::optional<Tolerance> tolerance{};
  double accuracy = 0;  ///< of the distances; a range from the distances is at least as long
};

/// The options of a struct on colours: colormap, range and tolerance.
template <class Struct>
inline constexpr auto kColorOptions = std::tuple{
    Option{.name = "colormap",
           .member = &Struct::colormap,
           .text = "Colormap; sequential: viridis from 0 to one side, and reds to the other one; automatic: "
                   "viridis if no distance is negative, sequential if little is on one side of 0, otherwise "
                   "diverging."},
    Option{.name = "range",
           .member = &Struct::range,
           .text = "The distances at the ends of the colour scale; by default up to the 99th percentile of "
                   "|distance|, rounded, to both sides of 0 if distances have both signs.",
           .unit = "length",
           .value = "LO HI"},
    Option{.name = "tolerance",
           .member = &Struct::tolerance,
           .text = "Draw colour bands, and judge whether all distances are from LO to HI; T: the same as "
                   "-T:T, also for unsigned distances.",
           .unit = "length",
           .value = "T|LO:HI"}};
inline constexpr const char* kUnitsText = "Units of the meshes, for printed and drawn values.";

template <>
inline constexpr auto kOptions<ColorChoice> = kColorOptions<ColorChoice>;

/// The colours of distances.
struct ColorRange {
  Colormap colormap = Colormap::viridis;  ///< automatic: bands of the tolerance
  std::array<double, 2> range{0, 1};      ///< the distances at the ends; the first one is smaller
  bool chosen = false;                    ///< whether a user chose the range
};

/// Returns the colours of a map with these statistics, by the rule for all files. The range ends at the 99th
/// percentile of |distance| (of the area, or of the points), so that a few outliers do not take the colours
/// from the rest: −p99 to p99 if the colormap is diverging, otherwise the range of the distances cut at ±p99,
/// from 0 unless all are beyond the half of it; if the colormap is sequential, the side of less area has at
/// most half of the length of the other one; with a tolerance, well beyond its limits. If the percentile is
/// within the accuracy, it ends at the largest |distance|. The ends are then rounded outwards, to multiples
/// of a step of 1, 2 or 5 times a power of ten that the range has at most ten of. Throws sdm::Error unless a
/// range is finite and increasing and a tolerance too, of which one limit may be infinite: none. Cost: O(1).
[[nodiscard]] SDM_API ColorRange color_range(const ColorChoice& choice, const DistanceStatistics& distances);

/// Returns colours that suit two maps: the union of their ranges. If one of them is sequential or diverging,
/// it is diverging if the shorter side of 0 is more than half as long as the other one, and sequential
/// otherwise.
[[nodiscard]] SDM_API ColorRange widest(const ColorRange& a, const ColorRange& b);

/// The parts of a surface of one kind: components, or the groups that its file names.
struct PartTable {
  /// A part.
  struct Row {
    std::string name;  ///< empty for components, and for the faces without a name
    PartStatistics part;
    std::uint32_t first_face = 0;
  };

  std::string kind;       ///< "component", or as FaceNames::kind
  std::size_t count = 0;  ///< of all parts
  std::vector<Row> rows;  ///< the largest by area, the largest first; none if there is only one part
};

/// How the area is distributed over distances and parts.
struct Distribution {
  std::optional<DistanceHistogram> histogram;  ///< nothing without a value
  std::vector<DistanceBand> bands;             ///< none without edges
  std::vector<PartTable> parts;                ///< components first
};

/// Returns the edges of the bands around a tolerance: the limits and their halves and doubles on either side
/// of zero; for a tolerance that does not contain zero, the limits, their middle, and as far again beyond
/// them; of one finite limit, it, its half and its double. Those below zero are omitted if unsigned.
[[nodiscard]] SDM_API std::vector<double> default_bands(const Tolerance& tolerance, bool is_signed);

/// Returns the extreme with the larger |distance|.
[[nodiscard]] SDM_API const Extreme& farthest(const Extremes& extremes);

/// Bounds on the largest |distance| of all points of a surface, not only of its samples.
struct LargestDistance {
  std::optional<double> lower;  ///< nothing if the accuracy is unknown
  std::optional<double> upper;  ///< nothing, too, if a texel is farther than the maximum distance
  std::optional<Vec3> point;    ///< where it is `lower`, but for twice the accuracy
};

/// What a map, or a measured cloud, is summed up to.
struct Summary {
  std::string units{};        ///< of all lengths, as the user names them
  bool of_points = false;     ///< of a cloud: each point counts the same, and there is nothing between points
  bool of_itself = false;     ///< a map of a surface to itself, whose texels say nothing about other points
  bool of_thickness = false;  ///< of the part itself, with a verdict on its samples
  SignUsed sign{};
  MeasuredDistance measured{};
  DistanceStatistics distance{};  ///< an estimate for the surface; exact for a cloud, but for the accuracy
  std::optional<Extremes> extremes{};             ///< nothing without a value
  std::array<std::uint64_t, 2> extreme_points{};  ///< of a cloud: their places in the file, from 0
  std::size_t beyond_max_distance = 0;
  double beyond_fraction = 0;       ///< theirs of the area of all texels, an estimate; or of all points
  std::size_t without_match = 0;    ///< samples without a value, as no face of O2 faces as they do
  std::size_t boundary_texels = 0;  ///< whose closest point lies on the boundary of an open mesh
  double max_distance = kInfinity;  ///< infinite if there is no limit
  Evidence evidence{};              ///< with the accuracy and the error bound
  LargestDistance hausdorff{};      ///< of a map: the one-sided Hausdorff distance
  std::optional<CertifiedVerdict> tolerance{};
  std::optional<Places> places{};              ///< where it deviates most; nothing of wall thickness
  std::optional<Coverage> coverage{};          ///< of O2, if it was asked for
  std::vector<Doubt> doubts{};                 ///< which make a pass Verdict::doubtful, unless accepted
  std::uint64_t exceeding_points = 0;          ///< of a cloud: out of the tolerance, or without a value
  double exceeding_point_fraction = 0;         ///< their fraction of all points
  std::optional<ColorRange> colors{};          ///< nothing of several maps together
  std::optional<Distribution> distribution{};  ///< nothing of clouds, self maps, and several maps together
  std::vector<std::string> notes{};            ///< what the user probably did not intend, a sentence each
};

/// Options of summarize().
struct SummaryOptions {
  std::string units{};
  double max_distance = kInfinity;  ///< that of the map
  double accuracy = 0;              ///< of the engine: engine_accuracy(); infinite if unknown
  double guard = 0;                 ///< how far the meshes may be from the surfaces that are meant
  double uncertainty = 0;           ///< Evidence::uncertainty
  std::optional<Tolerance> tolerance{};
  std::span<const GroupTolerance> table{};  ///< of groups of `names`, for the places
  Colormap colormap = Colormap::automatic;
  std::optional<std::array<double, 2>> range{};  ///< of the colours
  std::optional<ColorRange> colors{};            ///< shared with other maps; excludes the two above
  std::vector<double> bands{};                   ///< edges; empty: default_bands(), if there is a tolerance
  std::span<const FaceNames> names{};            ///< of the faces of `whole`
  const Mesh* whole = nullptr;                   ///< the mesh of which the surface is a part; null: its own
  std::span<const std::uint32_t>
      whole_face{};  ///< the face of `whole` of each of the surface; empty: the same
  const DistanceStatistics* distance = nullptr;  ///< statistics() of the map, if they are known
  std::span<const std::uint8_t> boundary{};      ///< boundary_mask() of the map, if it is known
  std::optional<Coverage> coverage{};            ///< for Summary::coverage
  std::vector<Doubt> doubts{};                   ///< for Summary::doubts
  bool accept_doubts = false;                    ///< a pass stays one
  Progress progress{};                           ///< of the proof of the tolerance
};

inline constexpr const char* kAcceptDoubtsText =
    "PASS stays PASS where units, the alignment, the coverage or thin walls leave a doubt, instead of "
    "DOUBTFUL.";

inline constexpr const char* kUncertaintyText =
    "The expanded uncertainty (k = 2) of the measurement: PASS and FAIL are given where a limit is kept, or "
    "exceeded, by more than that, as by ISO 14253-1, and NOT DECIDED in between.";

template <>
inline constexpr auto kOptions<SummaryOptions> = std::tuple_cat(
    kColorOptions<SummaryOptions>,
    std::tuple{
        Option{.name = "units", .member = &SummaryOptions::units, .text = kUnitsText, .value = "NAME"},
        Option{.name = "bands",
               .member = &SummaryOptions::bands,
               .text = "The edges of the bands of distance in the report, increasing, with the fraction "
                       "of the area in each; by default multiples of the tolerance.",
               .unit = "length",
               .value = "LIST"},
        Option{.name = "accept_doubts", .member = &SummaryOptions::accept_doubts, .text = kAcceptDoubtsText},
        Option{.name = "uncertainty",
               .member = &SummaryOptions::uncertainty,
               .text = kUncertaintyText,
               .range = {.least = 0},
               .unit = "length",
               .value = "U"}});

/// Sums up a map on `surface` of the distances to `sites`. `vertex_distances`: the distance at each vertex of
/// surface.mesh(), NaN if it has no value. Throws sdm::Error if the map or the distances belong to another
/// surface, as color_range() and certify_tolerance() do, and for bands that do not increase; Cancelled. Cost:
/// linear in texels and faces, and that of certify_tolerance(), all cores.
[[nodiscard]] SDM_API Summary summarize(const Surface& surface, const Sites& sites, const DistanceMap& map,
                                        std::span<const float> vertex_distances,
                                        const SummaryOptions& options = {});

/// Sums up a map of a surface to itself: statistics and colours. Errors and cost as of summarize().
[[nodiscard]] SDM_API Summary summarize_self(const Surface& surface, const DistanceMap& map,
                                             const SummaryOptions& options = {});

/// Sums up a map of thickness: statistics, the extremes of the texels, colours, distribution, and the
/// verdict on the texels, which between them is an estimate: without a bound, pass is not certified. Errors
/// and cost as of summarize().
[[nodiscard]] SDM_API Summary summarize_thickness(const Surface& surface, const DistanceMap& map,
                                                  const SummaryOptions& options = {});

/// The summary of several maps, such as those of the UDIM tiles of a mesh, as of one: statistics weighted by
/// area over all of them, the extremes, the largest error bound, and the verdict: Verdict::fail if that of
/// one is, else Verdict::not_decided or Verdict::doubtful if that of one is, else Verdict::pass.
class SDM_API CombinedSummary {
 public:
  /// Adds a map, which need not be kept, and its summary. Throws sdm::Error as CombinedStatistics::add()
  /// does. Cost: linear in texels.
  void add(const Surface& surface, const DistanceMap& map, const Summary& summary);
  /// Returns the summary of all, without distribution, colours and notes. At least one map was added.
  [[nodiscard]] Summary summary() const;

 private:
  CombinedStatistics statistics_;
  Summary total_;
  std::vector<double> areas_, beyond_;
  std::vector<Places> places_;
  std::vector<CertifiedVerdict> verdicts_;
};

/// Returns a sentence if one box is about as many times as large as the other as a unit of length is (10,
/// 25.4, 100, 304.8 or 1000, to 5 %), or more than 1000 times; by the diagonals of the boxes.
[[nodiscard]] SDM_API std::optional<std::string> note_on_sizes(const Box& a, const Box& b);
/// Returns a sentence if the boxes are more than 100 times the size of the larger one apart.
[[nodiscard]] SDM_API std::optional<std::string> note_on_places(const Box& a, const Box& b);
/// Returns both notes, if there are; none for a box that is empty.
[[nodiscard]] SDM_API std::vector<std::string> notes_on(const Box& a, const Box& b);

/// Returns a sentence if walls of a solid are thinner than twice the largest limit: a point is then closer to
/// the one or the other skin, never farther from both than half a wall, so that defects of that size do not
/// show. By estimate_walls(), at least 1 % of the area counts. Nothing for a mesh that bounds no solid.
/// Throws sdm::Error if there is not enough memory. Cost: that of estimate_walls().
[[nodiscard]] SDM_API std::optional<std::string> note_on_walls(const Sites& sites, const Tolerance& tolerance,
                                                               const std::string& units);

/// The same of all tolerances together: that of the whole, and those of the rows whose names faces have.
[[nodiscard]] SDM_API std::optional<std::string> note_on_walls(const Sites& sites,
                                                               const std::optional<Tolerance>& tolerance,
                                                               std::span<const FaceNames> names,
                                                               std::span<const GroupTolerance> table,
                                                               const std::string& units);

/// Returns a sentence if faces of a surface are so small that their direction is noise: where distances go to
/// faces that face the same way, within `facing` degrees, these are measured as their surroundings are (see
/// sdm/closest_points.h). Throws sdm::Error for an angle out of range. Cost: linear.
[[nodiscard]] SDM_API std::optional<std::string> note_on_directions(const Mesh& surface, double facing,
                                                                    const std::string& units);

/// Withholds a pass because of the doubts of the summary, unless they are accepted.
SDM_API void withhold_pass(Summary& summary, bool accept_doubts);

/// The tolerance in words, such as "±0.1 mm", which is "0.1 mm" if distances have no sign, or "at most 2 mm".
[[nodiscard]] SDM_API std::string limits_text(const Tolerance& tolerance, const std::string& units,
                                              bool is_signed);
/// What a PASS or a FAIL adds to its limits: " by more than the uncertainty, 0.02 mm (ISO 14253-1)". Empty
/// for 0.
[[nodiscard]] SDM_API std::string uncertainty_text(double uncertainty, const std::string& units);
/// The verdict as a clause, without its word and without a place: what all outputs say of a verdict that is
/// not decided or doubtful. Empty without a tolerance.
[[nodiscard]] SDM_API std::string verdict_text(const Summary& summary);

/// What follows from a verdict, in sentences; empty where nothing does.
struct NextSteps {
  std::string part{};         ///< what it means for the part, for whoever gets the report
  std::string measurement{};  ///< what would change it, for whoever measures, by options of the command
};

template <>
inline constexpr std::tuple kFields<NextSteps>{
    Field{"part", &NextSteps::part, "What the verdict means for the part; empty without a verdict."},
    Field{"measurement", &NextSteps::measurement,
          "Which options of the command would measure more; empty if none would."}};

/// What follows from the verdict on the tolerance of a summary. Empty without one.
[[nodiscard]] SDM_API NextSteps next_steps(const Summary& summary);

}  // namespace sdm
