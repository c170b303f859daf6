// The colours of pages.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace sdm::io {

/// The colours of all maps, of the tolerance and of what has no value: lists of [red, green, blue].
[[nodiscard]] nlohmann::ordered_json colors_json();

/// JSON as the content of a <script> element, which ends at "</script" and may not contain "<!--".
[[nodiscard]] std::string as_script(const std::string& json);

}  // namespace sdm::io
