// Finds the module that reads CAD files.
#pragma once

#include "io/mesh/cad/cad_module.h"

namespace sdm::io::cad {

/// Loads the module, once in a process. It is looked for beside the program or library that this code is part
/// of, in the folder of libraries beside its folder, and where the system looks for libraries. Throws
/// sdm::Error if it is not there, or of another version; `format`, for the message.
[[nodiscard]] ReadCad* load_module(const char* format);

}  // namespace sdm::io::cad
