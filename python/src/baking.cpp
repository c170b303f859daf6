// The compiled part of bake().
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>
#include <sdm/bake_files.h>
#include <sdm/error.h>
#include <sdm/supersampling.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "arrays.h"
#include "baked.h"
#include "look.h"
#include "objects.h"
#include "run.h"

namespace sdm::python {
namespace {

std::optional<AtlasKind> atlas_kind_of(const std::optional<std::string>& atlas) {
  if (!atlas) return std::nullopt;
  return enum_of<AtlasKind>("atlas", *atlas);
}

/// What is asked for.
struct Wanted {
  std::optional<std::vector<BakeChannel>> look{};  ///< nothing: the channels that differ
  std::vector<GeometryChannel> geometry{};

  [[nodiscard]] bool needs_look() const { return !look || !look->empty(); }
  [[nodiscard]] bool has(GeometryChannel channel) const { return std::ranges::count(geometry, channel) > 0; }
};

void check_channel_name(const std::string& name) {
  std::string all;
  const auto is_one = [&](const auto& channels) {
    for (const auto channel : channels) {
      if (name == name_of(channel)) return true;
      all.append(all.empty() ? "" : ", ").append(name_of(channel));
    }
    return false;
  };
  if (!is_one(kBakeChannels) && !is_one(kGeometryChannels))
    throw Error("channels are " + all + ", not '" + name + "'");
}

/// Those of the names, in the order of the library.
Wanted wanted_of(const std::optional<std::vector<std::string>>& names) {
  Wanted wanted;
  if (!names) return wanted;
  if (names->empty()) throw Error("channels is empty: there is nothing to bake");
  std::ranges::for_each(*names, check_channel_name);
  const auto add = [&](const auto& channels, auto& to) {
    for (const auto channel : channels)
      if (std::ranges::count(*names, std::string(name_of(channel))) > 0) to.push_back(channel);
  };
  add(kBakeChannels, wanted.look.emplace()), add(kGeometryChannels, wanted.geometry);
  if (wanted.has(GeometryChannel::normal) && !has_tangents())
    throw Error("the channel 'normal' needs MikkTSpace, which this build does not have");
  return wanted;
}

std::uint32_t side_of(std::int64_t samples) {
  if (const auto side = sample_side(samples)) return *side;
  throw Error("samples must be one of 1, 4, 9, 16, 25, 36, 49, 64, not " + std::to_string(samples));
}

BakeAtlas laid_out(const Mesh& mesh, AtlasOptions options, std::optional<AtlasKind> kind) {
  if (!kind) return bake_atlas(mesh, options);
  options.kind = *kind;
  return {Surface(mesh, options), {}};
}

/// `match`: None for the closest point, or that of facing if it is given.
MatchOptions match_options(const std::optional<std::string>& match, std::optional<double> facing,
                           std::optional<double> cage, double max_distance) {
  MatchOptions options{.method = match    ? enum_of<MatchMethod>("match", *match)
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
      wanted.look ? std::span<const BakeChannel>(*wanted.look) : kBakeChannels;
  look.pictures = decode_textures(look.file.textures, look.get(), channels, notes);
}

void check_look(const Wanted& wanted, const Look& look) {
  if (wanted.needs_look() && look.file.materials.empty() &&
      std::ranges::count(look.file.attributes, "color", &MeshAttribute::name) == 0)
    throw Error("high has neither materials nor colours of vertices, so there is nothing to bake");
  if (wanted.has(GeometryChannel::material) && look.file.materials.empty())
    throw Error("high has no materials, so the channel 'material' cannot be baked");
}

/// What is baked.
struct Baking {
  const Surface& surface;
  const Sites& sites;
  const TexelMatches& matches;
  const Look& look;
  SampleGrid grid;
  std::uint32_t gutter;      ///< in texels
  GeometryOptions geometry;  ///< with the progress
};

std::vector<BakedChannel> baked_look(const Baking& of, const Wanted& wanted) {
  const MeshLook look = of.look.get();
  const auto channels = wanted.look ? *wanted.look : default_channels(of.sites.mesh(), look);
  const bool single = of.grid.side == 1;
  std::vector<BakedChannel> baked = bake(of.surface, of.sites, of.matches, look, channels,
                                         {.fill = single, .progress = of.geometry.progress});
  if (single) return baked;
  for (BakedChannel& channel : baked) {
    channel.values = mean_of_samples(of.grid, channel.components, channel.values).values;
    channel.resolution = of.grid.texels();
    fill_texels(channel.resolution, channel.components, channel.values, of.gutter);
  }
  return baked;
}

std::vector<std::uint32_t> baked_numbers(const Baking& of, GeometryChannel channel) {
  std::vector<std::uint32_t> numbers =
      channel == GeometryChannel::face
          ? of.matches.face
          : matched_materials(of.surface, of.sites, of.matches, of.look.file.face_materials);
  return of.grid.side == 1 ? numbers : most_frequent_samples(of.grid, numbers);
}

BakedGeometry baked_geometry(const Baking& of, GeometryChannel channel) {
  if (is_number(channel)) return {.channel = channel, .numbers = baked_numbers(of, channel)};
  std::vector<float> values = bake_geometry(of.surface, of.sites, of.matches, channel, of.geometry);
  if (of.grid.side > 1)
    values = mean_of_samples(of.grid, components_of(channel), values,
                             is_direction(channel) ? SampleKind::directions : SampleKind::numbers)
                 .values;
  return {.channel = channel, .values = std::move(values)};
}

bool has_point(MatchKind kind) {
  return kind == MatchKind::closest || kind == MatchKind::facing || kind == MatchKind::ray;
}

/// The kind of most samples of each texel that have a point; if none has, of those that a face owns.
std::vector<MatchKind> kinds_of_texels(const SampleGrid& grid, const std::vector<MatchKind>& samples) {
  if (grid.side == 1) return samples;
  const auto most = [&](bool with_point) {
    std::vector<std::uint32_t> numbers(samples.size());
    std::ranges::transform(samples, numbers.begin(), [&](MatchKind kind) {
      const bool counts = kind != MatchKind::none && has_point(kind) == with_point;
      return counts ? static_cast<std::uint32_t>(kind) : kNone;
    });
    return most_frequent_samples(grid, numbers);
  };
  const std::vector<std::uint32_t> found = most(true), others = most(false);
  std::vector<MatchKind> kinds(found.size(), MatchKind::none);
  for (std::size_t i = 0; i < kinds.size(); ++i)
    if (const std::uint32_t kind = found[i] != kNone ? found[i] : others[i]; kind != kNone)
      kinds[i] = static_cast<MatchKind>(kind);
  return kinds;
}

std::vector<float> coverage_of(const SampleGrid& grid, const std::vector<MatchKind>& samples) {
  std::vector<float> found(samples.size());
  std::ranges::transform(samples, found.begin(), [](MatchKind kind) {
    return has_point(kind) ? 1 : std::numeric_limits<float>::quiet_NaN();
  });
  return mean_of_samples(grid, 1, found).coverage;
}

std::vector<std::string> names_of_materials(const std::vector<Material>& materials) {
  std::vector<std::string> names;
  for (const Material& material : materials) names.push_back(material.name);
  return names;
}

/// How textures are laid out, and what is in them.
struct BakeArguments {
  Wanted wanted;
  std::uint32_t side = 1;
  AtlasOptions texels;
  std::optional<AtlasKind> kind;
  MatchOptions match;
  AmbientOcclusionOptions occlusion;
};

std::unique_ptr<PyBaked> bake_look(const Look& look, BakeAtlas laid, const AtlasOptions& atlas,
                                   const BakeArguments& arguments) {
  const Wanted& wanted = arguments.wanted;
  check_look(wanted, look);
  const Sites sites(look.file.mesh);
  const TexelMatches matches = match_texels(laid.surface, sites, arguments.match);
  if (std::ranges::all_of(matches.face, [](std::uint32_t face) { return face == kNone; }))
    throw Error("no point of high is close enough to a texel of low, or faces one: nothing can be baked");
  const SampleGrid grid{laid.surface.resolution(), arguments.side};
  const auto& attributes = look.file.attributes;
  const auto own = std::ranges::find(attributes, "normal", &MeshAttribute::name);
  std::optional<DrawnFrames> frames;
  if (wanted.has(GeometryChannel::normal)) frames.emplace(laid.surface);
  GeometryOptions options;
  if (own != attributes.end()) options.normals = &*own;
  if (frames) options.drawn_normals = &frames->normals, options.drawn_tangents = &frames->tangents;
  options.occlusion = arguments.occlusion;
  options.progress = arguments.match.progress;
  const Baking baking{.surface = laid.surface,
                      .sites = sites,
                      .matches = matches,
                      .look = look,
                      .grid = grid,
                      .gutter = arguments.texels.gutter,
                      .geometry = options};
  std::vector<BakedChannel> channels = baked_look(baking, wanted);
  std::vector<BakedGeometry> geometry;
  for (const GeometryChannel channel : wanted.geometry) geometry.push_back(baked_geometry(baking, channel));
  return std::make_unique<PyBaked>(PyBaked{.atlas = atlas,
                                           .surface = std::move(laid.surface),
                                           .side = grid.side,
                                           .kinds = kinds_of_texels(grid, matches.kind),
                                           .coverage = coverage_of(grid, matches.kind),
                                           .channels = std::move(channels),
                                           .geometry = std::move(geometry),
                                           .frames = std::move(frames),
                                           .material = common_material(look.get()),
                                           .material_names = names_of_materials(look.file.materials),
                                           .notes = {}});
}

/// `file`: of O2; nothing: the mesh of `look`.
std::unique_ptr<PyBaked> bake_onto(const Mesh& on, const std::optional<std::filesystem::path>& file,
                                   Look& look, BakeArguments arguments, const Progress& progress) {
  std::vector<std::string> notes;
  if (file) read_look(*file, arguments.wanted, look, notes);
  AtlasOptions layout = sample_layout(arguments.texels, arguments.side);
  layout.progress = arguments.match.progress = progress;
  BakeAtlas laid = laid_out(on, layout, arguments.kind);
  layout.kind = arguments.kind.value_or(laid.fault.empty() ? AtlasKind::uv : AtlasKind::charts);
  layout.progress = {};
  if (!laid.fault.empty()) notes.push_back("low: " + laid.fault + ", so it got an atlas of charts");
  std::unique_ptr<PyBaked> result = bake_look(look, std::move(laid), layout, arguments);
  result->notes = std::move(notes);
  return result;
}

/// `file`: of O2, or None for `mesh`, which looks as `appearance` has it.
nb::object baked_from(nb::handle file, nb::handle mesh, const nb::dict& appearance, nb::handle low,
                      const std::optional<std::vector<std::string>>& channels, std::uint32_t resolution,
                      std::int64_t samples, const std::optional<std::string>& atlas, std::uint32_t gutter,
                      const std::optional<std::string>& match, nb::handle facing, std::optional<double> cage,
                      double max_distance, std::uint32_t occlusion_rays, double occlusion_distance,
                      nb::handle progress) {
  BakeArguments arguments;
  arguments.wanted = wanted_of(channels);
  arguments.side = side_of(samples);
  arguments.texels.resolution = resolution, arguments.texels.gutter = gutter;
  arguments.kind = atlas_kind_of(atlas);
  arguments.match = match_options(match, facing_of(facing), cage, max_distance);
  arguments.occlusion.rays = occlusion_rays, arguments.occlusion.max_distance = occlusion_distance;
  Look look;
  std::optional<std::filesystem::path> path;
  if (!file.is_none())
    path = path_of(file);
  else
    look.file.mesh = mesh_of(mesh, nb::none());
  add_look(appearance, look);
  const Mesh on = mesh_of(low, nb::none());
  std::unique_ptr<PyBaked> result;
  run(progress,
      [&](const Progress& report) { result = bake_onto(on, path, look, std::move(arguments), report); });
  return nb::cast(result.release(), nb::rv_policy::take_ownership);
}

}  // namespace

void bind_baking(nb::module_& module) {
  bind_baked(module);
  module.def("bake", &baked_from, nb::arg("file").none(), nb::arg("mesh").none(), nb::arg("appearance"),
             nb::arg("low").none(), nb::arg("channels").none(), nb::arg("resolution"), nb::arg("samples"),
             nb::arg("atlas").none(), nb::arg("gutter"), nb::arg("match").none(), nb::arg("facing").none(),
             nb::arg("cage").none(), nb::arg("max_distance"), nb::arg("occlusion_rays"),
             nb::arg("occlusion_distance"), nb::arg("progress").none(),
             nb::sig("def bake(file: object, mesh: object, appearance: dict[str, object], low: object, "
                     "channels: object, resolution: int, samples: int, atlas: object, gutter: int, match: "
                     "object, facing: object, cage: object, max_distance: float, occlusion_rays: int, "
                     "occlusion_distance: float, progress: object) -> Baked"));
}

}  // namespace sdm::python
