#include <array>

#include "io/fields/formats.h"
#include "io/fields/numbers.h"
#include "io/file/npy.h"

namespace sdm::io {

void write_field_npy(std::ostream& out, const DistanceField& field) {
  const auto& dims = field.grid.dims;
  out << npy_header("<f4", std::array<std::uint64_t, 3>{dims[0], dims[1], dims[2]}, NpyOrder::first_fastest);
  write_numbers<float>(out, field.distance);
}

}  // namespace sdm::io
