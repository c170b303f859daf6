/// Units of length by their names.
///
/// Threads: the functions may be called concurrently.
#pragma once

#include <sdm/api.h>

#include <optional>
#include <string_view>

namespace sdm {

/// The length in metres of "m", "cm", "mm", "um" or "µm", "in" or "ft"; nothing for any other name.
[[nodiscard]] SDM_API std::optional<double> metres_per(std::string_view unit);

}  // namespace sdm
