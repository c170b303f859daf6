#include "map/along_measure.h"

#include <sdm/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <new>
#include <string>

#include "closest/facing/facing_normals.h"
#include "core/memory.h"
#include "geometry/vec.h"
#include "rays/trace.h"

namespace sdm {
namespace map {
namespace {

constexpr double kParallel = 1e-12;  // products of unit vectors up to here count as 0

Vec3 unit_vector(const Vec3& d) {
  const double largest = std::max({std::abs(d[0]), std::abs(d[1]), std::abs(d[2])});
  Vec3 scaled;
  for (int k = 0; k < 3; ++k) scaled[k] = d[k] / largest;
  return normalized(scaled);
}

class LineSearch final : public FaceSearch {
 public:
  LineSearch(const sites::SitesData& sites, const std::optional<Vec3>& direction, double max_distance)
      : sites_(sites), direction_(direction), max_distance_(max_distance) {}

  // Traces the packet, whose points have no normal if the direction is given: among all faces.
  void start(std::span<const Sample> samples) override {
    samples_ = samples;
    hits_.resize(2 * samples.size());
    rays_.clear();
    towards_.clear();
    for (const Sample& sample : samples) {
      const Vec3 u = line_of(sample), m = sample.normal.value_or(u);
      const bool measured = u != Vec3{} && std::abs(dot(m, u)) > kParallel;
      const double t_max = measured ? kInfinity : -1;  // -1: no hit
      rays_.push_back({.origin = sample.point, .direction = u, .t_max = t_max});
      rays_.push_back({.origin = sample.point, .direction = -1.0 * u, .t_max = t_max});
      towards_.push_back(dot(m, u) > 0 ? u : -1.0 * u);
    }
    const auto faces_alike = [&](std::size_t ray, std::uint32_t face) {
      return !samples_[ray / 2].normal || dot(normal_of(face), towards_[ray / 2]) > kParallel;
    };
    rays::first_hits(sites_, rays_, rays::filter(faces_alike), scratch_, hits_.data());
  }

  Value value(std::size_t i) override {
    const bool ahead = hits_[2 * i].t <= hits_[2 * i + 1].t;
    const RayHit& hit = hits_[ahead ? 2 * i : 2 * i + 1];
    if (hit.face == kNone) return {.unmatched = true};
    if (!(hit.t <= max_distance_)) return {};
    const Vec3 vector = (ahead ? hit.t : -hit.t) * line_of(samples_[i]);
    return {.closest = {.point = samples_[i].point + vector,
                        .distance = hit.t,
                        .site = hit.face,
                        .type = SiteType::face,
                        .face = hit.face},
            .vector = vector,
            // (p − q)·n has the sign of −vector·n.
            .negative = dot(vector, normal_of(hit.face)) > 0};
  }

 private:
  [[nodiscard]] Vec3 normal_of(std::uint32_t face) const { return facing::outward_normal(sites_, face); }
  [[nodiscard]] Vec3 line_of(const Sample& sample) const { return direction_ ? *direction_ : *sample.normal; }

  const sites::SitesData& sites_;
  const std::optional<Vec3>& direction_;
  double max_distance_;
  std::span<const Sample> samples_;
  rays::Scratch scratch_;
  std::vector<Ray> rays_;
  std::vector<Vec3>
      towards_;  // of each sample: products of normals with it are positive where faces face alike
  std::vector<RayHit> hits_;
};

}  // namespace

AlongMeasure::AlongMeasure(const Sites& sites, const AlongOptions& options)
    : sites_(internals(sites)), max_distance_(options.max_distance) {
  check_options(options);
  if (options.direction) direction_ = unit_vector(*options.direction);
  description.measured = measured_distance(options);
  description.sign = {SignMethod::side, "the side of the face that the line hits"};
  progress = options.progress;
}

AlongMeasure::AlongMeasure(const Mesh& mesh, const Sites& sites, const AlongOptions& options)
    : AlongMeasure(sites, options) {
  normals = facing::outward_normals(mesh);
  if (direction_) group_by_side();
}

// What faces alike depends on the sign of m·u only.
void AlongMeasure::group_by_side() {
  for (const Vec3& m : normals) {
    const double product = dot(m, *direction_);
    groups.push_back(product > kParallel ? 0 : product < -kParallel ? 1 : 2);
  }
}

std::unique_ptr<FaceSearch> AlongMeasure::search() const {
  return std::make_unique<LineSearch>(sites_, direction_, max_distance_);
}

}  // namespace map

MeasuredDistance measured_distance(const AlongOptions& options, const std::string& sample) {
  MeasuredDistance measured{.kind = DistanceKind::along, .settings = settings_of(options)};
  if (!options.direction) {
    measured.text = "distance along the normal of the " + sample + ", to both sides";
    return measured;
  }
  std::array<char, 160> text{};
  const Vec3& d = *options.direction;
  std::snprintf(text.data(), text.size(), "distance along the direction (%.6g %.6g %.6g), to both sides",
                d[0], d[1], d[2]);
  measured.text = text.data();
  return measured;
}

FacingPoints closest_points_along(const Sites& sites, std::span<const Vec3> points,
                                  std::span<const Vec3> normals, const AlongOptions& options) try {
  const map::AlongMeasure measure(sites, options);
  if (normals.size() != points.size() && !(options.direction && normals.empty()))
    throw Error("distances along lines need one normal for each point, or a direction");
  if (!std::ranges::all_of(points, finite)) throw Error("points to measure from must be finite");
  return map::measure_points(points, normals, measure);
} catch (const std::bad_alloc&) {
  throw out_of_memory("the distances along lines of points");
}

}  // namespace sdm
