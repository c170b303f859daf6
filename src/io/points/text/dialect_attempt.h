// The first lines of a text, read in one dialect.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/points/text/column_names.h"
#include "io/points/text/text_dialect.h"

namespace sdm::io {

struct TextLine {
  std::string_view text;
  std::uint64_t number;
};

/// The beginning of a text.
struct TextBeginning {
  std::vector<TextLine> comments;  ///< before the first of `lines`
  std::vector<TextLine> lines;     ///< with contents
};

/// Why a text cannot be read in a dialect.
struct Misfit {
  std::uint64_t line;
  std::string fault;
};

class DialectAttempt {
 public:
  DialectAttempt(const TextBeginning& beginning, const TextDialect& given, TextSeparator separator,
                 DecimalMark decimal);

  [[nodiscard]] const TextTable& table() const { return table_; }
  /// Nothing if the dialect fits.
  [[nodiscard]] const std::optional<Misfit>& misfit() const { return misfit_; }
  /// The number of rows that fit.
  [[nodiscard]] std::size_t rows() const { return rows_.size(); }
  /// The number of columns of the first row, or of the header if there is no row.
  [[nodiscard]] std::size_t columns() const { return columns_; }
  /// The number of cells that are numbers.
  [[nodiscard]] std::size_t numbers() const { return numbers_; }
  /// Returns whether both read the same points and normals.
  [[nodiscard]] bool agrees_with(const DialectAttempt& other) const;
  /// Why the first three columns may not be the coordinates, although the dialect fits; empty: they are.
  [[nodiscard]] std::string doubt() const;

 private:
  using Cells = std::vector<std::string_view>;

  void read();
  void plan(const TextLine& first_row, Cells cells);
  [[nodiscard]] std::optional<NamedColumns> columns_in_header(const Cells& row);
  [[nodiscard]] std::optional<NamedColumns> columns_in_comment() const;
  [[nodiscard]] std::string other_columns(std::size_t named) const;
  void use(const NamedColumns& named);
  void examine(const TextLine& row, const Cells& cells);
  void examine_grid(const TextLine& row, const Cells& cells);
  [[nodiscard]] bool is_number(std::string_view cell) const;

  const TextBeginning& beginning_;
  const TextDialect& given_;
  TextTable table_;
  std::optional<Misfit> misfit_;
  std::vector<RowNumbers> rows_, rows_with_normals_;
  std::size_t columns_ = 0, numbers_ = 0;
  std::optional<TextLine> header_;
  /// What is known of columns that have no names.
  struct UnnamedColumns {
    bool normals = false;   ///< columns 4 to 6 are normals
    bool counting = false;  ///< column 1 counts the rows
    bool grid = false;      ///< columns 1 and 2 increase as the cells of a grid do
    bool halves = false;    ///< all cells are whole numbers that may be halves of numbers with decimal commas
    std::array<bool, 3> has_fraction{};  ///< which of columns 3 to 5
    std::uint64_t last_count = 0;
    std::pair<std::uint64_t, std::uint64_t> last_cell{};
  };
  std::optional<UnnamedColumns> unnamed_;
};

}  // namespace sdm::io
