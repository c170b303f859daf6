// OpenCASCADE, which damaged files may crash, in a process of its own.
#pragma once

#include "io/mesh/cad/cad_module.h"

namespace sdm::io::cad {

/// Reads a file by the module, which is loaded by a child process, and measures with `client` in this one.
/// Polls for cancellation, which kills the child. Throws sdm::Error with a clause if the file cannot be read,
/// also if the child dies of it; where it does before there are triangles, reads once more without labels.
/// `format`, for messages. By any threads at a time.
[[nodiscard]] CadShape read_in_child(const CadRequest& request, const char* format, CadClient& client);

}  // namespace sdm::io::cad
