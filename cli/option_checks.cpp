#include "option_checks.h"

#include <sdm/error.h>
#include <sdm/transform.h>

#include <cmath>

std::string check_transform(const std::string& text) try {
  (void)sdm::parse_transform(text);
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
                    : text + " is not a whole number from " + std::to_string(lowest) + " to " +
                          std::to_string(highest);
      },
      "");
}
