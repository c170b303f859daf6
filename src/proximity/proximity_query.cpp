#include <sdm/error.h>
#include <sdm/proximity_query.h>

#include <cmath>
#include <new>
#include <string>

#include "core/memory.h"
#include "mesh/validate.h"
#include "proximity/sampled/body.h"
#include "proximity/sampled/pair_answers.h"

namespace sdm {

struct ProximityQuery::Impl {
  std::array<sampled::Body, 2> bodies;
  sampled::PairAnswers answers;

  Impl(const Mesh& o1, const Mesh& o2, const ProximityOptions& options)
      : bodies{sampled::Body(o1, options.atlas), sampled::Body(o2, options.atlas)},
        answers({.exact = options.exact, .contact_margin = options.contact_margin}) {
    answers.begin(bodies[0], bodies[1]);
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

ProximityQuery::ProximityQuery(const Mesh& o1, const Mesh& o2, const ProximityOptions& options) try
    : impl_(std::make_unique<Impl>(o1, o2, checked(options))) {
} catch (const std::bad_alloc&) {
  throw out_of_memory("a proximity query");
}
ProximityQuery::~ProximityQuery() = default;
ProximityQuery::ProximityQuery(ProximityQuery&&) noexcept = default;
ProximityQuery& ProximityQuery::operator=(ProximityQuery&&) noexcept = default;

void ProximityQuery::refit(std::span<const Vec3> o1, std::span<const Vec3> o2) try {
  const std::array positions{o1, o2};
  for (int b = 0; b < 2; ++b)
    if (!positions[b].empty())
      mesh::validate_positions(positions[b], impl_->bodies[b].surface().mesh().positions.size());
  for (int b = 0; b < 2; ++b)
    if (!positions[b].empty()) impl_->bodies[b].refit(positions[b]);
  impl_->answers.begin(impl_->bodies[0], impl_->bodies[1]);
} catch (const std::bad_alloc&) {
  throw out_of_memory("a proximity query");
}

const BoundedLength& ProximityQuery::separation() try {
  return impl_->answers.separation();
} catch (const std::bad_alloc&) {
  throw out_of_memory("a proximity query");
}
BoundedBool ProximityQuery::colliding() try {
  return impl_->answers.colliding();
} catch (const std::bad_alloc&) {
  throw out_of_memory("a proximity query");
}
const std::optional<BoundedLength>& ProximityQuery::penetration_depth() try {
  return impl_->answers.penetration_depth();
} catch (const std::bad_alloc&) {
  throw out_of_memory("a proximity query");
}
std::span<const Contact> ProximityQuery::contacts() try {
  return impl_->answers.contacts();
} catch (const std::bad_alloc&) {
  throw out_of_memory("a proximity query");
}

const Surface& ProximityQuery::surface(int body) const {
  return impl_->bodies[body].surface();
}
const Sites& ProximityQuery::sites(int body) const {
  return impl_->bodies[body].sites();
}
std::size_t ProximityQuery::samples_used() const {
  return impl_->answers.samples_used();
}

}  // namespace sdm
