// Two works against each other.
#pragma once

#include <vector>

#include "cases.h"
#include "map_task.h"
#include "measure.h"

namespace sdm::bench {

/// A contender, and the texels that its work fills in: 0 if it does something else.
struct Side {
  Contender contender;
  std::size_t texels = 0;
};

/// Measures the time of the peer over ours, and fills in `asked` with it.
[[nodiscard]] Outcome race(const Trial& trial, const Side& ours, const Side& peer, Figure asked);

/// Maps that are measured together, one after another.
using Tasks = std::vector<MapTask*>;

[[nodiscard]] bool all_agree(const Tasks& tasks);
[[nodiscard]] cpu::DescentCounts work_of(const Tasks& tasks);
[[nodiscard]] Side ours(const Tasks& tasks, unsigned threads = 1);
[[nodiscard]] Side embree(const Tasks& tasks);

}  // namespace sdm::bench
