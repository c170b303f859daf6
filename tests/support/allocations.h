// The number of allocations, and their failure.
#pragma once

#include <cstddef>

namespace sdm::test {

/// Calls of operator new in this program so far.
[[nodiscard]] std::size_t allocations();

/// While it exists, one allocation fails, by operator new or of a task of oneTBB: number k of those of all
/// threads after its construction, from 0. One object at a time.
class FailingAllocation {
 public:
  /// The tasks that may fail. Without memory for the first one of a group, oneTBB waits for it forever.
  enum class Tasks { made_by_tasks, all };
  /// `failed`: set by the destructor to whether there were so many. Must outlive this object.
  FailingAllocation(std::size_t k, bool& failed, Tasks tasks = Tasks::made_by_tasks);
  ~FailingAllocation();
  FailingAllocation(const FailingAllocation&) = delete;
  FailingAllocation& operator=(const FailingAllocation&) = delete;

 private:
  std::size_t number_;
  bool& failed_;
};

}  // namespace sdm::test
