#include "bodies/many/body_parts.h"

#include <sdm/error.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include "geometry/vec.h"
#include "mesh/similarity.h"

namespace sdm::bodies {
namespace {

bool is_identity(const Transform& pose) {
  return pose.rows == Transform{}.rows;
}

// A box about `middle` that contains another one.
Box around(const Vec3& middle, const Box& box) {
  Box about;
  for (int k = 0; k < 3; ++k) {
    const double half = std::max(std::abs(box.lower[k] - middle[k]), std::abs(box.upper[k] - middle[k]));
    about.lower[k] = middle[k] - half;
    about.upper[k] = middle[k] + half;
  }
  return about;
}

// Adds the faces of a mesh that was moved.
void extend_by_mesh(Box& box, const Mesh& mesh, const Affine& moved) {
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) extend(box, moved(mesh.positions[v]));
}

// The position of an answer in the list: by bodies, then by parts.
constexpr auto kByBodies = [](const auto& answer) {
  return std::tuple(answer.first, answer.second, answer.parts);
};

// Unites neighbours of one pair of bodies by unite(answer, next one).
template <class Answer, class Unite>
void unite_pairs(std::vector<Answer>& answers, const Unite& unite) {
  auto end = answers.begin();
  for (Answer& answer : answers) {
    if (end != answers.begin() && (end - 1)->first == answer.first && (end - 1)->second == answer.second)
      unite(*(end - 1), answer);
    else
      *end++ = answer;
  }
  answers.erase(end, answers.end());
}

}  // namespace

BodyParts::BodyParts(std::size_t bodies) : first_(bodies + 1), body_of_(bodies) {
  std::iota(first_.begin(), first_.end(), 0U);
  std::iota(body_of_.begin(), body_of_.end(), 0U);
}

BodyParts::BodyParts(std::vector<std::vector<BodyPart>> bodies, std::vector<Shape>& shapes) : first_(1, 0) {
  for (std::vector<BodyPart>& parts : bodies) {
    const auto body = static_cast<std::uint32_t>(places_.size());
    Place place;
    place.compound = parts.size() > 1 || (!parts.empty() && !is_identity(parts[0].pose));
    on_behalf_of(body, [&] {
      if (parts.empty()) throw Error("a body without a shape; give it one part or more");
      std::optional<Vec3> of_half_space;
      for (BodyPart& part : parts) {
        shape::PosedBody posed(part.shape);
        posed.set_pose(part.pose);
        if (!place.compound) continue;
        if (posed.body().half_space()) {
          if (of_half_space)
            throw Error(
                "two half-spaces in a compound, which bodies may be unable to leave; make each a body");
          of_half_space = posed.pose().map.offset;
        } else if (posed.body().rounded())
          extend(place.box, posed.box());
        else
          extend_by_mesh(place.box, posed.body().sites().mesh(), posed.pose().map);
      }
      if (of_half_space && place.compound && !(place.box.lower[0] <= place.box.upper[0]))
        extend(place.box, *of_half_space);
    });
    for (BodyPart& part : parts) {
      shapes.push_back(std::move(part.shape));
      local_.push_back(mesh::Similarity::of(part.pose).transform());
      body_of_.push_back(body);
    }
    places_.push_back(place);
    first_.push_back(static_cast<std::uint32_t>(body_of_.size()));
  }
  if (std::ranges::none_of(places_, &Place::compound)) {
    places_.clear();
    local_.clear();
  }
}

std::uint32_t BodyParts::checked(std::size_t body, std::size_t part) const {
  if (part >= count(body))
    throw Error("there is no part " + std::to_string(part) + " among the " + std::to_string(count(body)) +
                " of body " + std::to_string(body) + "; they are numbered from 0");
  return static_cast<std::uint32_t>(begin(body) + part);
}

void BodyParts::require_one_shape(std::size_t body, const char* what) const {
  if (compound(body))
    throw Error("a compound body has no " + std::string(what) + "; make one mesh of its parts");
}

Transform BodyParts::pose_of(std::uint32_t part, const Transform& body) const {
  return compound(body_of_[part]) ? mesh::Similarity::of(body).transform() * local_[part] : body;
}

std::vector<motion::DividedMotion> BodyParts::divided(std::span<const shape::PosedBody> parts,
                                                      std::span<const Motion> motions) const {
  std::vector<motion::DividedMotion> divided;
  divided.reserve(parts.size());
  for (std::uint32_t body = 0; body < bodies(); ++body)
    on_behalf_of(body, [&] {
      if (!compound(body)) {
        divided.emplace_back(motions[body], parts[begin(body)].body().turning_box());
        return;
      }
      const Box& whole = places_[body].box;
      const motion::DividedMotion of_body(motions[body], whole);
      for (std::uint32_t part = begin(body); part < end(body); ++part) {
        const Affine to_part = inverse(mesh::Similarity::of(local_[part]).map);
        divided.push_back(
            of_body.of_part(local_[part], around(to_part(centre(whole)), parts[part].body().turning_box())));
      }
    });
  return divided;
}

Transform BodyParts::pose_at(std::size_t body, std::span<const shape::PosedBody> parts, const Motion& motion,
                             double time) const {
  const Box& box = compound(body) ? places_[body].box : parts[begin(body)].body().turning_box();
  return motion::DividedMotion(motion, box).at(time);
}

template <class Answer>
void BodyParts::to_bodies(std::vector<Answer>& pairs) const {
  for (Answer& pair : pairs) {
    const std::uint32_t first = body_of_[pair.first], second = body_of_[pair.second];
    pair.parts = {pair.first - begin(first), pair.second - begin(second)};
    pair.first = first;
    pair.second = second;
  }
}

void BodyParts::merge(std::vector<BodyPair>& pairs) const {
  if (!any_compound()) return;
  to_bodies(pairs);
  std::ranges::sort(pairs, {}, kByBodies);
  unite_pairs(pairs, [](BodyPair&, const BodyPair&) {});
}

void BodyParts::merge(std::vector<PairSeparation>& pairs) const {
  if (!any_compound()) return;
  to_bodies(pairs);
  std::ranges::sort(pairs, {}, kByBodies);
  unite_pairs(pairs, [](PairSeparation& pair, const PairSeparation& next) {
    const bool colliding = pair.colliding || next.colliding;
    if (next.separation.value < pair.separation.value) pair = next;
    pair.colliding = colliding;
  });
}

void BodyParts::merge(std::vector<PairDepth>& pairs) const {
  if (!any_compound()) return;
  to_bodies(pairs);
  std::ranges::sort(pairs, {}, kByBodies);
  unite_pairs(pairs, [](PairDepth& pair, const PairDepth& next) {
    const double lower = std::max(pair.penetration_depth.lower, next.penetration_depth.lower);
    const double upper = std::max(pair.penetration_depth.upper, next.penetration_depth.upper);
    if (next.penetration_depth.value > pair.penetration_depth.value) pair = next;
    pair.penetration_depth.lower = lower;
    pair.penetration_depth.upper = upper;
  });
}

void BodyParts::merge(std::vector<PairContacts>& pairs) const {
  if (!any_compound()) return;
  to_bodies(pairs);
  std::ranges::sort(pairs, {}, kByBodies);
}

void BodyParts::merge(std::vector<PairTimeOfContact>& pairs) const {
  if (!any_compound()) return;
  to_bodies(pairs);
  std::ranges::sort(pairs, {}, kByBodies);
  unite_pairs(pairs, [](PairTimeOfContact& pair, const PairTimeOfContact& next) {
    if (next.time_of_contact.time < pair.time_of_contact.time) pair = next;
  });
  std::ranges::sort(pairs, {}, [](const PairTimeOfContact& pair) {
    return std::tuple(pair.time_of_contact.time, pair.first, pair.second);
  });
}

void BodyParts::merge(NearestMap& nearest) const {
  nearest.part.clear();
  if (!any_compound()) return;
  nearest.part = nearest.body;
  for (std::size_t i = 0; i < nearest.body.size(); ++i) {
    if (nearest.body[i] == kNone) continue;
    nearest.body[i] = body_of_[nearest.body[i]];
    nearest.part[i] -= begin(nearest.body[i]);
  }
}

}  // namespace sdm::bodies
