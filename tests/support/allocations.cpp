#include "support/allocations.h"

#include <atomic>
#include <limits>

#include "support/allocation_faults.h"

namespace {

constexpr std::size_t kNever = std::numeric_limits<std::size_t>::max();

std::atomic<std::size_t> count = 0;                       // of operator new
std::atomic<std::size_t> attempts = 0, failing = kNever;  // these, and tasks of oneTBB

std::atomic<bool> first_tasks = false;

bool allocation_fails() {
  ++count;
  return sdm::test::allocation_fails();
}

}  // namespace

#include "support/replaced_new.h"  // IWYU pragma: keep, calls allocation_fails()

namespace sdm::test {

bool allocation_fails() {
  return attempts++ == failing;
}

bool first_tasks_may_fail() {
  return first_tasks;
}

std::size_t allocations() {
  return count;
}

FailingAllocation::FailingAllocation(std::size_t k, bool& failed, Tasks tasks)
    : number_(attempts + k), failed_(failed) {
  first_tasks = tasks == Tasks::all;
  failing = number_;
}
FailingAllocation::~FailingAllocation() {
  failing = kNever;
  failed_ = attempts > number_;
}

}  // namespace sdm::test
