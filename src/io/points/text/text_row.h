// The cells of a row of text.
#pragma once

#include <sdm/points.h>

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace sdm::io {

/// Reads the cells of a line from left to right. Cells may be in double quotes. A '#' or "//" at the start of
/// the line, or after a blank outside of quotes, ends it.
class RowScanner {
 public:
  /// `separator` and `decimal` are not automatic.
  RowScanner(std::string_view line, TextSeparator separator, DecimalMark decimal);

  /// Whether there is another cell; one after the last separator may be empty.
  [[nodiscard]] bool more() const { return more_; }
  /// Reads the next cell if it is a number. Returns whether it is.
  bool number(double& value);
  /// Reads the next cell, without blanks and quotes around it. Its quotes inside remain doubled.
  std::string_view text();

 private:
  [[nodiscard]] bool is_blank(char c) const { return c == ' ' || (c == '\t' && separator_ != '\t'); }
  [[nodiscard]] bool is_separator(char c) const { return separator_ == ' ' ? is_blank(c) : c == separator_; }
  [[nodiscard]] bool is_comment(const char* at) const;
  void skip_blanks(const char*& at) const;
  bool finish_cell(const char* at);
  [[nodiscard]] const char* parse(const char* first, const char* last, double& value) const;

  const char* at_;
  const char* begin_;
  const char* end_;
  char separator_;  // ' ' stands for blanks
  bool decimal_comma_, more_ = false;
};

/// A number that is read from a row: one of x, y, z, nx, ny, nz.
struct WantedNumber {
  std::size_t column, role;
};

/// What is read from the rows of a text.
struct RowPlan {
  TextSeparator separator = TextSeparator::blank;
  DecimalMark decimal = DecimalMark::point;
  std::size_t columns = 0;               ///< of every row
  std::array<WantedNumber, 6> wanted{};  ///< by columns
  std::size_t wanted_count = 0;          ///< 3, or 6 with normals

  /// Adds the columns of x, y, z, and of a normal if there are six, in the order of their roles.
  void want(std::initializer_list<std::size_t> columns_of_roles);
  [[nodiscard]] bool has_normals() const { return wanted_count == 6; }
};

using RowNumbers = std::array<double, 6>;

/// Reads a row. Returns whether it fits the plan. A separator after the last column is no fault.
[[nodiscard]] bool read_row(std::string_view line, const RowPlan& plan, RowNumbers& numbers);

/// Why a row does not fit the plan.
[[nodiscard]] std::string row_fault(std::string_view line, const RowPlan& plan);

/// Returns whether there is nothing in a line but blanks and a comment.
[[nodiscard]] bool is_empty_row(std::string_view line);

/// The number in a line that has nothing else than its digits and blanks.
[[nodiscard]] std::optional<std::uint64_t> lone_count(std::string_view line);

}  // namespace sdm::io
