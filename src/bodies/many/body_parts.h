// Bodies of several shapes.
#pragma once

#include <sdm/error.h>
#include <sdm/multi_body_query.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bodies/motion/divided_motion.h"
#include "bodies/shape/posed_body.h"

namespace sdm::bodies {

/// Adds the body to the messages of errors thrown by `work`.
template <class Work>
void on_behalf_of(std::size_t body, const Work& work) {
  try {
    work();
  } catch (const Cancelled&) {
    throw;
  } catch (const Error& error) {
    throw Error("body " + std::to_string(body) + ": " + error.what(), error.remedy());
  }
}

/// The parts of all bodies in one list, those of a body one after another, each with its pose in the frame of
/// the body. Of bodies of one shape, which have that of the body as their frame, the parts are the bodies.
class BodyParts {
 public:
  /// Makes bodies of one shape each.
  explicit BodyParts(std::size_t bodies);
  /// Appends the shapes to `shapes`. Throws sdm::Error for a body without parts, and for poses that no shape
  /// can have.
  BodyParts(std::vector<std::vector<BodyPart>> bodies, std::vector<Shape>& shapes);

  [[nodiscard]] std::size_t bodies() const { return first_.size() - 1; }
  [[nodiscard]] std::uint32_t begin(std::size_t body) const { return first_[body]; }
  [[nodiscard]] std::uint32_t end(std::size_t body) const { return first_[body + 1]; }
  [[nodiscard]] std::size_t count(std::size_t body) const { return end(body) - begin(body); }
  /// Whether a body is no shape in a frame of its own.
  [[nodiscard]] bool compound(std::size_t body) const { return !places_.empty() && places_[body].compound; }
  [[nodiscard]] bool any_compound() const { return !places_.empty(); }
  /// The body of each part.
  [[nodiscard]] const std::vector<std::uint32_t>& body_of() const { return body_of_; }

  /// Throws sdm::Error for a part that does not exist.
  [[nodiscard]] std::uint32_t checked(std::size_t body, std::size_t part) const;
  /// Throws sdm::Error if the body is a compound: `what` it cannot be asked for.
  void require_one_shape(std::size_t body, const char* what) const;

  /// The pose of a part in the frame of its body, of compounds.
  [[nodiscard]] std::optional<Transform> local(std::uint32_t part) const {
    if (!compound(body_of_[part])) return {};
    return local_[part];
  }
  /// The pose of a part of a body in that pose.
  [[nodiscard]] Transform pose_of(std::uint32_t part, const Transform& body) const;
  /// The motion of each part, in bodies that make these motions: parts turn with their body, about the centre
  /// of its box. Throws sdm::Error, naming the body, as Motion::at does.
  [[nodiscard]] std::vector<motion::DividedMotion> divided(std::span<const shape::PosedBody> parts,
                                                           std::span<const Motion> motions) const;
  /// The pose of a body at a time of its motion.
  [[nodiscard]] Transform pose_at(std::size_t body, std::span<const shape::PosedBody> parts,
                                  const Motion& motion, double time) const;

  // Turns answers for pairs of parts, whose numbers are in `first` and `second`, into those for pairs of
  // bodies. Without compounds, they are the same. Allocates nothing.
  void merge(std::vector<BodyPair>& pairs) const;
  void merge(std::vector<PairSeparation>& pairs) const;
  void merge(std::vector<PairDepth>& pairs) const;
  void merge(std::vector<PairContacts>& pairs) const;
  void merge(std::vector<PairTimeOfContact>& pairs) const;
  /// Replaces the numbers of parts at texels by those of bodies.
  void merge(NearestMap& nearest) const;

 private:
  /// Where the parts of a body are; a compound's box contains them, in its frame.
  struct Place {
    bool compound = false;
    Box box;
  };

  template <class Answer>
  void to_bodies(std::vector<Answer>& pairs) const;

  std::vector<std::uint32_t> first_, body_of_;
  std::vector<Transform> local_;  // of parts; empty without compounds
  std::vector<Place> places_;     // of bodies; empty without compounds
};

}  // namespace sdm::bodies
