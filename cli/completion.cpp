#include "completion.h"

#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <string_view>
#include <vector>

#include "option_words.h"

namespace {

// What completions offer for an option.
struct OptionWords {
  std::vector<std::string> names;    ///< "-o", "--output"
  std::string summary;               ///< the first clause of its description
  std::string value;                 ///< the name of its value; empty if it is a flag
  std::vector<std::string> choices;  ///< of the value, if it is one of some words
  bool is_file = false, is_folder = false;
};

struct CommandWords {
  std::string name, summary;
  std::vector<OptionWords> options;
};

std::vector<std::string> split(std::string_view text, char at) {
  std::vector<std::string> parts;
  for (std::size_t end; (end = text.find(at)) != std::string_view::npos; text.remove_prefix(end + 1))
    parts.emplace_back(text.substr(0, end));
  parts.emplace_back(text);
  return parts;
}

OptionWords words_of(const CLI::Option& option) {
  OptionWords words;
  words.names = names_of(option);
  words.summary = option.get_description().substr(0, option.get_description().find_first_of(";\n"));
  words.value = value_of(option);
  words.is_folder = words.value == "DIR";
  words.is_file = words.value == "FILE";
  const auto is_word = [](const std::string& word) {
    return std::ranges::all_of(
        word, [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-'; });
  };
  if (const auto choices = split(words.value, '|');
      choices.size() > 1 && std::ranges::all_of(choices, is_word))
    words.choices = choices;
  return words;
}

std::vector<CommandWords> commands_of(const CLI::App& app) {
  std::vector<CommandWords> commands;
  for (const CLI::App* command : visible_commands(app)) {
    CommandWords& words =
        commands.emplace_back(CommandWords{command->get_name(), command->get_description(), {}});
    for (const CLI::Option* option : command->get_options())
      if (option->nonpositional()) words.options.push_back(words_of(*option));
  }
  return commands;
}

std::string replaced(std::string text, std::string_view what, std::string_view by) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
    text.replace(at, what.size(), by);
  return text;
}

std::string bash_completion(const std::vector<CommandWords>& commands) {
  std::string names, values, options;
  for (const CommandWords& command : commands) {
    names += (names.empty() ? "" : " ") + command.name;
    std::string all;
    for (const OptionWords& option : command.options) {
      all += fmt::format("{}{}", all.empty() ? "" : " ", fmt::join(option.names, " "));
      if (option.value.empty()) continue;
      std::vector<std::string> patterns;
      for (const std::string& name : option.names) patterns.push_back(command.name + "," + name);
      const std::string action =
          option.is_folder ? "COMPREPLY=($(compgen -d -- \"$cur\"))"
          : option.is_file ? "COMPREPLY=($(compgen -f -- \"$cur\"))"
          : option.choices.empty()
              ? "COMPREPLY=()"
              : fmt::format("COMPREPLY=($(compgen -W \"{}\" -- \"$cur\"))", fmt::join(option.choices, " "));
      values += fmt::format("    {}) {}; return ;;\n", fmt::join(patterns, "|"), action);
    }
    options += fmt::format("    {}) options=\"{}\" ;;\n", command.name, all);
  }
  return fmt::format(R"(# bash completion for sdm, made by `sdm completion bash`.
_sdm() {{
  local cur=${{COMP_WORDS[COMP_CWORD]}} prev=${{COMP_WORDS[COMP_CWORD-1]}} command= options= word
  for word in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
    case $word in
    {}) command=$word; break ;;
    esac
  done
  case $command,$prev in
{}  esac
  case $command in
{}    *) options="--help --version" ;;
  esac
  if [[ $cur == -* ]]; then
    COMPREPLY=($(compgen -W "$options" -- "$cur"))
  elif [[ -z $command ]]; then
    COMPREPLY=($(compgen -W "{} help" -- "$cur"))
  else
    COMPREPLY=($(compgen -f -- "$cur"))
  fi
}}
complete -o filenames -F _sdm sdm
)",
                     replaced(names, " ", "|"), values, options, names);
}

// Text within single quotes and within [...] of an argument of _arguments.
std::string zsh_text(std::string text) {
  for (const char* special : {"\\", "[", "]", ":"})
    text = replaced(text, special, std::string("\\") + special);
  return replaced(text, "'", "'\\''");
}

std::string zsh_completion(const std::vector<CommandWords>& commands) {
  std::string list, cases;
  for (const CommandWords& command : commands) {
    list += fmt::format("    '{}:{}'\n", command.name, zsh_text(command.summary));
    cases += fmt::format("  {})\n    _arguments \\\n", command.name);
    for (const OptionWords& option : command.options) {
      std::string value;
      if (!option.value.empty())
        value = fmt::format(":{}:{}", zsh_text(option.value),
                            option.is_folder         ? "_files -/"
                            : option.is_file         ? "_files"
                            : option.choices.empty() ? " "
                                                     : fmt::format("({})", fmt::join(option.choices, " ")));
      const std::string names =
          option.names.size() == 1
              ? "'" + option.names[0]
              : fmt::format("'({})'{{{}}}'", fmt::join(option.names, " "), fmt::join(option.names, ","));
      cases += fmt::format("      {}[{}]{}' \\\n", names, zsh_text(option.summary), value);
    }
    cases += "      '*:file:_files'\n    ;;\n";
  }
  return fmt::format(R"(#compdef sdm
# zsh completion for sdm, made by `sdm completion zsh`.
_sdm() {{
  local -a commands
  commands=(
{}    'help:Print the help of a command'
  )
  if (( CURRENT == 2 )); then
    _describe command commands
    return
  fi
  local command=$words[2]
  shift words
  (( CURRENT-- ))
  case $command in
{}  esac
}}
_sdm "$@"
)",
                     list, cases);
}

std::string fish_text(std::string text) {
  return replaced(replaced(std::move(text), "\\", "\\\\"), "'", "\\'");
}

std::string fish_completion(const std::vector<CommandWords>& commands) {
  std::string text = "# fish completion for sdm, made by `sdm completion fish`.\n";
  for (const CommandWords& command : commands)
    text += fmt::format("complete -c sdm -n __fish_use_subcommand -f -a {} -d '{}'\n", command.name,
                        fish_text(command.summary));
  for (const CommandWords& command : commands)
    for (const OptionWords& option : command.options) {
      text += fmt::format("complete -c sdm -n '__fish_seen_subcommand_from {}'", command.name);
      for (const std::string& name : option.names)
        text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      if (option.is_file || option.is_folder)
        text += " -r";
      else if (!option.value.empty())
        text += option.choices.empty() ? " -x" : fmt::format(" -x -a '{}'", fmt::join(option.choices, " "));
      text += fmt::format(" -d '{}'\n", fish_text(option.summary));
    }
  return text;
}

}  // namespace

void add_completion_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("completion", "Print completions for a shell");
  command->group("");
  const auto shell = std::make_shared<std::string>();
  command->add_option("SHELL", *shell, "bash, zsh or fish")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish"}));
  command->callback([&app, shell] {
    const std::vector<CommandWords> commands = commands_of(app);
    std::cout << (*shell == "bash"  ? bash_completion(commands)
                  : *shell == "zsh" ? zsh_completion(commands)
                                    : fish_completion(commands));
  });
}
