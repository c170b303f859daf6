#include "facing.h"

#include <fmt/format.h>

#include "option_checks.h"

void add_facing_option(CLI::App& app, std::optional<double>& facing, const std::string& sample,
                       const std::string& other) {
  app.add_option_function<std::string>(
         "--facing",
         [&facing](const std::string& angle) { facing = angle.empty() ? 90 : *parse_number(angle); },
         fmt::format(
             "Measure to the closest of the faces of {} that face the same way: whose normal is within "
             "ANGLE degrees of that of the {}, 90 unless given. For thin walls, where the closest "
             "point may be on the other skin",
             other, sample))
      ->expected(0, 1)
      ->check(number("an angle above 0 and up to 180", [](double x) { return x > 0 && x <= 180; }))
      ->type_name("[ANGLE]");
}

void check_facing(const sdm::MapOptions& options) {
  const bool allowed = options.sign == sdm::SignMethod::automatic || options.sign == sdm::SignMethod::side ||
                       options.sign == sdm::SignMethod::none;
  if (options.facing && !allowed)
    throw CLI::ValidationError(
        "--facing", "gives distances the sign of the side of the faces; use --sign auto, side or none");
}
