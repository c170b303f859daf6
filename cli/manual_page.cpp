// The manual page, as input for groff's man macros.
#include <fmt/format.h>
#include <sdm/version.h>

#include <string>
#include <string_view>

#include "completion.h"
#include "declared_options.h"
#include "exit_codes.h"
#include "option_words.h"

namespace {

// Text whose characters mean themselves, also at the start of a line.
std::string plain(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '\\')
      result += "\\e";
    else if (c == '-')
      result += "\\-";
    else if ((c == '.' || c == '\'') && (result.empty() || result.back() == '\n'))
      result += std::string("\\&") + c;
    else
      result += c;
  }
  return result;
}

// The lines of a text as paragraphs; those that begin with a blank, such as examples, as they are.
std::string paragraphs(std::string_view text) {
  std::string result;
  bool as_is = false, first = true;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const bool example = line.starts_with(' ');
    if (example != as_is) result += example ? ".PP\n.nf\n" : ".fi\n";
    if (!example && !first) result += ".PP\n";
    as_is = example;
    first = false;
    if (!line.empty()) result += plain(line) + "\n";
  }
  return as_is ? result + ".fi\n" : result;
}

std::string option_entry(const CLI::App& command, const CLI::Option& option) {
  std::string names;
  const auto add = [&](const std::string& name) {
    names += fmt::format("{}\\fB{}\\fP", names.empty() ? "" : ", ", plain(name));
  };
  for (const std::string& name : names_of(option)) add(name);
  if (option.get_positional()) add(option.get_name(true, false));
  std::string value, remarks;
  if (const std::string name = value_of(option); !name.empty() && !option.get_positional())
    value = fmt::format(" \\fI{}\\fP", plain(name));
  if (!option.get_default_str().empty())
    remarks += fmt::format(" Default: {}.", plain(option.get_default_str()));
  if (option.get_required() && option.nonpositional()) remarks += " Required.";
  for (const CLI::Option* other : option.get_excludes())
    remarks += fmt::format(" Not with {}.", plain(other->get_name()));
  if (const std::string excluded = exclusions_of(command, option); !excluded.empty())
    remarks += " " + plain(excluded);
  return fmt::format(".TP\n{}{}\n{}.{}\n", names, value, plain(option.get_description()), remarks);
}

std::string command_section(const CLI::App& command) {
  std::string usage = "sdm " + command.get_name();
  std::string positionals, options;
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_positional()) {
      usage += " " + option->get_name(true, false) + (option->get_expected_max() > 1 ? "..." : "");
      positionals += option_entry(command, *option);
    } else {
      options += option_entry(command, *option);
    }
  }
  return fmt::format(".SS \"{}\"\n{}.\n{}{}.PP\n{}", plain(usage + " [OPTIONS]"),
                     plain(command.get_description()), positionals, options,
                     paragraphs(command.get_footer()));
}

}  // namespace

std::string manual_page(const CLI::App& app) {
  std::string text = fmt::format(
      ".TH SDM 1 \"\" \"sdm {}\" \"User Commands\"\n"
      ".SH NAME\nsdm \\- surface distance maps between triangle meshes\n"
      ".SH SYNOPSIS\n.B sdm\n.I command\n[\\fIoptions\\fP] [\\fIfiles\\fP]\n"
      ".SH DESCRIPTION\n{}\n.SH COMMANDS\n",
      sdm::kVersion, plain(app.get_description()));
  for (const CLI::App* command : visible_commands(app)) text += command_section(*command);
  text += ".SH EXIT STATUS\n";
  for (const auto& [code, meaning] : kExitMeanings)
    text += fmt::format(".TP\n{}\n{}\n", static_cast<int>(code), meaning);
  return text;
}
