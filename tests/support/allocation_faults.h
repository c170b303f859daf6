// What FailingAllocation has asked for, for the functions that allocate.
#pragma once

namespace sdm::test {

/// Counts an attempt to allocate, and returns whether it is the one that is to fail.
[[nodiscard]] bool allocation_fails();
/// FailingAllocation::Tasks::all.
[[nodiscard]] bool first_tasks_may_fail();

}  // namespace sdm::test
