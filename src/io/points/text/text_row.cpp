#include "io/points/text/text_row.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstring>

#include "io/points/text/text_lines.h"

namespace sdm::io {
namespace {

char character_of(TextSeparator separator) {
  switch (separator) {
    case TextSeparator::tab:
      return '\t';
    case TextSeparator::comma:
      return ',';
    case TextSeparator::semicolon:
      return ';';
    case TextSeparator::blank:
    case TextSeparator::automatic:
      break;
  }
  return ' ';
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

}  // namespace

RowScanner::RowScanner(std::string_view line, TextSeparator separator, DecimalMark decimal)
    : at_(line.data()),
      begin_(at_),
      end_(at_ + line.size()),
      separator_(character_of(separator)),
      decimal_comma_(decimal == DecimalMark::comma) {
  skip_blanks(at_);
  more_ = at_ != end_ && !is_comment(at_);
}

bool RowScanner::is_comment(const char* at) const {
  const bool marked = *at == '#' || (*at == '/' && end_ - at > 1 && at[1] == '/');
  return marked && (at == begin_ || at[-1] == ' ' || at[-1] == '\t');
}

void RowScanner::skip_blanks(const char*& at) const {
  while (at != end_ && is_blank(*at)) ++at;
}

// Moves past what follows a cell that ends at `at`. Returns false, and does not move, if it does not end
// there.
bool RowScanner::finish_cell(const char* at) {
  const bool blank = at != end_ && is_blank(*at);
  skip_blanks(at);
  if (at == end_ || is_comment(at)) {
    more_ = false;
  } else if (separator_ != ' ') {
    if (*at != separator_) return false;
    ++at;
  } else if (!blank) {
    return false;
  }
  at_ = at;
  return true;
}

// Parses a number at the start of a cell. Returns its end, or null.
const char* RowScanner::parse(const char* first, const char* last, double& value) const {
  if (first != last && *first == '+') {
    ++first;
    if (first != last && (*first == '-' || *first == '+')) return nullptr;
  }
  if (!decimal_comma_) {
    const auto [end, fault] = std::from_chars(first, last, value);
    return fault == std::errc() ? end : nullptr;
  }
  // A decimal comma has a digit on either side: a comma after a number does not belong to it.
  const char* end = first;
  while (end != last && !is_separator(*end) && !is_blank(*end)) ++end;
  std::array<char, 128> copy;
  const auto length = static_cast<std::size_t>(end - first);
  if (length > copy.size() || std::find(first, end, '.') != end) return nullptr;
  std::copy(first, end, copy.begin());
  if (const char* comma = std::find(first, end, ','); comma != end) {
    if (comma == first || !is_digit(comma[-1]) || comma + 1 == end || !is_digit(comma[1])) return nullptr;
    copy[static_cast<std::size_t>(comma - first)] = '.';
  }
  const auto [stop, fault] = std::from_chars(copy.data(), copy.data() + length, value);
  return fault == std::errc() && stop == copy.data() + length ? end : nullptr;
}

bool RowScanner::number(double& value) {
  const char* at = at_;
  skip_blanks(at);
  if (at == end_) return false;
  if (*at != '"') {
    const char* end = parse(at, end_, value);
    return end && finish_cell(end);
  }
  const auto* close =
      static_cast<const char*>(std::memchr(at + 1, '"', static_cast<std::size_t>(end_ - at - 1)));
  if (!close) return false;
  // What is quoted has no separators.
  RowScanner inside({at + 1, static_cast<std::size_t>(close - at - 1)}, TextSeparator::blank,
                    decimal_comma_ ? DecimalMark::comma : DecimalMark::point);
  return inside.more() && inside.number(value) && !inside.more() && finish_cell(close + 1);
}

std::string_view RowScanner::text() {
  const char* first = at_;
  skip_blanks(first);
  const char* at = first;
  if (at != end_ && *at == '"') {
    do {  // a doubled quote is one of the text
      at = std::find(at + 1, end_, '"');
      if (at != end_) ++at;
    } while (at != end_ && *at == '"');
    const char* close = at;
    if (close - first >= 2 && close[-1] == '"' && finish_cell(close))
      return {first + 1, static_cast<std::size_t>(close - first - 2)};
    at = first;
  }
  while (at != end_ && !is_separator(*at) && !(at != first && is_comment(at))) ++at;
  const char* last = at;
  while (last != first && is_blank(last[-1])) --last;
  if (!finish_cell(last)) {
    at_ = end_;
    more_ = false;
  }
  return {first, static_cast<std::size_t>(last - first)};
}

void RowPlan::want(std::initializer_list<std::size_t> columns_of_roles) {
  wanted_count = 0;
  for (const std::size_t column : columns_of_roles) {
    wanted[wanted_count] = {column, wanted_count};
    ++wanted_count;
  }
  std::sort(wanted.begin(), wanted.begin() + static_cast<std::ptrdiff_t>(wanted_count),
            [](const WantedNumber& a, const WantedNumber& b) { return a.column < b.column; });
}

bool read_row(std::string_view line, const RowPlan& plan, RowNumbers& numbers) {
  RowScanner row(line, plan.separator, plan.decimal);
  std::size_t column = 0;
  for (std::size_t k = 0; k < plan.wanted_count; ++k, ++column) {
    for (; column < plan.wanted[k].column && row.more(); ++column) (void)row.text();
    if (!row.more() || !row.number(numbers[plan.wanted[k].role])) return false;
  }
  bool empty = false;
  for (; row.more(); ++column) empty = row.text().empty();
  return column == plan.columns || (column == plan.columns + 1 && empty);
}

std::string row_fault(std::string_view line, const RowPlan& plan) {
  std::size_t columns = 0;
  std::string_view last;
  for (RowScanner row(line, plan.separator, plan.decimal); row.more(); ++columns) last = row.text();
  if (columns != plan.columns && !(columns == plan.columns + 1 && last.empty()))
    return fmt::format("{} column{} where {} are needed", columns, columns == 1 ? "" : "s", plan.columns);
  RowScanner row(line, plan.separator, plan.decimal);
  for (std::size_t column = 0, k = 0; k < plan.wanted_count; ++column) {
    double ignored = 0;
    if (column != plan.wanted[k].column) {
      (void)row.text();
    } else if (!row.number(ignored)) {
      const std::string_view cell = row.text();
      return cell.empty() ? "a number is missing" : fmt::format("expected a number, not {}", quoted(cell));
    } else {
      ++k;
    }
  }
  return "is not a row";
}

bool is_empty_row(std::string_view line) {
  return !RowScanner(line, TextSeparator::blank, DecimalMark::point).more();
}

std::optional<std::uint64_t> lone_count(std::string_view line) {
  RowScanner row(line, TextSeparator::blank, DecimalMark::point);
  if (!row.more()) return std::nullopt;
  const std::string_view digits = row.text();
  std::uint64_t count = 0;
  const auto [end, fault] = std::from_chars(digits.data(), digits.data() + digits.size(), count);
  if (fault != std::errc() || end != digits.data() + digits.size() || row.more()) return std::nullopt;
  return count;
}

}  // namespace sdm::io
