// The members of a query of many bodies.
#pragma once

#include <sdm/error.h>
#include <sdm/multi_body_query.h>

#include <algorithm>
#include <cstring>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bodies/many/body_parts.h"
#include "bodies/many/contact_store.h"
#include "bodies/many/internal_contacts.h"
#include "bodies/many/near_pairs.h"
#include "bodies/many/pair_separator.h"
#include "bodies/many/pool.h"
#include "bodies/pair/pair_answers.h"
#include "bodies/shape/posed_body.h"
#include "core/intact.h"
#include "mesh/similarity.h"

namespace sdm {

struct MultiBodyQuery::Impl {
  ProximityOptions options;
  bodies::BodyParts parts;
  std::vector<shape::PosedBody> posed;       // the parts, and so in `near`
  std::vector<Transform> given_poses;        // of bodies
  Intact intact{"a MultiBodyQuery object"};  // every call but construction requires it first
  bodies::Pool<pair::PairAnswers> pool;
  bodies::NearPairs near;
  std::vector<std::size_t> unknown;  // the pairs of `near` that a call computes

  // The pairs of parts of two bodies: a range of `grouped`, numbers in the list of near pairs.
  struct BodyGroup {
    Sweep::Pair bodies{};
    std::size_t first = 0, count = 0;
  };

  // The results of the last calls.
  std::vector<BodyPair> colliding;
  std::vector<PairSeparation> separations;
  std::size_t candidates = 0;
  std::vector<PairDepth> depths;
  std::vector<PairTranslation> translations;
  std::vector<PairContacts> contacts, separating_contacts;
  bodies::ContactStore stored_contacts{bodies::ContactList::closest};
  bodies::ContactStore stored_separating{bodies::ContactList::separating};
  bodies::InternalContacts internal_contacts, internal_separating;
  bodies::Pool<bodies::PairSeparator> separators;
  separate::SeparatingContacts fewer{0};
  std::vector<Contact> few_contacts;
  std::vector<std::size_t> grouped;
  std::vector<BodyGroup> groups;
  std::optional<std::size_t> known_surroundings{};  // with which the translations were found

  Impl(std::vector<Shape> shapes, bodies::BodyParts of_bodies, const ProximityOptions& asked)
      : options(asked), parts(std::move(of_bodies)), given_poses(parts.bodies()), near(parts.body_of()) {
    posed.reserve(shapes.size());
    for (Shape& shape : shapes) posed.emplace_back(std::move(shape));
    for (std::uint32_t part = 0; part < posed.size(); ++part) {
      if (parts.any_compound()) posed[part].set_pose(parts.pose_of(part, {}));
      const std::uint32_t body = parts.body_of()[part];
      if (posed[part].body().half_space())
        for (std::uint32_t other = parts.begin(body); other < parts.end(body); ++other)
          near.change_filter().set_half_space(other);
    }
  }

  [[nodiscard]] std::size_t checked(std::size_t body) const {
    intact.require();
    if (body >= parts.bodies())
      throw Error("there is no body " + std::to_string(body) + " among " + std::to_string(parts.bodies()) +
                  "; they are numbered from 0");
    return body;
  }
  [[nodiscard]] const shape::PosedBody& part_of(std::size_t body, std::size_t part) const {
    return posed[parts.checked(checked(body), part)];
  }
  [[nodiscard]] Sweep::Pair checked_pair(std::size_t a, std::size_t b) const {
    if (checked(a) == checked(b))
      throw Error("body " + std::to_string(a) + " and itself are no pair; give two bodies");
    return {static_cast<std::uint32_t>(std::min(a, b)), static_cast<std::uint32_t>(std::max(a, b))};
  }
  void check_count(std::size_t count, const char* what) const {
    intact.require();
    if (count != parts.bodies())
      throw Error("there are " + std::to_string(parts.bodies()) + " bodies, but " + what + " for " +
                  std::to_string(count) + " were given; give one entry per body");
  }
  void check(std::size_t body, std::span<const Vec3> positions) const {
    bodies::on_behalf_of(body, [&] {
      parts.require_one_shape(body, "vertices that can be moved");
      posed[parts.begin(body)].check_refit(positions);
    });
  }

  // Compares bits, since 0 and −0 may give zeros of other signs.
  [[nodiscard]] bool has_pose(std::size_t body, const Transform& pose) const {
    return std::memcmp(&given_poses[body], &pose, sizeof pose) == 0;
  }
  void set_pose(std::size_t body, const Transform& pose) {
    if (has_pose(body, pose)) return;
    if (parts.count(body) > 1) check_pose(body, pose);
    for (std::uint32_t part = parts.begin(body); part < parts.end(body); ++part) {
      bodies::on_behalf_of(body, [&] { posed[part].set_pose(parts.pose_of(part, pose)); });
      near.moved(part);
    }
    given_poses[body] = pose;
  }
  void check_pose(std::size_t body, const Transform& pose) const {
    bodies::on_behalf_of(body, [&] {
      for (std::uint32_t part = parts.begin(body); part < parts.end(body); ++part)
        (void)posed[part].checked_pose(parts.pose_of(part, pose));
    });
  }

  // Each finds what the call of its name returns.
  void find_colliding();
  void find_separations(double max_distance);
  void find_depths();
  void find_contacts();
  void find_translations();
  void find_separating_contacts(std::optional<std::size_t> most_per_patch);

  [[nodiscard]] Transform pose(std::size_t body) const {
    if (parts.compound(body)) return mesh::Similarity::of(given_poses[body]).transform();
    return posed[parts.begin(body)].pose().transform();
  }

 private:
  void group_by_bodies(double max_gap);
  void find_translation(bodies::PairSeparator& separator, const BodyGroup& group);
  void keep_per_patch(std::size_t most);
  void list_contacts(bodies::ContactList list, const bodies::ContactStore& store,
                     std::vector<PairContacts>& listed);
  template <class IsUnknown, class Compute>
  void complete(double max_gap, const IsUnknown& is_unknown, const Compute& compute);
  template <class IsListed>
  void list_separations_if(const IsListed& is_listed);
};

}  // namespace sdm
