// Proximity of many bodies.
#include <nanobind/stl/optional.h>
#include <sdm/error.h>

#include <array>
#include <string>

#include "arrays.h"
#include "objects.h"
#include "options.h"
#include "proximity.h"
#include "values.h"

namespace sdm::python {
namespace {

struct PySeparations {
  std::vector<PairSeparation> pairs;
  LazyArray bodies, parts, separation, witness, colliding;
};

struct PyPenetrationDepths {
  std::vector<PairDepth> pairs;
  LazyArray bodies, parts, depth, depth_bounds;
};

struct PySeparatingTranslations {
  std::vector<PairTranslation> pairs;
  LazyArray bodies, translation, length, length_bounds;
};

}  // namespace

template <>
inline constexpr auto kMembers<PySeparations> = std::tuple{&PySeparations::pairs};
template <>
inline constexpr auto kMembers<PyPenetrationDepths> = std::tuple{&PyPenetrationDepths::pairs};
template <>
inline constexpr auto kMembers<PySeparatingTranslations> = std::tuple{&PySeparatingTranslations::pairs};

namespace {

// The query throws for one that is too large.
std::size_t index_of(std::int64_t body) {
  if (body < 0) throw Error("there is no body " + std::to_string(body));
  return static_cast<std::size_t>(body);
}

std::array<double, 2> bounds_of(const BoundedLength& length) {
  if (length.certainty == Certainty::exact) return {length.value, length.value};
  return {length.lower, length.upper};
}

template <class Pairs, class Get>
auto pair_column(LazyArray Pairs::*array, Get get) {
  return [array, get](Pairs& self) { return (self.*array).get([&] { return column(self.pairs, get); }); };
}

constexpr auto kBodiesOfPair = [](const auto& pair) { return std::array{pair.first, pair.second}; };
constexpr auto kPartsOfPair = [](const auto& pair) { return pair.parts; };

void bind_separations(nb::module_& module) {
  using P = PySeparations;
  nb::class_<P>(module, "Separations", nb::is_weak_referenceable(),
                "The near pairs of bodies as arrays with one row each, sorted by first, then second body.")
      .def_prop_ro("bodies", pair_column(&P::bodies, kBodiesOfPair),
                   nb::sig("def bodies(self) -> numpy.typing.NDArray[numpy.uint32]"),
                   "The indices of O1 and O2, (n, 2) uint32, the smaller one first.")
      .def_prop_ro("parts", pair_column(&P::parts, kPartsOfPair),
                   nb::sig("def parts(self) -> numpy.typing.NDArray[numpy.uint32]"),
                   "The parts of O1 and O2 that are the separation apart, (n, 2) uint32; see Compound.")
      .def_prop_ro("separation",
                   pair_column(&P::separation, [](const PairSeparation& p) { return p.separation.value; }),
                   nb::sig("def separation(self) -> numpy.typing.NDArray[numpy.float64]"),
                   "The smallest distances of their surfaces, (n,) float64; exact.")
      .def_prop_ro("witness",
                   pair_column(&P::witness,
                               [](const PairSeparation& p) {
                                 constexpr Vec3 none{kNan, kNan, kNan};
                                 return p.separation.witness.value_or(std::array{none, none});
                               }),
                   nb::sig("def witness(self) -> numpy.typing.NDArray[numpy.float64]"),
                   "A point of O1 and one of O2 that are the separation apart, (n, 2, 3) float64; NaN if "
                   "there is none.")
      .def_prop_ro(
          "colliding",
          [](P& self) {
            return self.colliding.get([&] {
              std::vector<std::uint8_t> flags(self.pairs.size());
              for (std::size_t i = 0; i < flags.size(); ++i) flags[i] = self.pairs[i].colliding;
              return array_of<bool>(std::move(flags), {self.pairs.size()});
            });
          },
          nb::sig("def colliding(self) -> numpy.typing.NDArray[numpy.bool_]"),
          "Whether they collide, (n,) bool; exact.")
      .def("__len__", [](const P& self) { return self.pairs.size(); })
      .def("__repr__",
           [](const P& self) { return nb::str("sdm.Separations({})").format(self.pairs.size()); });
  bind_value<P>();
}

void bind_penetration_depths(nb::module_& module) {
  using P = PyPenetrationDepths;
  nb::class_<P>(module, "PenetrationDepths", nb::is_weak_referenceable(),
                "The pairs of bodies that collide, and of which one is a solid, as arrays with one row each, "
                "sorted by first, then second body.")
      .def_prop_ro("bodies", pair_column(&P::bodies, kBodiesOfPair),
                   nb::sig("def bodies(self) -> numpy.typing.NDArray[numpy.uint32]"),
                   "The indices of O1 and O2, (n, 2) uint32, the smaller one first.")
      .def_prop_ro("parts", pair_column(&P::parts, kPartsOfPair),
                   nb::sig("def parts(self) -> numpy.typing.NDArray[numpy.uint32]"),
                   "The parts of O1 and O2 that have this depth, (n, 2) uint32; see Compound.")
      .def_prop_ro("penetration_depth",
                   pair_column(&P::depth, [](const PairDepth& p) { return p.penetration_depth.value; }),
                   nb::sig("def penetration_depth(self) -> numpy.typing.NDArray[numpy.float64]"),
                   "The penetration depths, (n,) float64; within their bounds.")
      .def_prop_ro(
          "penetration_depth_bounds",
          pair_column(&P::depth_bounds, [](const PairDepth& p) { return bounds_of(p.penetration_depth); }),
          nb::sig("def penetration_depth_bounds(self) -> numpy.typing.NDArray[numpy.float64]"),
          "Lower and upper bounds on the penetration depths, (n, 2) float64.")
      .def("__len__", [](const P& self) { return self.pairs.size(); })
      .def("__repr__",
           [](const P& self) { return nb::str("sdm.PenetrationDepths({})").format(self.pairs.size()); });
  bind_value<P>();
}

void bind_separating_translations(nb::module_& module) {
  using P = PySeparatingTranslations;
  nb::class_<P>(
      module, "SeparatingTranslations", nb::is_weak_referenceable(),
      "How the pairs of bodies that collide leave each other, as arrays with one row each, sorted by "
      "first, then second body.")
      .def_prop_ro("bodies", pair_column(&P::bodies, kBodiesOfPair),
                   nb::sig("def bodies(self) -> numpy.typing.NDArray[numpy.uint32]"),
                   "The indices of O1 and O2, (n, 2) uint32, the smaller one first.")
      .def_prop_ro("translation",
                   pair_column(&P::translation,
                               [](const PairTranslation& p) { return p.separating_translation.translation; }),
                   nb::sig("def translation(self) -> numpy.typing.NDArray[numpy.float64]"),
                   "Moving O1 by it ends the collision, (n, 3) float64; verified by the exact test.")
      .def_prop_ro(
          "length",
          pair_column(&P::length, [](const PairTranslation& p) { return p.separating_translation.value; }),
          nb::sig("def length(self) -> numpy.typing.NDArray[numpy.float64]"),
          "The lengths of the translations, (n,) float64; the same as the upper bounds.")
      .def_prop_ro(
          "length_bounds",
          pair_column(&P::length_bounds,
                      [](const PairTranslation& p) {
                        return std::array{p.separating_translation.lower, p.separating_translation.upper};
                      }),
          nb::sig("def length_bounds(self) -> numpy.typing.NDArray[numpy.float64]"),
          "Lower and upper bounds on the length of the shortest translation, (n, 2) float64.")
      .def("__len__", [](const P& self) { return self.pairs.size(); })
      .def("__repr__",
           [](const P& self) { return nb::str("sdm.SeparatingTranslations({})").format(self.pairs.size()); });
  bind_value<P>();
}

MultiBodyQuery query_of(nb::handle bodies, const ProximityOptions& options) {
  std::vector<std::vector<BodyPart>> all;
  std::size_t i = 0;
  for (const nb::handle body : nb::iter(bodies)) {
    try {
      all.push_back(parts_of(body));
    } catch (const Cancelled&) {
      throw;
    } catch (const Error& error) {
      throw Error("body " + std::to_string(i) + ": " + error.what());
    }
    ++i;
  }
  return MultiBodyQuery(std::move(all), options);
}

void bind_motion(nb::class_<PyMultiBodyQuery>& query) {
  static const std::string signature = "def __init__(self, bodies: collections.abc.Iterable[object], *, " +
                                       option_signature("MultiBodyQuery") + ") -> None";
  query
      .def(
          "__init__",
          [](PyMultiBodyQuery* self, nb::handle bodies, const nb::kwargs& given) {
            check_keywords("MultiBodyQuery", given);
            ProximityOptions options;
            set_options(given, options);
            new (self) PyMultiBodyQuery{query_of(bodies, options), {}};
          },
          nb::arg("bodies").none(), nb::arg("options"), nb::sig(signature.c_str()))
      .def("__len__", [](const PyMultiBodyQuery& self) { return self.query.size(); })
      .def(
          "set_pose",
          [](PyMultiBodyQuery& self, std::int64_t body, nb::handle pose) {
            const Transform matrix = transform(pose, "pose");
            const auto lock = self.access.change();
            self.query.set_pose(index_of(body), matrix);
          },
          nb::arg("body"), nb::arg("pose").none(),
          nb::sig("def set_pose(self, body: int, pose: object) -> None"),
          "Sets the pose of a body, as ProximityQuery.set_pose().")
      .def(
          "set_poses",
          [](PyMultiBodyQuery& self, nb::handle poses) {
            const Poses all(poses, "poses");
            const auto lock = self.access.change();
            self.query.set_poses(all.get());
          },
          nb::arg("poses").none(), nb::sig("def set_poses(self, poses: object) -> None"),
          R"(Sets the poses of all bodies: (n, 4, 4) numbers, or (n, 7), each a position x y z and a quaternion
w x y z of any length.)")
      .def(
          "pose",
          [](const PyMultiBodyQuery& self, std::int64_t body) {
            const auto lock = self.access.use();
            return matrix(self.query.pose(index_of(body)));
          },
          nb::arg("body"), nb::sig("def pose(self, body: int) -> numpy.typing.NDArray[numpy.float64]"),
          "The pose of a body, (4, 4) float64.")
      .def(
          "refit",
          [](PyMultiBodyQuery& self, std::int64_t body, nb::handle vertices) {
            const Points positions(vertices, "vertices");
            if (positions.get().empty()) throw Error("vertices is empty");  // would leave the body unchanged
            const auto lock = self.access.change();
            run_short([&] { self.query.refit(index_of(body), positions.get()); });
          },
          nb::arg("body"), nb::arg("vertices").none(),
          nb::sig("def refit(self, body: int, vertices: object) -> None"),
          R"(Moves the vertices of a body, (n, 3) numbers, keeping its faces and its pose. Raises Error,
and changes nothing, for a body that does not exist, is a Compound or whose Shape is shared, another number of vertices,
or coordinates that are not finite. Cost: linear.)");
}

void bind_filters(nb::class_<PyMultiBodyQuery>& query) {
  query
      .def(
          "set_filter",
          [](PyMultiBodyQuery& self, std::int64_t body, bool fixed, std::uint32_t groups,
             std::uint32_t mask) {
            const auto lock = self.access.change();
            self.query.set_filter(index_of(body), {.fixed = fixed, .groups = groups, .mask = mask});
          },
          nb::arg("body"), nb::kw_only(), nb::arg("fixed") = false, nb::arg("groups") = 1u,
          nb::arg("mask") = ~0u,
          nb::sig("def set_filter(self, body: int, *, fixed: bool = False, groups: int = 1, mask: int = "
                  "0xFFFFFFFF) -> None"),
          R"(Sets which pairs a body takes part in: two bodies are a pair if at most one of them is fixed, and
each one's mask contains a group of the other; both have a bit for each group. A fixed body may still be
moved.)")
      .def(
          "exclude_pair",
          [](PyMultiBodyQuery& self, std::int64_t a, std::int64_t b) {
            const auto lock = self.access.change();
            self.query.exclude_pair(index_of(a), index_of(b));
          },
          nb::arg("a"), nb::arg("b"), nb::sig("def exclude_pair(self, a: int, b: int) -> None"),
          "Leaves out a pair, as of two links that a joint connects.")
      .def(
          "include_pair",
          [](PyMultiBodyQuery& self, std::int64_t a, std::int64_t b) {
            const auto lock = self.access.change();
            self.query.include_pair(index_of(a), index_of(b));
          },
          nb::arg("a"), nb::arg("b"), nb::sig("def include_pair(self, a: int, b: int) -> None"),
          "Takes exclude_pair() back.");
}

// The contacts of all pairs, as one table.
std::unique_ptr<PyContacts> table_of(std::span<const PairContacts> pairs) {
  auto result = std::make_unique<PyContacts>();
  result->has_bodies = true;
  for (const PairContacts& pair : pairs) {
    result->contacts.insert(result->contacts.end(), pair.contacts.begin(), pair.contacts.end());
    result->parts.insert(result->parts.end(), pair.contacts.size(), pair.parts);
    result->bodies.insert(result->bodies.end(), pair.contacts.size(), {pair.first, pair.second});
  }
  return result;
}

std::vector<BodyPair> colliding_pairs(PyMultiBodyQuery& self) {
  const auto lock = self.access.change();
  std::vector<BodyPair> pairs;
  run_sized(faces_of(self.query), [&] {
    const auto found = self.query.colliding();
    pairs.assign(found.begin(), found.end());
  });
  return pairs;
}

void bind_answers(nb::class_<PyMultiBodyQuery>& query) {
  query
      .def(
          "colliding", [](PyMultiBodyQuery& self) { return column(colliding_pairs(self), kBodiesOfPair); },
          nb::sig("def colliding(self) -> numpy.typing.NDArray[numpy.uint32]"),
          "Returns the pairs that collide, (n, 2) uint32, the smaller index first; exact.")
      .def(
          "colliding_parts",
          [](PyMultiBodyQuery& self) { return column(colliding_pairs(self), kPartsOfPair); },
          nb::sig("def colliding_parts(self) -> numpy.typing.NDArray[numpy.uint32]"),
          "Returns the first parts that collide of each pair of colliding(), (n, 2) uint32; see Compound.")
      .def(
          "separations",
          [](PyMultiBodyQuery& self, double max_distance) {
            const auto lock = self.access.change();
            auto result = std::make_unique<PySeparations>();
            run_sized(faces_of(self.query), [&] {
              const auto pairs = self.query.separations(max_distance);
              result->pairs.assign(pairs.begin(), pairs.end());
            });
            return result.release();
          },
          nb::rv_policy::take_ownership, nb::kw_only(), nb::arg("max_distance") = kInfinity,
          nb::sig("def separations(self, *, max_distance: float = ...) -> Separations"),
          R"(Returns the pairs that collide or whose separation is at most max_distance, > 0, in units of the
meshes.)")
      .def(
          "penetration_depths",
          [](PyMultiBodyQuery& self) {
            const auto lock = self.access.change();
            auto result = std::make_unique<PyPenetrationDepths>();
            run_sized(faces_of(self.query), [&] {
              const auto pairs = self.query.penetration_depths();
              result->pairs.assign(pairs.begin(), pairs.end());
            });
            return result.release();
          },
          nb::rv_policy::take_ownership,
          "Returns the depths of the pairs that collide and of which one is a solid.")
      .def(
          "contacts",
          [](PyMultiBodyQuery& self) {
            const auto lock = self.access.change();
            return run_sized(faces_of(self.query), [&] { return table_of(self.query.contacts()); }).release();
          },
          nb::rv_policy::take_ownership,
          "Returns the contacts of all pairs, those of each as by ProximityQuery.contacts().");
}

void bind_separating_answers(nb::class_<PyMultiBodyQuery>& query) {
  query
      .def(
          "separating_translations",
          [](PyMultiBodyQuery& self) {
            const auto lock = self.access.change();
            auto result = std::make_unique<PySeparatingTranslations>();
            run_sized(faces_of(self.query), [&] {
              const auto pairs = self.query.separating_translations();
              result->pairs.assign(pairs.begin(), pairs.end());
            });
            return result.release();
          },
          nb::rv_policy::take_ownership,
          R"(Returns a short translation of O1 after which a pair does not collide, for each that does, as
ProximityQuery.separating_translation(). Of a Compound it is that of all parts together. With
ignore_internal_edges, where it leads out of a fixed solid into another one that is fixed beside it, it is one
that ends the collision with both: a box that overlaps a tile by little is moved off the floor.)")
      .def(
          "separating_contacts",
          [](PyMultiBodyQuery& self, std::optional<std::size_t> most_per_patch) {
            const auto lock = self.access.change();
            return run_sized(faces_of(self.query),
                             [&] { return table_of(self.query.separating_contacts(most_per_patch)); })
                .release();
          },
          nb::kw_only(), nb::arg("most_per_patch") = nb::none(), nb::rv_policy::take_ownership,
          nb::sig("def separating_contacts(self, *, most_per_patch: int | None = None) -> Contacts"),
          R"(Returns the contacts along which all pairs leave each other: of those that collide as by
ProximityQuery.separating_contacts(), for the translations of separating_translations(); of others as by
contacts(). most_per_patch: so many of each patch, >= 1.)");
}

void bind_nearest(nb::class_<PyMultiBodyQuery>& query) {
  query
      .def(
          "nearest_map",
          [](const PyMultiBodyQuery& self, std::int64_t body, double max_distance) {
            const auto lock = self.access.use();
            auto result = std::make_unique<PyNearestMap>();
            run_sized(faces_of(self.query),
                      [&] { self.query.nearest_map(index_of(body), max_distance, result->nearest); });
            return result.release();
          },
          nb::rv_policy::take_ownership, nb::arg("body"), nb::kw_only(), nb::arg("max_distance") = kInfinity,
          nb::sig("def nearest_map(self, body: int, *, max_distance: float = ...) -> NearestMap"),
          R"(Returns the distances from the texels of a body to the nearest other body; texels with none
within max_distance, > 0, have no value. Raises Error for a body that does not exist, is a Compound, or whose
Shape has no resolution.)")
      .def(
          "distances_at_vertices",
          [](const PyMultiBodyQuery& self, std::int64_t body, double max_distance) {
            const auto lock = self.access.use();
            std::vector<float> distances;
            run_sized(faces_of(self.query), [&] {
              distances = nearest_distances_at_vertices(self.query, index_of(body), max_distance);
            });
            const std::size_t count = distances.size();
            return array_of<float>(std::move(distances), {count});
          },
          nb::arg("body"), nb::kw_only(), nb::arg("max_distance") = kInfinity,
          nb::sig("def distances_at_vertices(self, body: int, *, max_distance: float = ...) -> "
                  "numpy.typing.NDArray[numpy.float32]"),
          R"(Returns the distance from each vertex of a body to the nearest other body, (n,) float32,
signed as in nearest_map(); NaN where none is within max_distance.)")
      .def("__repr__", [](const PyMultiBodyQuery& self) {
        return nb::str("sdm.MultiBodyQuery({} bodies)").format(self.query.size());
      });
}

}  // namespace

std::size_t faces_of(const MultiBodyQuery& query) {
  std::size_t faces = 0;
  for (std::size_t body = 0; body < query.size(); ++body)
    for (std::size_t part = 0; part < query.part_count(body); ++part)
      faces += faces_at([&]() -> const Sites& { return query.sites(body, part); });
  return faces;
}

void bind_bodies(nb::module_& module) {
  bind_compound(module);
  bind_separations(module);
  bind_penetration_depths(module);
  bind_separating_translations(module);
  bind_nearest_map(module);
  static const std::string documentation =
      R"(Proximity of bodies that move and deform, each against all others.

bodies: each any form of a mesh (see Mesh), a Shape, which many bodies can share, or a Compound of several.
)" + option_documentation("MultiBodyQuery") +
      R"( Tiles of fixed solids side by side are one floor.

Each call computes what it returns, and no more, for the pairs of which a body has moved since the last call:
the answers of ProximityQuery, to the bit. A call raises Error while another thread uses the object.

>>> shape = sdm.Shape(box)
>>> query = sdm.MultiBodyQuery([shape] * 3)
>>> poses = np.tile(np.eye(4), (3, 1, 1))
>>> poses[:, 0, 3] = [0, 2, 4]
>>> query.set_poses(poses)
>>> query.separations(max_distance=1.5).bodies
array([[0, 1],
       [1, 2]], dtype=uint32))";
  nb::class_<PyMultiBodyQuery> query(module, "MultiBodyQuery", nb::is_weak_referenceable(),
                                     documentation.c_str());
  bind_motion(query);
  bind_filters(query);
  bind_answers(query);
  bind_separating_answers(query);
  bind_moving_bodies(module, query);
  bind_nearest(query);
  bind_no_state<PyMultiBodyQuery>(
      "a MultiBodyQuery cannot be pickled or copied; pickle its meshes or Shapes, and make another one");
}

}  // namespace sdm::python
