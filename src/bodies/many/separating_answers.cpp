// The answers of MultiBodyQuery on how bodies leave each other.
#include <memory>
#include <optional>
#include <span>

#include "bodies/many/multi_body_impl.h"
#include "core/parallel.h"

namespace sdm {

// The pairs within `max_gap`, those of two bodies one after another.
void MultiBodyQuery::Impl::group_by_bodies(double max_gap) {
  const std::span<const bodies::NearPair> pairs = near.list();
  const auto bodies_of = [&](std::size_t i) {
    return Sweep::Pair{parts.body_of()[pairs[i].pair[0]], parts.body_of()[pairs[i].pair[1]]};
  };
  grouped.clear();
  groups.clear();
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (pairs[i].gap <= max_gap) grouped.push_back(i);
  if (parts.any_compound())
    std::ranges::sort(grouped, {}, [&](std::size_t i) { return std::pair(bodies_of(i), i); });
  for (std::size_t g = 0; g < grouped.size(); ++g) {
    const Sweep::Pair bodies = bodies_of(grouped[g]);
    if (groups.empty() || groups.back().bodies != bodies) groups.push_back({bodies, g, 0});
    ++groups.back().count;
  }
}

void MultiBodyQuery::Impl::find_translation(bodies::PairSeparator& separator, const BodyGroup& group) {
  const bodies::World world{parts, given_poses, posed, near.filter(),
                            options.ignore_internal_edges ? &internal_separating : nullptr};
  const std::span<const std::size_t> numbers = std::span(grouped).subspan(group.first, group.count);
  separator.clear();
  for (const std::size_t i : numbers) {
    bodies::NearPair& pair = near.list()[i];
    bodies::PairState& state = near.state(pair);
    separator.begin(world, pair.pair, state.known);
    separator.add(world, pair.pair);
    state.known = separator.answers().known();
    pair.set(state.known);
  }
  bodies::PairSeparator::Found found{.translation = {{.certainty = Certainty::exact}}};
  if (separator.any_collides()) {
    if (parts.compound(group.bodies[0]) || parts.compound(group.bodies[1]))
      separator.add_parts(world, group.bodies);
    found = separator.find(world);
  }
  for (const std::size_t i : numbers) {
    bodies::NearPair& pair = near.list()[i];
    near.state(pair).translation = found.translation;
    near.state(pair).apart = found.apart;
    pair.translation_known = true;
  }
}

void MultiBodyQuery::Impl::find_translations() {
  near.follow(posed, options.contact_margin);
  if (options.ignore_internal_edges && known_surroundings != near.surroundings()) {
    internal_separating.follow(posed, near.filter());
    for (bodies::NearPair& pair : near.list()) pair.translation_known = pair.contacts_known[1] = false;
    known_surroundings = near.surroundings();
  }
  group_by_bodies(options.contact_margin);
  const auto is_known = [&](const BodyGroup& group) {
    const std::span<const std::size_t> numbers = std::span(grouped).subspan(group.first, group.count);
    return std::ranges::all_of(numbers, [&](std::size_t i) { return near.list()[i].translation_known; });
  };
  std::erase_if(groups, is_known);
  parallel_for(groups.size(), 1, [&](std::size_t begin, std::size_t end) {
    std::unique_ptr<bodies::PairSeparator> separator =
        separators.take([&] { return std::make_unique<bodies::PairSeparator>(options); });
    for (std::size_t g = begin; g < end; ++g) find_translation(*separator, groups[g]);
    separators.give_back(std::move(separator));
  });
  translations.clear();
  for (const bodies::NearPair& pair : near.list())
    if (pair.translation_known && pair.gap <= options.contact_margin)
      if (const SeparatingTranslation& out = near.state(pair).translation; out.value > 0)
        translations.push_back({parts.body_of()[pair.pair[0]], parts.body_of()[pair.pair[1]], out});
  if (!parts.any_compound()) return;
  const auto bodies_of = [](const PairTranslation& pair) { return std::pair(pair.first, pair.second); };
  std::ranges::sort(translations, {}, bodies_of);
  const auto repeated = std::ranges::unique(translations, {}, bodies_of);
  translations.erase(repeated.begin(), repeated.end());
}

void MultiBodyQuery::Impl::find_separating_contacts(std::optional<std::size_t> most_per_patch) {
  find_translations();
  const bodies::World world{parts, given_poses, posed, near.filter()};
  const std::span<bodies::NearPair> pairs = near.list();
  unknown.clear();
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (pairs[i].gap <= options.contact_margin && !pairs[i].contacts_known[1]) unknown.push_back(i);
  stored_separating.begin(pairs.size());
  parallel_for(unknown.size(), 1, [&](std::size_t begin, std::size_t end) {
    std::unique_ptr<bodies::PairSeparator> separator =
        separators.take([&] { return std::make_unique<bodies::PairSeparator>(options); });
    for (std::size_t u = begin; u < end; ++u) {
      const bodies::NearPair& pair = pairs[unknown[u]];
      stored_separating.found(u, separator->contacts(world, pair.pair, near.state(pair)));
    }
    separators.give_back(std::move(separator));
  });
  stored_separating.store(near, unknown);
  list_contacts(bodies::ContactList::separating, stored_separating, separating_contacts);
  if (options.ignore_internal_edges) internal_separating.leave_out(separating_contacts);
  if (most_per_patch) keep_per_patch(*most_per_patch);
  parts.merge(separating_contacts);
}

void MultiBodyQuery::Impl::keep_per_patch(std::size_t most) {
  std::size_t count = 0;
  for (const PairContacts& pair : separating_contacts) count += pair.contacts.size();
  few_contacts.clear();
  few_contacts.reserve(count);  // so that spans of it stay valid
  for (PairContacts& pair : separating_contacts) {
    fewer.assign(pair.contacts);
    fewer.keep_per_patch(most);
    const std::size_t first = few_contacts.size();
    few_contacts.insert(few_contacts.end(), fewer.contacts().begin(), fewer.contacts().end());
    pair.contacts = std::span(few_contacts).subspan(first);
  }
}

}  // namespace sdm
