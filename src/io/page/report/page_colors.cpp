#include "io/page/report/page_colors.h"

#include <span>

#include "io/image/pictures/color_scale.h"

namespace sdm::io {

using Json = nlohmann::ordered_json;

Json colors_json() {
  const auto list = [](std::span<const Rgb> colors) {
    Json json = Json::array();
    for (const Rgb& c : colors) json.push_back({c.r, c.g, c.b});
    return json;
  };
  return {{"viridis", list(colors_of(Colormap::viridis))},
          {"diverging", list(colors_of(Colormap::diverging))},
          {"paper2006", list(colors_of(Colormap::paper2006))},
          {"opposite", list(kOpposite)},
          {"within", list(kWithin)},
          {"above", list(kAbove)},
          {"below", list(kBelow)},
          {"no_value", list({&kNoValue, 1})},
          {"unjudged", list({&kUnjudged, 1})}};
}

std::string as_script(const std::string& json) {
  std::string text;
  text.reserve(json.size());
  for (const char c : json)
    if (c == '<')
      text += "\\u003c";
    else
      text += c;
  return text;
}

}  // namespace sdm::io
