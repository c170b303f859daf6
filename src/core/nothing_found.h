// Searches without a limit always find something, unless a shape was stored with forged numbers.
#pragma once

#include <sdm/error.h>

namespace sdm::core {

[[noreturn]] inline void throw_nothing_found() {
  throw Error(
      "a search found nothing: the shape was stored with wrong numbers; build it again from its mesh");
}

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
