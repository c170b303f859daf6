// The compiled part of DistanceMap.transfer().
#include <sdm/match.h>

#include <string_view>
#include <vector>

#include "arrays.h"
#include "map.h"
#include "run.h"

namespace sdm::python {
namespace {

AttributeDomain domain_of(std::string_view name) {
  if (name == "vertex") return AttributeDomain::vertex;
  if (name == "face") return AttributeDomain::face;
  if (name == "corner") return AttributeDomain::corner;
  throw Error("domain must be 'vertex', 'face' or 'corner', not '" + std::string(name) + "'");
}

nb::object transferred(const PyMap& self, const TransferRows& rows, const char* domain, bool fill,
                       nb::handle progress) {
  const auto lock = self.use_surface();
  const auto sites_lock = self.use_sites();
  const AttributeArray array = attribute_of(rows, domain);
  std::vector<float> values;
  run(progress, [&](const Progress& report) {
    values = transfer(self.on->surface, self.to->sites, self.map, array, {.fill = fill, .progress = report});
  });
  return array_of<float>(std::move(values), {self.rows(), self.map.resolution, array.components});
}

}  // namespace

AttributeArray attribute_of(const TransferRows& rows, const char* domain) {
  return {.values = {rows.data(), rows.size()}, .components = rows.shape(1), .domain = domain_of(domain)};
}

void bind_map_transfer(nb::class_<PyMap>& map) {
  map.def("transfer", &transferred, nb::arg("values"), nb::arg("domain"), nb::arg("fill"),
          nb::arg("progress").none(),
          nb::sig("def transfer(self, values: numpy.typing.NDArray[numpy.float32], domain: str, fill: bool, "
                  "progress: object) -> "
                  "numpy.typing.NDArray[numpy.float32]"));
}

}  // namespace sdm::python
