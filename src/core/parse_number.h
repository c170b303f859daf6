// Numbers in text.
#pragma once

#include <charconv>
#include <optional>
#include <string_view>

namespace sdm::core {

/// Reads all of a text as a number in base 10, with at most one sign; nothing if it is none.
template <class Number = double>
[[nodiscard]] std::optional<Number> parse_number(std::string_view text) {
  if (text.starts_with('+')) {
    text.remove_prefix(1);
    if (text.starts_with('-')) return std::nullopt;
  }
  Number value{};
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  return fault == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

}  // namespace sdm::core
