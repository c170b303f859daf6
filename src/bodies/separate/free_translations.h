// Short translations after which bodies do not collide.
#pragma once

#include "bodies/separate/moved_pair.h"

namespace sdm::separate {

/// Looks for translations without a collision that are ever shorter. Each one found is verified by the exact
/// test; that none is shorter is not said.
class FreeTranslations {
 public:
  /// `first`: a translation without a collision. `size`: of all bodies. `solids`: whether one is a solid.
  FreeTranslations(TranslatedBodies& pair, const Vec3& first, double size, bool solids)
      : pair_(pair), best_(first), size_(size), solids_(solids) {}

  [[nodiscard]] const Vec3& best() const { return best_; }
  [[nodiscard]] double length() const { return norm(best_); }

  /// Tries a few translations in a direction, |u| = 1, from the shortest on; descends from the first without
  /// a collision.
  void try_direction(const Vec3& u, double shortest);
  /// Whether there is no collision after the translation. If so, descends from it.
  bool try_translation(const Vec3& t);
  /// Descends from the best one.
  void improve() { descend(best_); }

 private:
  /// Descends from a translation without a collision, and takes the result if it is the shortest so far.
  void descend(const Vec3& from);
  /// Steps to shorter translations in any direction, as far as that is easy.
  [[nodiscard]] Vec3 lowest(Vec3 t);
  /// Shortens a translation without a collision, keeping its direction.
  [[nodiscard]] Vec3 shortened(Vec3 t);
  [[nodiscard]] double free_step(const Vec3& t, const Vec3& step, double separation);

  TranslatedBodies& pair_;
  Vec3 best_;
  double size_;
  bool solids_;
};

}  // namespace sdm::separate
