#include <sdm/error.h>
#include <sdm/proximity.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/parallel.h"
#include "core/vec.h"
#include "engine/engine.h"
#include "mesh/validate.h"
#include "query/contacts.h"
#include "query/local_distances.h"
#include "query/solid.h"

namespace sdm {
namespace {

// A sample of one of the bodies.
struct Sample {
  int body = 0;
  std::size_t index = kNone;
};

}  // namespace

struct Query::Impl {
  struct Body {
    Surface surface;
    Sites sites;
    LocalDistances distances{};  // to the other body
  };
  std::array<Body, 2> bodies;
  ProximityOptions options;
  std::array<SignMethod, 2> sign{};  // of the distances of each body's samples
  ContactFinder finder;
  PairWorkspace workspace;

  // What has been found since the last update.
  bool measured = false;
  double precision = 0;               // of a distance
  std::optional<Separation> closest;  // of the triangles
  std::optional<Length> separation;
  std::optional<Decision> colliding;
  bool depth_found = false;
  std::optional<Length> depth;
  std::optional<std::span<const Contact>> contacts;

  Impl(Mesh o1, Mesh o2, const ProximityOptions& asked)
      : bodies{Body{Surface(o1, asked.atlas), Sites(o1)}, Body{Surface(o2, asked.atlas), Sites(o2)}},
        options(asked) {
    for (int b = 0; b < 2; ++b) sign[b] = choose_sign(bodies[1 - b].sites, SignMethod::automatic).method;
  }

  void forget() {
    measured = depth_found = false;
    closest.reset(), separation.reset(), colliding.reset(), depth.reset(), contacts.reset();
  }

  [[nodiscard]] bool solid(int body) const { return sign[1 - body] != SignMethod::none; }

  void measure() {
    if (std::exchange(measured, true)) return;
    Box box = bounds(bodies[0].surface.mesh());
    extend(box, bounds(bodies[1].surface.mesh()));
    precision = 1e-6 * diagonal(box);
    for (int b = 0; b < 2; ++b) bodies[b].distances.probe(bodies[b].surface, bodies[1 - b].sites, sign[b]);
    // What is nearer matters for contacts, for depth, and unless the triangles tell it, for the separation.
    double reach = options.contact_margin;
    if (!options.exact)
      reach =
          std::max(reach, std::min(bodies[0].distances.least_probed(), bodies[1].distances.least_probed()));
    reach += precision;
    for (Body& body : bodies) body.distances.measure(reach);
  }

  // The least of value(distance, covering radius) of all samples measured, and where.
  template <class Value>
  std::pair<double, Sample> least(const Value& value) const {
    std::pair<double, Sample> least{std::numeric_limits<double>::infinity(), {}};
    for (int b = 0; b < 2; ++b) {
      const std::span<const float> distances = bodies[b].distances.distances();
      const std::span<const float> radii = bodies[b].surface.sample_radii();
      for (const LocalDistances::Run& run : bodies[b].distances.measured())
        for (std::size_t i = run.first; i < run.end; ++i)
          if (const double v = value(distances[i], radii[i]); v < least.first) least = {v, {b, i}};
    }
    return least;
  }

  // The sample, and the closest point of the other body.
  std::optional<std::array<Vec3, 2>> witness(const Sample& sample) const {
    if (sample.index == kNone) return {};
    const Vec3& p = bodies[sample.body].surface.sample_points()[sample.index];
    const Vec3 q =
        reference_closest(bodies[1 - sample.body].sites.impl(), p, std::numeric_limits<double>::infinity())
            .point;
    return sample.body == 0 ? std::array{p, q} : std::array{q, p};
  }

  [[nodiscard]] MeshPair pair() const { return {bodies[0].sites.impl(), bodies[1].sites.impl()}; }

  const Separation& closest_triangles() {
    if (!closest) closest = find_closest(pair(), std::numeric_limits<double>::infinity(), workspace);
    return *closest;
  }

  Length exact_separation() {
    const Separation& c = closest_triangles();
    return {.value = c.distance,
            .kind = Certainty::exact,
            .lower = c.distance,
            .upper = c.distance,
            .witness = std::array{c.point1, c.point2}};
  }

  Decision exact_collision() {
    return {closest_triangles().intersecting || one_contains_part_of_other(pair(), workspace),
            Certainty::exact};
  }

  Length bounded_separation() {
    measure();
    const auto [value, sample] = least([](double d, double) { return std::abs(d); });
    const double lower = least([](double d, double radius) { return std::abs(d) - radius; }).first;
    return {.value = value,
            .kind = Certainty::bounded,
            .lower = std::max(0.0, lower - precision),
            .upper = value + precision,
            .witness = witness(sample)};
  }

  Decision sampled_collision() {
    measure();
    if (least([](double d, double) { return d; }).first < -precision) return {true, Certainty::exact};
    if (bounded_separation().lower > 0) return {false, Certainty::exact};
    return {true, Certainty::estimate};  // as near as the samples can tell
  }

  std::optional<Length> bounded_depth() {
    if (!solid(0) && !solid(1)) return {};
    measure();
    const auto [value, sample] = least([](double d, double) { return d; });
    const double most = -least([](double d, double radius) { return d - radius; }).first;
    Length found{.kind = Certainty::bounded, .upper = std::max(0.0, most + precision)};
    if (value < 0) {
      found.value = -value;
      found.lower = std::max(0.0, found.value - precision);
      found.witness = witness(sample);
    }
    return found;
  }
};

namespace {

const ProximityOptions& checked(const ProximityOptions& options) {
  if (!(options.contact_margin >= 0 && std::isfinite(options.contact_margin)))
    throw Error("a contact margin of " + std::to_string(options.contact_margin) +
                " is out of range; use 0 or more");
  return options;
}

}  // namespace

Query::Query(Mesh o1, Mesh o2, const ProximityOptions& options)
    : impl_(std::make_unique<Impl>(std::move(o1), std::move(o2), checked(options))) {}
Query::~Query() = default;
Query::Query(Query&&) noexcept = default;
Query& Query::operator=(Query&&) noexcept = default;

void Query::update(std::span<const Vec3> o1, std::span<const Vec3> o2) {
  const std::array positions{o1, o2};
  for (int b = 0; b < 2; ++b)
    if (!positions[b].empty())
      validate_positions(positions[b], impl_->bodies[b].surface.mesh().positions.size());
  for (int b = 0; b < 2; ++b) {
    if (positions[b].empty()) continue;
    impl_->bodies[b].surface.refit(positions[b]);
    impl_->bodies[b].sites.refit(positions[b]);
  }
  impl_->forget();
}

const Length& Query::separation() {
  Impl& q = *impl_;
  if (!q.separation) q.separation = q.options.exact ? q.exact_separation() : q.bounded_separation();
  return *q.separation;
}

Decision Query::colliding() {
  Impl& q = *impl_;
  if (!q.colliding) q.colliding = q.options.exact ? q.exact_collision() : q.sampled_collision();
  return *q.colliding;
}

const std::optional<Length>& Query::penetration_depth() {
  Impl& q = *impl_;
  if (!std::exchange(q.depth_found, true)) {
    q.depth = q.bounded_depth();
    if (q.depth && q.options.exact && !colliding().value) q.depth = Length{.kind = Certainty::exact};
  }
  return q.depth;
}

std::span<const Contact> Query::contacts() {
  Impl& q = *impl_;
  q.measure();
  if (!q.contacts) {
    const std::array<MeasuredBody, 2> bodies{
        MeasuredBody{q.bodies[0].surface, q.bodies[0].sites, q.bodies[0].distances},
        MeasuredBody{q.bodies[1].surface, q.bodies[1].sites, q.bodies[1].distances}};
    q.contacts = q.finder.find(bodies, q.options.contact_margin, q.precision);
  }
  return *q.contacts;
}

const Surface& Query::surface(int body) const {
  return impl_->bodies[body].surface;
}
const Sites& Query::sites(int body) const {
  return impl_->bodies[body].sites;
}

std::size_t Query::samples_used() const {
  std::size_t sum = 0;
  for (const Impl::Body& body : impl_->bodies)
    for (const LocalDistances::Run& run : body.distances.measured()) sum += run.end - run.first;
  return sum;
}

}  // namespace sdm
