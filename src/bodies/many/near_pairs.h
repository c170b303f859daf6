// The pairs of bodies that are near each other, and what is known of each.
#pragma once

#include <sdm/multi_body_query.h>

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "bodies/pair/pair_answers.h"
#include "bodies/shape/posed_body.h"
#include "geometry/boxes.h"

namespace sdm::bodies {

/// Which pairs of parts are asked for (see BodyParts).
class PairFilter {
 public:
  /// `body_of`: the body of each part.
  explicit PairFilter(std::vector<std::uint32_t> body_of)
      : of_(body_of.size()), half_space_(body_of.size()), body_of_(std::move(body_of)) {}

  BodyFilter& operator[](std::size_t part) { return of_[part]; }
  const BodyFilter& operator[](std::size_t part) const { return of_[part]; }
  /// Pairs of bodies.
  void exclude(const Sweep::Pair& pair);
  void include(const Sweep::Pair& pair);

  /// A part of a body with a half-space and one of another such body are no pair.
  void set_half_space(std::uint32_t part) { half_space_[part] = 1; }

  [[nodiscard]] bool operator()(std::uint32_t a, std::uint32_t b) const;
  [[nodiscard]] bool same_body(std::uint32_t a, std::uint32_t b) const { return body_of_[a] == body_of_[b]; }
  /// Whether the body of a part has others.
  [[nodiscard]] bool in_compound(std::uint32_t part) const {
    return (part > 0 && same_body(part, part - 1)) ||
           (part + 1 < body_of_.size() && same_body(part, part + 1));
  }

 private:
  std::vector<BodyFilter> of_;
  std::vector<std::uint8_t> half_space_;
  std::vector<std::uint32_t> body_of_;
  std::vector<Sweep::Pair> excluded_;  ///< sorted
};

/// The bodies that have moved since the list of pairs was last brought up to date.
class MovedBodies {
 public:
  /// All bodies have moved at first.
  explicit MovedBodies(std::size_t bodies);

  void add(std::size_t body) noexcept {
    if (!flags_[body]) {
      flags_[body] = 1;
      list_.push_back(static_cast<std::uint32_t>(body));
    }
  }
  void clear() noexcept;
  [[nodiscard]] std::span<const std::uint32_t> list() const { return list_; }
  [[nodiscard]] bool contains(std::uint32_t body) const { return flags_[body] != 0; }
  [[nodiscard]] bool any_of(const Sweep::Pair& pair) const { return contains(pair[0]) || contains(pair[1]); }

 private:
  std::vector<std::uint32_t> list_;  // with room for all, so that add() allocates nothing
  std::vector<std::uint8_t> flags_;
};

/// The lists of contacts of a pair: contacts() and separating_contacts().
enum class ContactList : std::uint8_t { closest, separating };

/// The answers on a pair of bodies, which hold as long as neither moves.
struct PairState {
  /// A range of contacts in a ContactStore.
  struct Range {
    std::size_t first = 0, count = 0;
  };
  pair::KnownAnswers known{};
  std::array<Range, 2> contacts{};  ///< by ContactList
  /// The translation that separates the bodies, not these parts alone; 0 if the bodies do not collide.
  SeparatingTranslation translation{};
  /// How far apart the nearest of all pairs that leave each other together are then; nothing for a pair
  /// alone.
  std::optional<double> apart{};
};

/// A pair of bodies. What decides whether a call has to look at its state is here: passes over the list of
/// all pairs read little memory.
struct NearPair {
  Sweep::Pair pair{};
  std::uint32_t state = 0;  ///< its number
  bool collision_known = false, colliding = false, depth_known = false;
  bool separation_known = false;
  bool translation_known = false;
  std::array<bool, 2> contacts_known{}, touching{};  ///< by ContactList; touching: it has contacts
  double gap = 0;                                    ///< between the boxes, rounded down
  double apart = -1;  ///< the separation if it is known, otherwise what it exceeds

  void set(const pair::KnownAnswers& known) {
    collision_known = known.colliding.has_value();
    colliding = known.colliding.value_or(false);
    depth_known = known.depth.has_value();
    separation_known = known.separation.has_value();
    apart = known.separation ? known.separation->value : known.beyond;
  }
};

/// The list of near pairs. It follows the bodies that have moved, and keeps the states of the other pairs.
class NearPairs {
 public:
  /// `body_of`: the body of each part; bodies are parts elsewhere in this class.
  explicit NearPairs(std::vector<std::uint32_t> body_of)
      : boxes_(body_of.size()), filter_(std::move(body_of)), moved_(boxes_.size()) {}

  void moved(std::size_t body) noexcept;
  [[nodiscard]] const PairFilter& filter() const { return filter_; }
  /// The filter, to be changed; all pairs are looked for again.
  PairFilter& change_filter() {
    complete_ = false;
    ++surroundings_;
    return filter_;
  }

  /// A number that changes when a fixed body moves or a filter changes.
  [[nodiscard]] std::size_t surroundings() const { return surroundings_; }

  /// Brings the list up to date: then it has all pairs whose boxes are at most `max_gap` apart, and perhaps
  /// some that are farther. If there is not enough memory, it throws, and all is unknown.
  void follow(std::span<const shape::PosedBody> bodies, double max_gap);

  /// The pairs, in lexicographic order.
  [[nodiscard]] std::span<NearPair> list() { return list_; }
  PairState& state(const NearPair& pair) { return states_[pair.state]; }

 private:
  /// How far apart pairs are asked for. Several calls follow each motion, in any order: the list has what the
  /// farthest of them needs.
  struct MaxGap {
    double since_motion = 0, before = 0;  ///< the largest ones asked for since the last motion, and before it
    double listed = -1;                   ///< of the list
  };

  void find_near_moved(double max_gap);
  void adopt(std::span<const Sweep::Pair> found);
  [[nodiscard]] std::uint32_t new_state();
  void forget() noexcept;

  std::vector<Box> boxes_;
  PairFilter filter_;
  MovedBodies moved_;
  MaxGap max_gap_;
  std::size_t surroundings_ = 0;
  bool complete_ = false;  ///< the list has all pairs that were near before the bodies moved
  Sweep sweep_;
  std::vector<Sweep::Pair> found_, near_moved_;
  std::vector<NearPair> list_, next_;  ///< sorted
  std::vector<PairState> states_;
  std::vector<std::uint32_t> unused_;  ///< states of no pair
};

}  // namespace sdm::bodies
