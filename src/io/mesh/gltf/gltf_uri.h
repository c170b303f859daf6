// The files that a glTF file may refer to.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace sdm::io {

/// Returns the file of a relative URI, with its links resolved. Models come from strangers, and what a buffer
/// holds ends up in results: so only files in `folder`, or in a folder in it, can be referred to. Throws
/// sdm::Error for an absolute path, a scheme, "..", a backslash or a NUL, all after decoding, and for a file
/// that is elsewhere once links are resolved.
[[nodiscard]] std::filesystem::path file_of_uri(std::string_view uri, const std::filesystem::path& folder);

/// Decodes escape sequences such as %20, once: what they stand for is not decoded again.
[[nodiscard]] std::string decode_uri(std::string_view uri);

/// Returns whether the URI contains its data.
[[nodiscard]] bool is_data_uri(std::string_view uri);

}  // namespace sdm::io
