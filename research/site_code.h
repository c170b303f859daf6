// A site as one number.
#pragma once

#include <sdm/types.h>

#include <cstdint>
#include <utility>

namespace sdm::research {

/// Not kNone. Indices of sites are below 2³⁰, for lack of memory.
[[nodiscard]] inline std::uint32_t site_code(SiteType type, std::uint32_t site) {
  return static_cast<std::uint32_t>(type) << 30 | site;
}
[[nodiscard]] inline std::pair<SiteType, std::uint32_t> site_of(std::uint32_t code) {
  return {static_cast<SiteType>(code >> 30), code & ~(3u << 30)};
}

}  // namespace sdm::research
