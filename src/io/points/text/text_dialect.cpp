#include "io/points/text/text_dialect.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <algorithm>
#include <vector>

#include "io/points/text/dialect_attempt.h"
#include "io/points/text/text_lines.h"

namespace sdm {

using namespace io;

namespace {

constexpr std::size_t kLines = 1000;  // that are examined
constexpr std::string_view kRemedy = "; --columns, --separator and --decimal decide how the text is read";

[[noreturn]] void fail_at(std::uint64_t line, std::string_view fault, std::string_view remedy = "") {
  throw Error(fmt::format("line {}: {}{}", line, fault, remedy));
}

TextBeginning beginning_of(std::string_view text, bool whole) {
  TextBeginning result;
  const char end = line_end_of(text);
  for (std::uint64_t number = 1; !text.empty() && result.lines.size() < kLines; ++number) {
    const std::size_t length = std::min(text.find(end), text.size());
    if (length > kMaxLine) fail_at(number, kLongLine);
    if (!whole && length == text.size()) break;  // the line may be cut
    const std::string_view line = take_line(text, end);
    if (!is_empty_row(line))
      result.lines.push_back({line, number});
    else if (result.lines.empty())
      result.comments.push_back({line, number});
  }
  return result;
}

/// Those of a separator are together. Of dialects that read the same points, the first is taken.
std::vector<DialectAttempt> attempts(const TextBeginning& beginning, const TextDialect& given) {
  std::vector<DialectAttempt> result;
  for (const TextSeparator s :
       {TextSeparator::semicolon, TextSeparator::tab, TextSeparator::comma, TextSeparator::blank})
    for (const DecimalMark d : {DecimalMark::point, DecimalMark::comma})
      if ((given.separator == s || given.separator == TextSeparator::automatic) &&
          (given.decimal == d || given.decimal == DecimalMark::automatic))
        result.emplace_back(beginning, given, s, d);
  return result;
}

bool same_separator(const DialectAttempt& a, const DialectAttempt& b) {
  return a.table().plan.separator == b.table().plan.separator;
}

// Throws the fault of the dialect that fits best.
[[noreturn]] void fail(const std::vector<DialectAttempt>& all, bool any_given) {
  const auto key = [](const DialectAttempt& a) { return std::pair(a.rows(), a.columns()); };
  const DialectAttempt& best = *std::ranges::max_element(all, {}, key);
  if (best.columns() < 3 && !any_given)
    throw Error(fmt::format("unknown format; {} are supported", point_format_names()));
  fail_at(best.misfit()->line, best.misfit()->fault, best.rows() == 0 ? kRemedy : "");
}

}  // namespace

bool io::is_given(const TextDialect& dialect) {
  return dialect.separator != TextSeparator::automatic || dialect.decimal != DecimalMark::automatic ||
         !dialect.columns.empty();
}

TextTable io::find_dialect(std::string_view begin, bool whole, const TextDialect& given) {
  const TextBeginning beginning = beginning_of(begin, whole);
  const std::vector<DialectAttempt> all = attempts(beginning, given);
  const DialectAttempt* best = nullptr;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const DialectAttempt* fits = all[i].misfit() ? nullptr : &all[i];
    // The decimal mark of more numbers is taken: coordinates that fit both have none.
    for (; i + 1 < all.size() && same_separator(all[i], all[i + 1]); ++i)
      if (!all[i + 1].misfit() && (!fits || all[i + 1].numbers() > fits->numbers())) fits = &all[i + 1];
    if (fits && best && !fits->agrees_with(*best))
      fail_at(beginning.lines[0].number, "the text can be read in several ways", kRemedy);
    if (!best) best = fits;
  }
  if (!best) fail(all, is_given(given));
  if (const std::string doubt = best->doubt(); !doubt.empty())
    fail_at(beginning.lines[0].number, doubt, kRemedy);
  return best->table();
}

void validate(const TextDialect& dialect) {
  if (dialect.columns.empty()) return;
  const auto named = named_columns({dialect.columns.begin(), dialect.columns.end()});
  if (!named) throw Error("the columns of a text must have the names x, y and z among them");
}

}  // namespace sdm
