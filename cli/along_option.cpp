#include "along_option.h"

#include <fmt/format.h>
#include <sdm/vec.h>

#include <cmath>
#include <string>

#include "option_checks.h"

namespace {

constexpr const char* kNormal = "normal";

/// The direction X,Y,Z, whose length does not overflow, and which is not 0; or nothing.
std::optional<sdm::Vec3> parse_direction(const std::string& text) {
  const auto numbers = parse_list(text, 3);
  if (!numbers) return std::nullopt;
  const sdm::Vec3 direction{(*numbers)[0], (*numbers)[1], (*numbers)[2]};
  return direction != sdm::Vec3{} && std::isfinite(sdm::norm(direction)) ? std::optional(direction)
                                                                         : std::nullopt;
}

}  // namespace

void add_along_option(CLI::App& app, std::optional<sdm::AlongOptions>& along, const std::string& sample,
                      const std::string& remark) {
  app.add_option_function<std::string>(
         "--along",
         [&along](const std::string& text) {
           along.emplace();
           if (text != kNormal) along->direction = parse_direction(text);
         },
         fmt::format("Measure along a line, the normal of each {} or the direction X,Y,Z, to both sides: to "
                     "the nearest face of O2 that faces the same way. Along 0,0,1: the change of height of "
                     "terrain. Positive on the side to which the normal of that face points. {}",
                     sample, remark))
      ->check([](const std::string& text) {
        return text == kNormal || parse_direction(text)
                   ? std::string()
                   : text + " is neither normal nor a direction X,Y,Z other than 0,0,0";
      })
      ->type_name("normal|X,Y,Z");
}

void check_along(const CLI::App& app, const std::optional<sdm::AlongOptions>& along) {
  if (!along) return;
  for (const char* option : {"--sign", "--engine", "--facing"})
    if (const CLI::Option* given = app.get_option_no_throw(option); given != nullptr && given->count() > 0)
      throw CLI::ValidationError(option, "does not apply to --along");
}
