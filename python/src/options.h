// The options that structs declare (sdm/options.h) as keywords.
#pragma once

#include <nanobind/nanobind.h>
#include <sdm/options.h>

#include <string>
#include <vector>

namespace sdm::python {

namespace nb = nanobind;

/// The keywords of a call.
struct CallOptions {
  std::vector<OptionInfo> options;
  std::vector<std::string> others;              ///< that no struct declares
  void (*check_values)(const nb::dict& given);  ///< throws as set_options() does
};
/// Those of a function or class of the package.
[[nodiscard]] const CallOptions& call_options(const std::string& call);
/// A resolution may be two numbers, of a row and of a column. Returns the options with this one of them.
[[nodiscard]] nb::dict with_side(const nb::dict& given, std::size_t side);

/// Throws TypeError for a keyword that the call does not have, as set_options() does for values, and
/// sdm::Error for two that exclude each other. None is as if it were not given.
void check_keywords(const std::string& call, const nb::dict& given);

/// The options of a call as they are in its signature, each followed by ", ".
[[nodiscard]] std::string option_signature(const std::string& call,
                                           const std::vector<std::string>& without = {});
/// What they are, a paragraph for each.
[[nodiscard]] std::string option_documentation(const std::string& call,
                                               const std::vector<std::string>& without = {});

/// A value as text, for sdm::read_value(). Throws TypeError for one of another type than the option's.
[[nodiscard]] std::string text_of(const OptionInfo& option, nb::handle value);
[[noreturn]] void refuse(const OptionInfo& option, nb::handle value);

/// Sets an option of a struct. Throws TypeError, and sdm::Error for a value out of range.
template <class Struct, class Value>
void set_option(const Option<Struct, Value>& option, nb::handle value, Struct& options) {
  const OptionInfo info = info_of(option);
  if (!read_value(option, text_of(info, value), options)) refuse(info, value);
}

/// The same of those options of a struct that are given; None is as if it were not.
template <class Struct>
void set_options(const nb::dict& given, Struct& options) {
  for_each_option<Struct>([&](const auto& option) {
    if (given.contains(option.name) && !given[option.name].is_none())
      set_option(option, given[option.name], options);
  });
}

void bind_options(nb::module_& module);

}  // namespace sdm::python
