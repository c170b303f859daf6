/// Text from files, and names of files, in messages and on terminals.
///
/// Threads: the function may be called concurrently.
#pragma once

#include <sdm/types.h>

#include <string>
#include <string_view>

namespace sdm {

/// Returns `text` (UTF-8) with everything escaped that a terminal would obey or show in another order:
/// control characters, line ends and tabs included, and the marks of writing direction become `\u` and four
/// hexadecimal digits, bytes that are not UTF-8 `\x` and two. Text that has none is returned unchanged, so
/// escaping twice changes nothing. Cost: linear.
[[nodiscard]] SDM_API std::string printable(std::string_view text);

}  // namespace sdm
