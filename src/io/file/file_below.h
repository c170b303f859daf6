// The files that a model may refer to.
#pragma once

#include <filesystem>
#include <string_view>

#include "io/file/file_bytes.h"

namespace sdm::io {

/// Returns the file of a path relative to the folder of a model, with its links resolved. Models come from
/// strangers, and what they refer to ends up in results: so only files in `folder`, or in a folder in it, can
/// be referred to. Throws sdm::Error, naming `what` it is, for an absolute path, a scheme, "..", a backslash
/// or a NUL, and for a file that is elsewhere once links are resolved.
[[nodiscard]] std::filesystem::path file_below(const std::filesystem::path& folder, std::string_view path,
                                               std::string_view what);

/// Whether there is such a file. Throws as file_below() does.
[[nodiscard]] bool exists_below(const std::filesystem::path& folder, std::string_view path,
                                std::string_view what);

/// Returns the bytes of such a file. Also throws sdm::Error, naming `what` it is and the path, if it cannot
/// be read.
[[nodiscard]] FileBytes read_below(const std::filesystem::path& folder, std::string_view path,
                                   std::string_view what);

}  // namespace sdm::io
