// Errors that name what they are about.
#pragma once

#include <sdm/error.h>

#include <new>
#include <string>

#include "core/printable.h"

namespace sdm::io {

/// Calls `read`. If it throws sdm::Error or runs out of memory, throws an sdm::Error whose message begins
/// with `name`, unless that is empty. It is printable(), whatever the file contains.
template <typename Read>
auto with_error_prefix(const std::string& name, const Read& read) {
  const auto prefix = [&] { return name.empty() ? "" : name + ": "; };
  try {
    return read();
  } catch (const Cancelled&) {
    throw;
  } catch (const Error& fault) {
    throw Error(printable(prefix() + fault.what()));
  } catch (const std::bad_alloc&) {
    throw Error(printable(prefix()) + "there is not enough memory to read it");
  }
}

}  // namespace sdm::io
