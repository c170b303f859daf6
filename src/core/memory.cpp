#include "core/memory.h"

#include <string>

#include "core/numbers/number_text.h"
#include "core/platform.h"

namespace sdm::core {

void require_memory(std::size_t bytes, std::string_view purpose) {
  const std::size_t available = available_memory();
  if (bytes <= available) return;
  const auto gigabytes = [](std::size_t count) { return number_text(static_cast<double>(count) / 1e9, 3); };
  throw Error(std::string(purpose) + " needs " + gigabytes(bytes) + " GB of memory and " +
              gigabytes(available) + " GB are available");
}

Error out_of_memory(std::string_view purpose) {
  return Error(std::string(purpose) + ": not enough memory");
}

}  // namespace sdm::core
