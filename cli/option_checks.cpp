#include "option_checks.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <cmath>
#include <string_view>

#include "src/core/parse_number.h"
#include "src/io/mesh/placement.h"

std::optional<std::int64_t> parse_whole_number(std::string_view text) {
  return sdm::core::parse_number<std::int64_t>(text);
}

std::optional<double> parse_number(std::string_view text) {
  const std::optional<double> value = sdm::core::parse_number(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<std::vector<double>> parse_row(std::string_view text) {
  constexpr std::string_view kSeparators = " \t\r,;";
  std::vector<double> numbers;
  for (std::size_t at; (at = text.find_first_not_of(kSeparators)) != std::string_view::npos;) {
    text.remove_prefix(at);
    const std::string_view word = text.substr(0, text.find_first_of(kSeparators));
    text.remove_prefix(word.size());
    const std::optional<double> value = parse_number(word);
    if (!value) return std::nullopt;
    numbers.push_back(*value);
  }
  return numbers;
}

std::string check_transform(const std::string& text) try {
  (void)sdm::io::parse_placement(text);
  return {};
} catch (const sdm::Error& error) {
  return error.what();
}

CLI::Validator number(const std::string& description, bool (*accepts)(double)) {
  return CLI::Validator(
      [=](const std::string& text) {
        const std::optional<double> value = parse_number(text);
        return value && accepts(*value) ? std::string() : text + " is not " + description;
      },
      "");
}

CLI::Validator positive_number() {
  return number("a positive number", [](double x) { return x > 0; });
}
CLI::Validator no_negative_number() {
  return number("a number, 0 or more", [](double x) { return x >= 0; });
}
CLI::Validator non_empty() {
  return CLI::Validator(
      [](const std::string& text) { return text.empty() ? std::string("the name is empty") : std::string(); },
      "");
}

CLI::Validator any_number() {
  return number("a number", [](double) { return true; });
}

CLI::Validator whole_number(std::int64_t lowest, std::int64_t highest) {
  return CLI::Validator(
      [=](std::string& text) {
        const std::optional<std::int64_t> value = parse_whole_number(text);
        if (!value || *value < lowest || highest < *value)
          return fmt::format("{} is not a whole number from {} to {}", text, lowest, highest);
        text = std::to_string(*value);
        return std::string();
      },
      "");
}
