// The machine that a run's times belong to.
#pragma once

#include <string>

#include "research/figures/figure.h"

namespace sdm::figures {

struct Machine {
  std::string processor{}, system{}, compiler{};
  unsigned cores = 0;                    ///< that the process may use
  unsigned threads = 0;                  ///< that the library uses
  double memory_gb = 0;                  ///< 0: unknown
  std::string gl_device{}, gl_driver{};  ///< of the gl engine; empty without one
  bool gl_software = false;              ///< it draws on the processor

  /// "llvmpipe (...), a software rasteriser on the processor, not a GPU", or the name of the GPU.
  [[nodiscard]] std::string gl_text() const;
};

/// Describes this machine, and the device that the gl engine uses, if there is one.
[[nodiscard]] Machine this_machine();

[[nodiscard]] Json to_json(const Machine& machine);

}  // namespace sdm::figures
