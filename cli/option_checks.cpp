#include "option_checks.h"

#include <sdm/error.h>

#include <cmath>

#include "format.h"
#include "scenes/placement.h"

std::string check_transform(const std::string& text) try {
  (void)sdm::scenes::parse_placement(text);
  return {};
} catch (const sdm::Error& error) {
  return error.what();
}

CLI::Validator number(const std::string& description, bool (*accepts)(double)) {
  return CLI::Validator(
      [=](const std::string& text) {
        double value = 0;
        const bool good = CLI::detail::lexical_cast(text, value) && std::isfinite(value) && accepts(value);
        return good ? std::string() : text + " is not " + description;
      },
      "");
}

CLI::Validator whole_number(int lowest, int highest) {
  return CLI::Validator(
      [=](const std::string& text) {
        int value = 0;
        const bool good = CLI::detail::lexical_cast(text, value) && lowest <= value && value <= highest;
        return good ? std::string()
                    : fmt::format("{} is not a whole number from {} to {}", text, lowest, highest);
      },
      "");
}

std::optional<std::pair<std::uint32_t, std::uint32_t>> parse_size(const std::string& text) {
  const auto parse = [](const std::string& part, std::uint32_t& side) {
    return !part.empty() && part.find_first_not_of("0123456789") == std::string::npos &&
           CLI::detail::lexical_cast(part, side) && side >= 16 && side <= 32768;
  };
  std::pair<std::uint32_t, std::uint32_t> size{0, 0};
  const std::size_t by = text.find('x');
  const bool good = by == std::string::npos
                        ? parse(text, size.first)
                        : parse(text.substr(0, by), size.first) && parse(text.substr(by + 1), size.second);
  return good ? std::optional(size) : std::nullopt;
}

std::optional<sdm::Tolerance> parse_tolerance(const std::string& text) {
  const auto parse = [](const std::string& part, double& value) {
    return CLI::detail::lexical_cast(part, value) && std::isfinite(value);
  };
  double lo = 0, hi = 0;
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos)
    return parse(text, hi) && hi >= 0 ? std::optional<sdm::Tolerance>(hi) : std::nullopt;
  if (!parse(text.substr(0, colon), lo) || !parse(text.substr(colon + 1), hi) || lo > hi) return std::nullopt;
  return sdm::Tolerance(lo, hi);
}
