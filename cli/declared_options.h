// The options of the command that structs declare (sdm/options.h).
#pragma once

#include <sdm/along.h>
#include <sdm/options.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

/// Adds an option as it is declared. `read` gets its value as text, and returns whether it is one; what it
/// refers to must outlive the parsing.
CLI::Option* add_declared_option(CLI::App& app, sdm::OptionInfo info,
                                 std::function<bool(const std::string&)> read);

/// What is declared of an option, with the default that `target` has, which may be the command's own.
template <class Struct, class Value>
sdm::OptionInfo info_of(const sdm::Option<Struct, Value>& option, const Struct& target) {
  sdm::OptionInfo info = sdm::info_of(option);
  for (const sdm::GivenOption& setting : sdm::settings_of(target))
    if (setting.name == info.name) info.default_value = setting.value;
  return info;
}

/// A sentence of the command's own for an option.
struct OptionText {
  std::string_view name;
  const char* text;
};

/// Adds those that a struct declares, but for some, which set `target`; `texts`: in place of the declared
/// ones.
template <class Struct>
void add_declared_options(CLI::App& app, Struct& target, std::initializer_list<std::string_view> without = {},
                          std::initializer_list<OptionText> texts = {}) {
  sdm::for_each_option<Struct>([&](const auto& option) {
    if (std::ranges::find(without, option.name) != without.end()) return;
    sdm::OptionInfo info = info_of(option, target);
    for (const auto& [name, text] : texts)
      if (name == info.name) info.text = text;
    add_declared_option(app, std::move(info), [&option, &target](const std::string& text) {
      return sdm::read_value(option, text, target);
    });
  });
}

/// Adds --along, which sets `along`; `remark`: another sentence for its help, or nothing.
void add_along_option(CLI::App& app, std::optional<sdm::AlongOptions>& along, const std::string& remark = {});

/// What the options of a command exclude, for its manual: "Not with --a, --b." or nothing.
[[nodiscard]] std::string exclusions_of(const CLI::App& app, const CLI::Option& option);
/// Throws CLI::ValidationError if two given options exclude each other.
void check_declared_options(const CLI::App& app);
