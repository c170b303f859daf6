// Pickling and copying: objects that hold meshes are stored by what they were made from, and made again,
// which gives the same object bit for bit but for memory of earlier queries. Others are stored by their
// values (values.h).
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <array>
#include <utility>

#include "closest.h"
#include "map.h"
#include "objects.h"
#include "proximity.h"
#include "stored.h"
#include "values.h"

namespace sdm::python {
namespace {

nb::tuple state_of(const Mesh& mesh, double deviation) {
  return nb::make_tuple(packed(mesh.positions), packed(mesh.triangles), packed(mesh.corner_uvs), deviation);
}

PyMesh mesh_from(nb::handle packed) {
  const nb::tuple state = items(packed, 4);
  Mesh mesh{.positions = unpacked<Vec3>(state[0]),
            .triangles = unpacked<Triangle>(state[1]),
            .corner_uvs = unpacked<std::array<Vec2, 3>>(state[2])};
  validate(mesh);
  return {std::move(mesh), nb::cast<double>(state[3])};
}

/// The options of an atlas that its layout depends on.
nb::tuple state_of(const AtlasOptions& options) {
  return nb::make_tuple(name_of(options.kind), options.resolution, options.rows, options.max_stretch,
                        options.gutter);
}

AtlasOptions atlas_from(nb::handle packed) {
  const nb::tuple state = items(packed, 5);
  return {.kind = enum_of<AtlasKind>("atlas", nb::cast<std::string>(state[0])),
          .resolution = nb::cast<std::uint32_t>(state[1]),
          .rows = nb::cast<std::optional<std::uint32_t>>(state[2]),
          .max_stretch = nb::cast<double>(state[3]),
          .gutter = nb::cast<std::uint32_t>(state[4])};
}

/// The present positions if a refit has changed the first ones, otherwise None.
nb::object moved(const Positions& first, const Positions& present) {
  return first == nullptr || first == present ? nb::none() : packed(*present);
}

Positions moved_from(nb::handle state) {
  return state.is_none() ? nullptr : std::make_shared<std::vector<Vec3>>(unpacked<Vec3>(state));
}

/// Refits what an object holds.
template <class Object, class Held>
void refit_to(Object& object, Held& held, const Positions& positions) {
  held.refit(*positions);
  object.positions = positions;
}

void bind_surface_state() {
  bind_state<PySurface>(
      3,
      [](const PySurface& self) {
        const auto lock = self.access.use();
        if (self.edits > 0)
          throw Error("a surface that was edited cannot be pickled or copied; make another one of its mesh");
        Mesh first = self.surface.mesh();
        first.positions = *self.first;
        return nb::make_tuple(state_of(first, self.deviation), state_of(self.options),
                              moved(self.first, self.positions));
      },
      [](PySurface* self, const nb::tuple& from) {
        PyMesh mesh = mesh_from(from[0]);
        const AtlasOptions options = atlas_from(from[1]);
        const Positions positions = moved_from(from[2]);
        InPlace<PySurface> made(self);
        run_sized(mesh.mesh.triangles.size(), [&] {
          PySurface& surface = made.make([&] { return PySurface(std::move(mesh), options); });
          if (positions) refit_to(surface, surface.surface, positions);
        });
        made.release();
      });
}

nb::tuple state_of(const DistanceMap& map) {
  return nb::make_tuple(map.resolution, packed(map.distance), packed(map.vector), packed(map.site),
                        packed(map.site_type), bytes_of(map.sign), bytes_of(map.measured),
                        map.beyond_max_distance, map.without_match, packed(map.unmatched), map.without_texel);
}

/// A map of so many values, whose sites are not checked.
DistanceMap map_from(nb::handle packed, std::size_t values) {
  const nb::tuple state = items(packed, 11);
  DistanceMap map;
  map.resolution = nb::cast<std::uint32_t>(state[0]);
  map.distance = unpacked<float>(state[1]);
  map.vector = unpacked<Vec3f>(state[2]);
  map.site = unpacked<std::uint32_t>(state[3]);
  map.site_type = unpacked<SiteType>(state[4]);
  map.sign = value_of<SignUsed>(state[5]);
  map.measured = value_of<MeasuredDistance>(state[6]);
  map.beyond_max_distance = nb::cast<std::size_t>(state[7]);
  map.without_match = nb::cast<std::size_t>(state[8]);
  map.unmatched = unpacked<std::uint8_t>(state[9]);
  map.without_texel = nb::cast<std::size_t>(state[10]);
  if (map.without_texel > values || map.distance.size() != values || map.vector.size() != values ||
      map.site.size() != values || map.site_type.size() != values ||
      (!map.unmatched.empty() && map.unmatched.size() != values))
    throw Error(kDamaged);
  return map;
}

DistanceMap map_from(nb::handle packed, const Surface& surface, const Sites& sites) {
  DistanceMap map = map_from(packed, surface.map_faces().size());
  if (map.resolution != surface.resolution() || map.texels() != surface.texel_faces().size())
    throw Error(kDamaged);
  const std::array counts{sites.mesh().positions.size(), sites.edges().size(), sites.mesh().triangles.size()};
  for (std::size_t i = 0; i < map.site.size(); ++i) {
    const auto type = static_cast<std::size_t>(map.site_type[i]);
    if (map.site_type[i] != SiteType::none && (type >= counts.size() || map.site[i] >= counts[type]))
      throw Error(kDamaged);
  }
  return map;
}

/// What the distances of a map are to: options, and the rules of maps that are not to the closest point.
nb::tuple rule_of(const PyMap& self) {
  nb::object thickness = nb::none(), along = nb::none();
  if (self.thickness)
    thickness = nb::make_tuple(self.thickness->first == ThicknessMethod::ball, self.thickness->second);
  if (self.along) {
    std::vector<Vec3> direction;
    if (self.along->direction) direction.push_back(*self.along->direction);
    along = packed(direction);
  }
  return nb::make_tuple(self.engine, name_of(self.options.sign), self.options.max_distance,
                        self.options.facing, thickness, along);
}

void take_rule(PyMap& self, nb::handle packed) {
  const nb::tuple rule = items(packed, 6);
  self.engine = nb::cast<std::string>(rule[0]);
  self.options.sign = enum_of<SignMethod>("sign", nb::cast<std::string>(rule[1]));
  self.options.max_distance = nb::cast<double>(rule[2]);
  self.options.facing = nb::cast<std::optional<double>>(rule[3]);
  const nb::object thickness = rule[4], along = rule[5];
  if (!thickness.is_none()) {
    const auto [ball, angle] = nb::cast<std::pair<bool, double>>(thickness);
    self.thickness = {ball ? ThicknessMethod::ball : ThicknessMethod::ray, angle};
  } else if (!along.is_none()) {
    const std::vector<Vec3> direction = unpacked<Vec3>(along);
    self.along.emplace().max_distance = self.options.max_distance;
    if (!direction.empty()) self.along->direction = direction.front();
  } else {
    self.options.engine = engine_of(self.engine.c_str());
  }
}

void bind_map_state() {
  bind_state<PyMap>(
      5,
      [](const PyMap& self) {
        if (self.exclusion)
          throw Error("a map of a surface to itself cannot be pickled or copied; compute it again");
        const auto lock = self.use_surface();
        const auto sites_lock = self.use_sites();
        return nb::make_tuple(self.surface_object, self.sites_object, rule_of(self), state_of(self.map),
                              self.ms);
      },
      [](PyMap* self, const nb::tuple& from) {
        PyMap made;
        made.surface_object = from[0];
        made.sites_object = from[1];
        made.on = &nb::cast<const PySurface&>(made.surface_object);
        made.to = &nb::cast<const PySites&>(made.sites_object);
        made.surface_shape = made.on->shape;
        made.surface_edits = made.on->edits;
        made.sites_shape = made.to->shape;
        take_rule(made, from[2]);
        made.map = map_from(from[3], made.on->surface, made.to->sites);
        made.ms = nb::cast<double>(from[4]);
        new (self) PyMap(std::move(made));
      });
}

void bind_nearest_map_state() {
  bind_state<PyNearestMap>(
      3,
      [](const PyNearestMap& self) {
        return nb::make_tuple(state_of(self.nearest.map), packed(self.nearest.body),
                              packed(self.nearest.part));
      },
      [](PyNearestMap* self, const nb::tuple& from) {
        NearestMap nearest;
        nearest.body = unpacked<std::uint32_t>(from[1]);
        nearest.part = unpacked<std::uint32_t>(from[2]);
        nearest.map = map_from(from[0], nearest.body.size());
        if (nearest.map.resolution == 0 || nearest.map.texels() % nearest.map.resolution != 0 ||
            (!nearest.part.empty() && nearest.part.size() != nearest.body.size()))
          throw Error(kDamaged);
        new (self) PyNearestMap{.nearest = std::move(nearest), .valid = {}};
      });
}

void bind_closest_points_state() {
  bind_state<PyClosestPoints>(
      6,
      [](PyClosestPoints& self) {
        const StoredFaces faces = self.stored_faces();
        return nb::make_tuple(packed(self.found.closest), packed(self.found.inside), self.has_gradients(),
                              packed(self.gradients), packed(faces.corners), packed(faces.weights));
      },
      [](PyClosestPoints* self, const nb::tuple& from) {
        const auto closest = unpacked<ClosestPoint>(from[0]);
        const auto inside = unpacked<std::uint8_t>(from[1]);
        const bool with = nb::cast<bool>(from[2]);
        const auto gradients = unpacked<Vec3>(from[3]);
        StoredFaces faces{unpacked<Triangle>(from[4]), unpacked<Vec3>(from[5])};
        const std::size_t n = closest.size();
        if ((!inside.empty() && inside.size() != n) || gradients.size() != (with ? n : 0) ||
            faces.corners.size() != n || faces.weights.size() != n)
          throw Error(kDamaged);
        new (self) PyClosestPoints({closest, inside}, with, gradients, std::move(faces));
      });
}

PyShape with_margins(PyShape shape, const std::vector<double>& margins) {
  for (const double margin : margins) shape = shape.with_margin(margin);
  return shape;
}

}  // namespace

void bind_pickle() {
  bind_state<PyMesh>(
      4, [](const PyMesh& self) { return state_of(self.mesh, self.deviation); },
      [](PyMesh* self, const nb::tuple& from) { new (self) PyMesh(mesh_from(from)); });
  bind_state<PySites>(
      2,
      [](const PySites& self) {
        const auto lock = self.access.use();
        // Those of an edited mesh are made for its present shape: distances then agree but for rounding.
        Mesh first = self.sites.mesh();
        if (self.first) first.positions = *self.first;
        return nb::make_tuple(state_of(first, self.deviation), moved(self.first, self.positions));
      },
      [](PySites* self, const nb::tuple& from) {
        PyMesh mesh = mesh_from(from[0]);
        const Positions positions = moved_from(from[1]);
        InPlace<PySites> made(self);
        run_sized(mesh.mesh.triangles.size(), [&] {
          PySites& sites = made.make([&] { return PySites(std::move(mesh)); });
          if (positions) refit_to(sites, sites.sites, positions);
        });
        made.release();
      });
  bind_surface_state();
  bind_map_state();
  bind_nearest_map_state();
  bind_state<PyShape>(
      4,
      [](const PyShape& self) {
        std::vector<Primitive> primitive;
        if (self.primitive) primitive.push_back(*self.primitive);
        const nb::object mesh =
            self.primitive ? nb::none() : nb::object(state_of(self.shape.sites().mesh(), 0));
        return nb::make_tuple(mesh, self.resolution, packed(primitive), packed(self.margins));
      },
      [](PyShape* self, const nb::tuple& from) {
        const auto primitive = unpacked<Primitive>(from[2]);
        const auto margins = unpacked<double>(from[3]);
        InPlace<PyShape> made(self);
        if (!primitive.empty()) {
          made.make([&] { return with_margins(PyShape(primitive[0]), margins); });
        } else {
          const Mesh mesh = mesh_from(from[0]).mesh;
          const auto resolution = nb::cast<std::optional<std::uint32_t>>(from[1]);
          run_sized(mesh.triangles.size(),
                    [&] { made.make([&] { return with_margins(PyShape(mesh, resolution, {}), margins); }); });
        }
        made.release();
      });
  bind_closest_points_state();
  bind_state<PyCompound>(
      2,
      [](const PyCompound& self) {
        std::vector<Transform> poses;
        for (const BodyPart& part : self.parts) poses.push_back(part.pose);
        return nb::make_tuple(self.shapes, packed(poses));
      },
      [](PyCompound* self, const nb::tuple& from) {
        PyCompound made{.parts = {}, .shapes = nb::cast<nb::tuple>(from[0])};
        const auto poses = unpacked<Transform>(from[1]);
        for (const nb::handle shape : made.shapes)
          made.parts.push_back({nb::cast<const PyShape&>(shape).shape});
        if (made.parts.empty() || poses.size() != made.parts.size()) throw Error(kDamaged);
        for (std::size_t i = 0; i < poses.size(); ++i) made.parts[i].pose = poses[i];
        new (self) PyCompound(std::move(made));
      });
  bind_result_states();
}

}  // namespace sdm::python
