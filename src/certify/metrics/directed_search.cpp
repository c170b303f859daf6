#include "certify/metrics/directed_search.h"

#include <sdm/error.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "certify/hausdorff/vertex_search.h"
#include "certify/metrics/surface_points.h"
#include "core/cancellation.h"
#include "core/parallel.h"
#include "geometry/rounding.h"
#include "geometry/spatial_order.h"

namespace sdm::metrics {
namespace {

constexpr std::size_t kGrain = 256;
constexpr double kLeastSize = 1e-9;  // of the diagonal: smaller parts are not divided
// Parts that are smaller beside their distance, squared, have a close bound by their size.
constexpr double kNear = 1e-4;
// How many parts are in memory at once: at least kAtOnce or twice as many as there are faces, and up to
// kOfFace for each face of the finer mesh or kMany. Where more are needed, parts are bounded in runs of kRun,
// one after another, which takes some three times as long, and only sums of them are kept.
constexpr std::size_t kAtOnce = std::size_t{1} << 16, kOfFace = 32, kMany = std::size_t{1} << 20, kRun = 1024;

/// The vertices of A that have a face, measured.
std::vector<MeasuredPoint> measure_vertices(const Mesh& a, const sites::SitesData& b, double accuracy,
                                            const Progress& progress) {
  std::vector<std::uint8_t> used(a.positions.size());
  for (const Triangle& t : a.triangles)
    if (!hausdorff::repeats_corner(t))
      for (const std::uint32_t v : t) used[v] = 1;
  std::vector<Vec3> points, sorted;
  std::vector<std::uint32_t> vertex;
  for (std::uint32_t v = 0; v < used.size(); ++v)
    if (used[v]) {
      points.push_back(a.positions[v]);
      vertex.push_back(v);
    }
  const std::vector<std::uint32_t> order = spatial_order(points);
  sorted.reserve(points.size());
  for (const std::uint32_t i : order) sorted.push_back(points[i]);
  const std::vector<MeasuredPoint> measured = measure(b, sorted, accuracy, progress);
  std::vector<MeasuredPoint> result(a.positions.size());
  for (std::size_t i = 0; i < order.size(); ++i) result[vertex[order[i]]] = measured[i];
  return result;
}

std::size_t most_parts(const Mesh& a, const MetricsOptions& options) {
  constexpr std::size_t kMost = std::size_t{1} << 31;
  return a.triangles.size() + std::min(options.most_parts, kMost);
}

}  // namespace

DirectedSearch::DirectedSearch(const Mesh& a, const sites::SitesData& b, const MetricsOptions& options,
                               const Scale& scale)
    : a_(a), b_(b), options_(options), scale_(scale), most_parts_(most_parts(a, options)) {}

DirectedMetrics DirectedSearch::run() {
  make_parts();
  const std::size_t faces = a_.triangles.size(), most_faces = std::max(faces, b_.mesh.triangles.size());
  const std::size_t at_once =
      std::min(most_parts_, std::max({kAtOnce, 2 * faces, std::min(kMany, kOfFace * most_faces)}));
  Refined refined = Refined::yes;
  while (refined == Refined::yes) {
    sum_up();
    refined = refine(choose(), at_once);
  }
  if (refined == Refined::too_many && at_once < most_parts_) refine_in_runs();
  sums_.normal_consistency = std::min(1.0, (settled_.consistency + consistency()) / sums_.area);
  return sums_;
}

// A run may have the same share of what is asked for as it has of the area.
void DirectedSearch::refine_in_runs() {
  const std::vector<FacePart> all = std::move(parts_);
  in_runs_ = true;
  settled_.percentiles.clear();
  for (const BoundedNumber& percentile : sums_.percentiles) settled_.percentiles.emplace_back(percentile);
  settled_.within.resize(options_.tolerances.size());
  for (std::size_t begin = 0; begin < all.size(); begin += kRun) {
    const std::size_t end = std::min(all.size(), begin + kRun);
    parts_.assign(all.begin() + static_cast<std::ptrdiff_t>(begin),
                  all.begin() + static_cast<std::ptrdiff_t>(end));
    area_ = 0;
    for (const FacePart& part : parts_) area_ += part.area;
    const auto share = static_cast<double>(end - begin) / static_cast<double>(all.size());
    const auto most = static_cast<std::size_t>(share * static_cast<double>(most_parts_));
    while (refine(choose(), most) == Refined::yes) {
    }
    settle();
  }
  parts_.clear();
  sum_up();
}

void DirectedSearch::settle() {
  add_means(parts_, settled_.means);
  for (std::size_t i = 0; i < options_.tolerances.size(); ++i)
    add_within(parts_, limit(options_.tolerances[i]), settled_.within[i]);
  for (Steps& steps : settled_.percentiles)
    if (steps.bounds.lower < steps.bounds.upper)
      for (const FacePart& part : parts_) steps.add(part);
  settled_.consistency += consistency();
}

void DirectedSearch::make_parts() {
  const std::vector<MeasuredPoint> vertices = measure_vertices(a_, b_, scale_.accuracy, options_.progress);
  parts_.reserve(a_.triangles.size());
  CompensatedSum area_of_all, error;
  for (std::uint32_t f = 0; f < a_.triangles.size(); ++f) {
    const Triangle& t = a_.triangles[f];
    if (hausdorff::repeats_corner(t)) continue;
    const auto [area, rounding] = area_of(corners_of(a_, f));
    if (!(area > 0)) continue;
    error += rounding;
    parts_.push_back({.corner = {vertices[t[0]], vertices[t[1]], vertices[t[2]]}, .face = f, .area = area});
    area_of_all += area;
  }
  if (parts_.empty()) throw Error("the faces of a mesh have no area: there are no average distances");
  sums_.area = area_ = area_of_all.value();
  rounding_ = kDoubleRounding + 2 * error.value() / sums_.area;
  std::vector<std::size_t> all(parts_.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  bound_by_middles(all);
}

double DirectedSearch::width(const BoundedNumber& number) const {
  using O = MetricsOptions;
  const double usual =
      std::max(O::kRelative * number.lower, std::min(O::kOfNear * number.lower, O::kNear * scale_.size));
  return std::max(options_.precision.value_or(usual), O::kLeast * scale_.size);
}

// Parts that together contribute half of what is asked for need not be bounded more closely. Of the others,
// those that contribute most are, until half of what they contribute is enough.
void DirectedSearch::choose_by_share(const std::vector<double>& contributions, double target,
                                     Chosen& chosen) const {
  double total = 0;
  for (const double c : contributions) total += c;
  if (total <= target) return;
  const double share = target / (2 * static_cast<double>(contributions.size()));
  Chosen is_large(contributions.size());
  for_each_part([&](std::size_t i) { is_large[i] = contributions[i] > share && can_be_closer(parts_[i]); });
  std::vector<std::uint32_t> large;
  double of_large = 0;
  for (std::uint32_t i = 0; i < contributions.size(); ++i)
    if (is_large[i]) {
      large.push_back(i);
      of_large += contributions[i];
    }
  constexpr double kLess = 0.8, kLeft = 0.5;  // of what is asked for; of the contribution of a part
  const double surplus = total - kLess * target;
  if (kLeft * of_large > surplus)
    std::ranges::sort(large, [&](std::uint32_t i, std::uint32_t j) {
      return contributions[i] != contributions[j] ? contributions[i] > contributions[j] : i < j;
    });
  double less = 0;
  for (const std::uint32_t i : large) {
    if (less > surplus) break;
    less += kLeft * contributions[i];
    chosen[i] = 1;
  }
}

// A percentile is as close as the bounds of the parts whose distances may be equal to it. Those that are far
// apart come first: they may turn out to have other distances.
void DirectedSearch::choose_around(const BoundedNumber& percentile, Chosen& chosen) const {
  const double found = percentile.upper - percentile.lower, asked = width(percentile);
  if (found <= asked) return;
  const double enough = std::max(asked / 2, in_runs_ ? 0 : found / 4);
  for_each_part([&](std::size_t i) {
    const FacePart& part = parts_[i];
    if (!chosen[i] && part.upper().largest() >= percentile.lower &&
        part.lower().least() <= percentile.upper && part.gap() > enough)
      chosen[i] = 1;
  });
}

DirectedSearch::Chosen DirectedSearch::choose() const {
  poll();
  Chosen chosen(parts_.size());
  std::vector<double> contributions(parts_.size());
  const auto choose = [&](double target, const auto& difference) {
    for_each_part([&](std::size_t i) {
      contributions[i] = parts_[i].area * difference(parts_[i].lower(), parts_[i].upper());
    });
    choose_by_share(contributions, target * area_, chosen);
  };
  if (const double found = sums_.mean.upper - sums_.mean.lower, asked = width(sums_.mean);
      !in_runs_ || found > asked)
    choose(asked, [](const TwoSided& low, const TwoSided& high) { return high.mean() - low.mean(); });
  if (const double found = sums_.rms.upper - sums_.rms.lower, asked = width(sums_.rms); found > asked)
    choose(asked * (sums_.rms.lower + sums_.rms.upper),
           [](const TwoSided& low, const TwoSided& high) { return high.mean_square() - low.mean_square(); });
  for (std::size_t i = 0; i < options_.tolerances.size(); ++i)
    if (!in_runs_ || sums_.within[i].upper - sums_.within[i].lower > options_.fraction_precision)
      choose(options_.fraction_precision,
             [&, t = limit(options_.tolerances[i])](const TwoSided& low, const TwoSided& high) {
               return low.fraction_within(t) - high.fraction_within(t);
             });
  for (const BoundedNumber& percentile : sums_.percentiles) choose_around(percentile, chosen);
  return chosen;
}

void DirectedSearch::for_each_part(const std::function<void(std::size_t)>& visit) const {
  parallel_for(parts_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) visit(i);
  });
}

bool DirectedSearch::can_be_thorough(const FacePart& part) {
  return !part.thorough && part.squared_size() > kNear * part.upper().least() * part.upper().least();
}

bool DirectedSearch::can_be_closer(const FacePart& part) const {
  const double least = kLeastSize * scale_.size;
  return part.gap() > part.closest_bounds(scale_.accuracy) &&
         (can_be_thorough(part) || part.squared_size() > least * least);
}

DirectedSearch::Refined DirectedSearch::refine(const Chosen& chosen, std::size_t most) {
  std::vector<std::size_t> thorough, divided;
  Chosen closer(parts_.size());
  for_each_part([&](std::size_t i) { closer[i] = chosen[i] && can_be_closer(parts_[i]); });
  for (std::size_t i = 0; i < parts_.size(); ++i)
    if (closer[i]) (can_be_thorough(parts_[i]) ? thorough : divided).push_back(i);
  parallel_for(thorough.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) bound_thoroughly(b_, parts_[thorough[n]]);
  });
  const bool too_many = parts_.size() + 2 * divided.size() > most;
  if (too_many) divided.resize((most - std::min(most, parts_.size())) / 2);
  divide(divided);
  if (!thorough.empty() || !divided.empty()) return Refined::yes;
  return too_many ? Refined::too_many : Refined::no;
}

void DirectedSearch::divide(const std::vector<std::size_t>& divided) {
  std::vector<Cut> cuts(divided.size());
  parallel_for(divided.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) cuts[n] = choose_cut(b_, parts_[divided[n]]);
  });
  std::vector<Vec3> points;
  for (std::size_t n = 0; n < divided.size(); ++n) {
    const std::array<Vec3, 2> at = cuts[n].of(parts_[divided[n]]);
    points.insert(points.end(), at.begin(), at.begin() + cuts[n].points);
  }
  const std::vector<MeasuredPoint> measured = measure(b_, points, scale_.accuracy, options_.progress);
  std::vector<std::size_t> changed;
  std::span<const MeasuredPoint> left = measured;
  for (std::size_t n = 0; n < divided.size(); ++n) {
    const std::vector<FacePart> all = pieces(parts_[divided[n]], cuts[n], left);
    left = left.subspan(static_cast<std::size_t>(cuts[n].points));
    parts_[divided[n]] = all.front();
    changed.push_back(divided[n]);
    for (std::size_t k = 1; k < all.size(); ++k) {
      changed.push_back(parts_.size());
      parts_.push_back(all[k]);
    }
  }
  bound_by_middles(changed);
}

void DirectedSearch::bound_by_middles(const std::vector<std::size_t>& numbers) {
  std::vector<Vec3> points;
  points.reserve(numbers.size());
  for (const std::size_t i : numbers) points.push_back(parts_[i].middle());
  const std::vector<MeasuredPoint> middles =
      measure(b_, points, scale_.accuracy, options_.progress, kFarFace);
  parallel_for(numbers.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      FacePart& part = parts_[numbers[n]];
      part.nearest = middles[n].nearest;
      bound(b_, part);
    }
  });
}

}  // namespace sdm::metrics
