// Whether two runs wrote the same file.
#pragma once

#include <string>

namespace sdm::test {

/// Whether two files of a name have the same bytes or, as images, the same values. ISA-L writes other bytes
/// for the same values in one of some hundred processes on processors with AVX-512: PNG and EXR are decoded
/// if bytes differ.
[[nodiscard]] bool same_contents(const std::string& name, const std::string& text, const std::string& other);

}  // namespace sdm::test
