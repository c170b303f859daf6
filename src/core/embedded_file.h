// A file that the build compiles into the program.
#pragma once

#include <string_view>

namespace sdm::core {

struct EmbeddedFile {
  std::string_view name;   ///< without its folder
  std::string_view bytes;  ///< valid for the lifetime of the program
};

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
