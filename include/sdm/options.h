/// What calls can be asked for, declared once: the options of a struct by name, and how their values are read
/// from text, written and checked. The command has its options with their help from here, Python its keywords
/// with their documentation, JavaScript its options with their types, report.json its settings and the
/// documentation its table; all check values by the same rule, and refuse them by the same sentence.
///
/// Threads: the functions may be called concurrently.
#pragma once

#include <sdm/names.h>
#include <sdm/types.h>

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

namespace sdm {

/// The numbers that an option may be: from `least` to `most`.
struct OptionRange {
  double least = std::numeric_limits<double>::lowest();  ///< the lowest number there is: no limit but finite
  double most = std::numeric_limits<double>::max();      ///< the highest one: no limit but finite
  bool above = false;                                    ///< whether `least` itself is excluded
  bool below = false;                                    ///< whether `most` itself is excluded
  bool square = false;  ///< whether only squares of whole numbers are allowed
};
/// The finite numbers greater than 0.
inline constexpr OptionRange kPositive{0, std::numeric_limits<double>::max(), true};
/// The numbers greater than 0, infinity included.
inline constexpr OptionRange kPositiveOrInfinite{0, kInfinity, true};

/// An angle between normals, in degrees.
inline constexpr OptionRange kAngle{0, 180, true};

/// Reads all of a text as a number in base 10. Returns false, and changes nothing, if it is none or out of
/// range.
[[nodiscard]] SDM_API bool read_number(std::string_view text, const OptionRange& range, double& value);
/// Reads a whole number of at least 0, as the function above reads a number.
[[nodiscard]] SDM_API bool read_number(std::string_view text, const OptionRange& range, std::uint64_t& value);
/// Reads numbers with commas between them, as read_number() reads one; `count`: how many, 0: any number.
[[nodiscard]] SDM_API bool read_numbers(std::string_view text, const OptionRange& range, std::size_t count,
                                        std::vector<double>& values);
/// Reads a direction X,Y,Z other than 0,0,0, or "normal", which is nothing, as read_number() reads a number.
[[nodiscard]] SDM_API bool read_direction(std::string_view text, std::optional<Vec3>& value);

/// A number as text, by which it can be read again.
[[nodiscard]] SDM_API std::string text_of(double value);
/// Numbers as text, with commas between them.
[[nodiscard]] SDM_API std::string text_of(std::span<const double> values);
/// A direction as text; nothing is "normal".
[[nodiscard]] SDM_API std::string text_of(const std::optional<Vec3>& direction);

/// Whether the vector has a direction: it is finite, its length too, and not 0.
[[nodiscard]] SDM_API bool has_direction(const Vec3& vector);
/// Whether a number is in a range.
[[nodiscard]] constexpr bool in_range(double value, const OptionRange& range) {
  if (range.square) {
    double root = 0;
    while (root * root < value && root * root < range.most) ++root;
    if (root * root != value) return false;
  }
  return (range.above ? value > range.least : value >= range.least) &&
         (range.below ? value < range.most : value <= range.most);
}

/// How the values of an option are read from text, written and checked, beside each type that they may have:
///
///     static constexpr const char* kType;  // what it is, for the types of other languages
///     static std::string needed();         // what a value must be; empty: of a number in range, or a word
///     static bool read(std::string_view text, const OptionRange& range, Value& value);  // as read_number()
///     static std::string text(const Value& value);                                       // read() reads it
///     static bool allowed(const Value& value, const OptionRange& range);
template <class Value>
struct OptionForm;

template <>
struct OptionForm<bool> {
  static constexpr const char* kType = "flag";
  static std::string needed() { return "true or false"; }
  static bool read(std::string_view text, const OptionRange&, bool& value) {
    if (text != "true" && text != "false") return false;
    value = text == "true";
    return true;
  }
  static std::string text(bool value) { return value ? "true" : "false"; }
  static bool allowed(bool, const OptionRange&) { return true; }
};

template <Worded Value>
struct OptionForm<Value> {
  static constexpr const char* kType = "word";
  static std::string needed() { return {}; }
  static bool read(std::string_view text, const OptionRange&, Value& value) {
    const std::optional<Value> word = value_of<Value>(text);
    if (word) value = *word;
    return word.has_value();
  }
  static std::string text(Value value) { return name_of(value); }
  static bool allowed(Value, const OptionRange&) { return true; }
};

template <>
struct OptionForm<double> {
  static constexpr const char* kType = "number";
  static std::string needed() { return {}; }
  static bool read(std::string_view text, const OptionRange& range, double& value) {
    return read_number(text, range, value);
  }
  static std::string text(double value) { return text_of(value); }
  static bool allowed(double value, const OptionRange& range) { return in_range(value, range); }
};

template <std::integral Value>
struct OptionForm<Value> {
  static constexpr const char* kType = "integer";
  static std::string needed() { return {}; }
  static bool read(std::string_view text, const OptionRange& range, Value& value) {
    std::uint64_t number = 0;
    if (!read_number(text, range, number) || !std::in_range<Value>(number)) return false;
    value = static_cast<Value>(number);
    return true;
  }
  static std::string text(Value value) { return std::to_string(value); }
  static bool allowed(Value value, const OptionRange& range) {
    return in_range(static_cast<double>(value), range);
  }
};

/// A name, such as that of a unit.
template <>
struct OptionForm<std::string> {
  static constexpr const char* kType = "text";
  static std::string needed() { return "text"; }
  static bool read(std::string_view text, const OptionRange&, std::string& value) {
    value = text;
    return true;
  }
  static std::string text(const std::string& value) { return value; }
  static bool allowed(const std::string&, const OptionRange&) { return true; }
};

/// Words that are no enumeration, with a comma between two of them.
template <>
struct OptionForm<std::vector<std::string>> {
  static constexpr const char* kType = "texts";
  static std::string needed() { return "words with commas between them"; }
  SDM_API static bool read(std::string_view text, const OptionRange& range, std::vector<std::string>& values);
  SDM_API static std::string text(const std::vector<std::string>& values);
  static bool allowed(const std::vector<std::string>&, const OptionRange&) { return true; }
};

/// Each of the numbers is in the range.
template <>
struct OptionForm<std::vector<double>> {
  static constexpr const char* kType = "numbers";
  static std::string needed() { return {}; }
  static bool read(std::string_view text, const OptionRange& range, std::vector<double>& values) {
    return read_numbers(text, range, 0, values);
  }
  static std::string text(const std::vector<double>& values) { return text_of(values); }
  static bool allowed(const std::vector<double>& values, const OptionRange& range) {
    return std::ranges::all_of(values, [&](double value) { return in_range(value, range); });
  }
};

/// The ends of an interval.
template <>
struct OptionForm<std::array<double, 2>> {
  static constexpr const char* kType = "interval";
  static std::string needed() { return "two numbers, the smaller one first"; }
  static bool read(std::string_view text, const OptionRange& range, std::array<double, 2>& value) {
    std::vector<double> numbers;
    if (!read_numbers(text, range, 2, numbers) || !(numbers[0] < numbers[1])) return false;
    value = {numbers[0], numbers[1]};
    return true;
  }
  static std::string text(const std::array<double, 2>& value) { return text_of(value); }
  static bool allowed(const std::array<double, 2>& value, const OptionRange& range) {
    return value[0] < value[1] && in_range(value[0], range) && in_range(value[1], range) &&
           in_range(value[1] - value[0], range);
  }
};

/// A point, or a direction.
template <>
struct OptionForm<Vec3> {
  static constexpr const char* kType = "point";
  static std::string needed() { return "three numbers"; }
  static bool read(std::string_view text, const OptionRange& range, Vec3& value) {
    std::vector<double> numbers;
    if (!read_numbers(text, range, 3, numbers)) return false;
    value = {numbers[0], numbers[1], numbers[2]};
    return true;
  }
  static std::string text(const Vec3& value) { return text_of(std::span<const double>(value)); }
  static bool allowed(const Vec3& value, const OptionRange& range) {
    return std::ranges::all_of(value, [&](double x) { return in_range(x, range); });
  }
};

/// A direction; nothing: normals.
template <>
struct OptionForm<std::optional<Vec3>> {
  static constexpr const char* kType = "direction";
  static std::string needed() { return "normal or a direction of three numbers, not all 0"; }
  static bool read(std::string_view text, const OptionRange&, std::optional<Vec3>& value) {
    return read_direction(text, value);
  }
  static std::string text(const std::optional<Vec3>& value) { return text_of(value); }
  static bool allowed(const std::optional<Vec3>& value, const OptionRange&) {
    return !value || has_direction(*value);
  }
};

template <class Value>
struct OptionForm<std::optional<Value>> {
  static constexpr const char* kType = OptionForm<Value>::kType;
  static std::string needed() { return OptionForm<Value>::needed(); }
  static bool read(std::string_view text, const OptionRange& range, std::optional<Value>& value) {
    Value given{};
    if (!OptionForm<Value>::read(text, range, given)) return false;
    value = std::move(given);
    return true;
  }
  static std::string text(const std::optional<Value>& value) {
    return value ? OptionForm<Value>::text(*value) : std::string();
  }
  static bool allowed(const std::optional<Value>& value, const OptionRange& range) {
    return !value || OptionForm<Value>::allowed(*value, range);
  }
};

/// Another option that may not be given beside one.
struct ExcludedOption {
  const char* name;
  const char* why = "";  ///< a clause, perhaps empty
  const char* only =
      "";  ///< the words, one blank between two of them, for which that holds; empty: all values
};

/// An option: a member of a struct, whose initialiser is the default. Its type has an OptionForm.
template <class Struct, class Value>
struct Option {
  const char* name;  ///< Python's keyword; --with-dashes in the command, inCamelCase in JavaScript
  Value Struct::*member;
  const char* text;  ///< what it does; its sentences end with a full stop
  OptionRange range{};
  const char* unit = "";     ///< "length", in the units of the meshes, "degrees", "texels" or "pixels"
  const char* value = "";    ///< the name of its value in the help of the command
  const char* implied = "";  ///< its value where the command gives none; empty: it must
  std::span<const ExcludedOption> excludes{};  ///< given values other than the default exclude these
  const char* since = "0.1";                   ///< the version that has it first
};

// What several structs say of their members in the same words.
inline constexpr const char* kMaxDistanceText = "Samples farther than this have no value.";
inline constexpr const char* kSignText =
    "How the inside of O2, where distances are negative, is determined; automatic: exact if O2 is closed and "
    "orientable, otherwise none; winding: by generalised winding numbers, an estimate; side: of an open O2 "
    "the side to which its normals do not point is negative, an estimate.";
inline constexpr const char* kFacingText =
    "Measure to the closest of the faces of O2 that face the same way: whose normal is within this angle of "
    "that of the face that is measured from. For thin walls, where the closest point may be on the other "
    "skin.";

/// max_distance of a struct.
template <class Struct>
[[nodiscard]] constexpr auto max_distance_option(const char* text = kMaxDistanceText) {
  return Option{.name = "max_distance",
                .member = &Struct::max_distance,
                .text = text,
                .range = kPositiveOrInfinite,
                .unit = "length",
                .value = "D"};
}
/// facing of a struct, 90 degrees where the command gives no angle.
template <class Struct>
[[nodiscard]] constexpr auto facing_option(std::span<const ExcludedOption> excludes = {},
                                           const char* text = kFacingText) {
  return Option{.name = "facing",
                .member = &Struct::facing,
                .text = text,
                .range = kAngle,
                .unit = "degrees",
                .value = "ANGLE",
                .implied = "90",
                .excludes = excludes};
}

/// The options of a struct, a std::tuple of Option; nullptr of one that declares none.
template <class Struct>
inline constexpr auto kOptions = nullptr;

/// Calls visit(option) for each option of a struct.
template <class Struct, class Visit>
constexpr void for_each_option(const Visit& visit) {
  std::apply([&](const auto&... option) { (visit(option), ...); }, kOptions<Struct>);
}

/// The option that sets a member.
template <class Struct, class Value>
[[nodiscard]] constexpr Option<Struct, Value> option_of(Value Struct::*member) {
  Option<Struct, Value> found{};
  for_each_option<Struct>([&](const auto& option) {
    if constexpr (std::is_same_v<decltype(option), const Option<Struct, Value>&>)
      if (option.member == member) found = option;
  });
  return found;
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
  std::string type;                ///< OptionForm::kType
  bool optional = false;           ///< whether it may be absent, which is then its default
  std::string default_value;       ///< as text; empty if absent
  std::vector<std::string> words;  ///< of type "word"
  OptionRange range;               ///< of numbers
  std::string form;                ///< OptionForm::needed()
  std::vector<ExcludedOption> excludes;
};

/// An option with its value.
struct GivenOption {
  std::string name;    ///< as the field's
  std::string value;   ///< as text; empty if absent
  std::string type{};  ///< OptionForm::kType
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

[[noreturn]] SDM_API void refuse(const OptionInfo& option, const std::string& value);

}  // namespace detail

/// What is declared of an option.
template <class Struct, class Value>
[[nodiscard]] OptionInfo info_of(const Option<Struct, Value>& option) {
  using Type = typename detail::OptionalOf<Value>::Type;
  using Form = OptionForm<Value>;
  OptionInfo info{.name = option.name,
                  .text = option.text,
                  .unit = option.unit,
                  .value = option.value,
                  .implied = option.implied,
                  .since = option.since,
                  .type = Form::kType,
                  .optional = detail::OptionalOf<Value>::kOptional,
                  .default_value = {},
                  .words = {},
                  .range = option.range,
                  .form = Form::needed(),
                  .excludes = {option.excludes.begin(), option.excludes.end()}};
  if constexpr (!std::is_same_v<Value, std::optional<Vec3>>)
    info.default_value = Form::text(detail::defaults_of<Struct>().*option.member);
  if constexpr (Worded<Type>) info.words.assign(kWords<Type>.begin(), kWords<Type>.end());
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
  return OptionForm<Value>::read(text, option.range, options.*option.member);
}

/// The values of all options of a struct.
template <class Struct>
[[nodiscard]] std::vector<GivenOption> settings_of(const Struct& options) {
  std::vector<GivenOption> settings;
  for_each_option<Struct>([&]<class Value>(const Option<Struct, Value>& option) {
    settings.push_back(
        {option.name, OptionForm<Value>::text(options.*option.member), OptionForm<Value>::kType});
  });
  return settings;
}

/// Throws sdm::Error unless the values of a struct are in their ranges, and none that is not the default
/// excludes another one.
template <class Struct>
void check_options(const Struct& options) {
  std::vector<GivenOption> given;
  bool excluding = false;
  for_each_option<Struct>([&]<class Value>(const Option<Struct, Value>& option) {
    using Form = OptionForm<Value>;
    const Value& value = options.*option.member;
    if (!Form::allowed(value, option.range)) detail::refuse(info_of(option), Form::text(value));
    excluding =
        excluding || (!option.excludes.empty() && !(value == detail::defaults_of<Struct>().*option.member));
  });
  if (!excluding) return;
  for_each_option<Struct>([&]<class Value>(const Option<Struct, Value>& option) {
    const Value& value = options.*option.member;
    if (!(value == detail::defaults_of<Struct>().*option.member))
      given.push_back({option.name, OptionForm<Value>::text(value)});
  });
  check_exclusions(options_of<Struct>(), given, Spelling::field);
}

}  // namespace sdm
