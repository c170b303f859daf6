#include "bake_channels.h"

#include <fmt/format.h>
#include <sdm/bake.h>
#include <sdm/bake_files.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string_view>
#include <utility>

#include "output_folder.h"

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using sdm::GeometryChannel;

/// How the values of a channel are stored.
struct Storage {
  bool png, exr;
  const char* values;  ///< of the report
};

Storage storage_of(GeometryChannel channel) {
  switch (channel) {
    case GeometryChannel::normal:
      return {true, false, "tangent space"};
    case GeometryChannel::object_normal:
      return {true, false, "object space"};
    case GeometryChannel::displacement:
    case GeometryChannel::thickness:
      return {true, true, "units"};
    case GeometryChannel::position:
      return {false, true, "units"};
    case GeometryChannel::ambient_occlusion:
      return {true, false, "linear"};
    case GeometryChannel::face:
    case GeometryChannel::material:
      break;
  }
  return {false, true, "numbers"};
}

std::string file_of(std::string_view channel, const char* extension) {
  return fmt::format("{}.{}", channel, extension);
}

/// The planes of an EXR file, after the name of the channel.
std::span<const char* const> planes_of(GeometryChannel channel) {
  static constexpr std::array<const char*, 3> kVector{"X", "Y", "Z"};
  static constexpr std::array<const char*, 1> kLength{"D"}, kNumber{"id"};
  if (sdm::is_number(channel)) return kNumber;
  if (sdm::components_of(channel) == 3) return kVector;
  return kLength;
}

/// The least side of a square of texels that divides both numbers and makes the larger one at most `most`;
/// else 1.
std::uint32_t side_of_page(std::uint32_t columns, std::uint32_t rows, std::uint32_t most) {
  const std::uint32_t larger = std::max(columns, rows);
  for (std::uint32_t side = (larger + most - 1) / most; side <= larger / 16; ++side)
    if (side > 0 && columns % side == 0 && rows % side == 0) return side;
  return 1;
}

class ChannelBaker {
 public:
  ChannelBaker(const BakePair& pair, fs::path folder, Notes& notes)
      : pair_(pair),
        folder_(std::move(folder)),
        notes_(notes),
        grid_{pair.surface.resolution(), pair.command.request.side()},
        texels_(grid_.texels()) {}

  void bake(std::span<const sdm::BakeChannel> channels);
  void bake(GeometryChannel channel);

  BakedChannels result;

 private:
  /// Values of texels, all of which have some.
  struct Filled {
    std::vector<float> values, coverage;
  };
  /// The texels that samples make; samples that are not finite count as missing.
  [[nodiscard]] Filled filled(std::size_t components, std::vector<float> samples,
                              sdm::SampleKind kind = sdm::SampleKind::numbers,
                              const sdm::MeshAttribute* normals = nullptr) const;

  [[nodiscard]] std::vector<float> samples_of(GeometryChannel channel);
  void make_frames();
  void write_file(const std::string& name, const std::vector<char>& bytes);
  void add_normals(GeometryChannel channel, const std::vector<float>& normals);
  void add_occlusion(const std::vector<float>& values);
  void add_lengths(GeometryChannel channel, const Filled& filled);
  void add_numbers(GeometryChannel channel);
  void write_planes(GeometryChannel channel, const Filled& filled);

  template <class Encode>
  std::vector<char> page_png(std::size_t components, const std::vector<float>& values, sdm::SampleKind kind,
                             const std::vector<char>& png, const Encode& encode) const;

  const BakePair& pair_;
  fs::path folder_;
  Notes& notes_;
  sdm::SampleGrid grid_;
  std::uint32_t texels_;  ///< per row
};

ChannelBaker::Filled ChannelBaker::filled(std::size_t components, std::vector<float> samples,
                                          sdm::SampleKind kind, const sdm::MeshAttribute* normals) const {
  sdm::TexelMeans means =
      grid_.side == 1 ? sdm::mean_of_samples(grid_, components, samples, kind)
                      : sdm::mean_of_samples(pair_.surface, grid_.side, components, samples, kind, normals);
  samples = {};
  sdm::fill_texels(texels_, components, means.values, pair_.command.request.gutter);
  return {std::move(means.values), std::move(means.coverage)};
}

void ChannelBaker::write_file(const std::string& name, const std::vector<char>& bytes) {
  write_text(folder_ / name, {bytes.data(), bytes.size()});
  result.files.push_back(name);
}

/// The picture, or, if the page cannot show it, one of squares of texels.
template <class Encode>
std::vector<char> ChannelBaker::page_png(std::size_t components, const std::vector<float>& values,
                                         sdm::SampleKind kind, const std::vector<char>& png,
                                         const Encode& encode) const {
  if (!pair_.command.page) return {};
  const auto rows = static_cast<std::uint32_t>(values.size() / components / texels_);
  constexpr std::uint32_t kLargest = 2048;
  const std::uint32_t side = side_of_page(texels_, rows, kLargest);
  if (side == 1) return png;
  return encode(texels_ / side, sdm::mean_of_samples({texels_, side}, components, values, kind).values);
}

void ChannelBaker::bake(std::span<const sdm::BakeChannel> channels) {
  for (sdm::BakedChannel& baked :
       sdm::bake(pair_.surface, pair_.sites, pair_.matches, pair_.look, channels,
                 {.fill = grid_.side == 1, .progress = pair_.command.request.progress})) {
    if (grid_.side > 1) baked.values = filled(baked.components, std::move(baked.values)).values;
    const sdm::BakeChannel channel = baked.channel;
    const std::string name(sdm::name_of(channel));
    const auto encode = [&](std::uint32_t resolution, std::vector<float> values) {
      const sdm::BakedChannel of_size{channel, resolution, baked.components, std::move(values)};
      return sdm::encode_png(sdm::to_image(of_size), sdm::is_color(channel));
    };
    baked.resolution = texels_;
    std::vector<char> png = sdm::encode_png(sdm::to_image(baked), sdm::is_color(channel));
    write_file(file_of(name, "png"), png);
    result.names.push_back(name);
    result.report[name] = {{"file", file_of(name, "png")},
                           {"values", sdm::is_color(channel) ? "sRGB" : "linear"}};
    result.page_textures.push_back(
        {channel, page_png(baked.components, baked.values, sdm::SampleKind::numbers, png, encode)});
    result.textures.push_back({channel, std::move(png)});
    baked.values = {};
  }
}

/// The normals and tangents that the model is drawn with.
void ChannelBaker::make_frames() {
  NormalMap& map = result.normal_map;
  map.normals = sdm::smooth_normals(pair_.surface.mesh(), sdm::kDrawnCrease);
  map.tangents = sdm::tangents(pair_.surface, map.normals);
}

std::vector<float> ChannelBaker::samples_of(GeometryChannel channel) {
  const BakeCommand& command = pair_.command;
  if (channel == GeometryChannel::normal) make_frames();
  const auto& attributes = pair_.high.look.attributes;
  const auto own = std::ranges::find(attributes, "normal", &sdm::MeshAttribute::name);
  const bool has_own = own != attributes.end(), moved = !command.transform_high.empty();
  if (sdm::is_direction(channel) && has_own && moved) {
    const std::string note = fmt::format(
        "{}: its normals are not moved by --transform-high; smooth ones are baked", pair_.high.file);
    if (std::ranges::count(notes_, note) == 0) notes_.push_back(note);
  }
  try {
    return sdm::bake_geometry(pair_.surface, pair_.sites, pair_.matches, channel,
                              {.normals = pair_.normals,
                               .look = &pair_.look,
                               .drawn_normals = &result.normal_map.normals,
                               .drawn_tangents = &result.normal_map.tangents,
                               .occlusion = sdm::occlusion_options(command.request),
                               .method = command.request.thickness_method,
                               .progress = command.request.progress});
  } catch (const sdm::Cancelled&) {
    throw;
  } catch (const sdm::Error& error) {
    if (channel != GeometryChannel::thickness) throw;
    throw sdm::Error(fmt::format("{}: {}", pair_.high.file, error.what()), error.remedy());
  }
}

void ChannelBaker::bake(GeometryChannel channel) {
  const std::string name(sdm::name_of(channel));
  result.names.push_back(name);
  const Storage storage = storage_of(channel);
  result.report[name] = {{"file", file_of(name, storage.exr ? "exr" : "png")}, {"values", storage.values}};
  if (sdm::is_number(channel)) return add_numbers(channel);
  const bool directions = sdm::is_direction(channel);
  const Filled values = filled(sdm::components_of(channel), samples_of(channel),
                               directions ? sdm::SampleKind::directions : sdm::SampleKind::numbers,
                               channel == GeometryChannel::normal ? &result.normal_map.normals : nullptr);
  if (directions) return add_normals(channel, values.values);
  if (channel == GeometryChannel::ambient_occlusion) return add_occlusion(values.values);
  if (channel == GeometryChannel::position) return write_planes(channel, values);
  add_lengths(channel, values);
}

void ChannelBaker::add_normals(GeometryChannel channel, const std::vector<float>& normals) {
  const bool in_model = channel == GeometryChannel::normal;
  const auto encode = [&](std::uint32_t resolution, const std::vector<float>& values) {
    return sdm::encode_png(sdm::normal_map_image(resolution, values, in_model ? 8 : 16), false);
  };
  std::vector<char> png = encode(texels_, normals);
  write_file(file_of(sdm::name_of(channel), "png"), png);
  if (!in_model) return;
  result.page_normal_map = page_png(3, normals, sdm::SampleKind::directions, png, encode);
  result.normal_map.png = std::move(png);
}

/// Makes this the occlusion of the model, unless a texture of HIGH is.
void ChannelBaker::add_occlusion(const std::vector<float>& values) {
  const auto encode = [&](std::uint32_t resolution, const std::vector<float>& of_size) {
    return sdm::encode_png(sdm::scalar_image(resolution, of_size, {0, 1}, 8).image, false);
  };
  std::vector<char> png = encode(texels_, values);
  write_file(file_of(sdm::name_of(GeometryChannel::ambient_occlusion), "png"), png);
  const bool has_other =
      std::ranges::count(result.textures, sdm::BakeChannel::occlusion, &sdm::BakedTexture::channel) > 0;
  result.report[std::string(sdm::name_of(GeometryChannel::ambient_occlusion))]["in_model"] = !has_other;
  if (has_other) return;
  result.page_textures.push_back(
      {sdm::BakeChannel::occlusion, page_png(1, values, sdm::SampleKind::numbers, png, encode)});
  result.textures.push_back({sdm::BakeChannel::occlusion, std::move(png)});
}

/// As EXR, and as PNG: displacements with 0 in the middle, thicknesses from 0.
void ChannelBaker::add_lengths(GeometryChannel channel, const Filled& filled) {
  write_planes(channel, filled);
  float most = 0;
  for (const float value : filled.values)
    if (std::isfinite(value)) most = std::max(most, std::abs(value));
  const double upper = most > 0 ? most : 1, lower = channel == GeometryChannel::displacement ? -upper : 0;
  const std::string name(sdm::name_of(channel)), file = file_of(name, "png");
  write_file(file, sdm::encode_png(sdm::scalar_image(texels_, filled.values, {lower, upper}).image, false));
  result.report[name]["picture"] = {{"file", file}, {"bits", 16}, {"lower", lower}, {"upper", upper}};
}

void ChannelBaker::write_planes(GeometryChannel channel, const Filled& filled) {
  const std::string name(sdm::name_of(channel)), file = file_of(name, "exr");
  std::vector<sdm::TexelPlane> planes{{.name = "coverage.A", .values = filled.coverage}};
  const auto names = planes_of(channel);
  for (std::size_t k = 0; k < names.size(); ++k)
    planes.push_back({.name = fmt::format("{}.{}", name, names[k]),
                      .values = filled.values,
                      .components = names.size(),
                      .component = k});
  sdm::write_exr(folder_ / file, texels_, planes, {{"units", pair_.command.units}});
  result.files.push_back(file);
}

/// Whole numbers, which texels of no face do not have.
void ChannelBaker::add_numbers(GeometryChannel channel) {
  if (channel == GeometryChannel::material && pair_.look.materials.empty())
    throw sdm::Error(
        fmt::format("{} has no materials, so the channel `material` cannot be baked", pair_.high.file));
  const std::string name(sdm::name_of(channel)), file = file_of(name, "exr");
  std::vector<std::uint32_t> numbers =
      channel == GeometryChannel::face
          ? pair_.matches.face
          : sdm::matched_materials(pair_.surface, pair_.sites, pair_.matches, pair_.look.face_materials);
  if (grid_.side > 1) numbers = sdm::most_frequent_samples(grid_, numbers);
  const std::vector<sdm::TexelPlane> planes{{.name = name + ".id", .numbers = numbers}};
  sdm::write_exr(folder_ / file, texels_, planes);
  result.files.push_back(file);
  if (channel != GeometryChannel::material) return;
  Json& names = result.report[name]["names"] = Json::array();
  for (const sdm::Material& material : pair_.look.materials) names.push_back(material.name);
}

}  // namespace

BakedChannels bake_channels(const BakePair& pair, const fs::path& folder, Notes& notes) {
  ChannelBaker baker(pair, folder, notes);
  const auto& selected = pair.command.request.channels;
  baker.bake(selected ? selected->look : sdm::default_channels(pair.sites.mesh(), pair.look));
  if (selected)
    for (const GeometryChannel channel : selected->geometry) baker.bake(channel);
  return std::move(baker.result);
}
