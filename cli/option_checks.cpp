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
