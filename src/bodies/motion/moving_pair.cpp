#include "bodies/motion/moving_pair.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>
#include <vector>

#include "bodies/motion/safe_time.h"
#include "core/cancellation.h"
#include "geometry/triangle_pair.h"

namespace sdm::motion {
namespace {

// `vector` without its part along `along`, of length 1. Along such a direction, bodies do not approach with
// their velocity: where they pass beside each other, it separates them for all time.
Vec3 beside(const Vec3& vector, const Vec3& along) {
  const Vec3 ahead = normalized(along);
  const Vec3 rest = vector - dot(vector, ahead) * ahead;
  return normalized(rest - dot(rest, ahead) * ahead);
}

class Search {
 public:
  Search(const MovingSurface& o1, const MovingSurface& o2, double tolerance,
         const std::function<bool(double)>& in_contact, const std::atomic<double>* until)
      : parts_{Parts(o1), Parts(o2)},
        safe_(o1.motion, o2.motion, 0.5 * tolerance),
        tolerance_(tolerance),
        in_contact_(in_contact),
        until_(until) {}

  FreeMotion run() {
    if (parts_[0].empty() || parts_[1].empty()) return {};
    now_.push_back({});
    Poll due(256);
    while (!now_.empty() || !later_.empty()) {
      due();
      if (now_.empty()) {
        std::pop_heap(later_.begin(), later_.end(), std::greater{});
        now_.push_back(later_.back());
        later_.pop_back();
        if (until_ && now_.back().time > until_->load(std::memory_order_relaxed)) return {};
        safe_.set_now(now_.back().time);
      }
      const Pair pair = now_.back();
      now_.pop_back();
      if (!pair.faces())
        advance_nodes(pair);
      else if (const FreeMotion free = advance_faces(pair); free.time < 1 || !free.decided)
        return free;
    }
    return {};
  }

 private:
  // Faces that graze each other along curved paths take some 1/√tolerance steps.
  static constexpr std::uint32_t kMostSteps = 1'000'000;
  // Nodes are divided after a shorter step, in units of the motion.
  static constexpr double kLeastStep = 1.0 / 16;

  // Two parts that are safe until a time.
  struct Pair {
    double time = 0;
    std::array<Place, 2> place{};
    std::uint32_t steps = 0;
    bool divide = false;  // rather than advance them again
    Vec3 direction{};     // along which this was found, for themselves or for the nodes that contain them

    [[nodiscard]] bool faces() const { return place[0].face && place[1].face; }
    // Pairs of one time follow each other in the order of the trees.
    bool operator>(const Pair& other) const {
      const auto order = [](const Pair& p) {
        return std::tuple(p.time, p.place[0].face, p.place[0].child, p.place[1].face, p.place[1].child);
      };
      return order(*this) > order(other);
    }
  };
  using TwoParts = std::array<const Part*, 2>;

  // The longest time along some directions.
  struct Longest {
    double time;
    Vec3 direction;
    [[nodiscard]] bool done() const { return time >= 1; }
  };
  void offer(Longest& longest, const TwoParts& parts, const Vec3& direction) const {
    if (longest.done()) return;
    if (const double time = safe_.until(*parts[0], *parts[1], direction); time > longest.time)
      longest = {time, direction};
  }

  TwoParts parts_of(const Pair& pair) { return {&parts_[0].at(pair.place[0]), &parts_[1].at(pair.place[1])}; }

  void advance_nodes(Pair pair) {
    if (pair.divide) return divide(pair);
    const TwoParts parts = parts_of(pair);
    Longest longest{safe_.now(), pair.direction};
    offer(longest, parts, pair.direction);
    const Vec3 from = safe_.place(0, parts[0]->point[0]), to = safe_.place(1, parts[1]->point[0]);
    offer(longest, parts, beside(to - from, safe_.velocity(from, to)));
    for (int body = 0; body < 2; ++body)
      for (const Vec3& axis : parts[body]->axis)
        if (!longest.done()) offer(longest, parts, facing(safe_.turned(body, axis), to - from));
    offer(longest, parts, normalized(to - from));
    if (longest.done()) return;
    pair.direction = longest.direction;
    pair.divide = longest.time - safe_.now() < kLeastStep;
    if (longest.time > safe_.now())
      put_off(pair, longest.time);
    else
      divide(pair);
  }

  FreeMotion advance_faces(Pair pair) {
    const TwoParts parts = parts_of(pair);
    Longest longest{safe_.now(), pair.direction};
    offer(longest, parts, pair.direction);
    if (longest.done()) return {};
    std::array<Corners, 2> at;
    for (int body = 0; body < 2; ++body)
      for (int i = 0; i < 3; ++i) at[body][i] = safe_.place(body, parts[body]->point[i]);
    const auto [squared, point1, point2] = closest_points(at[0], at[1]);
    const double distance = std::sqrt(squared);
    if (distance <= tolerance_ && in_contact_(safe_.now())) return {.time = safe_.now()};
    const Vec3 between = point2 - point1;
    offer(longest, parts, normalized(between));
    offer(longest, parts, beside(between, safe_.velocity(point1, point2)));
    for (const Corners& t : at) offer(longest, parts, facing(cross(t[1] - t[0], t[2] - t[0]), between));
    if (distance * distance < 8 * safe_.rounding() * std::max(size_of(at[0]), size_of(at[1])))
      offer_features(longest, parts, at, between);
    if (longest.done()) return {};
    if (!(longest.time > safe_.now()) || ++pair.steps > kMostSteps)
      return {.time = safe_.now(), .decided = false};
    pair.direction = longest.direction;
    put_off(pair, longest.time);
    return {};
  }

  // Rounding turns the vector between points that are very close, by its own size over their distance, and
  // lets large faces overlap along it. The directions that their features have in exact arithmetic are
  // perpendicular to an edge, or to one of each face.
  void offer_features(Longest& longest, const TwoParts& parts, const std::array<Corners, 2>& at,
                      const Vec3& between) const {
    std::array<Corners, 2> edges;
    for (int body = 0; body < 2; ++body)
      for (int i = 0; i < 3; ++i) {
        edges[body][i] = normalized(at[body][(i + 1) % 3] - at[body][i]);
        offer(longest, parts, beside(between, edges[body][i]));
      }
    for (const Vec3& edge1 : edges[0])
      for (const Vec3& edge2 : edges[1]) offer(longest, parts, facing(cross(edge1, edge2), between));
  }
  static double size_of(const Corners& t) {
    return std::max({norm(t[1] - t[0]), norm(t[2] - t[1]), norm(t[0] - t[2])});
  }

  // The axis, of length 1, in the direction of `ahead`.
  static Vec3 facing(const Vec3& axis, const Vec3& ahead) {
    return normalized(dot(axis, ahead) < 0 ? -axis : axis);
  }

  void put_off(Pair& pair, double time) {
    pair.time = time;
    later_.push_back(pair);
    std::push_heap(later_.begin(), later_.end(), std::greater{});
  }

  // Into the pairs with the children of the larger node, or with the faces of a leaf.
  void divide(const Pair& pair) {
    const bool first = parts_[0].size(pair.place[0]) >= parts_[1].size(pair.place[1]) ? !pair.place[0].face
                                                                                      : pair.place[1].face;
    const int body = first ? 0 : 1;
    Pair part{.time = pair.time, .place = pair.place, .direction = pair.direction};
    parts_[body].for_each_child(pair.place[body], [&](const Place& child) {
      part.place[body] = child;
      now_.push_back(part);
    });
  }

  std::array<Parts, 2> parts_;
  SafeTime safe_;
  const double tolerance_;
  const std::function<bool(double)>& in_contact_;
  const std::atomic<double>* const until_;
  std::vector<Pair> now_;    // a stack: those that are safe until now, or not examined
  std::vector<Pair> later_;  // a heap: those that are safe until later, the earliest on top
};

}  // namespace

FreeMotion find_first_contact(const MovingSurface& o1, const MovingSurface& o2, double tolerance,
                              const std::function<bool(double)>& in_contact,
                              const std::atomic<double>* until) {
  return Search(o1, o2, tolerance, in_contact, until).run();
}

void MovingPair::set_time(double time) {
  for (int body = 0; body < 2; ++body) bodies_[body].set_pose(motions_[body]->at(time));
  const pair::Hints hints = begun_ ? answers_.known().hints() : pair::Hints{};
  answers_.begin(bodies_[0], bodies_[1], hints);
  begun_ = true;
}

TimeOfContact MovingPair::found(double time) {
  const BoundedLength& separation = answers_.separation();
  TimeOfContact found{.time = time, .separation = separation.value, .faces = answers_.closest_faces()};
  if (separation.witness) found.witness = *separation.witness;
  if (separation.value > 0 && separation.witness)
    found.normal = normalized(found.witness[0] - found.witness[1]);
  return found;
}

// The largest distance of a point of a body from the centre of its motion; of a half-space, of a point of the
// other body from that centre.
double MovingPair::from_centre(int body) const {
  const shape::Body& of = bodies_[body].body();
  const DividedMotion& motion = *motions_[body];
  if (!of.half_space()) return motion.scale() * (norm(of.ball().centre - motion.middle()) + of.ball().radius);
  const DividedMotion& other = *motions_[1 - body];
  const Vec3 first = other.start() - motion.start(), last = first + other.shift() - motion.shift();
  return std::max(norm(first), norm(last)) + from_centre(1 - body);
}

// How fast the bodies can approach each other from now on, at most: any two points, or their extents along
// the normal, if a plane across it separates them. The velocity of a point at q from the centre is w × q, no
// more than |n × w| |q| along n.
double MovingPair::closing_speed(bool along_normal) {
  const Vec3 shift = motions_[0]->shift() - motions_[1]->shift();
  const Vec3 n = along_normal ? answers_.relation().normal : Vec3{};
  double speed = along_normal ? -dot(n, shift) : norm(shift);
  for (int body = 0; body < 2; ++body) {
    const DividedMotion& motion = *motions_[body];
    if (!motion.turns()) continue;
    if (along_normal && bodies_[body].body().half_space()) return kInfinity;
    const double across = along_normal ? norm(cross(n, motion.axis())) : 1;
    speed += motion.angle() * across * from_centre(body);
  }
  return speed;
}

// Conservative advancement of the bodies as a whole, until they are within the tolerance.
FreeMotion MovingPair::advance(double tolerance, const std::atomic<double>& until) {
  constexpr std::uint32_t kMostSteps = 1'000'000;
  double time = 0;
  Poll due(256);
  for (std::uint32_t step = 0; step < kMostSteps; ++step) {
    due();
    const double apart = answers_.separation().lower;
    if (apart <= tolerance) return {.time = time};
    if (time > until.load(std::memory_order_relaxed)) return {};
    double speed = closing_speed(false);
    if (const solids::Relation& relation = answers_.relation(); relation.signed_distance && relation.gap > 0)
      speed = std::min(speed, closing_speed(true));
    if (!(speed > 0)) return {};
    const double next = time + (apart - 0.5 * tolerance) / speed;
    if (!(next < 1)) return {};
    if (!(next > time)) break;
    time = next;
    set_time(time);
  }
  return {.time = time, .decided = false};
}

TimeOfContact MovingPair::at(double time) {
  set_time(time);
  return found(time);
}

std::optional<TimeOfContact> MovingPair::first_contact(double tolerance, const std::atomic<double>& until) {
  set_time(0);
  if (answers_.within(tolerance)) {
    const bool collide = answers_.colliding();
    TimeOfContact contact = found(0);
    if (collide && contact.normal) contact.normal = -*contact.normal;
    contact.contact = true;
    return contact;
  }
  if (motions_[0]->rests() && motions_[1]->rests()) return std::nullopt;
  const auto surface = [&](int body) {
    return MovingSurface{internals(bodies_[body].body().sites()), *motions_[body]};
  };
  const auto in_contact = [&](double time) {
    set_time(time);
    return answers_.separation().value <= tolerance;
  };
  const bool solids = solids::are_solid_pair(bodies_[0], bodies_[1]);
  const FreeMotion free = solids ? advance(tolerance, until)
                                 : find_first_contact(surface(0), surface(1), tolerance, in_contact, &until);
  if (free.time > until.load(std::memory_order_relaxed)) return std::nullopt;
  set_time(free.time);
  if (free.decided && !answers_.surfaces_within(tolerance)) return std::nullopt;
  TimeOfContact contact = found(free.time);
  contact.contact = true;
  if (contact.separation > tolerance) contact.certainty = Certainty::bounded;
  return contact;
}

}  // namespace sdm::motion
