#include <array>
#include <memory>
#include <optional>
#include <span>

#include "bodies/many/multi_body_impl.h"
#include "core/parallel.h"

namespace sdm {

// Calls compute(answers, i) for the pairs within `max_gap` that is_unknown(pair), on all cores, where i
// counts them; and keeps what is then known.
template <class IsUnknown, class Compute>
void MultiBodyQuery::Impl::complete(double max_gap, const IsUnknown& is_unknown, const Compute& compute) {
  near.follow(posed, max_gap);
  unknown.clear();
  const std::span<bodies::NearPair> pairs = near.list();
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (pairs[i].gap <= max_gap && is_unknown(pairs[i])) unknown.push_back(i);
  const auto compute_some = [&](std::size_t begin, std::size_t end) {
    std::unique_ptr<pair::PairAnswers> answers = pool.take(
        [&] { return std::make_unique<pair::PairAnswers>(options.contact_margin, options.depth_precision); });
    for (std::size_t u = begin; u < end; ++u) {
      bodies::NearPair& pair = pairs[unknown[u]];
      bodies::PairState& state = near.state(pair);
      answers->begin(posed[pair.pair[0]], posed[pair.pair[1]], state.known);
      compute(*answers, u);
      state.known = answers->known();
      pair.set(state.known);
    }
    pool.give_back(std::move(answers));
  };
  parallel_for(unknown.size(), 1, compute_some);
}

void MultiBodyQuery::Impl::find_colliding() {
  complete(
      0, [](const bodies::NearPair& pair) { return !pair.collision_known; },
      [](pair::PairAnswers& answers, std::size_t) { (void)answers.colliding(); });
  colliding.clear();
  for (const bodies::NearPair& pair : near.list())
    if (pair.colliding) colliding.push_back({pair.pair[0], pair.pair[1]});
  parts.merge(colliding);
}

template <class IsListed>
void MultiBodyQuery::Impl::list_separations_if(const IsListed& is_listed) {
  separations.clear();
  for (const bodies::NearPair& pair : near.list())
    if (is_listed(pair))
      separations.push_back({pair.pair[0], pair.pair[1], *near.state(pair).known.separation, pair.colliding});
  parts.merge(separations);
}

void MultiBodyQuery::Impl::find_separations(double max_distance) {
  const auto is_unknown = [&](const bodies::NearPair& pair) {
    return !pair.collision_known ||
           !(pair.separation_known || (pair.apart >= max_distance && !pair.colliding));
  };
  complete(max_distance, is_unknown, [&](pair::PairAnswers& answers, std::size_t) {
    if (answers.within(max_distance)) {
      (void)answers.separation();
      (void)answers.colliding();
    }
  });
  candidates = 0;
  for (const bodies::NearPair& pair : near.list()) candidates += pair.gap <= max_distance;
  const auto is_near = [&](const bodies::NearPair& pair) {
    return pair.gap <= max_distance &&
           (pair.colliding || (pair.separation_known && pair.apart <= max_distance));
  };
  list_separations_if(is_near);
  if (!parts.any_compound()) return;

  // A part inside another one may be farther from its surface than other parts of the same bodies are.
  double max_gap = 0;
  colliding.clear();
  for (const PairSeparation& pair : separations)
    if (pair.colliding && pair.separation.value > max_distance) {
      colliding.push_back({pair.first, pair.second});
      max_gap = std::max(max_gap, pair.separation.value);
    }
  if (colliding.empty()) return;
  const auto is_contained = [&](const bodies::NearPair& pair) {
    const std::array bodies{parts.body_of()[pair.pair[0]], parts.body_of()[pair.pair[1]]};
    return std::ranges::binary_search(colliding, bodies, {}, [](const BodyPair& known) {
      return std::array{known.first, known.second};
    });
  };
  complete(
      max_gap, [&](const bodies::NearPair& pair) { return is_contained(pair) && !pair.separation_known; },
      [](pair::PairAnswers& answers, std::size_t) {
        (void)answers.separation();
        (void)answers.colliding();
      });
  list_separations_if([&](const bodies::NearPair& pair) {
    return is_near(pair) || (is_contained(pair) && pair.separation_known);
  });
}

void MultiBodyQuery::Impl::find_depths() {
  const auto is_unknown = [](const bodies::NearPair& pair) {
    return !pair.collision_known || (pair.colliding && !pair.depth_known);
  };
  complete(0, is_unknown, [](pair::PairAnswers& answers, std::size_t) {
    if (answers.colliding()) (void)answers.penetration_depth();
  });
  depths.clear();
  for (const bodies::NearPair& pair : near.list()) {
    if (!pair.colliding) continue;
    if (const std::optional<BoundedLength>& depth = *near.state(pair).known.depth)
      depths.push_back({pair.pair[0], pair.pair[1], *depth});
  }
  parts.merge(depths);
}

// Lists the contacts of all pairs of parts that have some.
void MultiBodyQuery::Impl::list_contacts(bodies::ContactList list, const bodies::ContactStore& store,
                                         std::vector<PairContacts>& listed) {
  listed.clear();
  for (const bodies::NearPair& pair : near.list())
    if (pair.touching[static_cast<std::size_t>(list)])
      listed.push_back({pair.pair[0], pair.pair[1], store.of(near.state(pair))});
}

void MultiBodyQuery::Impl::find_contacts() {
  near.follow(posed, options.contact_margin);
  stored_contacts.begin(near.list().size());
  complete(
      options.contact_margin, [](const bodies::NearPair& pair) { return !pair.contacts_known[0]; },
      [&](pair::PairAnswers& answers, std::size_t u) { stored_contacts.found(u, answers.contacts()); });
  stored_contacts.store(near, unknown);
  list_contacts(bodies::ContactList::closest, stored_contacts, contacts);
  if (options.ignore_internal_edges) {
    internal_contacts.follow(posed, near.filter());
    internal_contacts.leave_out(contacts);
  }
  parts.merge(contacts);
}

}  // namespace sdm
