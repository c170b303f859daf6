// A page with its data in it.
#pragma once

#include <sdm/map_files.h>

#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <string_view>

#include "io/page/report/area_by_value.h"
#include "io/page/report/packed_arrays.h"

namespace sdm::io {

/// Adds the arrays `area_key`, `area_of_key` and `area_of_bin`. Returns their range.
[[nodiscard]] nlohmann::ordered_json add_area(PackedArrays& arrays, const AreaByValue& area);

/// What all pages have: version, axis and colours.
[[nodiscard]] nlohmann::ordered_json common_json(UpAxis up);

/// Adds the index of the arrays, which are compressed, to `page`, and writes `html` with these and, unless
/// null, the JSON text of a report in the place that it has for data.
void put_page(std::ostream& out, std::string_view html, nlohmann::ordered_json& page,
              const std::string* report, const PackedArrays& arrays);

}  // namespace sdm::io
