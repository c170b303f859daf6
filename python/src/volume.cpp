// Distance fields on grids.
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <sdm/error.h>
#include <sdm/map_files.h>
#include <sdm/volume.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>

#include "arrays.h"
#include "fields.h"
#include "options.h"
#include "signatures.h"
#include "sites_in_use.h"
#include "values.h"

namespace sdm::python {
namespace {

struct PyField {
  DistanceField field;
};

struct PyFieldSamples {
  std::vector<FieldSample> samples;
  LazyArray value, lower, upper;
};

Box box_of(const Mesh& mesh, nb::handle bounds, std::optional<double> margin, double max_distance) {
  if (!bounds.is_none()) {
    const Points corners(bounds, "bounds");
    if (corners.get().size() != 2 || margin)
      throw Error("bounds must be the lowest and the highest corner, (2, 3) numbers, without a margin");
    return {corners.get()[0], corners.get()[1]};
  }
  Box box = sdm::bounds(mesh);
  const double diagonal =
      std::hypot(box.upper[0] - box.lower[0], box.upper[1] - box.lower[1], box.upper[2] - box.lower[2]);
  const double around = margin.value_or(max_distance < kInfinity ? max_distance : 0.1 * diagonal);
  if (!(around >= 0) || !std::isfinite(around))
    throw Error("margin must be a finite number that is not negative");
  for (int k = 0; k < 3; ++k) {
    box.lower[k] -= around;
    box.upper[k] += around;
  }
  return box;
}

Grid grid_of(const Mesh& mesh, std::optional<double> spacing, nb::handle shape, nb::handle bounds,
             std::optional<double> margin, double max_distance) {
  if (spacing.has_value() == !shape.is_none()) throw Error("give either spacing or shape");
  const Box box = box_of(mesh, bounds, margin, max_distance);
  if (spacing) return make_grid(box, *spacing);
  std::array<std::int64_t, 3> points{};
  if (!nb::try_cast(shape, points, true)) throw Error("shape must be three integers: (nz, ny, nx)");
  for (const std::int64_t n : points)
    if (n < 1 || n > Grid::kMostPoints) throw Error("shape must be three integers from 1 to 1048576");
  const auto dim = [&](int k) { return static_cast<std::uint32_t>(points[2 - k]); };
  return make_grid(box, {dim(0), dim(1), dim(2)});
}

Transform index_transform(const Grid& grid) {
  Transform result;
  for (int k = 0; k < 3; ++k) {
    result.rows[k][k] = grid.spacing[k];
    result.rows[k][3] = grid.origin[k];
  }
  return result;
}

template <class Scalar, class Element>
nb::object points_of(const std::vector<Element>& values, const Grid& grid, nb::handle owner) {
  if (values.empty()) return nb::none();
  return view_of<Scalar>(values, {grid.dims[2], grid.dims[1], grid.dims[0]}, owner);
}

}  // namespace

template <>
inline constexpr auto kMembers<FieldSample> =
    std::tuple{&FieldSample::value, &FieldSample::certainty, &FieldSample::lower, &FieldSample::upper,
               &FieldSample::magnitude};
template <>
inline constexpr auto kMembers<PyFieldSamples> = std::tuple{&PyFieldSamples::samples};

namespace {

void bind_samples(nb::module_& module) {
  using S = PyFieldSamples;
  const auto sample_column = [](LazyArray S::*array, double FieldSample::*member) {
    return [array, member](S& self) {
      return (self.*array).get([&] {
        return column(self.samples, [member](const FieldSample& sample) { return sample.*member; });
      });
    };
  };
  nb::class_<S>(module, "FieldSamples", nb::is_weak_referenceable(),
                "The distances at n points between the points of a grid.")
      .def_prop_ro(
          "value", sample_column(&S::value, &FieldSample::value),
          nb::sig("def value(self) -> numpy.typing.NDArray[numpy.float64]"),
          "Estimates, (n,) float64: interpolated linearly along each axis; NaN outside the grid, and "
          "beside a point without a value.")
      .def_prop_ro("lower", sample_column(&S::lower, &FieldSample::lower),
                   nb::sig("def lower(self) -> numpy.typing.NDArray[numpy.float64]"),
                   "Lower bounds on the distances, (n,) float64.")
      .def_prop_ro("upper", sample_column(&S::upper, &FieldSample::upper),
                   nb::sig("def upper(self) -> numpy.typing.NDArray[numpy.float64]"),
                   "Upper bounds, (n,) float64.")
      .def("__len__", [](const S& self) { return self.samples.size(); })
      .def("__repr__",
           [](const S& self) { return nb::str("sdm.FieldSamples({})").format(self.samples.size()); });
  bind_value<S>();
}

using F = PyField;

void bind_arrays(nb::class_<PyField>& field) {
  field
      .def_prop_ro(
          "distance",
          [](nb::handle self) {
            const DistanceField& f = nb::cast<const F&>(self).field;
            return points_of<float>(f.distance, f.grid, self);
          },
          nb::sig("def distance(self) -> numpy.typing.NDArray[numpy.float32]"),
          "(nz, ny, nx) float32, in units of the mesh; negative inside the mesh if the field is signed.")
      .def_prop_ro(
          "site",
          [](nb::handle self) {
            const DistanceField& f = nb::cast<const F&>(self).field;
            return points_of<std::uint32_t>(f.site, f.grid, self);
          },
          nb::sig("def site(self) -> numpy.typing.NDArray[numpy.uint32] | None"),
          "The closest vertex, edge or face, (nz, ny, nx) uint32, by ``site_type``; None unless requested.")
      .def_prop_ro(
          "site_type",
          [](nb::handle self) {
            const DistanceField& f = nb::cast<const F&>(self).field;
            return points_of<std::uint8_t>(f.site_type, f.grid, self);
          },
          nb::sig("def site_type(self) -> numpy.typing.NDArray[numpy.uint8] | None"),
          "The SiteType of each site, (nz, ny, nx) uint8; None unless requested.");
}

void bind_grid(nb::class_<PyField>& field) {
  bind_fields_of<Grid>(field, [](const F& self) -> const Grid& { return self.field.grid; }, {"points"});
  bind_fields_of<DistanceField>(field, [](const F& self) -> const DistanceField& { return self.field; },
                                {"grid", "sign"})
      .def_prop_ro(
          "transform", [](const F& self) { return matrix(index_transform(self.field.grid)); },
          nb::sig("def transform(self) -> numpy.typing.NDArray[numpy.float64]"),
          "From the indices (i, j, k, 1) of a point, i along x, to its coordinates: (4, 4) float64.")
      .def_prop_ro(
          "interpolation_error",
          [](const F& self) { return interpolation_error(self.field.grid) + self.field.accuracy; },
          "Upper bound on the error of an interpolated distance.")
      .def_prop_ro(
          "sign", [](const F& self) { return name_of(self.field.sign.method); },
          "How inside and outside are distinguished: 'none' (unsigned distances), 'exact' or 'winding'.")
      .def_prop_ro(
          "sign_reason", [](const F& self) { return self.field.sign.reason; }, "Why, in words.");
}

void bind_uses(nb::class_<PyField>& field) {
  field
      .def(
          "sample",
          [](const F& self, nb::handle points) {
            const Points p(points, "points");
            auto result = std::make_unique<PyFieldSamples>();
            run_sized(p.get().size(), [&] { result->samples = sample_field(self.field, p.get()); });
            return result.release();
          },
          nb::rv_policy::take_ownership, nb::arg("points").none(),
          nb::sig("def sample(self, points: object) -> FieldSamples"),
          R"(Returns the distances at n points, (n, 3) numbers, anywhere: interpolated, with bounds that hold
because a distance changes no faster than the point moves. Raises Error for coordinates that are not finite.)")
      .def(
          "save",
          [](const F& self, nb::handle file) {
            const std::filesystem::path name = path_of(file);
            run_sized(self.field.distance.size(), [&] { write_field(name, self.field); });
          },
          nb::arg("file").none(), nb::sig("def save(self, file: str | os.PathLike[str]) -> None"),
          R"(Writes the field: .npy (the distances, indexed [i, j, k]), .vti (VTK ImageData, for ParaView) or
.vdb (OpenVDB). The complete file appears, or none. Raises Error, naming the file and the fault.)")
      .def("__repr__", [](const F& self) {
        const auto& [nx, ny, nz] = self.field.grid.dims;
        return nb::str("sdm.DistanceField({} × {} × {} points, {})")
            .format(nz, ny, nx, name_of(self.field.sign.method));
      });
}

nb::tuple state_of(const DistanceField& field) {
  return nb::make_tuple(
      packed(std::vector{field.grid}), packed(field.distance), packed(field.site), packed(field.site_type),
      field.max_distance, field.accuracy, packed(std::vector{field.o2_bounds}),
      nb::make_tuple(sdm::name_of(field.sign.method), field.sign.reason), field.beyond_max_distance);
}

DistanceField field_from(const nb::tuple& state) {
  const auto grid = unpacked<Grid>(state[0]);
  const auto bounds = unpacked<Box>(state[6]);
  const nb::tuple sign = items(state[7], 2);
  if (grid.size() != 1 || bounds.size() != 1) throw Error(kDamaged);
  DistanceField field{
      .grid = grid.front(),
      .distance = unpacked<float>(state[1]),
      .site = unpacked<std::uint32_t>(state[2]),
      .site_type = unpacked<SiteType>(state[3]),
      .max_distance = nb::cast<double>(state[4]),
      .accuracy = nb::cast<double>(state[5]),
      .o2_bounds = bounds.front(),
      .sign = {enum_of<SignMethod>("sign", nb::cast<std::string>(sign[0])), nb::cast<std::string>(sign[1])},
      .beyond_max_distance = nb::cast<std::size_t>(state[8])};
  const std::size_t n = field.distance.size();
  const bool bad_dims =
      std::ranges::any_of(field.grid.dims, [](std::uint32_t d) { return d == 0 || d > Grid::kMostPoints; });
  if (bad_dims || field.grid.size() != n || (!field.site.empty() && field.site.size() != n) ||
      field.site_type.size() != field.site.size())
    throw Error(kDamaged);
  return field;
}

void bind_field_state() {
  bind_state<PyField>(
      9, [](const PyField& self) { return state_of(self.field); },
      [](PyField* self, const nb::tuple& from) { new (self) PyField{field_from(from)}; });
}

void bind_field(nb::module_& module) {
  nb::class_<PyField> field(
      module, "DistanceField", nb::is_weak_referenceable(),
      R"(The distances from the points of a regular grid to a mesh. Returned by distance_field().

Arrays are read-only and have the shape (nz, ny, nx): the value of the point with the coordinates
``origin + (i, j, k) * spacing`` is at [k, j, i]. Points farther than the maximum distance hold NaN or NONE.)");
  bind_arrays(field);
  bind_grid(field);
  bind_uses(field);
  bind_field_state();
}

}  // namespace

void bind_volume(nb::module_& module) {
  bind_samples(module);
  bind_field(module);
  static const std::string signature =
      "def distance_field(mesh: object, *, spacing: float | None = None, shape: tuple[int, int, int] | None "
      "= "
      "None, bounds: object = None, margin: float | None = None, " +
      option_signature("distance_field") + kProgress + "DistanceField";
  static const std::string documentation =
      R"(Computes the distances from the points of a regular grid to a mesh.

mesh: any form of a mesh (see Mesh); Sites are used as they are.
spacing: > 0: cubic cells of this size, the fewest that cover the box.
shape: instead, the numbers of points (nz, ny, nx), whose outermost ones are on the sides of the box.
bounds: the lowest and the highest corner of the box, (2, 3) numbers. By default the box of the mesh and
``margin`` around it, which is ``max_distance``, or a tenth of the diagonal without one.
)" + option_documentation("distance_field") +
      R"(
progress: called as progress(step, fraction), on this thread; False cancels.

Raises Error for an unusable mesh, a grid or an option out of range, or too little memory, which is checked
first; Cancelled. Cost: a search per point, or per point near the mesh if there is a maximum distance; all cores.

>>> field = sdm.distance_field(box, shape=(3, 5, 5), bounds=[[0, 0, 0], [1, 1, 1]])
>>> field.distance.shape, float(field.distance[1, 2, 2]), float(field.transform[0, 0])
((3, 5, 5), -0.5, 0.25)
>>> field.sample([[0.5, 0.5, 0.75]]).value
array([-0.25]))";
  module.def(
      "distance_field",
      [](nb::handle mesh, std::optional<double> spacing, nb::handle shape, nb::handle bounds,
         std::optional<double> margin, nb::handle progress, const nb::kwargs& given) {
        check_keywords("distance_field", given);
        FieldOptions options;
        set_options(given, options);
        SitesInUse to(mesh);
        validate(to.mesh());
        const Grid grid = grid_of(to.mesh(), spacing, shape, bounds, margin, options.max_distance);
        auto result = std::make_unique<PyField>();
        run(progress, [&](const Progress& report) {
          options.progress = report;
          result->field = compute_field(to.get(), grid, options);
        });
        return result.release();
      },
      nb::rv_policy::take_ownership, nb::arg("mesh").none(), nb::kw_only(), nb::arg("spacing") = nb::none(),
      nb::arg("shape") = nb::none(), nb::arg("bounds") = nb::none(), nb::arg("margin") = nb::none(),
      nb::arg("progress") = nb::none(), nb::arg("options"), nb::sig(signature.c_str()),
      documentation.c_str());
}

}  // namespace sdm::python
