// The dialect of a text, from its first lines.
#pragma once

#include <sdm/points.h>

#include <string_view>

#include "io/points/text/text_row.h"

namespace sdm::io {

/// How a text is read.
struct TextTable {
  RowPlan plan;
  TextDialect dialect;  ///< what reports say of it
};

/// Finds the dialect of a text that begins with `begin`, which is all of it if `whole`. What `given` decides
/// is so; all other dialects are tried on the first rows. Throws sdm::Error, which does not name the file, if
/// none fits, or if several do and read other points.
[[nodiscard]] TextTable find_dialect(std::string_view begin, bool whole, const TextDialect& given);

/// Returns whether anything is not left to the file.
[[nodiscard]] bool is_given(const TextDialect& dialect);

/// The fault of a row after those that the text declares.
inline constexpr const char* kMoreRows = "more rows follow than the number before them says";

}  // namespace sdm::io
