// The compiled part of bake().
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>
#include <sdm/bake_files.h>
#include <sdm/baked_geometry.h>
#include <sdm/error.h>

#include <algorithm>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "look.h"
#include "objects.h"
#include "run.h"
#include "values.h"

namespace sdm::python {
namespace {

constexpr const char* kNormalMap = "normal";

/// The normals of O2 in the tangent space of O1, as it is drawn with these normals and tangents.
struct NormalMap {
  std::vector<float> values;
  MeshAttribute normals, tangents;
};

NormalMap as_drawn(const Surface& surface, std::vector<float> values) {
  NormalMap map{
      .values = std::move(values), .normals = smooth_normals(surface.mesh(), kDrawnCrease), .tangents = {}};
  map.tangents = tangents(surface, map.normals);
  return map;
}

/// O1 with its textures.
struct PyBaked {
  AtlasOptions atlas;  ///< of the surface
  Surface surface;
  std::vector<MatchKind> kinds;  ///< of each texel
  std::vector<BakedChannel> channels;
  std::optional<NormalMap> normal_map;
  Material material;
  std::vector<std::string> notes;

  [[nodiscard]] const BakedChannel* find(const std::string& name) const {
    const auto found = std::ranges::find_if(
        channels, [&](const BakedChannel& channel) { return name == name_of(channel.channel); });
    if (found == channels.end() && !(normal_map && name == kNormalMap))
      throw Error("there is no channel '" + name + "'");
    return found == channels.end() ? nullptr : &*found;
  }
  /// The values of a channel, and how many each texel has.
  [[nodiscard]] std::pair<const std::vector<float>&, std::size_t> values(const std::string& name) const {
    const BakedChannel* const channel = find(name);
    if (channel == nullptr) return {normal_map->values, 3};
    return {channel->values, channel->components};
  }
  [[nodiscard]] Image image(const std::string& name) const {
    const BakedChannel* const channel = find(name);
    return channel == nullptr ? normal_map_image(surface, normal_map->values) : to_image(*channel);
  }
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const BakedChannel& channel : channels) names.emplace_back(name_of(channel.channel));
    if (normal_map) names.emplace_back(kNormalMap);
    return names;
  }
};

/// What a PyBaked is stored by: its surface is laid out again.
struct StoredBaked {
  Mesh mesh;
  AtlasOptions atlas;
  std::vector<MatchKind> kinds;
  std::vector<BakedChannel> channels;
  std::vector<float> normal_map;  ///< empty: there is none
  Material material;
  std::vector<std::string> notes;
};

}  // namespace

template <>
inline constexpr auto kLast<AtlasKind> = AtlasKind::uv;
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
inline constexpr auto kMembers<StoredBaked> =
    std::tuple{&StoredBaked::mesh,       &StoredBaked::atlas,    &StoredBaked::kinds, &StoredBaked::channels,
               &StoredBaked::normal_map, &StoredBaked::material, &StoredBaked::notes};

namespace {

void check_stored(const StoredBaked& stored, const Surface& surface) {
  const std::size_t texels = surface.texel_faces().size();
  bool fits =
      stored.kinds.size() == texels && (stored.normal_map.empty() || stored.normal_map.size() == 3 * texels);
  for (const BakedChannel& channel : stored.channels)
    fits &= channel.resolution == surface.resolution() && channel.components >= 1 &&
            channel.components <= 4 && channel.values.size() == channel.components * texels;
  if (!fits) throw Error(kDamaged);
}

void bind_baked_state() {
  bind_state<PyBaked>(
      1,
      [](const PyBaked& self) {
        return nb::make_tuple(bytes_of(StoredBaked{
            self.surface.mesh(), self.atlas, self.kinds, self.channels,
            self.normal_map ? self.normal_map->values : std::vector<float>(), self.material, self.notes}));
      },
      [](PyBaked* self, const nb::tuple& from) {
        auto stored = value_of<StoredBaked>(from[0]);
        validate(stored.mesh);
        run_sized(stored.mesh.triangles.size(), [&] {
          Surface surface(std::move(stored.mesh), stored.atlas);
          check_stored(stored, surface);
          std::optional<NormalMap> normal_map;
          if (!stored.normal_map.empty()) normal_map = as_drawn(surface, std::move(stored.normal_map));
          new (self) PyBaked{std::move(stored.atlas),    std::move(surface),    std::move(stored.kinds),
                             std::move(stored.channels), std::move(normal_map), std::move(stored.material),
                             std::move(stored.notes)};
        });
      });
}

std::optional<AtlasKind> atlas_kind_of(const std::optional<std::string>& atlas) {
  if (!atlas) return std::nullopt;
  return atlas_of(atlas->c_str());
}

/// What is asked for: nothing for the channels that differ.
struct Wanted {
  std::optional<std::vector<BakeChannel>> channels;
  bool normal_map = false;

  [[nodiscard]] bool look() const { return !channels || !channels->empty(); }
};

Wanted wanted_of(const std::optional<std::vector<std::string>>& names) {
  Wanted wanted;
  if (!names) return wanted;
  wanted.channels.emplace();
  for (const std::string& name : *names) {
    const auto* const found =
        std::ranges::find_if(kBakeChannels, [&](BakeChannel channel) { return name == name_of(channel); });
    if (found != std::end(kBakeChannels))
      wanted.channels->push_back(*found);
    else if (name == kNormalMap)
      wanted.normal_map = true;
    else
      throw Error("channels are base_color, metallic_roughness, occlusion, emissive and normal, not '" +
                  name + "'");
  }
  if (names->empty()) throw Error("channels is empty: there is nothing to bake");
  if (wanted.normal_map && !has_tangents())
    throw Error("the channel 'normal' needs MikkTSpace, which this build does not have");
  return wanted;
}

std::vector<BakeChannel> channels_of(const Wanted& wanted, const Look& look) {
  if (wanted.channels) return *wanted.channels;
  return default_channels(look.file.mesh, look.get());
}

BakeAtlas laid_out(const Mesh& mesh, AtlasOptions options, std::optional<AtlasKind> kind) {
  if (!kind) return bake_atlas(mesh, options);
  options.kind = *kind;
  return {Surface(mesh, options), {}};
}

/// `match`: None for the closest point, or that of facing if it is given.
MatchOptions match_options(const std::optional<std::string>& match, std::optional<double> facing,
                           std::optional<double> cage, double max_distance) {
  MatchOptions options{.method = match    ? match_method_of(*match)
                                 : facing ? MatchMethod::facing
                                          : MatchMethod::closest,
                       .max_distance = max_distance};
  if (facing && options.method == MatchMethod::closest)
    throw Error("facing does not apply to match='closest'");
  if (cage && options.method != MatchMethod::ray) throw Error("cage applies to match='ray'");
  if (facing) options.facing = *facing;
  if (cage) options.cage = *cage;
  return options;
}

/// Reads a file with what its faces look like.
void read_look(const std::filesystem::path& path, const Wanted& wanted, Look& look,
               std::vector<std::string>& notes) {
  look.file = read_mesh_file(path, {.attributes = true});
  notes = look.file.notes;
  const std::span<const BakeChannel> channels =
      wanted.channels ? std::span<const BakeChannel>(*wanted.channels) : kBakeChannels;
  look.pictures = decode_textures(look.file.textures, look.get(), channels, notes);
}

/// The normals of O2 are those of its file, or smooth ones.
NormalMap normal_map_of(const Surface& surface, const Sites& sites, const TexelMatches& matches,
                        const Look& look, const Progress& progress) {
  const auto& attributes = look.file.attributes;
  const auto own = std::ranges::find(attributes, "normal", &MeshAttribute::name);
  NormalMap map = as_drawn(
      surface, matched_normals(surface, sites, matches,
                               own != attributes.end() ? *own : smooth_normals(sites.mesh()), progress));
  map.values = tangent_space_normals(surface, map.normals, map.tangents, map.values, progress);
  fill_texels(surface, 3, map.values, true);
  return map;
}

std::unique_ptr<PyBaked> bake_look(const Look& look, BakeAtlas laid, const AtlasOptions& atlas,
                                   const Wanted& wanted, const MatchOptions& options) {
  if (wanted.look() && look.file.materials.empty() &&
      std::ranges::count(look.file.attributes, "color", &MeshAttribute::name) == 0)
    throw Error("high has neither materials nor colours of vertices, so there is nothing to bake");
  const Sites sites(look.file.mesh);
  TexelMatches matches = match_texels(laid.surface, sites, options);
  if (std::ranges::all_of(matches.face, [](std::uint32_t face) { return face == kNone; }))
    throw Error("no point of high is close enough to a texel of low, or faces one: nothing can be baked");
  const auto chosen = channels_of(wanted, look);
  std::vector<BakedChannel> channels =
      bake(laid.surface, sites, matches, look.get(), chosen, {.progress = options.progress});
  std::optional<NormalMap> normal_map;
  if (wanted.normal_map) normal_map = normal_map_of(laid.surface, sites, matches, look, options.progress);
  return std::make_unique<PyBaked>(PyBaked{.atlas = atlas,
                                           .surface = std::move(laid.surface),
                                           .kinds = std::move(matches.kind),
                                           .channels = std::move(channels),
                                           .normal_map = std::move(normal_map),
                                           .material = common_material(look.get()),
                                           .notes = {}});
}

/// `file`: of O2, or None for `mesh`, which looks as `appearance` has it.
nb::object baked_from(nb::handle file, nb::handle mesh, const nb::dict& appearance, nb::handle low,
                      const std::optional<std::vector<std::string>>& channels, std::uint32_t resolution,
                      const std::optional<std::string>& atlas, std::uint32_t gutter,
                      const std::optional<std::string>& match, nb::handle facing, std::optional<double> cage,
                      double max_distance, nb::handle progress) {
  const Wanted wanted = wanted_of(channels);
  MatchOptions options = match_options(match, facing_of(facing), cage, max_distance);
  const std::optional<AtlasKind> kind = atlas_kind_of(atlas);
  Look look;
  std::optional<std::filesystem::path> path;
  if (!file.is_none())
    path = path_of(file);
  else
    look.file.mesh = mesh_of(mesh, nb::none());
  add_look(appearance, look);
  const Mesh on = mesh_of(low, nb::none());
  std::unique_ptr<PyBaked> result;
  run(progress, [&](const Progress& report) {
    options.progress = report;
    std::vector<std::string> notes;
    if (path) read_look(*path, wanted, look, notes);
    AtlasOptions layout{.resolution = resolution, .gutter = gutter, .progress = report};
    BakeAtlas laid = laid_out(on, layout, kind);
    layout.kind = kind.value_or(laid.fault.empty() ? AtlasKind::uv : AtlasKind::charts);
    layout.progress = {};
    if (!laid.fault.empty()) notes.push_back("low: " + laid.fault + ", so it got an atlas of charts");
    result = bake_look(look, std::move(laid), layout, wanted, options);
    result->notes = std::move(notes);
  });
  return nb::cast(result.release(), nb::rv_policy::take_ownership);
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

void save_baked(const PyBaked& self, nb::handle file, const std::string& units, const std::string& up) {
  const std::filesystem::path path = path_of(file);
  if (up != "y" && up != "z") throw Error("up must be 'y' or 'z', not '" + up + "'");
  run(nb::none(), [&](const Progress&) {
    std::vector<BakedTexture> textures;
    for (const BakedChannel& channel : self.channels)
      textures.push_back({channel.channel, encode_png(to_image(channel), is_color(channel.channel))});
    BakedModelOptions options{
        .material = self.material, .units = units, .up = up == "z" ? UpAxis::z : UpAxis::y};
    std::vector<char> normal_map;
    if (self.normal_map) {
      normal_map = encode_png(self.image(kNormalMap), false);
      options.normals = &self.normal_map->normals, options.tangents = &self.normal_map->tangents;
      options.normal_map = normal_map;
    }
    write_baked_glb(path, self.surface, textures, options);
  });
}

nb::dict material_of(const PyBaked& self) {
  const Material& material = self.material;
  nb::dict result;
  result["base_color"] = nb::make_tuple(material.base_color[0], material.base_color[1],
                                        material.base_color[2], material.base_color[3]);
  result["metallic"] = material.metallic, result["roughness"] = material.roughness;
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
      .def(
          "__getitem__",
          [](const PyBaked& self, const std::string& name) {
            const auto [values, components] = self.values(name);
            std::vector<float> copy = values;
            return array_of<float>(std::move(copy),
                                   {self.surface.rows(), self.surface.resolution(), components});
          },
          nb::arg("channel"),
          nb::sig("def __getitem__(self, channel: str) -> numpy.typing.NDArray[numpy.float32]"),
          R"(The values of a channel, (rows, resolution, k) float32, row 0 at the top, from 0 to 1.

Colours are in linear light: 3, or 4 with alpha; metallic_roughness has roughness and metallic, occlusion one value.
normal: vectors of length 1 in the tangent space of the coarse mesh. A new array. Raises Error for a channel that was
not baked.)")
      .def(
          "image",
          [](const PyBaked& self, const std::string& name) {
            Image image = self.image(name);
            return array_of<std::uint8_t>(std::move(image.bytes),
                                          {image.height, image.width, image.components});
          },
          nb::arg("channel"), nb::sig("def image(self, channel: str) -> numpy.typing.NDArray[numpy.uint8]"),
          "A channel as a picture, (rows, resolution, k) uint8, as textures of glTF have it: colours in "
          "sRGB, "
          "roughness in green and metallic in blue, normals from 0 to 255. Raises Error for a channel that "
          "was "
          "not baked.");
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
      .def("save", &save_baked, nb::arg("file"), nb::arg("units") = "", nb::arg("up") = "y",
           nb::sig("def save(self, file: str | os.PathLike[str], units: str = '', up: typing.Literal['y', "
                   "'z'] = 'y') -> None"),
           "Writes the coarse mesh with its textures as GLB. units: m, cm, mm, um, in or ft scale it to "
           "metres. up: the axis of the mesh that points up. Raises Error, naming the file, if it cannot be "
           "written.");
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

void bind_baked(nb::module_& module) {
  nb::class_<PyBaked> type(module, "Baked", nb::is_weak_referenceable(),
                           "Textures of a coarse mesh, baked by bake().");
  bind_channels(type);
  bind_mesh(type);
  type.def_prop_ro(
          "matched",
          [](const PyBaked& self) {
            std::vector<std::uint8_t> matched(self.kinds.size());
            std::ranges::transform(self.kinds, matched.begin(), [](MatchKind kind) {
              return kind == MatchKind::closest || kind == MatchKind::facing || kind == MatchKind::ray;
            });
            return array_of<std::uint8_t>(std::move(matched),
                                          {self.surface.rows(), self.surface.resolution()});
          },
          nb::sig("def matched(self) -> numpy.typing.NDArray[numpy.uint8]"),
          "1 for each texel with a point of the detailed mesh, otherwise 0: its values are those of others, "
          "(rows, resolution) uint8.")
      .def_prop_ro(
          "kind",
          [](nb::handle self) {
            const auto& baked = nb::cast<const PyBaked&>(self);
            return view_of<std::uint8_t>(baked.kinds, {baked.surface.rows(), baked.surface.resolution()},
                                         self);
          },
          nb::sig("def kind(self) -> numpy.typing.NDArray[numpy.uint8]"),
          "How the point of each texel was found, or why there is none, (rows, resolution) uint8: see "
          "MatchKind.")
      .def_ro("notes", &PyBaked::notes, "What could not be had, and whether the coarse mesh got an atlas.")
      .def("__repr__", [](const PyBaked& self) {
        std::string names;
        for (const std::string& name : self.names()) names.append(names.empty() ? "" : ", ").append(name);
        return nb::str("sdm.Baked({}, {} x {})")
            .format(names, self.surface.resolution(), self.surface.rows());
      });
  bind_baked_state();
}

}  // namespace

void bind_baking(nb::module_& module) {
  bind_baked(module);
  module.def("bake", &baked_from, nb::arg("file").none(), nb::arg("mesh").none(), nb::arg("appearance"),
             nb::arg("low").none(), nb::arg("channels").none(), nb::arg("resolution"),
             nb::arg("atlas").none(), nb::arg("gutter"), nb::arg("match").none(), nb::arg("facing").none(),
             nb::arg("cage").none(), nb::arg("max_distance"), nb::arg("progress").none(),
             nb::sig("def bake(file: object, mesh: object, appearance: dict[str, object], low: object, "
                     "channels: object, resolution: int, atlas: object, gutter: int, match: object, facing: "
                     "object, cage: object, max_distance: float, progress: object) -> Baked"));
}

}  // namespace sdm::python
