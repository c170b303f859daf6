// When two moving bodies first come into contact.
#include <nanobind/stl/optional.h>
#include <sdm/proximity_query.h>

#include "objects.h"
#include "proximity.h"
#include "values.h"

namespace sdm::python {
namespace {

struct PyTimeOfContact {
  TimeOfContact found;
  std::array<Transform, 2> poses;  ///< at that time
};

}  // namespace

template <>
inline constexpr auto kMembers<PyTimeOfContact> =
    std::tuple{&PyTimeOfContact::found, &PyTimeOfContact::poses};

namespace {

Motion motion_of(nb::handle poses, const char* name) {
  const auto [from, to] = motion(poses, name);
  return {from, to};
}

void bind_result(nb::module_& module) {
  using T = PyTimeOfContact;
  nb::class_<T> result(module, "TimeOfContact", nb::is_weak_referenceable(),
                       "When two moving bodies first come into contact, if they do.");
  bind_fields_of<TimeOfContact>(result, [](const T& self) -> const TimeOfContact& { return self.found; })
      .def_prop_ro(
          "pose1", [](const T& self) { return matrix(self.poses[0]); },
          nb::sig("def pose1(self) -> numpy.typing.NDArray[numpy.float64]"),
          "The pose of the first body at ``time``, (4, 4) float64.")
      .def_prop_ro(
          "pose2", [](const T& self) { return matrix(self.poses[1]); },
          nb::sig("def pose2(self) -> numpy.typing.NDArray[numpy.float64]"), "That of the second.")
      .def("__repr__", [](const T& self) {
        return nb::str("sdm.TimeOfContact({}, time={:.9g}, separation={:.6g})")
            .format(self.found.contact ? "contact" : "no contact", self.found.time, self.found.separation);
      });
  bind_value<T>();
}

}  // namespace

void bind_time_of_contact(nb::module_& module) {
  bind_result(module);
  module.def(
      "time_of_contact",
      [](nb::handle o1, nb::handle motion1, nb::handle o2, nb::handle motion2, double tolerance) {
        const Shape first = shape_of(o1), second = shape_of(o2);
        const Motion m1 = motion_of(motion1, "motion1"), m2 = motion_of(motion2, "motion2");
        return run_sized(faces_of(first) + faces_of(second), [&] {
          PyTimeOfContact result{time_of_contact(first, m1, second, m2, tolerance), {}};
          result.poses = {m1.at(result.found.time, first), m2.at(result.found.time, second)};
          return result;
        });
      },
      nb::arg("o1").none(), nb::arg("motion1").none(), nb::arg("o2").none(), nb::arg("motion2").none(),
      nb::kw_only(), nb::arg("tolerance"),
      nb::sig("def time_of_contact(o1: object, motion1: object, o2: object, motion2: object, *, tolerance: "
              "float) -> TimeOfContact"),
      R"(Finds when two bodies that move from one pose to another first come into contact.

o1, o2: each any form of a mesh (see Mesh), or a Shape.
motion1, motion2: the poses at time 0 and at time 1: two 4 × 4 matrices, as of ProximityQuery.set_pose(), with
the same scale; or one, or None (the identity), for a body at rest. The centre of the mesh's box moves along a
straight line, and the body turns about it with constant speed, by at most 180°.
tolerance: > 0, in units of space: bodies that come closer than its half are in contact, and those farther apart
are not. Where it is less than the rounding of coordinates, the result is 'bounded'.

By controlled conservative advancement of pairs of parts: no contact is missed, however thin the bodies and long
the motions. Bodies that collide at first have contact at time 0. Raises Error for unusable meshes, poses or
tolerances. Cost: two searches for the closest faces, and that of the parts that come near each other before the
contact.

>>> far, beyond = np.eye(4), np.eye(4)
>>> far[0, 3], beyond[0, 3] = 5, -5
>>> found = sdm.time_of_contact(box, (far, beyond), box, None, tolerance=1e-6)
>>> found.contact, round(found.time, 6), round(float(found.pose1[0, 3]), 5)
(True, 0.4, 1.0)
>>> found.certainty, round(float(found.normal[0]), 6)
('exact', 1.0))");
}

}  // namespace sdm::python
