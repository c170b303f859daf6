// Limits in words.
#pragma once

#include <sdm/tolerance.h>

#include <string>

#include "core/rules.h"

namespace sdm::summary {

/// The limits, with numbers as `text` has them. Without a sign, ±t is t.
template <class Text>
std::string limits_words(const Tolerance& tolerance, bool is_signed, Text text) {
  const auto [lo, hi] = tolerance;
  const double form = rules::limits_form(lo, hi, is_signed);
  const std::string words = rules::kLimitWords[static_cast<std::size_t>(form)];
  if (form == rules::kBetween) return text(lo) + " to " + text(hi);
  return words + text(form == rules::kAtLeast ? lo : hi);
}

}  // namespace sdm::summary
