// Validators and choices for options of several commands.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Checks steps for sdm::io::parse_placement; returns an error message, or an empty string.
[[nodiscard]] std::string check_transform(const std::string& text);

/// Reads all of a text as a finite number in base 10, with at most one sign; nothing if it is none.
[[nodiscard]] std::optional<double> parse_number(std::string_view text);
/// The same for a whole number.
[[nodiscard]] std::optional<std::int64_t> parse_whole_number(std::string_view text);
/// Reads a row of a file of numbers, with blanks, commas or semicolons between them; nothing if something
/// else is in it.
[[nodiscard]] std::optional<std::vector<double>> parse_row(std::string_view text);
/// Requires a finite number in base 10 for which `accepts` holds.
[[nodiscard]] CLI::Validator number(const std::string& description, bool (*accepts)(double));
/// Requires a finite number, above 0, not below 0, or any.
[[nodiscard]] CLI::Validator positive_number();
[[nodiscard]] CLI::Validator no_negative_number();
[[nodiscard]] CLI::Validator any_number();
/// Requires a name: a variable of a script that is not set would switch an option off.
[[nodiscard]] CLI::Validator non_empty();
/// Requires a whole number in base 10, and removes its leading zeros: CLI11 would read 010 in base 8. To be
/// passed to CLI::Option::transform().
[[nodiscard]] CLI::Validator whole_number(std::int64_t lowest, std::int64_t highest);

/// An option with a fixed set of values; the first one is the default.
template <class Enum>
void add_choice(CLI::App& app, const std::string& name, Enum& target, const std::string& description,
                const std::vector<std::pair<std::string, Enum>>& choices) {
  std::string names;
  for (const auto& choice : choices) names += (names.empty() ? "" : "|") + choice.first;
  const auto find = [choices](const std::string& text) -> std::optional<Enum> {
    for (const auto& [word, value] : choices)
      if (word == text) return value;
    return std::nullopt;
  };
  app.add_option_function<std::string>(
         name, [=, &target](const std::string& text) { target = *find(text); }, description)
      ->check(CLI::Validator(
          [=](const std::string& text) {
            return find(text) ? std::string() : text + " is not one of " + names;
          },
          ""))
      ->type_name(names)
      ->default_str(choices[0].first);
}
