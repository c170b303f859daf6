// Words of a file in messages.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace sdm::core {

/// Returns the beginning of `text`, at most `most` bytes before they are escaped as by printable(), and "..."
/// if there is more. Every message that quotes a file passes the words through it.
[[nodiscard]] std::string excerpt(std::string_view text, std::size_t most = 64);

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
