// What sdm.dask needs for meshes in parts: the samples of a surface, and the closest points of one part.
#include <sdm/closest_points.h>
#include <sdm/error.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "arrays.h"
#include "objects.h"

namespace sdm::python {
namespace {

template <class Scalar>
using Column = nb::ndarray<Scalar, nb::shape<-1>, nb::c_contig, nb::device::cpu>;
using Rows = nb::ndarray<double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Numbers = Column<const std::uint32_t>;

std::span<const std::uint32_t> numbers_of(const Numbers& array) {
  return {array.data(), array.shape(0)};
}

// Arrays, changed in place: the fields of ClosestInParts.
struct Best {
  Column<double> distance;
  Rows vector;
  Column<std::uint32_t> site, face;
  Column<std::uint8_t> type;

  [[nodiscard]] std::vector<ClosestInParts> get() const {
    const std::size_t count = distance.shape(0);
    if (vector.shape(0) != count || site.shape(0) != count || face.shape(0) != count ||
        type.shape(0) != count)
      throw Error("the arrays of the closest points must have the same length");
    std::vector<ClosestInParts> best(count);
    for (std::size_t i = 0; i < count; ++i) {
      best[i] = {.distance = distance.data()[i],
                 .vector = {},
                 .site = site.data()[i],
                 .face = face.data()[i],
                 .type = static_cast<SiteType>(type.data()[i])};
      std::copy_n(vector.data() + 3 * i, 3, best[i].vector.begin());
    }
    return best;
  }
  void set(std::span<const ClosestInParts> best) {
    for (std::size_t i = 0; i < best.size(); ++i) {
      distance.data()[i] = best[i].distance;
      site.data()[i] = best[i].site;
      face.data()[i] = best[i].face;
      type.data()[i] = static_cast<std::uint8_t>(best[i].type);
      std::ranges::copy(best[i].vector, vector.data() + 3 * i);
    }
  }
};

void merge(const PySites& part, const Numbers& vertices, const Numbers& edges, const Numbers& faces,
           nb::handle queries, Best best) {
  const Points points(queries, "queries");
  const auto lock = part.access.use();
  run_sized(points.get().size(), [&] {
    std::vector<ClosestInParts> results = best.get();
    merge_closest(part.sites, {numbers_of(vertices), numbers_of(edges), numbers_of(faces)}, points.get(),
                  results);
    best.set(results);
  });
}

// Calls visit(place, texel) for the samples that are texels: arrays have no place for others.
template <class Visit>
void for_each_owned(const Surface& surface, const Visit& visit) {
  const auto samples = surface.sample_texels();
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (samples[i] < surface.texel_faces().size()) visit(i, samples[i]);
}

}  // namespace

void bind_parts(nb::module_& module) {
  module.def(
      "sample_texels",
      [](nb::handle self) {
        std::vector<std::uint32_t> texels;
        for_each_owned(nb::cast<const PySurface&>(self).surface,
                       [&](std::size_t, std::uint32_t texel) { texels.push_back(texel); });
        const std::size_t count = texels.size();
        return array_of<std::uint32_t>(std::move(texels), {count});
      },
      nb::arg("surface"),
      nb::sig("def sample_texels(surface: Surface) -> numpy.typing.NDArray[numpy.uint32]"),
      "Returns the indices of the texels that a face owns, (n,) uint32: neighbours on the surface "
      "follow each other.");
  module.def(
      "sample_points",
      [](const PySurface& self) {
        const auto lock = self.access.use();
        auto points = run_short([&] {
          std::vector<Vec3> all = self.surface.sample_points(), owned;
          for_each_owned(self.surface, [&](std::size_t i, std::uint32_t) { owned.push_back(all[i]); });
          return owned;
        });
        const std::size_t count = points.size();
        return array_of<double>(std::move(points), {count, 3});
      },
      nb::arg("surface"),
      nb::sig("def sample_points(surface: Surface) -> numpy.typing.NDArray[numpy.float64]"),
      "Returns the surface points of sample_texels(), (n, 3) float64.");
  module.def(
      "merge_closest",
      [](const PySites& part, const Numbers& vertices, const Numbers& edges, const Numbers& faces,
         nb::handle queries, Column<double> distance, Rows vector, Column<std::uint32_t> site,
         Column<std::uint8_t> type, Column<std::uint32_t> face) {
        merge(part, vertices, edges, faces, queries, {distance, vector, site, face, type});
      },
      nb::arg("part"), nb::arg("vertices"), nb::arg("edges"), nb::arg("faces"), nb::arg("queries"),
      nb::arg("distance"), nb::arg("vector"), nb::arg("site"), nb::arg("site_type"), nb::arg("face"),
      nb::sig("def merge_closest(part: Sites, vertices: numpy.typing.NDArray[typing.Any], edges: "
              "numpy.typing.NDArray[typing.Any], faces: "
              "numpy.typing.NDArray[typing.Any], queries: "
              "object, distance: numpy.typing.NDArray[typing.Any], vector: numpy.typing.NDArray[typing.Any], "
              "site: numpy.typing.NDArray[typing.Any], site_type: "
              "numpy.typing.NDArray[typing.Any], face: "
              "numpy.typing.NDArray[typing.Any]) -> None"),
      "Replaces closest points, in place, by those of a part of O2 that are closer; see "
      "sdm/closest_points.h. vertices, edges, faces: their numbers in the whole O2, uint32, increasing.");
}

}  // namespace sdm::python
