#include <sdm/error.h>
#include <sdm/simplify.h>
#include <sdm/sites.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <new>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/memory.h"
#include "core/parallel.h"
#include "core/stopwatch.h"
#include "simplify/certificate.h"
#include "simplify/collapse.h"
#include "simplify/free_placement.h"
#include "simplify/wedges.h"

namespace sdm {
namespace {

using namespace simplify;

// Collapses in several steps mostly deviate less than in one, as each has the errors of a mesh that is
// smoother than that before: on a scan of a bunny reduced to 1 %, by a quarter. With a count, there are two,
// the first of which ends at this multiple of the count; not so on an armadillo reduced to 1 %, so that up to
// this many triangles, where it takes little time, one step is measured, too.
constexpr std::size_t kFirstTriangles = 4, kMostForBoth = 250'000;

// The errors of the steps towards a limit are those of a ladder that does not depend on the limit: relative
// to the size of the mesh, the first one and the factors between them after a step that removed much, and
// after one that removed less than the share that is worth a step. A first step that removes more than a
// share is made smaller.
constexpr double kFirstError = 1e-7, kLarger = 1.15, kMuchLarger = 2, kSmaller = 0.7;
constexpr double kWorthwhile = 0.04, kTooMuch = 0.25;
// Steps whose error is below this share of the limit are not measured before they are to be the result; the
// ladder ends where so many in succession exceed the limit.
constexpr double kSafeError = 0.1;
constexpr int kMostFailures = 4;
constexpr double kMostError = 100;  // relative to the size: nothing else is left to collapse

// A mesh of more triangles than the first number is halved again and again, to at most the second one, before
// there are steps of that ladder or vertices are placed freely.
constexpr std::size_t kLarge = 400'000, kHalved = 100'000;

bool has_area(const Mesh& mesh) {
  return std::ranges::any_of(mesh.triangles, [&](const Triangle& t) {
    const Vec3& a = mesh.positions[t[0]];
    return squared_norm(cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a)) > 0;
  });
}

bool changes_by_rounding(const Mesh& mesh) {
  return std::ranges::any_of(mesh.positions, [](const Vec3& p) {
    return std::ranges::any_of(p, [](double x) { return x != static_cast<float>(x); });
  });
}

// The first face of the region of each face.
std::vector<std::uint32_t> first_faces(const Mesh& mesh, std::span<const std::uint32_t> regions) {
  if (regions.empty()) return {};
  if (regions.size() != mesh.triangles.size()) throw Error("regions need a number for each face of the mesh");
  std::unordered_map<std::uint32_t, std::uint32_t> first;
  std::vector<std::uint32_t> result;
  result.reserve(regions.size());
  for (std::uint32_t f = 0; f < regions.size(); ++f)
    result.push_back(first.try_emplace(regions[f], f).first->second);
  return result;
}

/// Sets the mesh that is left of some wedges.
void set_mesh(Simplified& simplified, const Wedges& wedges, std::span<const Triangle> triangles,
              bool single_precision) {
  auto [mesh, source_faces] = mesh_of(wedges, triangles, single_precision);
  simplified.mesh = std::move(mesh);
  simplified.source_faces = std::move(source_faces);
}

}  // namespace

/// The input, what is made of it once, and the steps of a simplification.
class Simplifier::State {
 public:
  State(const Mesh& mesh, std::span<const std::uint32_t> regions) {
    validate(mesh);
    wedges_ = wedges_of(mesh, first_faces(mesh, regions));
    mesh_ = mesh_of(wedges_, wedges_.triangles, false).mesh;
    mesh_.corner_uvs = {};
  }

  Simplified to_deviation(double limit, const SimplifyOptions& options);
  Simplified to_triangles(std::size_t count, const SimplifyOptions& options);
  [[nodiscard]] const SimplifyReport& report() const { return report_; }

 private:
  /// A mesh on the way: what is left of the wedges, and its deviation, complete or of the points of the
  /// input.
  struct Step : Simplified {
    std::vector<Triangle> triangles;
  };

  /// Makes the sites of the input beside the first collapses. The result has no triangles if none has an
  /// area.
  Step collapsed(const Wedges& wedges, const Step& from, const CollapseLimit& limit,
                 const SimplifyOptions& options);
  /// Collapses in one step after another, each to this multiple of a count; to more where nothing with an
  /// area would be left.
  Step reduced(const Wedges& wedges, const Step& start, std::size_t count,
               std::initializer_list<std::size_t> multiples, const SimplifyOptions& options);
  void measure_input(Step& step, double limit, const SimplifyOptions& options);
  void measure_result(Step& step, double limit, const SimplifyOptions& options);
  void measure(Step& step, const SimplifyOptions& options);
  /// Nothing where vertices are to be kept, or no mesh with fewer triangles is found.
  std::optional<Simplified> freely_placed(double limit, const SimplifyOptions& options);
  /// The start, and meshes of half of the triangles of the one before, down to kHalved.
  std::vector<Step> halved(const Wedges& wedges, const Step& start, const SimplifyOptions& options);
  /// Steps of the ladder, each made from the one before, up to where the limit is exceeded.
  std::vector<Step> coarser(const Wedges& wedges, const Step& start, double limit,
                            const SimplifyOptions& options);
  /// The next step that removes enough, and the error of the one after it. No triangles: there is none.
  Step next_step(const Wedges& wedges, const Step& from, double& error, const SimplifyOptions& options);
  /// The input, or what is to be simplified further, as it is.
  Simplified unchanged(double limit, const SimplifyOptions& options);
  void make_sites();

  Mesh mesh_;  // until there are sites
  Wedges wedges_;
  std::optional<Sites> sites_;
  Simplified start_;  // of free_; no triangles: the input
  std::optional<FreePlacement> free_;
  SimplifyReport report_;
};

void Simplifier::State::make_sites() {
  if (sites_) return;
  Stopwatch watch;
  sites_.emplace(mesh_);
  mesh_ = {};
  report_.sites_ms += watch.lap();
}

Simplifier::State::Step Simplifier::State::collapsed(const Wedges& wedges, const Step& from,
                                                     const CollapseLimit& limit,
                                                     const SimplifyOptions& options) {
  Step step;
  parallel_invoke(
      [&] {
        Stopwatch watch;
        Collapsed result = collapse(wedges, from.triangles, limit);
        step.triangles = std::move(result.triangles);
        step.estimate = from.estimate + result.estimate;
        set_mesh(step, wedges, step.triangles, options.single_precision);
        if (!has_area(step.mesh)) {
          step.mesh = {};
          step.source_faces = {};
          step.triangles.clear();
        }
        report_.collapse_ms += watch.lap();
      },
      [&] { make_sites(); });
  return step;
}

Simplifier::State::Step Simplifier::State::reduced(const Wedges& wedges, const Step& start, std::size_t count,
                                                   std::initializer_list<std::size_t> multiples,
                                                   const SimplifyOptions& options) {
  Step step;
  for (std::size_t most = count; step.triangles.empty() && most < start.triangles.size(); most *= 2) {
    step = start;
    for (const std::size_t multiple : multiples)
      if (step.triangles.size() > multiple * most)
        step = collapsed(wedges, step, {multiple * most, kInfinity}, options);
  }
  return step;
}

void Simplifier::State::measure(Step& step, const SimplifyOptions& options) {
  measure_input(step, kInfinity, options);
  measure_result(step, kInfinity, options);
}

void Simplifier::State::measure_input(Step& step, double limit, const SimplifyOptions& options) {
  Stopwatch watch;
  step.deviation = deviation_of_input(*sites_, step.mesh, {limit, step.estimate}, options.progress);
  report_.deviation_ms += watch.lap();
  ++report_.candidates;
}

void Simplifier::State::measure_result(Step& step, double limit, const SimplifyOptions& options) {
  Stopwatch watch;
  step.deviation =
      with_deviation_of_result(step.deviation, *sites_, step.mesh, {limit, step.estimate}, options.progress);
  report_.deviation_ms += watch.lap();
}

Simplified Simplifier::State::unchanged(double limit, const SimplifyOptions& options) {
  if (options.from != nullptr && !(options.single_precision && changes_by_rounding(options.from->mesh)))
    return *options.from;
  make_sites();
  const Wedges finer =
      options.from != nullptr ? wedges_of(options.from->mesh, options.from->source_faces) : Wedges{};
  const Wedges& wedges = options.from != nullptr ? finer : wedges_;
  Step step;
  set_mesh(step, wedges, wedges.triangles, false);
  step.deviation.certainty = Certainty::exact;
  if (options.single_precision && changes_by_rounding(step.mesh)) {
    set_mesh(step, wedges, wedges.triangles, true);
    if (!has_area(step.mesh))
      throw Error("nothing is left of the mesh when its positions are rounded to float");
    measure_input(step, limit, options);
    measure_result(step, limit, options);
  }
  return step;
}

Simplifier::State::Step Simplifier::State::next_step(const Wedges& wedges, const Step& from, double& error,
                                                     const SimplifyOptions& options) {
  const auto before = static_cast<double>(from.triangles.size());
  const auto left = [&](const Step& step) { return static_cast<double>(step.triangles.size()) / before; };
  // Steps of a large mesh cost most, and those from it to a smaller one are seldom the result.
  constexpr double kMany = 200'000;
  const bool has_many = before > kMany;
  bool is_larger = false;  // than the error of a step that removed too few
  for (; error < kMostError * wedges_.size; error *= kMuchLarger) {
    Step step = collapsed(wedges, from, {0, error}, options);
    if (left(step) > 1 - kWorthwhile) {
      is_larger = true;
      continue;
    }
    if (is_larger && !has_many && left(step) < 1 - kTooMuch) {
      Step smaller = collapsed(wedges, from, {0, kSmaller * error}, options);
      if (left(smaller) <= 1 - kWorthwhile) {
        error *= kSmaller;
        step = std::move(smaller);
      }
    }
    error *= has_many ? kMuchLarger : kLarger;
    return step;
  }
  return {};
}

std::vector<Simplifier::State::Step> Simplifier::State::halved(const Wedges& wedges, const Step& start,
                                                               const SimplifyOptions& options) {
  std::vector<Step> steps{start};
  while (steps.back().triangles.size() > kHalved) {
    const Step& from = steps.back();
    Step step = collapsed(wedges, from, {from.triangles.size() / 2, kMostError * wedges.size}, options);
    if (static_cast<double>(step.triangles.size()) >
            (1 - kWorthwhile) * static_cast<double>(from.triangles.size()) ||
        step.triangles.empty())
      break;
    steps.push_back(std::move(step));
  }
  return steps;
}

// The mesh that is the result for a limit is the last one on the way that keeps it. The way is the same for
// all limits, and the part of it that is looked at grows with the limit, as does the set of meshes that keep
// it: a larger limit never leaves more triangles.
std::vector<Simplifier::State::Step> Simplifier::State::coarser(const Wedges& wedges, const Step& start,
                                                                double limit,
                                                                const SimplifyOptions& options) {
  std::vector<Step> steps;
  double error = kFirstError * wedges_.size;
  if (start.triangles.size() > kLarge) {
    steps = halved(wedges, start, options);
    if (steps.size() > 1) error = kLarger * (steps.back().estimate - steps[steps.size() - 2].estimate);
    steps.erase(steps.begin());
    // Vertices are placed freely from the last of these on: no limit that it exceeds has fewer triangles.
    if (free_ && free_->is_possible() && !options.keep_vertices) return steps;
  }
  std::size_t kept = steps.size();  // steps up to the last one that may keep the limit
  for (int failures = 0; failures < kMostFailures;) {
    Step step = next_step(wedges, steps.empty() ? start : steps.back(), error, options);
    if (step.triangles.empty()) break;
    bool passes = true;
    if (error / kLarger >= kSafeError * limit) {
      measure_input(step, limit, options);
      passes = step.deviation.upper <= limit;
    }
    failures = passes ? 0 : failures + 1;
    steps.push_back(std::move(step));
    if (passes) kept = steps.size();
  }
  steps.resize(kept);
  return steps;
}

std::optional<Simplified> Simplifier::State::freely_placed(double limit, const SimplifyOptions& options) {
  const bool has_seams = !wedges_.uvs.empty() || wedges_.vertex.size() > wedges_.positions.size();
  if (options.keep_vertices || has_seams) return {};
  if (!free_) {
    if (wedges_.triangles.size() > kLarge) {
      Step start;
      start.triangles = wedges_.triangles;
      start = halved(wedges_, start, {.progress = options.progress}).back();
      start_ = std::move(static_cast<Simplified&>(start));
    }
    make_sites();
    Stopwatch watch;
    free_.emplace(start_.mesh.triangles.empty() ? sites_->mesh() : start_.mesh, *sites_, wedges_.size);
    report_.collapse_ms += watch.lap();
  }
  if (!free_->is_possible()) return {};
  if (!start_.mesh.triangles.empty()) {
    double& upper = start_.deviation.upper;
    if (!(upper > 0 && upper <= limit))
      upper = deviation_of_input(*sites_, start_.mesh, {limit, start_.estimate}, options.progress).upper;
    if (upper > limit) return {};
  }
  Simplified result = free_->to_deviation(limit, options, report_);
  if (result.mesh.triangles.empty() || !has_area(result.mesh)) return {};
  if (options.from != nullptr && result.mesh.triangles.size() > options.from->mesh.triangles.size())
    return {};
  for (std::uint32_t& face : result.source_faces)
    if (!wedges_.regions.empty())
      face = start_.source_faces.empty() ? wedges_.regions[wedges_.triangles[face][0]]
                                         : start_.source_faces[face];
  if (wedges_.regions.empty()) result.source_faces.clear();
  return result;
}

Simplified Simplifier::State::to_deviation(double limit, const SimplifyOptions& options) {
  if (std::optional<Simplified> result = freely_placed(limit, options)) return std::move(*result);
  const Wedges finer =
      options.from != nullptr ? wedges_of(options.from->mesh, options.from->source_faces) : Wedges{};
  const Wedges& wedges = options.from != nullptr ? finer : wedges_;
  Step start;
  start.triangles = wedges.triangles;
  if (options.from != nullptr) start.estimate = options.from->estimate;
  std::vector<Step> steps = coarser(wedges, start, limit, options);
  for (; !steps.empty(); steps.pop_back()) {
    Step& step = steps.back();
    if (!(step.deviation.upper > 0)) measure_input(step, limit, options);
    if (step.deviation.upper > limit) continue;
    measure_result(step, limit, options);
    if (step.deviation.upper <= limit) return std::move(step);
  }
  Simplified result = unchanged(limit, options);
  result.stopped = true;
  if (result.deviation.upper <= limit) return result;
  throw Error(
      options.from != nullptr
          ? "the mesh to go on from deviates by more than the limit"
          : "the positions of the mesh rounded to float are not certain to deviate by the limit at most");
}

Simplified Simplifier::State::to_triangles(std::size_t count, const SimplifyOptions& options) {
  const Wedges finer =
      options.from != nullptr ? wedges_of(options.from->mesh, options.from->source_faces) : Wedges{};
  const Wedges& wedges = options.from != nullptr ? finer : wedges_;
  if (wedges.triangles.size() <= count) return unchanged(kInfinity, options);
  Step start;
  start.triangles = wedges.triangles;
  if (options.from != nullptr) start.estimate = options.from->estimate;
  Step step = reduced(wedges, start, count, {kFirstTriangles, 1}, options);
  const bool none = step.triangles.empty() || step.triangles.size() == start.triangles.size();
  Simplified result;
  if (none) {
    result = unchanged(kInfinity, options);
  } else {
    measure(step, options);
    const std::size_t before = start.triangles.size();
    if (before > kFirstTriangles * count && before <= kMostForBoth) {
      Step other = reduced(wedges, start, count, {1}, options);
      if (other.triangles.size() <= std::max(count, step.triangles.size()) && !other.triangles.empty()) {
        measure(other, options);
        if (other.deviation.upper < step.deviation.upper) step = std::move(other);
      }
    }
    result = std::move(step);
  }
  result.stopped = result.mesh.triangles.size() > count;
  return result;
}

Simplifier::Simplifier(const Mesh& mesh, std::span<const std::uint32_t> regions) try
    : state_(std::make_unique<State>(mesh, regions)) {
} catch (const std::bad_alloc&) {
  throw out_of_memory("simplification");
}
Simplifier::~Simplifier() = default;
Simplifier::Simplifier(Simplifier&&) noexcept = default;
Simplifier& Simplifier::operator=(Simplifier&&) noexcept = default;

Simplified Simplifier::to_deviation(double max_deviation, const SimplifyOptions& options) try {
  if (!(max_deviation > 0 && std::isfinite(max_deviation)))
    throw Error("the largest deviation of a simplified mesh must be a number greater than 0");
  return state_->to_deviation(max_deviation, options);
} catch (const std::bad_alloc&) {
  throw out_of_memory("simplification");
}

Simplified Simplifier::to_triangles(std::size_t triangles, const SimplifyOptions& options) try {
  if (triangles == 0) throw Error("a simplified mesh must be allowed at least one triangle");
  return state_->to_triangles(triangles, options);
} catch (const std::bad_alloc&) {
  throw out_of_memory("simplification");
}

const SimplifyReport& Simplifier::report() const {
  return state_->report();
}

SimplifiedLevels simplify_levels(const Mesh& mesh, const LevelsOptions& options) {
  check_options(options);
  if (!options.max_deviation && !options.triangles)
    throw Error("a simplification needs max_deviation or triangles");
  Simplifier simplifier(mesh, options.regions);
  SimplifiedLevels result;
  std::vector<Simplified>& levels = result.levels;
  levels.reserve(options.lods + std::size_t{1});
  for (std::uint32_t level = 0; level <= options.lods; ++level) {
    const SimplifyOptions of_level{.from = levels.empty() ? nullptr : &levels.back(),
                                   .single_precision = options.single_precision,
                                   .keep_vertices = options.keep_vertices,
                                   .progress = options.progress};
    const double factor = std::ldexp(1, static_cast<int>(level));
    if (options.max_deviation) {
      levels.push_back(simplifier.to_deviation(factor * *options.max_deviation, of_level));
    } else {
      const double count = std::max(1.0, static_cast<double>(*options.triangles) / factor);
      levels.push_back(simplifier.to_triangles(static_cast<std::size_t>(count), of_level));
    }
  }
  result.report = simplifier.report();
  return result;
}

}  // namespace sdm
