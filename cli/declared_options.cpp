#include "declared_options.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <map>
#include <utility>
#include <vector>

namespace {

constexpr auto kSpelling = sdm::Spelling::dashed;
constexpr auto kAlong = sdm::option_of(&sdm::AlongOptions::direction);
constexpr std::string_view kLongWord = "automatic", kShortWord = "auto";

/// Those that each command has.
std::vector<sdm::OptionInfo>& declared(const CLI::App& app) {
  static std::map<const CLI::App*, std::vector<sdm::OptionInfo>> all;
  return all[&app];
}

std::string substituted(std::string text, std::string_view from, std::string_view to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

/// The command abbreviates the word "automatic".
sdm::OptionInfo abbreviated(sdm::OptionInfo info) {
  if (info.type != "word") return info;
  for (std::string* text : {&info.text, &info.default_value})
    *text = substituted(*text, kLongWord, kShortWord);
  for (std::string& word : info.words)
    if (word == kLongWord) word = kShortWord;
  return info;
}

std::string unabbreviated(const std::string& word) {
  return word == kShortWord ? std::string(kLongWord) : word;
}

/// The name of its value in the help.
std::string value_name(const sdm::OptionInfo& info) {
  if (info.type == "word") return fmt::format("{}", fmt::join(info.words, "|"));
  return info.implied.empty() ? info.value : "[" + info.value + "]";
}

std::string without_full_stop(std::string text) {
  if (text.ends_with('.')) text.pop_back();
  return text;
}

}  // namespace

CLI::Option* add_declared_option(CLI::App& app, sdm::OptionInfo info,
                                 std::function<bool(const std::string&)> read) {
  info = abbreviated(std::move(info));
  declared(app).push_back(info);
  const std::string name = sdm::spelled(info.name, kSpelling), help = without_full_stop(info.text);
  if (info.type == "flag") {
    const bool is_set = info.default_value == "true";
    return app.add_flag_callback(
        is_set ? sdm::spelled("no_" + info.name, kSpelling) : name,
        [read = std::move(read), is_set] { (void)read(is_set ? "false" : "true"); }, help);
  }
  const auto take = [info, read = std::move(read)](const std::string& given) {
    const std::string& text = given.empty() ? info.implied : given;
    if (!read(info.type == "word" ? unabbreviated(text) : text))
      throw CLI::ValidationError(sdm::refused(info, text, kSpelling));
  };
  if (info.type == "interval")
    return app
        .add_option_function<std::vector<std::string>>(
            name, [take](const std::vector<std::string>& ends) { take(ends[0] + "," + ends[1]); }, help)
        ->expected(2)
        ->type_name(info.value);
  CLI::Option* option = app.add_option_function<std::string>(name, take, help);
  if (!info.implied.empty()) option->expected(0, 1);
  if (!info.optional && info.default_value != "inf") option->default_str(info.default_value);
  return option->type_name(value_name(info));
}

void add_along_option(CLI::App& app, std::optional<sdm::AlongOptions>& along, const std::string& remark) {
  sdm::OptionInfo info = sdm::info_of(kAlong);
  if (!remark.empty()) info.text += " " + remark;
  add_declared_option(app, std::move(info), [&along](const std::string& text) {
    return sdm::read_value(kAlong, text, along.emplace());
  });
}

std::string exclusions_of(const CLI::App& app, const CLI::Option& option) {
  std::string names;
  for (const sdm::OptionInfo& info : declared(app)) {
    if (sdm::spelled(info.name, kSpelling) != option.get_name()) continue;
    for (const sdm::ExcludedOption& excluded : info.excludes)
      if (const std::string name = sdm::spelled(excluded.name, kSpelling);
          app.get_option_no_throw(name) != nullptr)
        names += fmt::format("{}{}{}{}", names.empty() ? "" : ", ", name, *excluded.only ? " " : "",
                             excluded.only);
  }
  return names.empty() ? names : fmt::format("Not with {}.", names);
}

void check_declared_options(const CLI::App& app) {
  std::vector<sdm::GivenOption> given;
  for (const CLI::Option* option : app.get_options()) {
    if (option->count() == 0 || option->get_lnames().empty()) continue;
    const std::string name = substituted(option->get_lnames().front(), "-", "_");
    given.push_back({name, option->results().empty() ? "" : unabbreviated(option->results().front())});
  }
  try {
    sdm::check_exclusions(declared(app), given, kSpelling);
  } catch (const sdm::Error& error) {
    throw CLI::ValidationError(error.what());
  }
}
