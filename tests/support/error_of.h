// The message of the error that a call throws.
#pragma once

#include <sdm/error.h>

#include <string>

namespace sdm::test {

/// The message of the Error that the call throws; empty if it throws none.
template <class Call>
std::string error_of(Call call) {
  try {
    (void)call();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

}  // namespace sdm::test
