// Compresses the arrays of a page.
#pragma once

#include "io/page/report/packed_arrays.h"

namespace sdm::io {

/// Compresses the planes. Cost: linear, all cores.
void compress(PackedArrays& arrays);

}  // namespace sdm::io
