// The options of the command that structs declare (sdm/options.h).
#pragma once

#include <sdm/measure.h>
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

/// What a command says of an option otherwise than its struct does.
struct OptionText {
  std::string_view name;
  const char* text = nullptr;  ///< its sentences; null: the declared ones
  const char* as = nullptr;    ///< the option's name, with underscores; null: the declared one
};

/// Adds an option of a struct, which sets `target`, a value like that of the struct; its default may be the
/// command's own. An optional word may also be "auto", for nothing.
template <class Struct, class Value>
CLI::Option* add_declared_option(CLI::App& app, const sdm::Option<Struct, Value>& option, Value& target,
                                 const OptionText& said = {}) {
  static constexpr std::string_view kNothing = "automatic";
  sdm::OptionInfo info = sdm::info_of(option);
  const bool is_optional_word = info.optional && info.type == "word";
  if (info.type != "direction") info.default_value = sdm::OptionForm<Value>::text(target);
  if (said.text != nullptr) info.text = said.text;
  if (said.as != nullptr) info.name = said.as;
  if constexpr (sdm::detail::OptionalOf<Value>::kOptional)
    if (is_optional_word) {
      info.words.insert(info.words.begin(), std::string(kNothing));
      if (!target) info.default_value = kNothing;
      info.optional = false;  // nothing is "auto"
    }
  return add_declared_option(app, std::move(info),
                             [range = option.range, is_optional_word, &target](const std::string& text) {
                               if (is_optional_word && text == kNothing) {
                                 target = Value{};
                                 return true;
                               }
                               return sdm::OptionForm<Value>::read(text, range, target);
                             });
}

/// Adds those that a struct declares, but for some, which set `target`; `texts`: what the command says of
/// them.
template <class Struct>
void add_declared_options(CLI::App& app, Struct& target, std::initializer_list<std::string_view> without = {},
                          std::initializer_list<OptionText> texts = {}) {
  sdm::for_each_option<Struct>([&](const auto& option) {
    if (std::ranges::find(without, option.name) != without.end()) return;
    const auto said = std::ranges::find(texts, std::string_view(option.name), &OptionText::name);
    add_declared_option(app, option, target.*option.member, said == texts.end() ? OptionText{} : *said);
  });
}

/// Adds --along, which sets `along`; `remark`: another sentence for its help, or nothing.
void add_along_option(CLI::App& app, std::optional<sdm::AlongOptions>& along, const std::string& remark = {});

/// What the options of a command exclude, for its manual: "Not with --a, --b." or nothing.
[[nodiscard]] std::string exclusions_of(const CLI::App& app, const CLI::Option& option);
/// Throws CLI::ValidationError if two given options exclude each other.
void check_declared_options(const CLI::App& app);
