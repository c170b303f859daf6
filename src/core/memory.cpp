#include "core/memory.h"

#include <sstream>
#include <string>

#include "core/platform.h"

namespace sdm::core {

void require_memory(std::size_t bytes, std::string_view purpose) {
  const std::size_t available = available_memory();
  if (bytes <= available) return;
  std::ostringstream message;
  message.precision(3);
  message << purpose << " needs " << static_cast<double>(bytes) / 1e9 << " GB of memory and "
          << static_cast<double>(available) / 1e9 << " GB are available";
  throw Error(message.str());
}

Error out_of_memory(std::string_view purpose) {
  return Error(std::string(purpose) + ": not enough memory");
}

}  // namespace sdm::core
