#include <sdm/error.h>
#include <sdm/self_proximity_query.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <new>
#include <utility>

#include "bodies/contacts/contact_patches.h"
#include "core/cancellation.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "geometry/vec.h"
#include "map/measures/self_measure.h"

namespace sdm {

struct SelfProximityQuery::Impl {
  Sites sites;
  Exclusion exclusion;
  self::PatchTree patch_tree;
  double max_distance;

  // Results since the last refit.
  std::optional<self::FacePair> closest;

  std::vector<self::FacePair> nearest{};  // of each face
  std::vector<Contact> contacts{};
  std::vector<Box> boxes{};
  contacts::ContactPatches patches{};

  Impl(Mesh rest, const SelfProximityOptions& options)
      : sites(std::move(rest)),
        exclusion(sites.mesh(), {.rule = options.exclusion, .progress = options.progress}),
        patch_tree(internals(sites), exclusion),
        max_distance(options.max_distance) {}

  // Calls body(search, face) for each face in the tree, those of a patch one after another.
  template <class Body>
  void for_each_face(const Body& body) const {
    parallel_for(patch_tree.order.size(), self::grain_of_patches(exclusion),
                 [&](std::size_t begin, std::size_t end) {
                   self::SelfSearch search(internals(sites), exclusion, patch_tree);
                   for (std::size_t i = begin; i < end; ++i)
                     for (const std::uint32_t face : exclusion.faces_of(patch_tree.order[i])) {
                       if (internals(sites).topology.ignored(face)) continue;
                       search.start_from({&face, 1});
                       body(search, face);
                     }
                 });
  }

  // The bound depends on the order in which threads finish, but it never excludes a pair at the smallest
  // distance, and exactly one of those is before all others.
  self::FacePair find_closest() const {
    std::atomic<double> bound{max_distance};
    std::mutex mutex;
    self::FacePair best;
    for_each_face([&](const self::SelfSearch& search, std::uint32_t) {
      self::FacePair known;
      if (const double limit = bound.load(std::memory_order_relaxed); limit == 0) {
        const std::scoped_lock lock(mutex);
        known = best;
      }
      const self::FacePair pair = search.nearest(bound.load(std::memory_order_relaxed), known);
      if (pair.face1 == kNone) return;
      const std::scoped_lock lock(mutex);
      if (pair.before(best)) best = pair;
      bound.store(best.distance, std::memory_order_relaxed);
    });
    return best;
  }

  void find_contacts(double margin) {
    nearest.assign(exclusion.faces(), {});
    for_each_face(
        [&](const self::SelfSearch& search, std::uint32_t face) { nearest[face] = search.nearest(margin); });
    // Two faces that are each other's nearest are found twice.
    std::erase_if(nearest, [](const self::FacePair& pair) { return pair.face1 == kNone; });
    std::ranges::sort(nearest, [](const self::FacePair& a, const self::FacePair& b) { return a.before(b); });
    const auto same = [](const self::FacePair& a, const self::FacePair& b) {
      return a.face1 == b.face1 && a.face2 == b.face2;
    };
    nearest.erase(std::unique(nearest.begin(), nearest.end(), same), nearest.end());
    contacts.clear();
    boxes.clear();
    for (const self::FacePair& pair : nearest) {
      contacts.push_back(contact_of(pair));
      Box& box = boxes.emplace_back();
      for (const std::uint32_t face : {pair.face1, pair.face2})
        for (const std::uint32_t v : sites.mesh().triangles[face]) extend(box, sites.mesh().positions[v]);
    }
  }

  [[nodiscard]] Contact contact_of(const self::FacePair& pair) const {
    Contact c{.point1 = pair.point1, .point2 = pair.point2, .depth = -pair.distance};
    c.normal =
        pair.distance > 0 ? (1 / c.depth) * (c.point2 - c.point1) : internals(sites).normals.face[pair.face2];
    return c;
  }
};

SelfProximityQuery::SelfProximityQuery(Mesh rest, const SelfProximityOptions& options) try {
  check_options(options);
  impl_ = std::make_unique<Impl>(std::move(rest), options);
} catch (const std::bad_alloc&) {
  throw out_of_memory("a proximity query of a mesh with itself");
}
SelfProximityQuery::~SelfProximityQuery() = default;
SelfProximityQuery::SelfProximityQuery(SelfProximityQuery&&) noexcept = default;
SelfProximityQuery& SelfProximityQuery::operator=(SelfProximityQuery&&) noexcept = default;

void SelfProximityQuery::refit(std::span<const Vec3> positions) try {
  const Uncancellable whole;
  impl_->closest.reset();  // before a refit that may fail half-way
  impl_->sites.refit(positions);
} catch (const std::bad_alloc&) {
  throw out_of_memory("a proximity query of a mesh with itself");
}

std::optional<BoundedLength> SelfProximityQuery::separation() try {
  if (!impl_->closest) impl_->closest = impl_->find_closest();
  const self::FacePair& c = *impl_->closest;
  if (c.face1 == kNone) return {};
  return BoundedLength{
      {.value = c.distance, .certainty = Certainty::exact, .lower = c.distance, .upper = c.distance},
      std::array{c.point1, c.point2}};
} catch (const std::bad_alloc&) {
  throw out_of_memory("a proximity query of a mesh with itself");
}

std::span<const Contact> SelfProximityQuery::contacts(double margin) try {
  internals(impl_->sites).require_intact();
  if (!(margin >= 0 && std::isfinite(margin)))
    throw Error("a contact margin of " + std::to_string(margin) + " is out of range; use 0 or more");
  impl_->find_contacts(margin);
  impl_->patches.sort(impl_->contacts, impl_->boxes, 0);
  return impl_->contacts;
} catch (const std::bad_alloc&) {
  throw out_of_memory("a proximity query of a mesh with itself");
}

const Sites& SelfProximityQuery::sites() const {
  internals(impl_->sites).require_intact();
  return impl_->sites;
}
const Exclusion& SelfProximityQuery::exclusion() const {
  internals(impl_->sites).require_intact();
  return impl_->exclusion;
}

}  // namespace sdm
