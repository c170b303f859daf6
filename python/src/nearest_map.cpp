// Maps of a body to the nearest other one.
#include "proximity.h"

namespace sdm::python {
namespace {

using M = PyNearestMap;

/// A property with the values of all texels, which `values` returns of a NearestMap.
template <class Scalar, class Values>
auto texel_array(Values values) {
  return [values](nb::handle self) {
    const NearestMap& nearest = nb::cast<const M&>(self).nearest;
    return texels_of<Scalar>(values(nearest), nearest.map, self);
  };
}

void bind_closest_of_texels(nb::class_<M>& type) {
  type.def_prop_ro("distance",
                   texel_array<float>([](const NearestMap& n) -> auto& { return n.map.distance; }),
                   nb::sig("def distance(self) -> numpy.typing.NDArray[numpy.float32]"),
                   "(H, W) float32, negative inside the other body if that is a solid; NaN where there is no "
                   "value.")
      .def_prop_ro("vector", texel_array<float>([](const NearestMap& n) -> auto& { return n.map.vector; }),
                   nb::sig("def vector(self) -> numpy.typing.NDArray[numpy.float32]"),
                   "From the texel to the closest point, (H, W, 3) float32.")
      .def_prop_ro("site",
                   texel_array<std::uint32_t>([](const NearestMap& n) -> auto& { return n.map.site; }),
                   nb::sig("def site(self) -> numpy.typing.NDArray[numpy.uint32]"),
                   "The closest site of the other body, (H, W) uint32, or NONE.")
      .def_prop_ro("site_type",
                   texel_array<std::uint8_t>([](const NearestMap& n) -> auto& { return n.map.site_type; }),
                   nb::sig("def site_type(self) -> numpy.typing.NDArray[numpy.uint8]"),
                   "Its SiteType, (H, W) uint8.");
}

nb::object part_of(nb::handle self) {
  const NearestMap& nearest = nb::cast<const M&>(self).nearest;
  return nearest.part.empty() ? nb::none() : texels_of<std::uint32_t>(nearest.part, nearest.map, self);
}

nb::object valid_of(M& self) {
  return self.valid.get([&] {
    const auto& bodies = self.nearest.body;
    std::vector<std::uint8_t> flags(bodies.size());
    for (std::size_t i = 0; i < flags.size(); ++i) flags[i] = bodies[i] != kNone;
    return array_of<bool>(std::move(flags), {self.nearest.map.rows(), self.nearest.map.resolution});
  });
}

}  // namespace

void bind_nearest_map(nb::module_& module) {
  nb::class_<M> type(
      module, "NearestMap", nb::is_weak_referenceable(),
      "The distances from the texels of a body to the nearest other body. Arrays are read-only, "
      "with row 0 at the top.");
  bind_closest_of_texels(type);
  type.def_prop_ro("body", texel_array<std::uint32_t>([](const NearestMap& n) -> auto& { return n.body; }),
                   nb::sig("def body(self) -> numpy.typing.NDArray[numpy.uint32]"),
                   "The index of the other body, (H, W) uint32, or NONE.")
      .def_prop_ro("part", &part_of, nb::sig("def part(self) -> numpy.typing.NDArray[numpy.uint32] | None"),
                   "The part of that body, (H, W) uint32, or NONE; None if no body is a Compound.")
      .def_prop_ro("valid", &valid_of, nb::sig("def valid(self) -> numpy.typing.NDArray[numpy.bool_]"),
                   "Whether a texel has a value, (H, W) bool.")
      .def("__repr__", [](const M& self) {
        return nb::str("sdm.NearestMap({} × {} texels)")
            .format(self.nearest.map.resolution, self.nearest.map.rows());
      });
}

}  // namespace sdm::python
