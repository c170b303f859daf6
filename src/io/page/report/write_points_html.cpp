#include <sdm/points.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/memory.h"
#include "geometry/vec.h"
#include "io/file/atomic_file.h"
#include "io/file/input_files.h"
#include "io/page/report/embedded_page.h"
#include "io/page/report/largest_by_cell.h"
#include "io/page/report/packed_arrays.h"
#include "io/page/report/page_file.h"
#include "io/page/report/page_ghost.h"
#include "io/page/report/page_numbers.h"
#include "io/points/measured_rows.h"

namespace sdm {

using namespace io;

namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kPagePoints = 150'000;
// Steps in the longest side of the box, as a power of two: more than for meshes, as clouds have outliers far
// away.
constexpr int kStepBits = 26;

struct Shown {
  std::uint64_t number;
  MeasuredPoint point;
};

/// One number of each of `parts` runs of equal length, at a pseudorandom place in it.
class Picks {
 public:
  Picks(std::uint64_t count, std::uint64_t parts) : count_(count), parts_(parts) { advance(); }
  /// Whether a number is shown; called with ascending numbers.
  bool operator()(std::uint64_t number) {
    if (part_ >= parts_ || number != next_) return false;
    ++part_;
    advance();
    return true;
  }

 private:
  void advance() {
    // count · part does not overflow: a file has less than 2^46 points.
    const std::uint64_t begin = count_ * part_ / parts_, end = count_ * (part_ + 1) / parts_;
    if (begin < end) next_ = begin + mixed(part_) % (end - begin);
  }
  // The finaliser of SplitMix64.
  static std::uint64_t mixed(std::uint64_t x) {
    x += 0x9E3779B97F4A7C15u;
    x = (x ^ x >> 30) * 0xBF58476D1CE4E5B9u;
    x = (x ^ x >> 27) * 0x94D049BB133111EBu;
    return x ^ x >> 31;
  }

  std::uint64_t count_, parts_, part_ = 0, next_ = 0;
};

/// What a page has of a cloud.
struct Contents {
  std::vector<Shown> shown;  ///< by their numbers
  std::size_t picked = 0;    ///< of them, in the random sample
  AreaByValue by_value;
};

/// The box of all but the outermost 1 % of the points along each axis, and what is near it: outliers may be
/// far away.
Box usual_box(std::span<const Shown> sample, const Box& all) {
  Box box = all;
  for (int k = 0; k < 3 && sample.size() > 1; ++k) {
    std::vector<double> along;
    for (const Shown& s : sample) along.push_back(s.point.point[k]);
    std::ranges::sort(along);
    const std::size_t outside = along.size() / 200;
    const double least = along[outside], most = along[along.size() - 1 - outside];
    const double margin = 0.1 * (most - least);
    box.lower[k] = std::max(all.lower[k], least - margin);
    box.upper[k] = std::min(all.upper[k], most + margin);
  }
  return box;
}

Contents contents_of(MeasuredRows& rows, const PointDistances& found) {
  Contents result;
  AreaSums sums(found.min ? found.min->distance : 0, found.max ? found.max->distance : 0);
  Picks picks(found.points, std::min(found.points, kPagePoints));
  rows.for_each([&](std::uint64_t number, const MeasuredPoint& p) {
    const bool picked = picks(number);
    if (!finite(p.point)) return;
    if (picked) result.shown.push_back({number, p});
    if (!std::isfinite(p.distance)) return;
    sums.add(p.distance, 1);
  });
  LargestByCell cells(usual_box(result.shown, found.bounds));
  rows.for_each([&](std::uint64_t number, const MeasuredPoint& p) {
    if (finite(p.point)) cells.add({p.distance, p.point, number});
  });
  sums.add_without_value(static_cast<double>(found.beyond_max_distance + found.without_match));
  result.picked = result.shown.size();
  result.by_value = sums.fractions();

  // The largest of each neighbourhood, and the extremes.
  std::vector<std::uint64_t> more;
  for (const CellPlace& place : cells.largest()) more.push_back(place.sample);
  if (found.min && found.max) more.insert(more.end(), {found.min->index, found.max->index});
  std::ranges::sort(more);
  more.erase(std::ranges::unique(more).begin(), more.end());
  for (const std::uint64_t number : more)
    if (!std::ranges::binary_search(std::span(result.shown).first(result.picked), number, {}, &Shown::number))
      result.shown.push_back({number, rows.read(number)});
  std::ranges::sort(result.shown, {}, &Shown::number);
  return result;
}

/// The normal of the point, or that of its closest face.
std::optional<Vec3f> shading_normal(const MeasuredPoint& p, const Mesh* other) {
  const auto usable = [](const Vec3& n) { return squared_norm(n) > 0 && finite(n); };
  const auto unit = [](const Vec3& n) {
    const Vec3 u = normalized(n);
    return Vec3f{static_cast<float>(u[0]), static_cast<float>(u[1]), static_cast<float>(u[2])};
  };
  if (const Vec3 n{p.normal[0], p.normal[1], p.normal[2]}; usable(n)) return unit(n);
  if (!other || p.face >= other->triangles.size()) return std::nullopt;
  const auto& [a, b, c] = other->triangles[p.face];
  const Vec3 n = cross(other->positions[b] - other->positions[a], other->positions[c] - other->positions[a]);
  if (!usable(n)) return std::nullopt;
  return unit(n);
}

/// Arrays: `position` (three a point, in steps), `distance` and `face` (differences; kNone without one),
/// `normal` (1 + octahedral, 0 without one), `number` (differences) and, if some do not fit, `number_high`.
Json add_cloud(PackedArrays& arrays, std::span<const Shown> shown, const Box& box, const Mesh* other) {
  const Steps steps(box, kStepBits);
  std::vector<std::uint32_t> position, distance, face, normal, low, high;
  for (const auto& [number, p] : shown) {
    for (int k = 0; k < 3; ++k) position.push_back(steps(p.point, k));
    distance.push_back(ordered(p.distance));
    face.push_back(p.face);
    const auto n = shading_normal(p, other);
    normal.push_back(n ? octahedral(*n) + 1 : 0);
    low.push_back(static_cast<std::uint32_t>(number));
    high.push_back(static_cast<std::uint32_t>(number >> 32));
  }
  arrays.add_differences("position", position, 3);
  arrays.add("distance", std::move(distance));
  arrays.add_differences("face", face);
  arrays.add("normal", std::move(normal));
  arrays.add_differences("number", low);
  if (std::ranges::any_of(high, [](std::uint32_t h) { return h > 0; })) arrays.add("number_high", high);
  return steps.json();
}

}  // namespace

void write_points_html(const std::filesystem::path& file, const std::filesystem::path& ply,
                       const PointDistances& found, const std::string& report,
                       const HtmlOptions& options) try {
  require_other_file(file, ply);
  AtomicFile out(file);
  MeasuredRows rows(ply, found.points, found.has_normals);
  const Contents contents = contents_of(rows, found);
  PackedArrays arrays;
  Json page = common_json(options.up);
  Box box = found.bounds;
  if (contents.shown.empty()) box = {{0, 0, 0}, {1, 1, 1}};
  page["cloud"] = add_cloud(arrays, contents.shown, box, options.other);
  page["cloud"]["points"] = found.points - found.invalid;
  page["cloud"]["picked"] = contents.picked;
  page["cloud"]["normals"] = found.has_normals;
  if (options.other)
    page["ghost"] = add_ghost(arrays, *options.other, options.coverage, options.triangles_of_other);
  page["area"] = add_area(arrays, contents.by_value);
  compress(arrays);
  put_page(out.stream(), kPageHtml.bytes, page, &report, arrays);
  out.commit();
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing " + file.string());
}

}  // namespace sdm
