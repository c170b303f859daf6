// Bodies of several shapes.
#include <sdm/error.h>

#include <string>
#include <utility>

#include "proximity.h"

namespace sdm::python {

std::vector<BodyPart> parts_of(nb::handle body) {
  if (nb::isinstance<PyCompound>(body)) return nb::cast<const PyCompound&>(body).parts;
  return {{shape_of(body)}};
}

void bind_compound(nb::module_& module) {
  nb::class_<PyCompound>(
      module, "Compound", nb::is_weak_referenceable(),
      R"(Several shapes that move as one body of MultiBodyQuery, as the links of a gripper or the tiles of a floor.

shapes: each any form of a mesh (see Mesh), or a Shape. poses: of the shapes in the frame of the body, (n, 4, 4)
or (n, 7) numbers, as of MultiBodyQuery.set_poses(); None: as the meshes are.

The answers for a pair of bodies are the smallest separation, the largest depth and all contacts of pairs of their
parts, and name these. Parts of a body are no pair, and where they overlap, a depth is that in one of them. Raises
Error for no shape, and for another number of poses.

>>> dumbbell = sdm.Compound([box, box], [[0, 0, 0, 1, 0, 0, 0], [3, 0, 0, 1, 0, 0, 0]])
>>> query = sdm.MultiBodyQuery([dumbbell, box])
>>> query.set_poses([[0, 0, 0, 1, 0, 0, 0], [5, 0, 0, 1, 0, 0, 0]])
>>> found = query.separations()
>>> found.separation.tolist(), found.parts.tolist()
([1.0], [[1, 0]]))")
      .def(
          "__init__",
          [](PyCompound* self, nb::handle shapes, nb::handle poses) {
            std::vector<BodyPart> parts;
            nb::list kept;
            for (const nb::handle shape : nb::iter(shapes)) {
              kept.append(nb::isinstance<PyShape>(shape) ? nb::borrow(shape) : nb::type<PyShape>()(shape));
              parts.push_back({shape_of(kept[parts.size()])});
            }
            if (parts.empty()) throw Error("a compound without shapes; give it one or more");
            if (!poses.is_none()) {
              const Poses all(poses, "poses");
              if (all.get().size() != parts.size())
                throw Error("there are " + std::to_string(parts.size()) + " shapes, but " +
                            std::to_string(all.get().size()) + " poses; give one for each");
              for (std::size_t i = 0; i < parts.size(); ++i) parts[i].pose = all.get()[i];
            }
            new (self) PyCompound{std::move(parts), nb::tuple(kept)};
          },
          nb::arg("shapes").none(), nb::arg("poses") = nb::none(),
          nb::sig(
              "def __init__(self, shapes: collections.abc.Iterable[object], poses: object = None) -> None"))
      .def("__len__", [](const PyCompound& self) { return self.parts.size(); })
      .def("__repr__", [](const PyCompound& self) {
        return nb::str("sdm.Compound({} shapes)").format(self.parts.size());
      });
}

}  // namespace sdm::python
