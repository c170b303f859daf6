// Paths by which a model refers to other files.
#pragma once

#include <string_view>

namespace sdm::io {

/// Throws sdm::Error, naming `what` it is, unless the text is a path into the folder of the model: for an
/// absolute path, a scheme, "..", a backslash or a NUL.
void check_path_below(std::string_view path, std::string_view what);

/// Throws the sdm::Error that says why the path is refused.
[[noreturn]] void refuse_path(std::string_view what, std::string_view path, std::string_view fault);

}  // namespace sdm::io
