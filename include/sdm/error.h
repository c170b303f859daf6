/// The exceptions that the public functions throw. Kernels never throw.
#pragma once

#include <stdexcept>

namespace sdm {

/// Invalid input or a missing resource: one sentence that names the object, the fault and the remedy.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A progress callback requested cancellation; there is no result.
class Cancelled : public Error {
 public:
  Cancelled() : Error("cancelled") {}
};

}  // namespace sdm
