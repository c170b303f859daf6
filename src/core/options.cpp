#include <sdm/error.h>
#include <sdm/options.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/parse_number.h"

namespace sdm {
namespace {

constexpr const char* kNormal = "normal";

/// The number of characters to insert, delete or replace to make one text the other (Levenshtein).
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i);
    for (std::size_t j = 1; j <= b.size(); ++j)
      diagonal =
          std::exchange(row[j], std::min({row[j] + 1, row[j - 1] + 1, diagonal + (a[i - 1] != b[j - 1])}));
  }
  return row.back();
}

/// "a, b or c".
std::string alternatives(std::span<const std::string> words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text += (i == 0 ? "" : i + 1 < words.size() ? ", " : " or ") + words[i];
  return text;
}

std::string needed_number(const OptionInfo& option) {
  const auto [least, most, above, below, square] = option.range;
  using Limits = std::numeric_limits<double>;
  const bool from = least > Limits::lowest(), to = most < Limits::max();
  std::string text = option.type == "integer"   ? "a whole number"
                     : option.type == "numbers" ? "numbers"
                     : option.type == "point"   ? option.form
                                                : "a number";
  if (option.unit == "degrees") text += " of degrees";
  if (from && to && !above && !below)
    return text + " from " + text_of(least) + " to " + text_of(most) + (square ? " that is a square" : "");
  if (from) text += (above ? " greater than " : " of at least ") + text_of(least);
  if (to) text += std::string(from ? " and" : "") + (below ? " less than " : " at most ") + text_of(most);
  return text;
}

/// Whether the value of an option is one of the words, if there are words.
bool is_one_of(std::string_view value, std::string_view words) {
  if (words.empty()) return true;
  while (!words.empty()) {
    const std::size_t end = std::min(words.find(' '), words.size());
    if (words.substr(0, end) == value) return true;
    words.remove_prefix(std::min(end + 1, words.size()));
  }
  return false;
}

template <class Number>
bool read(std::string_view text, const OptionRange& range, Number& value) {
  const std::optional<Number> number = core::parse_number<Number>(text);
  if (!number || !in_range(static_cast<double>(*number), range)) return false;
  value = *number;
  return true;
}

}  // namespace

std::string spelled(std::string_view name, Spelling spelling) {
  if (spelling == Spelling::field) return std::string(name);
  std::string text = spelling == Spelling::dashed ? "--" : "";
  for (std::size_t i = 0; i < name.size(); ++i) {
    if (name[i] != '_')
      text += name[i];
    else if (spelling == Spelling::dashed)
      text += '-';
    else if (++i < name.size())
      text += static_cast<char>(name[i] - 'a' + 'A');
  }
  return text;
}

std::string needed(const OptionInfo& option) {
  if (!option.form.empty() && option.type != "point") return option.form;
  if (option.type == "word") return alternatives(option.words);
  // Words beside numbers, such as "auto", are those of a door.
  return option.words.empty() ? needed_number(option)
                              : alternatives(option.words) + " or " + needed_number(option);
}

std::string refused(const OptionInfo& option, std::string_view value, Spelling spelling) {
  return spelled(option.name, spelling).append(" is ").append(value) + ": it must be " + needed(option);
}

std::string unknown_name(std::string_view kind, std::string_view name, std::span<const std::string> known) {
  constexpr std::size_t kSimilar = 2;
  const auto distance = [&](std::string_view other) { return edit_distance(name, other); };
  const auto nearest = std::ranges::min_element(known, {}, distance);
  std::string text = "unknown " + std::string(kind) + " " + std::string(name);
  if (nearest != known.end() && distance(*nearest) <= kSimilar) text += "; did you mean " + *nearest + "?";
  return text;
}

void check_exclusions(std::span<const OptionInfo> options, std::span<const GivenOption> given,
                      Spelling spelling) {
  const auto find = [](const auto& list, std::string_view name) {
    return std::ranges::find(list, name, [](const auto& one) { return std::string_view(one.name); });
  };
  for (const OptionInfo& option : options) {
    if (find(given, option.name) == given.end()) continue;
    for (const ExcludedOption& excluded : option.excludes) {
      const auto other = find(given, excluded.name);
      if (other == given.end() || !is_one_of(other->value, excluded.only)) continue;
      std::string text = spelled(option.name, spelling) + " excludes " + spelled(excluded.name, spelling);
      if (*excluded.only != 0) text += " " + other->value;
      if (*excluded.why != 0) text.append(": ").append(excluded.why);
      throw Error(text);
    }
  }
}

bool read_number(std::string_view text, const OptionRange& range, double& value) {
  return read(text, range, value);
}
bool read_number(std::string_view text, const OptionRange& range, std::uint64_t& value) {
  return read(text, range, value);
}

bool read_numbers(std::string_view text, const OptionRange& range, std::size_t count,
                  std::vector<double>& values) {
  std::vector<double> numbers;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    double number = 0;
    if (!read_number(text.substr(begin, end - begin), range, number)) return false;
    numbers.push_back(number);
    begin = end + 1;
  }
  if (count > 0 && numbers.size() != count) return false;
  values = std::move(numbers);
  return true;
}

bool OptionForm<std::vector<std::string>>::read(std::string_view text, const OptionRange&,
                                                std::vector<std::string>& values) {
  values.clear();
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    values.emplace_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return true;
}

std::string OptionForm<std::vector<std::string>>::text(const std::vector<std::string>& values) {
  std::string text;
  for (std::size_t i = 0; i < values.size(); ++i) text.append(i == 0 ? "" : ",").append(values[i]);
  return text;
}

std::string text_of(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

std::string text_of(std::span<const double> values) {
  std::string text;
  for (std::size_t i = 0; i < values.size(); ++i) text.append(i == 0 ? "" : ",").append(text_of(values[i]));
  return text;
}

std::string text_of(const std::optional<Vec3>& direction) {
  return direction ? text_of(std::span<const double>(*direction)) : std::string(kNormal);
}

bool has_direction(const Vec3& vector) {
  return vector != Vec3{} && std::isfinite(std::hypot(vector[0], vector[1], vector[2]));
}

bool read_direction(std::string_view text, std::optional<Vec3>& value) {
  if (text == kNormal) {
    value.reset();
    return true;
  }
  Vec3 direction{};
  if (!OptionForm<Vec3>::read(text, {}, direction) || !has_direction(direction)) return false;
  value = direction;
  return true;
}

namespace detail {

void refuse(const OptionInfo& option, const std::string& value) {
  throw Error(refused(option, value, Spelling::field));
}

}  // namespace detail
}  // namespace sdm
