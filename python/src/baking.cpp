// The compiled part of bake().
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>
#include <sdm/bake.h>
#include <sdm/bake_files.h>
#include <sdm/error.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "baked.h"
#include "look.h"
#include "objects.h"
#include "options.h"
#include "run.h"

namespace sdm::python {
namespace {

/// Whether the look of O2 is baked; by default, the channels that differ are.
bool needs_look(const BakeRequest& wanted) {
  return !wanted.channels || !wanted.channels->look.empty();
}

bool has(const BakeRequest& wanted, GeometryChannel channel) {
  return wanted.channels && wanted.channels->has(channel);
}

BakeRequest request_of(const nb::dict& given) {
  check_keywords("bake", given);
  BakeRequest request;
  set_options(with_side(given, 1), request);
  const std::uint32_t rows = request.resolution;
  set_options(with_side(given, 0), request);
  if (rows != request.resolution) request.rows = rows;
  return request;
}

BakeAtlas laid_out(const Mesh& mesh, const BakeRequest& request) {
  const AtlasOptions layout = sample_layout(request);
  return request.atlas ? BakeAtlas{Surface(mesh, layout), {}} : bake_atlas(mesh, layout);
}

/// Reads a file with what its faces look like.
void read_look(const std::filesystem::path& path, const BakeRequest& wanted, Look& look,
               std::vector<std::string>& notes) {
  look.file = read_mesh_file(path, {.attributes = true});
  notes = look.file.notes;
  const std::span<const BakeChannel> channels =
      wanted.channels ? std::span<const BakeChannel>(wanted.channels->look) : kBakeChannels;
  const bool normals = wanted.channels && std::ranges::any_of(wanted.channels->geometry, is_direction);
  look.pictures = decode_textures(look.file.textures, look.get(), channels, notes, normals);
}

void check_look(const BakeRequest& wanted, const Look& look) {
  if (needs_look(wanted) && look.file.materials.empty() &&
      std::ranges::count(look.file.attributes, "color", &MeshAttribute::name) == 0)
    throw Error("high has neither materials nor colours of vertices, so there is nothing to bake");
  if (has(wanted, GeometryChannel::material) && look.file.materials.empty())
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

std::vector<BakedChannel> baked_look(const Baking& of, const BakeRequest& wanted) {
  const MeshLook look = of.look.get();
  const auto channels = wanted.channels ? wanted.channels->look : default_channels(of.sites.mesh(), look);
  const bool single = of.grid.side == 1;
  std::vector<BakedChannel> baked = bake(of.surface, of.sites, of.matches, look, channels,
                                         {.fill = single, .progress = of.geometry.progress});
  if (single) return baked;
  for (BakedChannel& channel : baked) {
    channel.values = mean_of_samples(of.surface, of.grid.side, channel.components, channel.values).values;
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
    values = mean_of_samples(of.surface, of.grid.side, components_of(channel), values,
                             is_direction(channel) ? SampleKind::directions : SampleKind::numbers,
                             channel == GeometryChannel::normal ? of.geometry.drawn_normals : nullptr)
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

std::unique_ptr<PyBaked> bake_look(const Look& look, BakeAtlas laid, const AtlasOptions& atlas,
                                   const BakeRequest& wanted) {
  check_look(wanted, look);
  const Sites sites(look.file.mesh);
  const TexelMatches matches = match_texels(laid.surface, sites, match_options(wanted));
  if (std::ranges::all_of(matches.face, [](std::uint32_t face) { return face == kNone; }))
    throw Error("no point of high is close enough to a texel of low, or faces one: nothing can be baked");
  const SampleGrid grid{laid.surface.resolution(), wanted.side()};
  const auto& attributes = look.file.attributes;
  const auto own = std::ranges::find(attributes, "normal", &MeshAttribute::name);
  std::optional<DrawnFrames> frames;
  if (has(wanted, GeometryChannel::normal)) frames.emplace(laid.surface);
  GeometryOptions options;
  if (own != attributes.end()) options.normals = &*own;
  const MeshLook shown = look.get();
  if (shown.pictures.size() == look.file.textures.size()) options.look = &shown;
  if (frames) {
    options.drawn_normals = &frames->normals;
    options.drawn_tangents = &frames->tangents;
  }
  options.occlusion = occlusion_options(wanted);
  options.method = wanted.thickness_method;
  options.progress = wanted.progress;
  const Baking baking{.surface = laid.surface,
                      .sites = sites,
                      .matches = matches,
                      .look = look,
                      .grid = grid,
                      .gutter = wanted.gutter,
                      .geometry = options};
  std::vector<BakedChannel> channels = baked_look(baking, wanted);
  std::vector<BakedGeometry> geometry;
  if (wanted.channels)
    for (const GeometryChannel channel : wanted.channels->geometry)
      geometry.push_back(baked_geometry(baking, channel));
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
                                   Look& look, const BakeRequest& wanted) {
  std::vector<std::string> notes;
  if (file) read_look(*file, wanted, look, notes);
  BakeAtlas laid = laid_out(on, wanted);
  AtlasOptions layout = sample_layout(wanted);
  layout.kind = wanted.atlas.value_or(laid.fault.empty() ? AtlasKind::uv : AtlasKind::charts);
  layout.progress = {};
  if (!laid.fault.empty()) notes.push_back("low: " + laid.fault + ", so it got an atlas of charts");
  std::unique_ptr<PyBaked> result = bake_look(look, std::move(laid), layout, wanted);
  result->notes = std::move(notes);
  return result;
}

/// `file`: of O2, or None for `mesh`, which looks as `appearance` has it.
nb::object baked_from(nb::handle file, nb::handle mesh, const nb::dict& appearance, nb::handle low,
                      const nb::dict& given, nb::handle progress) {
  BakeRequest wanted = request_of(given);
  (void)match_options(wanted);  // throws before files are read
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
    wanted.progress = report;
    result = bake_onto(on, path, look, wanted);
  });
  return nb::cast(result.release(), nb::rv_policy::take_ownership);
}

}  // namespace

void bind_baking(nb::module_& module) {
  bind_baked(module);
  module.def("bake", &baked_from, nb::arg("file").none(), nb::arg("mesh").none(), nb::arg("appearance"),
             nb::arg("low").none(), nb::arg("options"), nb::arg("progress").none(),
             nb::sig("def bake(file: object, mesh: object, appearance: dict[str, object], low: object, "
                     "options: dict[str, object], progress: object) -> Baked"));
}

}  // namespace sdm::python
