// Proximity of one shape in many poses.
#include <nanobind/stl/optional.h>
#include <sdm/error.h>
#include <sdm/proximity_query.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "objects.h"
#include "options.h"
#include "proximity.h"
#include "stored.h"

namespace sdm::python {
namespace {

struct PyPoseQuery {
  PoseQuery query;
  Access access;
};

// One shape, or a list of shapes; a pair of arrays is one mesh.
std::vector<Shape> obstacles_of(nb::handle obstacles) {
  std::vector<Shape> shapes;
  if (!nb::isinstance<nb::list>(obstacles)) {
    shapes.push_back(shape_of(obstacles));
    return shapes;
  }
  for (const nb::handle obstacle : nb::iter(obstacles)) shapes.push_back(shape_of(obstacle));
  return shapes;
}

// Calls work(poses) without the GIL; Python handles signals meanwhile if there are many poses.
template <class Work>
auto for_poses(PyPoseQuery& self, nb::handle array, const Work& work) {
  const Poses poses(array, "poses");
  const auto lock = self.access.change();
  constexpr std::size_t kFacesOfPose = 10;  // of the time of run_sized()
  return run_sized(kFacesOfPose * poses.get().size(), [&] { return work(poses.get()); });
}

void bind_answers_of_poses(nb::class_<PyPoseQuery>& query) {
  query
      .def(
          "colliding",
          [](PyPoseQuery& self, nb::handle poses) {
            auto found = for_poses(self, poses,
                                   [&](std::span<const Transform> all) { return self.query.colliding(all); });
            const std::size_t count = found.size();
            return array_of<bool>(std::move(found), {count});
          },
          nb::arg("poses").none(),
          nb::sig("def colliding(self, poses: object) -> numpy.typing.NDArray[numpy.bool_]"),
          "Returns whether the shape collides with any obstacle, (n,) bool; exact.")
      .def(
          "separations",
          [](PyPoseQuery& self, nb::handle poses, double max_distance) {
            auto found = for_poses(self, poses, [&](std::span<const Transform> all) {
              return self.query.separations(all, max_distance);
            });
            const std::size_t count = found.size();
            return array_of<double>(std::move(found), {count});
          },
          nb::arg("poses").none(), nb::kw_only(), nb::arg("max_distance") = kInfinity,
          nb::sig("def separations(self, poses: object, *, max_distance: float = ...) -> "
                  "numpy.typing.NDArray[numpy.float64]"),
          R"(Returns the smallest distances between the surfaces of the shape and of any obstacle, (n,) float64:
exact, 0 if they intersect; infinite if it is more than max_distance, > 0. A smaller one takes less time.)")
      .def(
          "penetration_depths",
          [](PyPoseQuery& self, nb::handle poses) {
            const auto found = for_poses(self, poses, [&](std::span<const Transform> all) {
              return self.query.penetration_depths(all);
            });
            return column(found, [](const BoundedNumber& depth) {
              return std::array{depth.lower, depth.upper};
            });
          },
          nb::arg("poses").none(),
          nb::sig("def penetration_depths(self, poses: object) -> numpy.typing.NDArray[numpy.float64]"),
          R"(Returns lower and upper bounds on the largest penetration depth of the shape and any obstacle,
(n, 2) float64, of the pairs of which one is a solid: both 0 without a collision; NaN if there is no such pair.)");
}

}  // namespace

void bind_poses(nb::module_& module) {
  static const std::string signature = "def __init__(self, shape: object, obstacles: object, *, " +
                                       option_signature("PoseQuery") + ") -> None";
  nb::class_<PyPoseQuery> query(module, "PoseQuery", nb::is_weak_referenceable(),
                                R"(Proximity of one shape in many poses to obstacles, other shapes at rest.

shape: any form of a mesh (see Mesh), or a Shape. obstacles: one of these, or a list of them.
depth_precision: as of ProximityQuery.

Poses are (n, 4, 4) numbers, matrices as of ProximityQuery.set_pose(), or (n, 7): each a position x y z and a
quaternion w x y z of any length. The answers are those of ProximityQuery for the shape and each obstacle, on all
cores; consecutive poses that are near each other take less time. Raises Error for a pose that is
no rotation with a uniform scale and a translation, and while another thread uses the object.

>>> query = sdm.PoseQuery(box, [box])
>>> query.colliding([[0.5, 0, 0, 1, 0, 0, 0], [3, 0, 0, 1, 0, 0, 0]])
array([ True, False])
>>> query.separations([[3, 0, 0, 1, 0, 0, 0], [9, 0, 0, 1, 0, 0, 0]], max_distance=2)
array([ 2., inf]))");
  query
      .def(
          "__init__",
          [](PyPoseQuery* self, nb::handle shape, nb::handle obstacles, const nb::kwargs& given) {
            check_keywords("PoseQuery", given);
            PoseQueryOptions options;
            set_options(given, options);
            new (self) PyPoseQuery{PoseQuery(shape_of(shape), obstacles_of(obstacles), options), {}};
          },
          nb::arg("shape").none(), nb::arg("obstacles").none(), nb::arg("options"),
          nb::sig(signature.c_str()))
      .def(
          "set_pose",
          [](PyPoseQuery& self, std::int64_t obstacle, nb::handle pose) {
            const Transform matrix = transform(pose, "pose");
            if (obstacle < 0) throw Error("there is no obstacle " + std::to_string(obstacle));
            const auto lock = self.access.change();
            self.query.set_pose(static_cast<std::size_t>(obstacle), matrix);
          },
          nb::arg("obstacle"), nb::arg("pose").none(),
          nb::sig("def set_pose(self, obstacle: int, pose: object) -> None"),
          "Sets the pose of an obstacle, as ProximityQuery.set_pose(). Initially the identity.")
      .def("__repr__", [](const PyPoseQuery&) { return "sdm.PoseQuery()"; });
  bind_answers_of_poses(query);
  bind_no_state<PyPoseQuery>(
      "a PoseQuery cannot be pickled or copied; pickle its meshes or Shapes, and make another one");
}

}  // namespace sdm::python
