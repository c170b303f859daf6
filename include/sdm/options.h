/// What calls can be asked for, declared once: the options of a struct by name. The command has its options
/// with their help from here, Python its keywords with their documentation, JavaScript its options with their
/// types, report.json its settings and the documentation its table; all check values by the same rule, and
/// refuse them by the same sentence.
///
/// Threads: the functions may be called concurrently.
#pragma once

#include <sdm/api.h>
#include <sdm/names.h>
#include <sdm/option_forms.h>
#include <sdm/types.h>

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

namespace sdm {

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
    settings.push_back({option.name, OptionForm<Value>::text(options.*option.member)});
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
