// The verdict on several maps as of one.
#pragma once

#include <sdm/verdict.h>

#include <span>

namespace sdm::summary {

/// That of one of the maps, which have these areas, with the shares and the margin of all. There is one.
[[nodiscard]] CertifiedVerdict combined_verdict(std::span<const CertifiedVerdict> verdicts,
                                                std::span<const double> areas);

}  // namespace sdm::summary
