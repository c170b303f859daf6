// The data of report.html.
#pragma once

#include <sdm/map_files.h>

#include <nlohmann/json.hpp>
#include <span>

#include "io/page/report/packed_arrays.h"

namespace sdm::io {

/// What put_page() writes, before the arrays are compressed.
struct HtmlPage {
  nlohmann::ordered_json page;
  PackedArrays arrays;
};

/// Returns the data of the page that write_html() writes. Throws sdm::Error as it does, but the message names
/// no file.
[[nodiscard]] HtmlPage html_page(const Surface& surface, const DistanceMap& map,
                                 std::span<const float> vertex_distances, const HtmlOptions& options);

}  // namespace sdm::io
