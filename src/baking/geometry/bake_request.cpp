#include <sdm/bake.h>
#include <sdm/error.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace sdm {
namespace {

using Names = std::vector<std::string>;

Names channel_names() {
  Names names;
  for (const BakeChannel channel : kBakeChannels) names.emplace_back(name_of(channel));
  for (const GeometryChannel channel : kGeometryChannels)
    if (channel != GeometryChannel::normal || has_tangents()) names.emplace_back(name_of(channel));
  return names;
}

/// Adds those of the names, in the order of the library.
template <class Channels, class Channel>
void add_named(const Channels& channels, const Names& names, std::vector<Channel>& to) {
  for (const Channel channel : channels)
    if (std::ranges::find(names, name_of(channel)) != names.end()) to.push_back(channel);
}

}  // namespace

std::string OptionForm<BakeSelection>::needed() {
  std::string text = "one or more of ";
  for (const std::string& name : channel_names()) text.append(text.ends_with(' ') ? "" : ", ").append(name);
  return has_tangents() ? text : text + "; normal needs MikkTSpace, which this build does not have";
}

bool OptionForm<BakeSelection>::read(std::string_view text, const OptionRange& range, BakeSelection& value) {
  Names names;
  const Names known = channel_names();
  (void)OptionForm<Names>::read(text, range, names);
  for (const std::string& name : names)
    if (std::ranges::find(known, name) == known.end()) return false;
  value = {};
  add_named(kBakeChannels, names, value.look);
  add_named(kGeometryChannels, names, value.geometry);
  return true;
}

std::string OptionForm<BakeSelection>::text(const BakeSelection& value) {
  Names names;
  for (const BakeChannel channel : value.look) names.emplace_back(name_of(channel));
  for (const GeometryChannel channel : value.geometry) names.emplace_back(name_of(channel));
  return OptionForm<Names>::text(names);
}

std::uint32_t BakeRequest::side() const {
  return sample_side(samples).value_or(1);
}

MatchOptions match_options(const BakeRequest& request) {
  check_options(request);
  const MatchMethod method =
      request.match.value_or(request.facing ? MatchMethod::facing : MatchMethod::closest);
  if (request.facing && method == MatchMethod::closest) throw Error("facing does not apply to match closest");
  if (request.cage && method != MatchMethod::ray) throw Error("cage applies to match ray");
  MatchOptions options{.method = method, .max_distance = request.max_distance, .progress = request.progress};
  if (request.facing) options.facing = *request.facing;
  if (request.cage) options.cage = *request.cage;
  return options;
}

AtlasOptions sample_layout(const BakeRequest& request) {
  check_options(request);
  return sample_layout({.kind = request.atlas.value_or(AtlasKind::charts),
                        .resolution = request.resolution,
                        .rows = request.rows,
                        .gutter = request.gutter,
                        .progress = request.progress},
                       request.side());
}

AmbientOcclusionOptions occlusion_options(const BakeRequest& request) {
  return {.rays = request.occlusion_rays, .max_distance = request.occlusion_distance};
}

}  // namespace sdm
