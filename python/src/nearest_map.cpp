// Maps of a body to the nearest other one.
#include "proximity.h"

namespace sdm::python {

void bind_nearest_map(nb::module_& module) {
  using M = PyNearestMap;
  nb::class_<M>(module, "NearestMap", nb::is_weak_referenceable(),
                "The distances from the texels of a body to the nearest other body. Arrays are read-only, "
                "with row 0 at "
                "the top.")
      .def_prop_ro(
          "distance",
          [](nb::handle self) {
            const NearestMap& n = nb::cast<const M&>(self).nearest;
            return texels_of<float>(n.map.distance, n.map, self);
          },
          nb::sig("def distance(self) -> numpy.typing.NDArray[numpy.float32]"),
          "(H, W) float32, negative inside the other body if that is a solid; NaN where there is no value.")
      .def_prop_ro(
          "vector",
          [](nb::handle self) {
            const NearestMap& n = nb::cast<const M&>(self).nearest;
            return texels_of<float>(n.map.vector, n.map, self);
          },
          nb::sig("def vector(self) -> numpy.typing.NDArray[numpy.float32]"),
          "From the texel to the closest point, (H, W, 3) float32.")
      .def_prop_ro(
          "site",
          [](nb::handle self) {
            const NearestMap& n = nb::cast<const M&>(self).nearest;
            return texels_of<std::uint32_t>(n.map.site, n.map, self);
          },
          nb::sig("def site(self) -> numpy.typing.NDArray[numpy.uint32]"),
          "The closest site of the other body, (H, W) uint32, or NONE.")
      .def_prop_ro(
          "site_type",
          [](nb::handle self) {
            const NearestMap& n = nb::cast<const M&>(self).nearest;
            return texels_of<std::uint8_t>(n.map.site_type, n.map, self);
          },
          nb::sig("def site_type(self) -> numpy.typing.NDArray[numpy.uint8]"), "Its SiteType, (H, W) uint8.")
      .def_prop_ro(
          "body",
          [](nb::handle self) {
            const NearestMap& n = nb::cast<const M&>(self).nearest;
            return texels_of<std::uint32_t>(n.body, n.map, self);
          },
          nb::sig("def body(self) -> numpy.typing.NDArray[numpy.uint32]"),
          "The index of the other body, (H, W) uint32, or NONE.")
      .def_prop_ro(
          "part",
          [](nb::handle self) -> nb::object {
            const NearestMap& n = nb::cast<const M&>(self).nearest;
            if (n.part.empty()) return nb::none();
            return texels_of<std::uint32_t>(n.part, n.map, self);
          },
          nb::sig("def part(self) -> numpy.typing.NDArray[numpy.uint32] | None"),
          "The part of that body, (H, W) uint32, or NONE; None if no body is a Compound.")
      .def_prop_ro(
          "valid",
          [](M& self) {
            return self.valid.get([&] {
              const auto& bodies = self.nearest.body;
              std::vector<std::uint8_t> flags(bodies.size());
              for (std::size_t i = 0; i < flags.size(); ++i) flags[i] = bodies[i] != kNone;
              return array_of<bool>(std::move(flags), {self.nearest.map.rows(), self.nearest.map.resolution});
            });
          },
          nb::sig("def valid(self) -> numpy.typing.NDArray[numpy.bool_]"),
          "Whether a texel has a value, (H, W) bool.");
}

}  // namespace sdm::python
