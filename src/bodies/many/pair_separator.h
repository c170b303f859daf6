// How two bodies of a world leave each other: all their parts, and with the bodies beside them.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "bodies/many/body_parts.h"
#include "bodies/many/internal_contacts.h"
#include "bodies/many/near_pairs.h"
#include "bodies/separate/common_translation.h"
#include "bodies/separate/separating_contacts.h"
#include "bodies/separate/separating_translation.h"

namespace sdm::bodies {

/// The poses, parts and filters of a world, which a search reads.
struct World {
  const BodyParts& parts;
  std::span<const Transform> given_poses;   ///< of bodies
  std::span<const shape::PosedBody> posed;  ///< parts
  const PairFilter& filter;
  const InternalContacts* internal = nullptr;  ///< null: bodies do not continue each other
};

/// A search, with the memory that it uses again. Results do not depend on earlier searches.
///
/// Where the translation leads out of a body into one beside it, both are one to what moves: that pair takes
/// part, too, and the translation is found again.
///
/// ```
///        ┌───┐                    ┌───┐
///        │ O1│ → into B           │ O1│ ↑ off A and B
///   ┌────┼─┐ ├────┐          ┌────┼─┬─┼────┐
///   │  A └─┼─┘ B  │          │  A └─┼─┘ B  │
/// ```
class PairSeparator {
 public:
  explicit PairSeparator(const ProximityOptions& options)
      : answers_(options.contact_margin, options.depth_precision), contacts_(options.contact_margin) {}

  /// Takes a pair of parts, with what is known of it: answers() are of this pair then.
  void begin(const World& world, const Sweep::Pair& pair, const pair::KnownAnswers& known) {
    answers_.begin(world.posed[pair[0]], world.posed[pair[1]], known);
  }
  [[nodiscard]] pair::PairAnswers& answers() { return answers_; }

  /// Before the pairs of two bodies are added.
  void clear() {
    members_.clear();
    pairs_.clear();
  }
  /// Adds the pair that begin() was called for.
  void add(const World& world, const Sweep::Pair& pair);
  /// Adds all other pairs of parts of two bodies.
  void add_parts(const World& world, const Sweep::Pair& bodies);
  /// Whether a pair that was added collides.
  [[nodiscard]] bool any_collides() const;
  /// A translation of all pairs that were added, one of which collides, and of those beside them that it
  /// leads into. `apart` is empty of a pair alone.
  struct Found {
    SeparatingTranslation translation{};
    std::optional<double> apart{};
  };
  [[nodiscard]] Found find(const World& world);

  /// The separating contacts of a pair of parts whose bodies collide. Valid until the next call.
  [[nodiscard]] std::span<const Contact> contacts(const World& world, const Sweep::Pair& pair,
                                                  const PairState& state);

 private:
  void add(const World& world, const Sweep::Pair& pair, const SeparatingTranslation& alone);
  [[nodiscard]] bool has(const Sweep::Pair& pair) const;
  [[nodiscard]] Found find_once();
  bool add_neighbours(const World& world, const Found& found);
  bool add_beside(const World& world, std::uint32_t part, int side, std::uint32_t other);

  pair::PairAnswers answers_;
  separate::TranslationWorkspace translation_workspace_;
  separate::CommonWorkspace common_workspace_;
  separate::SeparatingContacts contacts_;
  InternalContacts::Around around_;
  std::vector<Sweep::Pair> members_;        // numbers of parts, that of the body that is moved first
  std::vector<separate::PosedPair> pairs_;  // the same
};

}  // namespace sdm::bodies
