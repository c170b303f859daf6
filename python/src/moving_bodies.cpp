// The first contacts of many bodies that move.
#include <limits>

#include "options.h"
#include "proximity.h"
#include "values.h"

namespace sdm::python {
namespace {

struct PyTimesOfContact {
  std::vector<PairTimeOfContact> pairs;
  LazyArray bodies, parts, time, separation, witness, faces, normal, bounded;
};

}  // namespace

template <>
inline constexpr auto kMembers<PyTimesOfContact> = std::tuple{&PyTimesOfContact::pairs};

namespace {

// A property with get(pair) of all pairs.
template <class Get>
auto contact_column(LazyArray PyTimesOfContact::*array, Get get) {
  return [array, get](PyTimesOfContact& self) {
    return (self.*array).get([&] { return column(self.pairs, get); });
  };
}

void bind_times_of_contact(nb::module_& module) {
  using T = PyTimesOfContact;
  using Pair = PairTimeOfContact;
  nb::class_<T>(
      module, "TimesOfContact", nb::is_weak_referenceable(),
      "The first contacts of pairs of bodies that move, as arrays with one row each, sorted by time, then by "
      "first and second body.")
      .def_prop_ro("bodies",
                   contact_column(&T::bodies,
                                  [](const Pair& p) {
                                    return std::array{p.first, p.second};
                                  }),
                   nb::sig("def bodies(self) -> numpy.typing.NDArray[numpy.uint32]"),
                   "The indices of O1 and O2, (n, 2) uint32, the smaller one first.")
      .def_prop_ro("parts", contact_column(&T::parts, [](const Pair& p) { return p.parts; }),
                   nb::sig("def parts(self) -> numpy.typing.NDArray[numpy.uint32]"),
                   "The parts of O1 and O2 that come into contact first, (n, 2) uint32; see Compound.")
      .def_prop_ro(
          "time", contact_column(&T::time, [](const Pair& p) { return p.time_of_contact.time; }),
          nb::sig("def time(self) -> numpy.typing.NDArray[numpy.float64]"),
          R"(The times of the first contacts, in [0, 1], (n,) float64. The bodies of a pair do not touch
before: they are more than half of the tolerance apart.)")
      .def_prop_ro("separation",
                   contact_column(&T::separation, [](const Pair& p) { return p.time_of_contact.separation; }),
                   nb::sig("def separation(self) -> numpy.typing.NDArray[numpy.float64]"),
                   "The smallest distances between their surfaces at these times, in units of space, (n,) "
                   "float64; exact.")
      .def_prop_ro(
          "witness", contact_column(&T::witness, [](const Pair& p) { return p.time_of_contact.witness; }),
          nb::sig("def witness(self) -> numpy.typing.NDArray[numpy.float64]"),
          "A point of O1 and one of O2 that are the separation apart then, in space, (n, 2, 3) float64.")
      .def_prop_ro("faces", contact_column(&T::faces, [](const Pair& p) { return p.time_of_contact.faces; }),
                   nb::sig("def faces(self) -> numpy.typing.NDArray[numpy.uint32]"),
                   "A face of O1 and one of O2 that contain these points, (n, 2) uint32.")
      .def_prop_ro("normal",
                   contact_column(&T::normal,
                                  [](const Pair& p) {
                                    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
                                    return p.time_of_contact.normal.value_or(Vec3{nan, nan, nan});
                                  }),
                   nb::sig("def normal(self) -> numpy.typing.NDArray[numpy.float64]"),
                   R"(Unit vectors along which moving O1 separates it from O2, (n, 3) float64; NaN where the
surfaces intersect at time 0.)")
      .def_prop_ro(
          "bounded",
          [](T& self) {
            return self.bounded.get([&] {
              std::vector<std::uint8_t> flags(self.pairs.size());
              for (std::size_t i = 0; i < flags.size(); ++i)
                flags[i] = self.pairs[i].time_of_contact.certainty != Certainty::exact;
              return array_of<bool>(std::move(flags), {self.pairs.size()});
            });
          },
          nb::sig("def bounded(self) -> numpy.typing.NDArray[numpy.bool_]"),
          R"(Where it is not decided whether there is a contact, but the motions are free until ``time`` for certain,
(n,) bool: ``TimeOfContact.certainty`` is 'bounded'.)")
      .def("__len__", [](const T& self) { return self.pairs.size(); })
      .def("__repr__",
           [](const T& self) { return nb::str("sdm.TimesOfContact({})").format(self.pairs.size()); });
  bind_value<T>();
}

std::vector<Motion> motions_of(nb::handle starts, nb::handle ends) {
  const Poses from(starts, "starts"), to(ends, "ends");
  if (from.get().size() != to.get().size())
    throw Error("there are " + std::to_string(from.get().size()) + " starts, but " +
                std::to_string(to.get().size()) + " ends; give one of both for each body");
  std::vector<Motion> motions(from.get().size());
  for (std::size_t b = 0; b < motions.size(); ++b) motions[b] = {from.get()[b], to.get()[b]};
  return motions;
}

}  // namespace

constexpr const char* kCall = "MultiBodyQuery.time_of_contact";

void bind_moving_bodies(nb::module_& module, nb::class_<PyMultiBodyQuery>& query) {
  bind_times_of_contact(module);
  static const std::string signature =
      "def time_of_contact(self, starts: object, ends: object, *, tolerance: float, " +
      option_signature(kCall) + ") -> TimesOfContact";
  static const std::string documentation =
      R"(Returns the pairs that come into contact while each body moves from one pose to another, whatever
their poses now: the first contact of each pair, as of sdm.time_of_contact().

starts, ends: the poses of all bodies at time 0 and at time 1, as of set_poses().
tolerance: > 0, in units of space, as of sdm.time_of_contact().
)" + option_documentation(kCall) +
      R"(

A Compound turns about the centre of the box of all its parts in its frame. Pairs are those of the filters, and
each is by itself: bodies move on after their contacts. None is missed,
however thin the bodies and long the motions. Raises Error for another number of poses, or one that is out of
range. Cost: a sweep over the boxes around the motions, and that of sdm.time_of_contact() for each pair whose
boxes are within the tolerance, on all cores.

>>> query = sdm.MultiBodyQuery([box, box, box])
>>> starts = np.tile(np.eye(4), (3, 1, 1))
>>> starts[:, 0, 3] = [0, 5, 9]
>>> ends = starts.copy()
>>> ends[0, 0, 3] = 20
>>> found = query.time_of_contact(starts, ends, tolerance=1e-6)
>>> found.bodies.tolist(), found.time.round(5).tolist()
([[0, 1], [0, 2]], [0.2, 0.4]))";
  query.def(
      "time_of_contact",
      [](const PyMultiBodyQuery& self, nb::handle starts, nb::handle ends, double tolerance,
         const nb::kwargs& given) {
        check_keywords(kCall, given);
        TimeOfContactOptions options;
        set_options(given, options);
        const std::vector<Motion> motions = motions_of(starts, ends);
        const auto lock = self.access.use();
        auto result = std::make_unique<PyTimesOfContact>();
        run_sized(faces_of(self.query),
                  [&] { result->pairs = self.query.time_of_contact(motions, tolerance, options); });
        return result.release();
      },
      nb::rv_policy::take_ownership, nb::arg("starts").none(), nb::arg("ends").none(), nb::kw_only(),
      nb::arg("tolerance"), nb::arg("options"), nb::sig(signature.c_str()), documentation.c_str());
  query.def(
      "poses_at",
      [](const PyMultiBodyQuery& self, nb::handle starts, nb::handle ends, double time) {
        const std::vector<Motion> motions = motions_of(starts, ends);
        const auto lock = self.access.use();
        std::vector<Transform> poses = self.query.poses_at(motions, time);
        const std::size_t count = poses.size();
        return array_of<double>(std::move(poses), {count, 4, 4});
      },
      nb::arg("starts").none(), nb::arg("ends").none(), nb::arg("time"),
      nb::sig("def poses_at(self, starts: object, ends: object, time: float) -> "
              "numpy.typing.NDArray[numpy.float64]"),
      R"(Returns the poses of all bodies at a time, in [0, 1], of the motions of time_of_contact(), (n, 4, 4)
float64.)");
}

}  // namespace sdm::python
