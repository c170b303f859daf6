// Bodies of which some are translated, and two, the first of which is.
#pragma once

#include <optional>
#include <span>

#include "bodies/pair/pair_answers.h"
#include "bodies/shape/posed_body.h"

namespace sdm::separate {

/// Bodies that collide, some of which are translated.
class TranslatedBodies {
 public:
  /// Whether any collide after a translation; exact.
  [[nodiscard]] virtual bool collide(const Vec3& translation) = 0;
  /// The closest points after a translation without a collision; valid until the next call.
  [[nodiscard]] virtual const BoundedLength& separation(const Vec3& translation) = 0;
  /// How many translations were tried.
  [[nodiscard]] std::size_t tries() const { return tries_; }

 protected:
  ~TranslatedBodies() = default;
  std::size_t tries_ = 0;
};

class MovedPair final : public TranslatedBodies {
 public:
  /// `answers`: whose memory is reused; results do not depend on what it was used for before.
  MovedPair(const shape::PosedBody& o1, const shape::PosedBody& o2, pair::PairAnswers& answers)
      : pose_(o1.pose().transform()), moved_(o1), o2_(o2), answers_(answers) {
    answers_.begin(moved_, o2_);
  }

  /// Sets the hints for the next translation.
  void set_hints(const pair::Hints& hints) { answers_.begin(moved_, o2_, hints); }
  [[nodiscard]] bool collide(const Vec3& translation) override {
    move(translation);
    return answers_.colliding();
  }
  [[nodiscard]] const BoundedLength& separation(const Vec3& translation) override {
    move(translation);
    return answers_.separation();
  }
  /// The penetration depth after a translation; empty if neither body is a solid.
  [[nodiscard]] const std::optional<BoundedLength>& depth(const Vec3& translation) {
    move(translation);
    return answers_.penetration_depth();
  }
  /// The contacts after a translation, valid until the next call.
  [[nodiscard]] std::span<const Contact> contacts(const Vec3& translation) {
    move(translation);
    return answers_.contacts();
  }

 private:
  void move(const Vec3& translation) {
    if (translation == at_) return;
    at_ = translation;
    ++tries_;
    moved_.set_pose(Transform::translation(translation) * pose_);
    answers_.begin(moved_, o2_, answers_.known().hints());
  }

  Transform pose_;
  shape::PosedBody moved_;
  const shape::PosedBody& o2_;
  pair::PairAnswers& answers_;
  std::optional<Vec3> at_{};
};

}  // namespace sdm::separate
