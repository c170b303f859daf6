#include "baked.h"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>
#include <sdm/bake_files.h>
#include <sdm/error.h>

#include <algorithm>
#include <cstddef>
#include <tuple>
#include <utility>

#include "arrays.h"
#include "objects.h"
#include "run.h"
#include "values.h"

namespace sdm::python {
namespace {

/// What a PyBaked is stored by: its surface is laid out again.
struct StoredBaked {
  Mesh mesh;
  AtlasOptions atlas;
  std::uint32_t side = 1;
  std::vector<MatchKind> kinds;
  std::vector<float> coverage;
  std::vector<BakedChannel> channels;
  std::vector<BakedGeometry> geometry;
  Material material;
  std::vector<std::string> material_names, notes;
};

}  // namespace

template <>
inline constexpr auto kMembers<AtlasOptions> =
    std::tuple{&AtlasOptions::kind,        &AtlasOptions::resolution, &AtlasOptions::rows,
               &AtlasOptions::max_stretch, &AtlasOptions::gutter,     &AtlasOptions::strict_uv};
template <>
inline constexpr auto kLast<BakeChannel> = BakeChannel::emissive;
template <>
inline constexpr auto kMembers<BakedChannel> = std::tuple{&BakedChannel::channel, &BakedChannel::resolution,
                                                          &BakedChannel::components, &BakedChannel::values};
template <>
inline constexpr auto kLast<AlphaMode> = AlphaMode::blend;
template <>
inline constexpr auto kLast<TextureWrap> = TextureWrap::clamp;
template <>
inline constexpr auto kMembers<TextureUse> =
    std::tuple{&TextureUse::texture, &TextureUse::uv_set, &TextureUse::place, &TextureUse::wrap};
template <>
inline constexpr auto kMembers<Material> = std::tuple{&Material::name,
                                                      &Material::base_color,
                                                      &Material::emissive,
                                                      &Material::alpha_mode,
                                                      &Material::alpha_cutoff,
                                                      &Material::metallic,
                                                      &Material::roughness,
                                                      &Material::normal_scale,
                                                      &Material::occlusion_strength,
                                                      &Material::base_color_texture,
                                                      &Material::metallic_roughness_texture,
                                                      &Material::normal_texture,
                                                      &Material::occlusion_texture,
                                                      &Material::emissive_texture};
template <>
inline constexpr auto kLast<MatchKind> = MatchKind::facing_away;
template <>
inline constexpr auto kLast<GeometryChannel> = GeometryChannel::material;
template <>
inline constexpr auto kMembers<BakedGeometry> =
    std::tuple{&BakedGeometry::channel, &BakedGeometry::values, &BakedGeometry::numbers};
template <>
inline constexpr auto kMembers<StoredBaked> = std::tuple{
    &StoredBaked::mesh,           &StoredBaked::atlas,    &StoredBaked::side,     &StoredBaked::kinds,
    &StoredBaked::coverage,       &StoredBaked::channels, &StoredBaked::geometry, &StoredBaked::material,
    &StoredBaked::material_names, &StoredBaked::notes};

namespace {

bool fits(BakeChannel channel, std::size_t components) {
  switch (channel) {
    case BakeChannel::base_color:
      return components == 3 || components == 4;
    case BakeChannel::metallic_roughness:
      return components == 2;
    case BakeChannel::occlusion:
      return components == 1;
    case BakeChannel::emissive:
      break;
  }
  return components == 3;
}

std::size_t components_in(const BakedGeometry& of) {
  return is_number(of.channel) ? 0 : components_of(of.channel);
}

void check_stored(const StoredBaked& stored, const Surface& surface) {
  const std::uint32_t side = stored.side;
  if (side < 1 || surface.resolution() % side != 0 || surface.rows() % side != 0) throw Error(kDamaged);
  const std::uint32_t columns = surface.resolution() / side;
  const std::size_t texels = std::size_t{columns} * (surface.rows() / side);
  bool whole = stored.kinds.size() == texels && stored.coverage.size() == texels;
  for (const BakedChannel& channel : stored.channels)
    whole &= channel.resolution == columns && fits(channel.channel, channel.components) &&
             channel.values.size() == channel.components * texels;
  for (const BakedGeometry& of : stored.geometry)
    whole &= of.values.size() == components_in(of) * texels &&
             of.numbers.size() == (is_number(of.channel) ? texels : 0);
  if (!whole) throw Error(kDamaged);
}

void bind_baked_state() {
  bind_state<PyBaked>(
      1,
      [](const PyBaked& self) {
        return nb::make_tuple(bytes_of(StoredBaked{self.surface.mesh(), self.atlas, self.side, self.kinds,
                                                   self.coverage, self.channels, self.geometry, self.material,
                                                   self.material_names, self.notes}));
      },
      [](PyBaked* self, const nb::tuple& from) {
        auto stored = value_of<StoredBaked>(from[0]);
        validate(stored.mesh);
        InPlace<PyBaked> made(self);
        run_sized(stored.mesh.triangles.size(), [&] {
          Surface surface(std::move(stored.mesh), stored.atlas);
          check_stored(stored, surface);
          std::optional<DrawnFrames> frames;
          if (std::ranges::count(stored.geometry, GeometryChannel::normal, &BakedGeometry::channel) > 0)
            frames.emplace(surface);
          made.make([&] {
            return PyBaked{.atlas = std::move(stored.atlas),
                           .surface = std::move(surface),
                           .side = stored.side,
                           .kinds = std::move(stored.kinds),
                           .coverage = std::move(stored.coverage),
                           .channels = std::move(stored.channels),
                           .geometry = std::move(stored.geometry),
                           .frames = std::move(frames),
                           .material = std::move(stored.material),
                           .material_names = std::move(stored.material_names),
                           .notes = std::move(stored.notes)};
          });
        });
        made.release();
      });
}

/// Copies of values as an array.
nb::object baked_array(const PyBaked& self, const std::string& name) {
  const std::size_t rows = self.rows(), columns = self.columns();
  if (const BakedChannel* const look = self.find_look(name)) {
    std::vector<float> values = look->values;
    return array_of<float>(std::move(values), {rows, columns, look->components});
  }
  const BakedGeometry* const of = self.find_geometry(name);
  if (of == nullptr) throw Error("there is no channel '" + name + "'");
  if (is_number(of->channel)) {
    std::vector<std::uint32_t> numbers = of->numbers;
    return array_of<std::uint32_t>(std::move(numbers), {rows, columns});
  }
  std::vector<float> values = of->values;
  const std::size_t components = components_of(of->channel);
  if (components == 1) return array_of<float>(std::move(values), {rows, columns});
  return array_of<float>(std::move(values), {rows, columns, components});
}

nb::object uvs_of(const PyBaked& self) {
  const Surface& surface = self.surface;
  const std::size_t faces = surface.mesh().triangles.size();
  std::vector<double> uvs(6 * faces);
  for (std::uint32_t face = 0; face < faces; ++face) {
    if (surface.face_charts()[face] == kNone) continue;
    const auto corners = surface.atlas_corners(face);
    for (std::size_t k = 0; k < 3; ++k) {
      uvs[6 * std::size_t{face} + 2 * k] = corners[k][0] / surface.resolution();
      uvs[6 * std::size_t{face} + 2 * k + 1] = 1 - corners[k][1] / surface.rows();
    }
  }
  return array_of<double>(std::move(uvs), {faces, 3, 2});
}

/// The textures of the model but the normal map.
std::vector<BakedTexture> textures_of(const PyBaked& self) {
  std::vector<BakedTexture> textures;
  for (const BakedChannel& channel : self.channels)
    textures.push_back({channel.channel, encode_png(to_image(channel), is_color(channel.channel))});
  const std::string ambient(name_of(GeometryChannel::ambient_occlusion));
  if (self.find_geometry(ambient) != nullptr &&
      std::ranges::count(self.channels, BakeChannel::occlusion, &BakedChannel::channel) == 0)
    textures.push_back({BakeChannel::occlusion, encode_png(self.image(ambient), false)});
  return textures;
}

void save_baked(const PyBaked& self, nb::handle file, const std::string& units, const std::string& up) {
  const std::filesystem::path path = path_of(file);
  const UpAxis axis = enum_of<UpAxis>("up", up);
  run(nb::none(), [&](const Progress&) {
    BakedModelOptions options{.material = self.material, .units = units, .up = axis};
    std::vector<char> normal_map;
    if (self.frames) {
      normal_map = encode_png(self.image(std::string(name_of(GeometryChannel::normal))), false);
      options.normals = &self.frames->normals;
      options.tangents = &self.frames->tangents;
      options.normal_map = normal_map;
    }
    write_baked_glb(path, self.surface, textures_of(self), options);
  });
}

nb::dict material_of(const PyBaked& self) {
  const Material& material = self.material;
  nb::dict result;
  result["base_color"] = nb::make_tuple(material.base_color[0], material.base_color[1],
                                        material.base_color[2], material.base_color[3]);
  result["metallic"] = material.metallic;
  result["roughness"] = material.roughness;
  result["emissive"] = nb::make_tuple(material.emissive[0], material.emissive[1], material.emissive[2]);
  result["alpha_mode"] = material.alpha_mode == AlphaMode::opaque ? "OPAQUE"
                         : material.alpha_mode == AlphaMode::mask ? "MASK"
                                                                  : "BLEND";
  result["alpha_cutoff"] = material.alpha_cutoff;
  return result;
}

template <class Type>
void bind_channels(nb::class_<Type>& type) {
  type.def_prop_ro("channels", &PyBaked::names, nb::sig("def channels(self) -> list[str]"),
                   "The names of the channels that were baked.")
      .def("__getitem__", &baked_array, nb::arg("channel"),
           nb::sig("def __getitem__(self, channel: str) -> numpy.typing.NDArray[typing.Any]"),
           R"(The values of a channel: a new array, row 0 at the top.

Of materials, (rows, resolution, k) float32 from 0 to 1, filled where there is no point: colours in linear light, 3, or 4
with alpha; metallic_roughness: roughness and metallic; occlusion: one. Of the shape of the detailed mesh, float32, NaN where
there is no point: normal and object_normal, (rows, resolution, 3), have length 1, in the tangent space of the coarse mesh or
in the coordinates of the meshes; position, (rows, resolution, 3), and displacement and thickness, (rows, resolution), are in
the units of the meshes; ambient_occlusion, (rows, resolution), from 0 to 1. face and material: (rows, resolution) uint32,
NONE where there is none. Raises Error for a channel that was not baked.)")
      .def(
          "image",
          [](const PyBaked& self, const std::string& name) {
            Image image = self.image(name);
            return array_of<std::uint8_t>(std::move(image.bytes),
                                          {image.height, image.width, image.components});
          },
          nb::arg("channel"), nb::sig("def image(self, channel: str) -> numpy.typing.NDArray[numpy.uint8]"),
          R"(A channel as a picture without gaps, (rows, resolution, k) uint8, as textures of glTF have it.

Colours are in sRGB, roughness in green and metallic in blue, normals from 0 to 255, ambient_occlusion in grey. Raises Error
for a channel that was not baked, and for lengths, positions and numbers, which are no pictures.)")
      .def_ro("material_names", &PyBaked::material_names, nb::sig("def material_names(self) -> list[str]"),
              "The names of the materials of the detailed mesh that the channel material has the numbers of, "
              "empty for those without one.");
}

template <class Type>
void bind_texels(nb::class_<Type>& type) {
  type.def_prop_ro(
          "matched",
          [](const PyBaked& self) {
            std::vector<std::uint8_t> matched(self.coverage.size());
            std::ranges::transform(self.coverage, matched.begin(), [](float share) { return share > 0; });
            return array_of<std::uint8_t>(std::move(matched), {self.rows(), self.columns()});
          },
          nb::sig("def matched(self) -> numpy.typing.NDArray[numpy.uint8]"),
          "1 for each texel with a point of the detailed mesh, otherwise 0: its values are those of others, "
          "(rows, resolution) uint8.")
      .def_prop_ro(
          "coverage",
          [](nb::handle self) {
            const auto& baked = nb::cast<const PyBaked&>(self);
            return view_of<float>(baked.coverage, {baked.rows(), baked.columns()}, self);
          },
          nb::sig("def coverage(self) -> numpy.typing.NDArray[numpy.float32]"),
          "The share of each texel's samples that have a point of the detailed mesh, from 0 to 1, (rows, "
          "resolution) float32.")
      .def_prop_ro(
          "kind",
          [](nb::handle self) {
            const auto& baked = nb::cast<const PyBaked&>(self);
            return view_of<std::uint8_t>(baked.kinds, {baked.rows(), baked.columns()}, self);
          },
          nb::sig("def kind(self) -> numpy.typing.NDArray[numpy.uint8]"),
          "How the point of each texel was found, or why there is none, (rows, resolution) uint8: see "
          "MatchKind. Of several samples, that of most of those with a point, or of those of a face.");
}

template <class Type>
void bind_mesh(nb::class_<Type>& type) {
  type.def_prop_ro(
          "mesh",
          [](const PyBaked& self) {
            return nb::cast(new PyMesh{self.surface.mesh()}, nb::rv_policy::take_ownership);
          },
          nb::sig("def mesh(self) -> Mesh"), "The coarse mesh, with the texture coordinates that it had.")
      .def_prop_ro("corner_uvs", &uvs_of,
                   nb::sig("def corner_uvs(self) -> numpy.typing.NDArray[numpy.float64]"),
                   "The texture coordinates of the corners of the coarse mesh's faces, (m, 3, 2), (0, 0) at "
                   "the lower left.")
      .def_prop_ro("material", &material_of, nb::sig("def material(self) -> dict[str, typing.Any]"),
                   "The factors of the model's material, for what has no texture: base_color, metallic, "
                   "roughness, emissive, in linear light, alpha_mode and alpha_cutoff, as glTF has them.")
      .def(
          "save", &save_baked, nb::arg("file"), nb::arg("units") = "", nb::arg("up") = "y",
          nb::sig("def save(self, file: str | os.PathLike[str], units: str = '', up: typing.Literal['y', "
                  "'z'] = 'y') -> None"),
          "Writes the coarse mesh with its textures as GLB: those of the material, the normal map, and "
          "ambient_occlusion unless occlusion is baked. units: m, cm, mm, um, in or ft scale it to metres. "
          "up: the axis of the mesh that points up. Raises Error, naming the file, if it cannot be written.");
  const auto forwarded = [&](const char* name, const char* signature, const char* text) {
    type.def(
        name, [name](nb::handle self) { return nb::module_::import_("sdm._looks").attr(name)(self); },
        nb::sig(signature), text);
  };
  forwarded("to_trimesh", "def to_trimesh(self) -> typing.Any",
            "The coarse mesh as a mesh of trimesh, with its textures in a PBRMaterial. A vertex with several "
            "texture coordinates becomes several. Needs trimesh and Pillow.");
  forwarded("to_pyvista", "def to_pyvista(self) -> tuple[typing.Any, typing.Any]",
            "The coarse mesh as (mesh, texture) of pyvista, for mesh.plot(texture=texture): with its texture "
            "coordinates, and the base colour, None if that was not baked. Needs pyvista.");
}

}  // namespace

const BakedChannel* PyBaked::find_look(const std::string& name) const {
  const auto found = std::ranges::find_if(
      channels, [&](const BakedChannel& channel) { return name == name_of(channel.channel); });
  return found == channels.end() ? nullptr : &*found;
}

const BakedGeometry* PyBaked::find_geometry(const std::string& name) const {
  const auto found =
      std::ranges::find_if(geometry, [&](const BakedGeometry& of) { return name == name_of(of.channel); });
  return found == geometry.end() ? nullptr : &*found;
}

std::vector<std::string> PyBaked::names() const {
  std::vector<std::string> names;
  for (const BakedChannel& channel : channels) names.emplace_back(name_of(channel.channel));
  for (const BakedGeometry& of : geometry) names.emplace_back(name_of(of.channel));
  return names;
}

Image PyBaked::image(const std::string& name) const {
  if (const BakedChannel* const look = find_look(name)) return to_image(*look);
  const BakedGeometry* const of = find_geometry(name);
  if (of == nullptr) throw Error("there is no channel '" + name + "'");
  const bool directions = is_direction(of->channel);
  if (!directions && of->channel != GeometryChannel::ambient_occlusion)
    throw Error("the channel '" + name + "' is no picture; its values are those of baked['" + name + "']");
  std::vector<float> filled = of->values;
  const auto free_texels = static_cast<std::uint32_t>((std::uint64_t{atlas.gutter} + 1) / side - 1);
  fill_texels(columns(), components_of(of->channel), filled, free_texels);
  return directions ? normal_map_image(columns(), filled) : scalar_image(columns(), filled, {0, 1}, 8).image;
}

void bind_baked(nb::module_& module) {
  nb::class_<PyBaked> type(module, "Baked", nb::is_weak_referenceable(),
                           "Textures of a coarse mesh, baked by bake().");
  bind_channels(type);
  bind_texels(type);
  bind_mesh(type);
  type.def_ro("notes", &PyBaked::notes, "What could not be had, and whether the coarse mesh got an atlas.")
      .def("__repr__", [](const PyBaked& self) {
        std::string names;
        for (const std::string& name : self.names()) names.append(names.empty() ? "" : ", ").append(name);
        return nb::str("sdm.Baked({}, {} x {})").format(names, self.columns(), self.rows());
      });
  bind_baked_state();
}

}  // namespace sdm::python
