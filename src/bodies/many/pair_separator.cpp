#include "bodies/many/pair_separator.h"

#include <algorithm>

#include "mesh/similarity.h"

namespace sdm::bodies {
namespace {

// The pose of the body of a part, as MultiBodyQuery::pose() has it.
Transform frame_of(const World& world, std::uint32_t part) {
  if (!world.parts.local(part)) return world.posed[part].pose().transform();
  return mesh::Similarity::of(world.given_poses[world.parts.body_of()[part]]).transform();
}

}  // namespace

void PairSeparator::add(const World& world, const Sweep::Pair& pair) {
  add(world, pair,
      separate::separating_translation(world.posed[pair[0]], world.posed[pair[1]], answers_,
                                       translation_workspace_));
}

void PairSeparator::add(const World& world, const Sweep::Pair& pair, const SeparatingTranslation& alone) {
  members_.push_back(pair);
  pairs_.push_back({.o1 = &world.posed[pair[0]],
                    .o2 = &world.posed[pair[1]],
                    .frame = frame_of(world, pair[0]),
                    .local = world.parts.local(pair[0]),
                    .alone = alone});
}

// Adds the pairs of parts that are near each other: others do not collide.
void PairSeparator::add_parts(const World& world, const Sweep::Pair& bodies) {
  for (std::uint32_t a = world.parts.begin(bodies[0]); a < world.parts.end(bodies[0]); ++a)
    for (std::uint32_t b = world.parts.begin(bodies[1]); b < world.parts.end(bodies[1]); ++b)
      if (!has({a, b})) add(world, {a, b}, {});
}

bool PairSeparator::has(const Sweep::Pair& pair) const {
  return std::ranges::find(members_, pair) != members_.end();
}

bool PairSeparator::any_collides() const {
  return std::ranges::any_of(pairs_, [](const auto& pair) { return pair.alone.value > 0; });
}

PairSeparator::Found PairSeparator::find(const World& world) {
  Found found = find_once();
  if (world.internal != nullptr)
    while (add_neighbours(world, found)) found = find_once();
  return found;
}

PairSeparator::Found PairSeparator::find_once() {
  if (pairs_.size() == 1) return {pairs_.front().alone, {}};
  const separate::CommonTranslation common = separate::common_translation(pairs_, common_workspace_);
  return {common.translation, common.apart};
}

// Adds the bodies beside those that the translation leads out of, into them; returns whether there are any.
bool PairSeparator::add_neighbours(const World& world, const Found& found) {
  bool any = false;
  const std::size_t count = members_.size();
  for (std::size_t m = 0; m < count; ++m) {
    const Sweep::Pair pair = members_[m];
    if (world.internal->neighbours(pair[0]).empty() && world.internal->neighbours(pair[1]).empty()) continue;
    const std::optional<Contact> exit =
        contacts_.exit_of(*pairs_[m].o1, *pairs_[m].o2, found.translation, found.apart);
    for (int side = 0; exit && side < 2; ++side) {
      if (!world.internal->leads_into_neighbour(*exit, pair, side, around_)) continue;
      for (const auto& [part, beside] : world.internal->neighbours(pair[side]))
        any |= add_beside(world, beside, side, pair[1 - side]);
    }
  }
  return any;
}

// Adds a part at a side of its pairs with all parts of the body that meets it.
bool PairSeparator::add_beside(const World& world, std::uint32_t part, int side, std::uint32_t other) {
  bool any = false;
  const std::uint32_t body = world.parts.body_of()[other];
  for (std::uint32_t met = world.parts.begin(body); met < world.parts.end(body); ++met) {
    const Sweep::Pair pair = side == 0 ? Sweep::Pair{part, met} : Sweep::Pair{met, part};
    if (has(pair) || !world.filter(part, met)) continue;
    begin(world, pair, {});
    add(world, pair);
    any = true;
  }
  return any;
}

std::span<const Contact> PairSeparator::contacts(const World& world, const Sweep::Pair& pair,
                                                 const PairState& state) {
  if (state.translation.value == 0) {
    begin(world, pair, state.known);
    return answers_.contacts();
  }
  contacts_.find(world.posed[pair[0]], world.posed[pair[1]], state.translation, {}, state.apart);
  return contacts_.contacts();
}

}  // namespace sdm::bodies
