// The compiled part of bake().
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>
#include <sdm/bake_files.h>
#include <sdm/error.h>

#include <algorithm>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "objects.h"
#include "run.h"
#include "values.h"

namespace sdm::python {
namespace {

/// O1 with its textures.
struct PyBaked {
  AtlasOptions atlas;  ///< of the surface
  Surface surface;
  std::vector<std::uint8_t> matched;  ///< for each texel, whether O2 has a point for it
  std::vector<BakedChannel> channels;
  Material material;
  std::vector<std::string> notes;

  [[nodiscard]] const BakedChannel& channel(const std::string& name) const {
    for (const BakedChannel& channel : channels)
      if (name == name_of(channel.channel)) return channel;
    throw Error("there is no channel '" + name + "'");
  }
};

/// What O2 looks like.
struct Look {
  MeshFile file;
  std::vector<Image> pictures;

  [[nodiscard]] MeshLook get() const {
    return {file.materials, file.face_materials, pictures, file.attributes};
  }
};

/// What a PyBaked is stored by: its surface is laid out again.
struct StoredBaked {
  Mesh mesh;
  AtlasOptions atlas;
  std::vector<std::uint8_t> matched;
  std::vector<BakedChannel> channels;
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
inline constexpr auto kMembers<StoredBaked> =
    std::tuple{&StoredBaked::mesh,     &StoredBaked::atlas,    &StoredBaked::matched,
               &StoredBaked::channels, &StoredBaked::material, &StoredBaked::notes};

namespace {

void check_stored(const StoredBaked& stored, const Surface& surface) {
  const std::size_t texels = surface.texel_faces().size();
  bool fits = stored.matched.size() == texels;
  for (const BakedChannel& channel : stored.channels)
    fits &= channel.resolution == surface.resolution() && channel.components >= 1 &&
            channel.components <= 4 && channel.values.size() == channel.components * texels;
  if (!fits) throw Error(kDamaged);
}

void bind_baked_state() {
  bind_state<PyBaked>(
      1,
      [](const PyBaked& self) {
        return nb::make_tuple(bytes_of(StoredBaked{self.surface.mesh(), self.atlas, self.matched,
                                                   self.channels, self.material, self.notes}));
      },
      [](PyBaked* self, const nb::tuple& from) {
        auto stored = value_of<StoredBaked>(from[0]);
        validate(stored.mesh);
        run_sized(stored.mesh.triangles.size(), [&] {
          Surface surface(std::move(stored.mesh), stored.atlas);
          check_stored(stored, surface);
          new (self)
              PyBaked{std::move(stored.atlas),    std::move(surface),         std::move(stored.matched),
                      std::move(stored.channels), std::move(stored.material), std::move(stored.notes)};
        });
      });
}

using Colors = nb::ndarray<const float, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Pixels = nb::ndarray<const std::uint8_t, nb::ndim<3>, nb::c_contig, nb::device::cpu>;

void add_colors(const Colors& colors, MeshFile& file) {
  if (colors.shape(0) != file.mesh.positions.size())
    throw Error("vertex_colors needs a row for each of " + std::to_string(file.mesh.positions.size()) +
                " vertices, not " + std::to_string(colors.shape(0)));
  file.attributes = {{.name = "color",
                      .components = 3,
                      .values = {colors.data(), colors.data() + colors.size()},
                      .rows = std::make_shared<std::vector<Triangle>>(file.mesh.triangles)}};
}

void add_texture(const Pixels& pixels, Look& look) {
  if (look.file.mesh.corner_uvs.empty()) throw Error("texture needs a mesh with texture coordinates");
  if (pixels.size() == 0 || pixels.shape(2) > 4)
    throw Error("texture must have the shape (height, width, 1 to 4) and at least one pixel");
  look.pictures = {{.width = static_cast<std::uint32_t>(pixels.shape(1)),
                    .height = static_cast<std::uint32_t>(pixels.shape(0)),
                    .components = static_cast<std::uint32_t>(pixels.shape(2)),
                    .bits = 8,
                    .bytes = {pixels.data(), pixels.data() + pixels.size()}}};
  look.file.materials.resize(1);
  look.file.materials[0].base_color_texture.texture = 0;
  look.file.face_materials.assign(look.file.mesh.triangles.size(), 0);
}

std::optional<AtlasKind> atlas_kind_of(const std::optional<std::string>& atlas) {
  if (!atlas) return std::nullopt;
  return atlas_of(atlas->c_str());
}

std::vector<BakeChannel> channels_of(const std::optional<std::vector<std::string>>& names, const Look& look) {
  std::vector<BakeChannel> channels;
  if (!names) {
    channels = varying_channels(look.file.mesh, look.get());
    if (std::ranges::count(channels, BakeChannel::base_color) == 0)
      channels.insert(channels.begin(), BakeChannel::base_color);
    return channels;
  }
  for (const std::string& name : *names) {
    const auto* const found =
        std::ranges::find_if(kBakeChannels, [&](BakeChannel channel) { return name == name_of(channel); });
    if (found == std::end(kBakeChannels))
      throw Error("channels are base_color, metallic_roughness, occlusion and emissive, not '" + name + "'");
    channels.push_back(*found);
  }
  return channels;
}

BakeAtlas laid_out(const Mesh& mesh, AtlasOptions options, std::optional<AtlasKind> kind) {
  if (!kind) return bake_atlas(mesh, options);
  options.kind = *kind;
  return {Surface(mesh, options), {}};
}

/// `file`: of O2, or None for `mesh` with colours or a texture.
nb::object baked_from(nb::handle file, nb::handle mesh, nb::handle low, const std::optional<Colors>& colors,
                      const std::optional<Pixels>& texture,
                      const std::optional<std::vector<std::string>>& channels, std::uint32_t resolution,
                      const std::optional<std::string>& atlas, double max_distance, nb::handle facing,
                      nb::handle progress) {
  Look look;
  std::optional<std::filesystem::path> path;
  if (!file.is_none())
    path = path_of(file);
  else
    look.file.mesh = mesh_of(mesh, nb::none());
  if (colors) add_colors(*colors, look.file);
  if (texture) add_texture(*texture, look);
  const Mesh on = mesh_of(low, nb::none());
  MapOptions options{.sign = SignMethod::none, .max_distance = max_distance, .facing = facing_of(facing)};
  const std::optional<AtlasKind> kind = atlas_kind_of(atlas);
  std::unique_ptr<PyBaked> result;
  run(progress, [&](const Progress& report) {
    options.progress = report;
    std::vector<std::string> notes;
    if (path) {
      look.file = read_mesh_file(*path, {.attributes = true});
      notes = look.file.notes;
      look.pictures = decode_textures(look.file.textures, look.get(), kBakeChannels, notes);
    }
    if (look.file.materials.empty() &&
        std::ranges::count(look.file.attributes, "color", &MeshAttribute::name) == 0)
      throw Error("high has neither materials nor colours of vertices, so there is nothing to bake");
    AtlasOptions layout{.resolution = resolution, .progress = report};
    BakeAtlas laid = laid_out(on, layout, kind);
    layout.kind = kind.value_or(laid.fault.empty() ? AtlasKind::uv : AtlasKind::charts);
    layout.progress = {};
    if (!laid.fault.empty()) notes.push_back("low: " + laid.fault + ", so it got an atlas of charts");
    const Sites sites(look.file.mesh);
    const TexelMatches matches = matches_of(laid.surface, sites, compute_map(laid.surface, sites, options));
    if (std::ranges::all_of(matches.face, [](std::uint32_t face) { return face == kNone; }))
      throw Error("no point of high is close enough to a texel of low, or faces one: nothing can be baked");
    const auto chosen = channels_of(channels, look);
    std::vector<BakedChannel> values =
        bake(laid.surface, sites, matches, look.get(), chosen, {.progress = report});
    std::vector<std::uint8_t> matched(matches.face.size());
    std::ranges::transform(matches.face, matched.begin(), [](std::uint32_t face) { return face != kNone; });
    result =
        std::make_unique<PyBaked>(PyBaked{std::move(layout), std::move(laid.surface), std::move(matched),
                                          std::move(values), common_material(look.get()), std::move(notes)});
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
    write_baked_glb(path, self.surface, textures,
                    {.material = self.material, .units = units, .up = up == "z" ? UpAxis::z : UpAxis::y});
  });
}

void bind_baked(nb::module_& module) {
  nb::class_<PyBaked>(module, "Baked", nb::is_weak_referenceable(),
                      "Textures of a coarse mesh, baked by bake().")
      .def_prop_ro(
          "channels",
          [](const PyBaked& self) {
            std::vector<std::string> names;
            for (const BakedChannel& channel : self.channels) names.emplace_back(name_of(channel.channel));
            return names;
          },
          nb::sig("def channels(self) -> list[str]"), "The names of the channels that were baked.")
      .def(
          "__getitem__",
          [](const PyBaked& self, const std::string& name) {
            const BakedChannel& channel = self.channel(name);
            std::vector<float> copy = channel.values;
            return array_of<float>(std::move(copy),
                                   {self.surface.rows(), channel.resolution, channel.components});
          },
          nb::arg("channel"),
          nb::sig("def __getitem__(self, channel: str) -> numpy.typing.NDArray[numpy.float32]"),
          "The values of a channel, (rows, resolution, k) float32 from 0 to 1, row 0 at the top. Colours are "
          "in linear light: 3, or 4 with alpha; metallic_roughness has roughness and metallic, occlusion one "
          "value. A new array. Raises Error for a channel that was not baked.")
      .def(
          "image",
          [](const PyBaked& self, const std::string& name) {
            Image image = to_image(self.channel(name));
            return array_of<std::uint8_t>(std::move(image.bytes),
                                          {image.height, image.width, image.components});
          },
          nb::arg("channel"), nb::sig("def image(self, channel: str) -> numpy.typing.NDArray[numpy.uint8]"),
          "A channel as a picture, (rows, resolution, k) uint8, as textures of glTF have it: colours in "
          "sRGB, "
          "roughness in green and metallic in blue. Raises Error for a channel that was not baked.")
      .def_prop_ro(
          "matched",
          [](const PyBaked& self) {
            std::vector<std::uint8_t> copy = self.matched;
            return array_of<std::uint8_t>(std::move(copy), {self.surface.rows(), self.surface.resolution()});
          },
          nb::sig("def matched(self) -> numpy.typing.NDArray[numpy.uint8]"),
          "1 for each texel with a point of the detailed mesh, otherwise 0: its values are those of others, "
          "(rows, resolution) uint8.")
      .def_prop_ro("corner_uvs", &uvs_of,
                   nb::sig("def corner_uvs(self) -> numpy.typing.NDArray[numpy.float64]"),
                   "The texture coordinates of the corners of the coarse mesh's faces, (m, 3, 2), (0, 0) at "
                   "the lower left.")
      .def_ro("notes", &PyBaked::notes, "What could not be had, and whether the coarse mesh got an atlas.")
      .def("save", &save_baked, nb::arg("file"), nb::arg("units") = "", nb::arg("up") = "y",
           nb::sig("def save(self, file: str | os.PathLike[str], units: str = '', up: typing.Literal['y', "
                   "'z'] = 'y') -> None"),
           "Writes the coarse mesh with its textures as GLB. units: m, cm, mm, um, in or ft scale it to "
           "metres. "
           "up: the axis of the mesh that points up. Raises Error, naming the file, if it cannot be written.")
      .def("__repr__", [](const PyBaked& self) {
        std::string names;
        for (const BakedChannel& channel : self.channels)
          names.append(names.empty() ? "" : ", ").append(name_of(channel.channel));
        return nb::str("sdm.Baked({}, {} x {})")
            .format(names, self.surface.resolution(), self.surface.rows());
      });
  bind_baked_state();
}

}  // namespace

void bind_baking(nb::module_& module) {
  bind_baked(module);
  module.def("bake", &baked_from, nb::arg("file").none(), nb::arg("mesh").none(), nb::arg("low").none(),
             nb::arg("colors").none(), nb::arg("texture").none(), nb::arg("channels").none(),
             nb::arg("resolution"), nb::arg("atlas").none(), nb::arg("max_distance"),
             nb::arg("facing").none(), nb::arg("progress").none(),
             nb::sig("def bake(file: object, mesh: object, low: object, colors: object, texture: object, "
                     "channels: object, resolution: int, atlas: object, max_distance: float, facing: object, "
                     "progress: object) -> Baked"));
}

}  // namespace sdm::python
