/// The exceptions that the public functions throw. Kernels never throw.
#pragma once

#include <stdexcept>

namespace sdm {

/// Bad input or a resource that is missing: one sentence that names the thing, the fault and what to do.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A progress callback asked to stop; nothing was produced.
class Cancelled : public Error {
 public:
  Cancelled() : Error("cancelled") {}
};

}  // namespace sdm
