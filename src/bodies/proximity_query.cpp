#include <sdm/error.h>
#include <sdm/proximity_query.h>

#include <new>
#include <string>

#include "bodies/many/internal_contacts.h"
#include "bodies/pair/pair_answers.h"
#include "bodies/separate/separating_contacts.h"
#include "bodies/separate/separating_translation.h"
#include "bodies/shape/posed_body.h"
#include "core/cancellation.h"
#include "core/memory.h"

namespace sdm {

struct ProximityQuery::Impl {
  std::array<shape::PosedBody, 2> bodies;
  pair::PairAnswers answers;
  std::optional<SeparatingTranslation> separating_translation{};
  separate::TranslationWorkspace translation_workspace{};
  separate::SeparatingContacts separating_contacts;
  // Only with ignore_internal_edges.
  std::optional<bodies::ExternalContacts> external_contacts{}, external_contacts_after{};

  Impl(Shape o1, Shape o2, const ProximityOptions& options)
      : bodies{shape::PosedBody(std::move(o1)), shape::PosedBody(std::move(o2))},
        answers(options.contact_margin, options.depth_precision),
        separating_contacts(options.contact_margin) {
    if (options.ignore_internal_edges) {
      external_contacts.emplace();
      external_contacts_after.emplace();
    }
    begin();
  }
  [[nodiscard]] std::span<const Contact> contacts() {
    const std::span<const Contact> all = answers.contacts();
    return external_contacts ? external_contacts->of(bodies, all) : all;
  }
  // Chooses among the contacts after the separating translation.
  [[nodiscard]] separate::ContactFilter filter_after() {
    if (!external_contacts_after) return {};
    return [this](const auto& bodies_after, const auto& all) {
      external_contacts_after->forget();
      return external_contacts_after->of(bodies_after, all);
    };
  }
  // Every call but construction begins with this.
  void require_intact() const {
    for (const shape::PosedBody& body : bodies) body.body().require_intact();
  }
  // The faces that were closest before are most likely near the closest ones now.
  void begin() { begin(answers.known().hints()); }
  void begin_anew() { begin({}); }

 private:
  void begin(const pair::Hints& hints) {
    answers.begin(bodies[0], bodies[1], hints);
    separating_translation.reset();
    if (external_contacts) external_contacts->forget();
  }
};

namespace {

void check_body(int body) {
  if (body != 0 && body != 1)
    throw Error("there is no body " + std::to_string(body) + " in a query of two; use 0 or 1");
}

// Calls `work`, whose errors of memory become sdm::Error.
template <class Work>
decltype(auto) with_memory(const Work& work) try {
  return work();
} catch (const std::bad_alloc&) {
  throw out_of_memory("a proximity query");
}

}  // namespace

ProximityQuery::ProximityQuery(const Mesh& o1, const Mesh& o2, const ProximityOptions& options)
    : ProximityQuery(Shape(o1), Shape(o2), pair::checked(options)) {}
ProximityQuery::ProximityQuery(Shape o1, Shape o2, const ProximityOptions& options)
    : impl_(with_memory(
          [&] { return std::make_unique<Impl>(std::move(o1), std::move(o2), pair::checked(options)); })) {}
ProximityQuery::~ProximityQuery() = default;
ProximityQuery::ProximityQuery(ProximityQuery&&) noexcept = default;
ProximityQuery& ProximityQuery::operator=(ProximityQuery&&) noexcept = default;

void ProximityQuery::set_pose(int body, const Transform& pose) {
  impl_->require_intact();
  check_body(body);
  const Uncancellable whole;
  impl_->bodies[body].set_pose(pose);
  impl_->begin();
}

Transform ProximityQuery::pose(int body) const {
  impl_->require_intact();
  check_body(body);
  return impl_->bodies[body].pose().transform();
}

void ProximityQuery::refit(std::span<const Vec3> o1, std::span<const Vec3> o2) {
  impl_->require_intact();
  const Uncancellable whole;
  const std::array positions{o1, o2};
  for (int b = 0; b < 2; ++b)
    if (!positions[b].empty()) impl_->bodies[b].check_refit(positions[b]);
  with_memory([&] {
    for (int b = 0; b < 2; ++b)
      if (!positions[b].empty()) impl_->bodies[b].refit(positions[b]);
    impl_->begin();
  });
}

void ProximityQuery::edit(int body, const MeshEdit& edit) {
  impl_->require_intact();
  check_body(body);
  const Uncancellable whole;
  impl_->bodies[body].require_own_shape();
  with_memory([&] {
    impl_->bodies[body].edit(edit);
    impl_->begin_anew();
  });
}

void ProximityQuery::replace(int body, Shape shape) {
  impl_->require_intact();
  check_body(body);
  const Uncancellable whole;
  impl_->bodies[body].replace(std::move(shape));
  impl_->begin_anew();
}

const BoundedLength& ProximityQuery::separation() {
  impl_->require_intact();
  return with_memory([&]() -> const BoundedLength& { return impl_->answers.separation(); });
}
bool ProximityQuery::colliding() {
  impl_->require_intact();
  return with_memory([&] { return impl_->answers.colliding(); });
}
const std::optional<BoundedLength>& ProximityQuery::penetration_depth() {
  impl_->require_intact();
  return with_memory(
      [&]() -> const std::optional<BoundedLength>& { return impl_->answers.penetration_depth(); });
}
const SeparatingTranslation& ProximityQuery::separating_translation() {
  impl_->require_intact();
  return with_memory([&]() -> const SeparatingTranslation& {
    if (!impl_->separating_translation)
      impl_->separating_translation = separate::separating_translation(
          impl_->bodies[0], impl_->bodies[1], impl_->answers, impl_->translation_workspace);
    return *impl_->separating_translation;
  });
}
std::span<const Contact> ProximityQuery::contacts() {
  impl_->require_intact();
  return with_memory([&] { return impl_->contacts(); });
}
std::span<const Contact> ProximityQuery::separating_contacts(std::optional<std::size_t> most_per_patch) {
  if (most_per_patch == 0) throw Error("0 contacts of each patch are too few; use 1 or more");
  const SeparatingTranslation& out = separating_translation();
  return with_memory([&]() -> std::span<const Contact> {
    separate::SeparatingContacts& contacts = impl_->separating_contacts;
    if (impl_->answers.colliding())
      contacts.find(impl_->bodies[0], impl_->bodies[1], out, impl_->filter_after());
    else
      contacts.assign(impl_->contacts());
    if (most_per_patch) contacts.keep_per_patch(*most_per_patch);
    return contacts.contacts();
  });
}

const Surface& ProximityQuery::surface(int body) const {
  impl_->require_intact();
  check_body(body);
  return impl_->bodies[body].body().surface();
}
const Sites& ProximityQuery::sites(int body) const {
  impl_->require_intact();
  check_body(body);
  return impl_->bodies[body].body().sites();
}
}  // namespace sdm
