/// What calls can be asked for, declared once: the options of a struct by name. The command has its options
/// with their help from here, Python its keywords with their documentation, JavaScript its options with their
/// types, report.json its settings and the documentation its table; all check values by the same rule, and
/// refuse them by the same sentence.
///
/// Threads: the functions may be called concurrently.
#pragma once

#include <sdm/api.h>
#include <sdm/names.h>
#include <sdm/types.h>

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

namespace sdm {

/// The numbers that an option may be: from `least` to `most`.
struct OptionRange {
  double least = std::numeric_limits<double>::lowest();  ///< the lowest number there is: no limit but finite
  double most = std::numeric_limits<double>::max();      ///< the same
  bool above = false;                                    ///< whether `least` itself is excluded
  bool below = false;                                    ///< whether `most` itself is excluded
};
/// The finite numbers greater than 0.
inline constexpr OptionRange kPositive{0, std::numeric_limits<double>::max(), true};
/// The same, and infinity.
inline constexpr OptionRange kPositiveOrInfinite{0, std::numeric_limits<double>::infinity(), true};

/// Another option that may not be given beside one.
struct ExcludedOption {
  const char* name;
  const char* why = "";  ///< a clause, perhaps empty
  const char* only =
      "";  ///< the words, one blank between two of them, for which that holds; empty: all values
};

/// An option: a member of a struct, whose initialiser is the default. Values are numbers, flags, words of an
/// enumeration, and each of them as an optional one; or an optional direction, nothing standing for normals.
template <class Struct, class Value>
struct Option {
  const char* name;  ///< Python's keyword; --with-dashes in the command, inCamelCase in JavaScript
  Value Struct::*member;
  const char* text;  ///< what it does; its sentences end with a full stop
  OptionRange range{};
  const char* unit = "";     ///< "length", in the units of the meshes, "degrees" or "texels"
  const char* value = "";    ///< the name of its value in the help of the command
  const char* implied = "";  ///< its value where the command gives none; empty: it must
  std::span<const ExcludedOption> excludes{};  ///< given values other than the default exclude these
  const char* since = "0.1";                   ///< the version that has it first
};

/// The options of a struct, a std::tuple of Option; nullptr of one that declares none.
template <class Struct>
inline constexpr auto kOptions = nullptr;

/// Calls visit(option) for each option of a struct.
template <class Struct, class Visit>
constexpr void for_each_option(const Visit& visit) {
  std::apply([&](const auto&... option) { (visit(option), ...); }, kOptions<Struct>);
}

/// How a door spells the names of options.
enum class Spelling {
  field,      ///< max_distance, of C++ and Python
  dashed,     ///< --max-distance, of the command
  camel_case  ///< maxDistance, of JavaScript
};

/// What may be known of an option while a program runs.
struct OptionInfo {
  std::string name;  ///< as the field's
  std::string text, unit, value, implied, since;
  std::string type;                ///< "number", "integer", "flag", "word" or "direction"
  bool optional = false;           ///< whether it may be absent, which is then its default
  std::string default_value;       ///< as text; empty if absent
  std::vector<std::string> words;  ///< of type "word"
  OptionRange range;               ///< of numbers
  std::vector<ExcludedOption> excludes;
};

/// An option with its value.
struct GivenOption {
  std::string name;   ///< as the field's
  std::string value;  ///< as text; empty if absent
};

/// A name as a door spells it.
[[nodiscard]] SDM_API std::string spelled(std::string_view name, Spelling spelling);
/// What a value must be, such as "a number greater than 0".
[[nodiscard]] SDM_API std::string needed(const OptionInfo& option);
/// Why a value is refused: a sentence without a full stop.
[[nodiscard]] SDM_API std::string refused(const OptionInfo& option, std::string_view value,
                                          Spelling spelling);
/// Why a name is refused, with the most similar one of `known`, if one is similar: "unknown option --sing;
/// did you mean --sign?". `kind`: what is unknown. Names are the door's.
[[nodiscard]] SDM_API std::string unknown_name(std::string_view kind, std::string_view name,
                                               std::span<const std::string> known);
/// Throws sdm::Error if two of the given options exclude each other. `options`: all that the call has.
SDM_API void check_exclusions(std::span<const OptionInfo> options, std::span<const GivenOption> given,
                              Spelling spelling);

/// Reads an option's value from text, as a number in base 10, "true" or "false", or a word. Returns false,
/// and changes nothing, if it is none or out of range.
[[nodiscard]] SDM_API bool read_number(std::string_view text, const OptionRange& range, double& value);
/// The same of a whole number.
[[nodiscard]] SDM_API bool read_number(std::string_view text, const OptionRange& range, std::uint32_t& value);

/// The same of a direction X,Y,Z other than 0,0,0, or of "normal" for nothing.
[[nodiscard]] SDM_API bool read_direction(std::string_view text, std::optional<Vec3>& value);

/// A number as text, by which it can be read again.
[[nodiscard]] SDM_API std::string text_of(double value);
/// The same of a direction.
[[nodiscard]] SDM_API std::string text_of(const std::optional<Vec3>& direction);

/// Whether the vector has a direction: it is finite, its length too, and not 0.
[[nodiscard]] SDM_API bool has_direction(const Vec3& vector);
/// Whether a number is in a range.
[[nodiscard]] constexpr bool in_range(double value, const OptionRange& range) {
  return (range.above ? value > range.least : value >= range.least) &&
         (range.below ? value < range.most : value <= range.most);
}

namespace detail {

template <class Struct>
[[nodiscard]] const Struct& defaults_of() {
  static const Struct defaults{};
  return defaults;
}

template <class Value>
struct OptionalOf {
  using Type = Value;
  static constexpr bool kOptional = false;
};
template <class Value>
struct OptionalOf<std::optional<Value>> {
  using Type = Value;
  static constexpr bool kOptional = true;
};

template <class Value>
[[nodiscard]] std::string value_text(const Value& value) {
  if constexpr (std::is_same_v<Value, std::optional<Vec3>>)
    return text_of(value);
  else if constexpr (OptionalOf<Value>::kOptional)
    return value ? value_text(*value) : std::string();
  else if constexpr (std::is_same_v<Value, bool>)
    return value ? "true" : "false";
  else if constexpr (std::is_enum_v<Value>)
    return name_of(value);
  else
    return text_of(static_cast<double>(value));
}

template <class Value>
[[nodiscard]] constexpr bool allowed(const Value& value, const OptionRange& range) {
  if constexpr (std::is_same_v<Value, std::optional<Vec3>>)
    return !value || has_direction(*value);
  else if constexpr (OptionalOf<Value>::kOptional)
    return !value || allowed(*value, range);
  else if constexpr (std::is_same_v<Value, bool> || std::is_enum_v<Value>)
    return true;
  else
    return in_range(static_cast<double>(value), range);
}

[[noreturn]] SDM_API void refuse(const OptionInfo& option, const std::string& value);

}  // namespace detail

/// What is declared of an option.
template <class Struct, class Value>
[[nodiscard]] OptionInfo info_of(const Option<Struct, Value>& option) {
  using Type = typename detail::OptionalOf<Value>::Type;
  OptionInfo info{.name = option.name,
                  .text = option.text,
                  .unit = option.unit,
                  .value = option.value,
                  .implied = option.implied,
                  .since = option.since,
                  .type = "number",
                  .optional = detail::OptionalOf<Value>::kOptional,
                  .default_value = detail::value_text(detail::defaults_of<Struct>().*option.member),
                  .words = {},
                  .range = option.range,
                  .excludes = {option.excludes.begin(), option.excludes.end()}};
  if constexpr (std::is_same_v<Type, Vec3>) {
    info.type = "direction";
    info.default_value.clear();
  } else if constexpr (std::is_same_v<Type, bool>) {
    info.type = "flag";
  } else if constexpr (std::is_enum_v<Type>) {
    info.type = "word";
    info.words.assign(kWords<Type>.begin(), kWords<Type>.end());
  } else if constexpr (std::is_integral_v<Type>) {
    info.type = "integer";
  }
  return info;
}

/// The options of one struct or of several, in their order; of those that have the same name, the first.
template <class... Structs>
[[nodiscard]] std::vector<OptionInfo> options_of() {
  std::vector<OptionInfo> all;
  const auto add = [&](const auto& option) {
    for (const OptionInfo& known : all)
      if (known.name == option.name) return;
    all.push_back(info_of(option));
  };
  (for_each_option<Structs>(add), ...);
  return all;
}

/// Reads the value of an option from text. Returns false, and changes nothing, if it is none or out of range.
template <class Struct, class Value>
[[nodiscard]] bool read_value(const Option<Struct, Value>& option, std::string_view text, Struct& options) {
  using Type = typename detail::OptionalOf<Value>::Type;
  Value& member = options.*option.member;
  if constexpr (std::is_same_v<Type, Vec3>) {
    return read_direction(text, member);
  } else if constexpr (std::is_same_v<Type, bool>) {
    if (text != "true" && text != "false") return false;
    member = text == "true";
  } else if constexpr (std::is_enum_v<Type>) {
    const std::optional<Type> value = value_of<Type>(text);
    if (!value) return false;
    member = *value;
  } else {
    Type value{};
    if (!read_number(text, option.range, value)) return false;
    member = value;
  }
  return true;
}

/// The values of all options of a struct.
template <class Struct>
[[nodiscard]] std::vector<GivenOption> settings_of(const Struct& options) {
  std::vector<GivenOption> settings;
  for_each_option<Struct>([&](const auto& option) {
    settings.push_back({option.name, detail::value_text(options.*option.member)});
  });
  return settings;
}

/// Throws sdm::Error unless the values of a struct are in their ranges, and none that is not the default
/// excludes another one.
template <class Struct>
void check_options(const Struct& options) {
  bool excluding = false;
  for_each_option<Struct>([&](const auto& option) {
    const auto& value = options.*option.member;
    if (!detail::allowed(value, option.range)) detail::refuse(info_of(option), detail::value_text(value));
    excluding =
        excluding || (!option.excludes.empty() && !(value == detail::defaults_of<Struct>().*option.member));
  });
  if (!excluding) return;
  std::vector<GivenOption> given;
  for_each_option<Struct>([&](const auto& option) {
    if (!(options.*option.member == detail::defaults_of<Struct>().*option.member))
      given.push_back({option.name, detail::value_text(options.*option.member)});
  });
  check_exclusions(options_of<Struct>(), given, Spelling::field);
}

}  // namespace sdm
