// When two moving bodies first come into contact.
#include <sdm/time_of_contact.h>

#include "proximity.h"

namespace sdm::python {
namespace {

struct PyTimeOfContact {
  TimeOfContact found;
  std::array<Transform, 2> poses;  ///< at that time
};

Motion motion_of(nb::handle poses, const char* name) {
  const auto [from, to] = motion(poses, name);
  return {from, to};
}

}  // namespace

void bind_time_of_contact(nb::module_& module) {
  using T = PyTimeOfContact;
  nb::class_<T>(module, "TimeOfContact", "When two moving bodies first come into contact, if they do.")
      .def_prop_ro(
          "contact", [](const T& self) { return self.found.contact; },
          "Whether the bodies collide at ``time``, or are at most the tolerance apart.")
      .def_prop_ro(
          "time", [](const T& self) { return self.found.time; },
          "The bodies do not touch before this, in [0, 1]; 1 if they come no nearer than the tolerance.")
      .def_prop_ro(
          "separation", [](const T& self) { return self.found.separation; },
          "The smallest distance between the surfaces at ``time``, in units of space; exact.")
      .def_prop_ro(
          "pose1", [](const T& self) { return matrix(self.poses[0]); },
          nb::sig("def pose1(self) -> numpy.ndarray"),
          "The pose of the first body at ``time``, (4, 4) float64.")
      .def_prop_ro(
          "pose2", [](const T& self) { return matrix(self.poses[1]); },
          nb::sig("def pose2(self) -> numpy.ndarray"), "That of the second.")
      .def("__repr__", [](const T& self) {
        return nb::str("sdm.TimeOfContact({}, time={:.9g}, separation={:.6g})")
            .format(self.found.contact ? "contact" : "no contact", self.found.time, self.found.separation);
      });

  module.def(
      "time_of_contact",
      [](nb::handle o1, nb::handle motion1, nb::handle o2, nb::handle motion2, double tolerance) {
        const Shape first = shape_of(o1), second = shape_of(o2);
        const Motion m1 = motion_of(motion1, "motion1"), m2 = motion_of(motion2, "motion2");
        return run_short([&] {
          T result{time_of_contact(first, m1, second, m2, tolerance), {}};
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
tolerance: > 0, in units of space: bodies that come closer than this are in contact.

By conservative advancement: no contact is missed, however thin the bodies and long the motions. Bodies that
collide at first have contact at time 0. Raises Error for unusable meshes, poses or tolerances. Cost: some ten
searches for the closest faces; more where the bodies pass each other closely.

>>> far, beyond = np.eye(4), np.eye(4)
>>> far[0, 3], beyond[0, 3] = 5, -5
>>> found = sdm.time_of_contact(box, (far, beyond), box, None, tolerance=1e-6)
>>> found.contact, round(found.time, 6), round(float(found.pose1[0, 3]), 5)
(True, 0.4, 1.0))");
}

}  // namespace sdm::python
