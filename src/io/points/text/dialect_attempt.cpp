#include "io/points/text/dialect_attempt.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>

namespace sdm::io {
namespace {

using Cells = std::vector<std::string_view>;

Cells cells_of(std::string_view line, TextSeparator separator, DecimalMark decimal) {
  Cells cells;
  for (RowScanner row(line, separator, decimal); row.more();) cells.push_back(row.text());
  return cells;
}

/// The words of a line, whatever separates them.
Cells words_of(std::string_view line) {
  constexpr std::string_view kSeparators = " \t,;";
  Cells words;
  for (std::size_t at = 0; (at = line.find_first_not_of(kSeparators, at)) != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(kSeparators, at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

struct Header {
  NamedColumns named;
  std::size_t columns;
};

/// The names in a header, whose separators may be others than those of the rows; nothing without x, y and z.
/// `columns`: of the rows. Throws sdm::Error for a name that is there twice.
std::optional<Header> header_of(std::string_view line, TextSeparator separator, std::size_t columns) {
  constexpr std::string_view kMarks = " \t#/";
  line.remove_prefix(std::min(line.find_first_not_of(kMarks), line.size()));
  std::optional<Header> result;
  for (const Cells& names : {cells_of(line, separator, DecimalMark::point), words_of(line)})
    if (const auto named = named_columns(names); named && (!result || names.size() == columns)) {
      result = {*named, names.size()};
      if (names.size() == columns) break;
    }
  return result;
}

bool is_whole(std::string_view cell, bool with_sign) {
  if (with_sign && (cell.starts_with('-') || cell.starts_with('+'))) cell.remove_prefix(1);
  return !cell.empty() && std::ranges::all_of(cell, [](char c) { return c >= '0' && c <= '9'; });
}

bool has_unit_normal(const RowNumbers& n) {
  constexpr double kMargin = 0.01;
  return std::abs(std::hypot(n[3], n[4], n[5]) - 1) < kMargin;
}

}  // namespace

DialectAttempt::DialectAttempt(const TextBeginning& beginning, const TextDialect& given,
                               TextSeparator separator, DecimalMark decimal)
    : beginning_(beginning), given_(given) {
  table_.plan.separator = table_.dialect.separator = separator;
  table_.plan.decimal = table_.dialect.decimal = decimal;
  try {
    read();
  } catch (const Misfit& misfit) {
    misfit_ = misfit;
  } catch (const Error& fault) {  // of the names in the header
    misfit_ = {header_ ? header_->number : 1, fault.what()};
  }
}

bool DialectAttempt::agrees_with(const DialectAttempt& other) const {
  const std::size_t count = table_.plan.wanted_count;
  const auto same = [count](const RowNumbers& a, const RowNumbers& b) {
    for (std::size_t k = 0; k < count; ++k)
      if (std::bit_cast<std::uint64_t>(a[k]) != std::bit_cast<std::uint64_t>(b[k])) return false;
    return true;
  };
  return count == other.table_.plan.wanted_count && std::ranges::equal(rows_, other.rows_, same);
}

std::string DialectAttempt::doubt() const {
  constexpr std::size_t kRows = 3;
  if (!unnamed_ || table_.plan.has_normals()) return {};
  if (unnamed_->counting && rows_.size() >= kRows)
    return "the first column counts the rows, so that it may be x or the number of the point";
  if (unnamed_->grid && rows_.size() >= kRows && std::ranges::all_of(unnamed_->has_fraction, std::identity()))
    return "the first two columns may be x and y, or the row and column of a scanner before x, y and z";
  if (unnamed_->halves && given_.separator == TextSeparator::automatic &&
      given_.decimal == DecimalMark::automatic)
    return fmt::format("the rows may be {} numbers, or {} with decimal commas", columns_, columns_ / 2);
  return {};
}

std::string DialectAttempt::other_columns(std::size_t named) const {
  return fmt::format("names {} columns where rows have {}", named, columns_);
}

bool DialectAttempt::is_number(std::string_view cell) const {
  double ignored = 0;
  // As if it were quoted: a cell has no separators.
  RowScanner row(cell, TextSeparator::blank, table_.plan.decimal);
  return row.more() && row.number(ignored) && !row.more();
}

// Rows follow a header and their number at most; another number and its rows may follow them.
void DialectAttempt::read() {
  const auto number = [this](std::string_view cell) { return is_number(cell); };
  std::optional<std::uint64_t> left;
  for (const TextLine& line : beginning_.lines) {
    if (left ? *left == 0 : rows_.empty()) {
      if (const auto count = lone_count(line.text)) {
        left = count;
        continue;
      }
    }
    const Cells cells = cells_of(line.text, table_.plan.separator, table_.plan.decimal);
    const auto numbers = static_cast<std::size_t>(std::ranges::count_if(cells, number));
    // Names may be numbers, but not those of x, y and z.
    if (rows_.empty() && !header_ &&
        (numbers == 0 || header_of(line.text, table_.plan.separator, cells.size()))) {
      header_ = line;
      continue;
    }
    if (left && (*left)-- == 0) throw Misfit{line.number, kMoreRows};
    if (rows_.empty()) plan(line, cells);
    RowNumbers values{};
    if (!read_row(line.text, table_.plan, values))
      throw Misfit{line.number, row_fault(line.text, table_.plan)};
    rows_.push_back(values);
    numbers_ += numbers;
    if (unnamed_) examine(line, cells);
  }
  if (rows_.empty()) {
    if (!header_) throw Misfit{1, "there are no rows"};
    const auto header = header_of(header_->text, table_.plan.separator, 0);
    columns_ = header ? header->columns : 0;
    throw Misfit{header_->number,
                 header ? "names columns, but no row follows" : "not a row of three numbers"};
  }
  if (!unnamed_ || !unnamed_->normals) return;
  table_.plan.want({0, 1, 2, 3, 4, 5});
  std::copy(std::begin(kRoleNames), std::end(kRoleNames), table_.dialect.columns.begin());
  rows_ = std::move(rows_with_normals_);
}

// Finds the columns by the given names, by those of the file, or by their place.
void DialectAttempt::plan(const TextLine& first_row, Cells row) {
  const bool open_end = row.back().empty();  // a separator after the last column
  if (open_end && !header_ && row.size() > 3) row.pop_back();
  columns_ = row.size();
  if (columns_ < 3)
    throw Misfit{first_row.number,
                 fmt::format("{} column{}, fewer than three", columns_, columns_ == 1 ? "" : "s")};
  table_.dialect.header_line.reset();
  if (header_) table_.dialect.header_line = header_->number;
  if (!given_.columns.empty()) {
    const Cells names(given_.columns.begin(), given_.columns.end());
    if (names.size() > columns_)
      throw Misfit{first_row.number, fmt::format("{} columns, fewer than --columns names", columns_)};
    return use(*named_columns(names));
  }
  if (header_) {
    const auto found = columns_in_header(row);
    if (!found)
      throw Misfit{header_->number,
                   "neither a row, which begins with three numbers, nor names with x, y and z"};
    return use(*found);
  }
  if (const auto found = columns_in_comment()) return use(*found);
  unnamed_ = {.normals = columns_ >= kRoles,
              .counting = columns_ > 3,
              .grid = columns_ > 4,
              .halves = table_.plan.separator == TextSeparator::comma && columns_ >= 6 && columns_ % 2 == 0};
  use({.columns = {0, 1, 2}});
}

std::optional<NamedColumns> DialectAttempt::columns_in_header(const Cells& row) {
  const auto header = header_of(header_->text, table_.plan.separator, row.size());
  if (!header) return std::nullopt;
  columns_ = row.size() - (header->columns + 1 == row.size() && row.back().empty() ? 1 : 0);
  if (header->columns != columns_) throw Misfit{header_->number, other_columns(header->columns)};
  return header->named;
}

// A comment before the rows may have the names. In rows of three columns they matter only in another order.
std::optional<NamedColumns> DialectAttempt::columns_in_comment() const {
  for (auto comment = beginning_.comments.rbegin(); comment != beginning_.comments.rend(); ++comment) {
    std::optional<Header> header;
    try {
      header = header_of(comment->text, table_.plan.separator, columns_);
    } catch (const Error& fault) {
      if (columns_ > 3) throw Misfit{comment->number, fault.what()};
    }
    if (!header) continue;
    const NamedColumns& named = header->named;
    if (header->columns == columns_) return named;
    if (columns_ > 3 || !std::is_sorted(named.columns, named.columns + 3))
      throw Misfit{comment->number, other_columns(header->columns)};
  }
  return std::nullopt;
}

void DialectAttempt::use(const NamedColumns& named) {
  const auto& c = named.columns;
  if (named.has_normals)
    table_.plan.want({c[0], c[1], c[2], c[3], c[4], c[5]});
  else
    table_.plan.want({c[0], c[1], c[2]});
  table_.plan.columns = columns_;
  table_.dialect.columns.assign(columns_, "_");
  for (std::size_t k = 0; k < table_.plan.wanted_count; ++k) table_.dialect.columns[c[k]] = kRoleNames[k];
}

// Updates what is said of columns by their place.
void DialectAttempt::examine(const TextLine& row, const Cells& cells) {
  RowNumbers values{};
  if (unnamed_->normals) {
    RowPlan plan = table_.plan;
    plan.want({0, 1, 2, 3, 4, 5});
    unnamed_->normals = read_row(row.text, plan, values) && has_unit_normal(values);
    if (unnamed_->normals) rows_with_normals_.push_back(values);
  }
  const auto count = lone_count(cells[0]);
  unnamed_->counting = unnamed_->counting && count && is_number(cells[3]) &&
                       (rows_.size() == 1 || *count == unnamed_->last_count + 1);
  unnamed_->last_count = count.value_or(0);
  if (unnamed_->grid) examine_grid(row, cells);
  for (std::size_t i = 0; unnamed_->halves && i < columns_; ++i)
    unnamed_->halves = is_whole(cells[i], i % 2 == 0);
}

// Scanners write their points by row and column, or by column and row, often with gaps.
void DialectAttempt::examine_grid(const TextLine& row, const Cells& cells) {
  const auto first = lone_count(cells[0]), second = lone_count(cells[1]);
  RowNumbers point{};
  RowPlan plan = table_.plan;
  plan.want({2, 3, 4});
  unnamed_->grid = first && second && read_row(row.text, plan, point);
  if (!unnamed_->grid) return;
  const std::pair cell{*first, *second};
  unnamed_->grid = rows_.size() == 1 || unnamed_->last_cell < cell;
  unnamed_->last_cell = cell;
  for (std::size_t k = 0; k < 3; ++k) unnamed_->has_fraction[k] |= point[k] != std::trunc(point[k]);
}

}  // namespace sdm::io
