#include "io/page/player/player_page.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "geometry/vec.h"
#include "io/file/atomic_file.h"
#include "io/image/pictures/color_scale.h"
#include "io/page/report/embedded_page.h"
#include "io/page/report/packed_arrays.h"
#include "io/page/report/page_file.h"

namespace sdm::io {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kSteps = 65535;              // along the longest side of the box of all frames
constexpr std::uint32_t kNoDistance = 65535;  // others are from 0 to 65534

const char* mode_of(const ColorScale& scale) {
  if (scale.tolerance) return "tolerance";
  return name_of(scale.map);
}

Json scale_json(const ColorScale& scale) {
  return {{"mode", mode_of(scale)},
          {"lo", scale.lower},
          {"hi", scale.upper},
          {"lower", scale.tolerance ? scale.tolerance->lower : 0},
          {"upper", scale.tolerance ? scale.tolerance->upper : 0},
          {"accuracy", scale.accuracy}};
}

bool moves(std::span<const PlayerFrame> frames, int body) {
  return std::ranges::any_of(
      frames, [&](const PlayerFrame& f) { return f.positions[body] != frames[0].positions[body]; });
}

/// Adds the arrays `triangle0` or `triangle1` (corners, as differences), `position…` (three a vertex, frame
/// after frame, in steps, as differences from the frame before; of a body at rest one frame) and
/// `distance…`.
Json add_body(PackedArrays& arrays, const PlayerContent& content, int body, const Vec3& origin, double step,
              double reach) {
  const std::string which = std::to_string(body);
  const std::size_t vertices = content.frames[0].positions[body].size();
  const bool moving = moves(content.frames, body);
  std::vector<std::uint32_t> corners, positions, distances;
  for (const Triangle& t : content.triangles[body]) corners.insert(corners.end(), t.begin(), t.end());
  for (const PlayerFrame& frame : content.frames.first(moving ? content.frames.size() : 1))
    for (const Vec3f& p : frame.positions[body])
      for (int k = 0; k < 3; ++k)
        positions.push_back(
            static_cast<std::uint32_t>(std::clamp((p[k] - origin[k]) / step + 0.5, 0.0, kSteps)));
  for (const PlayerFrame& frame : content.frames)
    for (const float d : frame.distances[body])
      distances.push_back(std::isfinite(d)
                              ? static_cast<std::uint32_t>(std::clamp(
                                    (d / reach + 1) * 0.5 * (kNoDistance - 1) + 0.5, 0.0, kNoDistance - 1.0))
                              : kNoDistance);
  arrays.add_differences("triangle" + which, corners);
  arrays.add_differences("position" + which, positions, 3 * vertices);
  const bool coloured = !distances.empty();
  if (coloured) arrays.add_differences("distance" + which, distances, vertices);
  return {{"vertices", vertices}, {"moves", moving}, {"coloured", coloured}};
}

Json panels_json(std::span<const PlotPanel> panels) {
  Json json = Json::array();
  for (const PlotPanel& panel : panels) {
    Json curves = Json::array();
    for (const Curve& curve : panel.curves)
      curves.push_back({{"name", curve.name}, {"values", curve.values}});  // NaN becomes null
    json.push_back({{"title", panel.title}, {"curves", curves}});
  }
  return json;
}

}  // namespace

void write_player_page(const std::filesystem::path& file, const PlayerContent& content,
                       const PlayerOptions& options, const PictureOptions& fixed) {
  AtomicFile out(file);
  Box box;
  double reach = 0;
  for (const PlayerFrame& frame : content.frames)
    for (int b = 0; b < 2; ++b) {
      for (const Vec3f& p : frame.positions[b]) extend(box, Vec3{p[0], p[1], p[2]});
      for (const float d : frame.distances[b])
        if (std::isfinite(d)) reach = std::max<double>(reach, std::abs(d));
    }
  double longest = 0;
  for (int k = 0; k < 3; ++k) longest = std::max(longest, box.upper[k] - box.lower[k]);
  const double step = longest > 0 ? longest / kSteps : 1;
  if (!(reach > 0)) reach = 1;

  PackedArrays arrays;
  Json page = common_json(options.up);
  page["units"] = options.units;
  page["names"] = options.names;
  page["xxh3"] = options.xxh3;
  page["origin"] = box.lower;
  page["step"] = step;
  page["reach"] = reach;
  page["added"] = content.added;
  page["stride"] = content.stride;
  Json shown = Json::array();
  for (const PlayerFrame& frame : content.frames) shown.push_back(frame.number);
  page["shown"] = shown;
  page["bodies"] = Json::array();
  for (int b = 0; b < 2; ++b) page["bodies"].push_back(add_body(arrays, content, b, box.lower, step, reach));
  page["panels"] = panels_json(content.panels);
  page["scale"] = scale_json(color_scale(fixed));
  if (options.verdicts) {
    page["verdict"] = name_of(options.verdicts->of_all);
    page["certified"] = options.verdicts->certified;
    if (!options.verdicts->doubt.empty()) page["doubt"] = options.verdicts->doubt;
    page["tolerance"] = {{"lower", options.verdicts->tolerance.lower},
                         {"upper", options.verdicts->tolerance.upper}};
    page["verdicts"] = Json::array();
    for (const Verdict verdict : options.verdicts->of_frames) page["verdicts"].push_back(name_of(verdict));
  }
  compress(arrays);
  put_page(out.stream(), kPlayerHtml.bytes, page, nullptr, arrays);
  out.commit();
}

}  // namespace sdm::io
