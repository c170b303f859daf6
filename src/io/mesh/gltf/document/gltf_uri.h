// The URIs of glTF: of files, or with the data.
#pragma once

#include <string>
#include <string_view>

#include "io/file/file_bytes.h"

namespace sdm::io {

/// Decodes escape sequences such as %20, once: what they stand for is not decoded again.
[[nodiscard]] std::string decode_uri(std::string_view uri);

/// Returns whether the URI contains its data.
[[nodiscard]] bool is_data_uri(std::string_view uri);

/// Returns the data of such a URI. Throws sdm::Error unless they are base64.
[[nodiscard]] FileBytes decode_data_uri(std::string_view uri);

}  // namespace sdm::io
