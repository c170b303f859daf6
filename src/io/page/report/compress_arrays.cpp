#include "io/page/report/compress_arrays.h"

#include "core/parallel.h"
#include "io/file/deflate.h"

namespace sdm::io {

void compress(PackedArrays& arrays) {
  std::vector<std::vector<std::uint8_t>> planes = arrays.planes();
  parallel_for(planes.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (!planes[i].empty()) planes[i] = deflate_part(planes[i], true);
  });
  arrays.set_compressed(planes);
}

}  // namespace sdm::io
