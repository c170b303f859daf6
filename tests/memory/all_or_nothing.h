// Changes during which one allocation fails: each in turn.
#pragma once

#include <gtest/gtest.h>
#include <sdm/error.h>
#include <sdm/execution.h>
#include <sdm/mesh.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <new>
#include <optional>
#include <thread>
#include <vector>

#include "support/allocations.h"

namespace sdm::test {

/// Allocates without operator new: what a test notes while an allocation is to fail.
template <class Item>
struct Unfailing {
  using value_type = Item;
  Unfailing() = default;
  template <class Other>
  explicit Unfailing(const Unfailing<Other>&) {}
  [[nodiscard]] Item* allocate(std::size_t count) {
    return static_cast<Item*>(std::malloc(count * sizeof(Item)));
  }
  void deallocate(Item* items, std::size_t) { std::free(items); }
  friend bool operator==(const Unfailing&, const Unfailing&) { return true; }
};

/// What one call returns, as numbers.
class Numbers {
 public:
  template <class Number>
  requires std::is_arithmetic_v<Number> || std::is_enum_v<Number>
  void add(Number number) { numbers_.push_back(static_cast<double>(number)); }
  void add(const Mesh& mesh) {
    add(mesh.positions);
    add(mesh.triangles);
    add(mesh.corner_uvs);
  }
  template <class Range>
  requires requires(const Range& range) {
    range.begin();
    range.end();
  }
  void add(const Range& range) {
    add(std::size(range));
    for (const auto& item : range) add(item);
  }
  template <class Item>
  void add(const std::optional<Item>& item) {
    add(item.has_value());
    if (item) add(*item);
  }
  template <class... Items>
  requires(sizeof...(Items) > 1) void add(const Items&... items) { (add(items), ...); }

  /// NaN equals NaN.
  friend bool operator==(const Numbers& a, const Numbers& b) {
    return std::ranges::equal(a.numbers_, b.numbers_,
                              [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); });
  }

 private:
  std::vector<double, Unfailing<double>> numbers_;
};

template <class... Items>
Numbers numbers_of(const Items&... items) {
  Numbers numbers;
  (numbers.add(items), ...);
  return numbers;
}

/// The public calls by which an object is observed, each by itself.
template <class Object>
using Calls = std::vector<std::function<Numbers(Object&)>>;

/// The results of the calls; none where one throws sdm::Error.
template <class Object>
std::vector<std::optional<Numbers>> observe(Object& object, const Calls<Object>& calls) {
  std::vector<std::optional<Numbers>> results;
  for (const auto& call : calls) {
    results.emplace_back();
    try {
      results.back() = call(object);
    } catch (const Error&) {
    }
  }
  return results;
}

/// What a failed change may leave: the object as it was, or one that throws at every call.
enum class Guarantee { unchanged, unchanged_or_broken };

/// Whether changes run in threads of their own, in which the memory that threads keep is yet to be allocated,
/// or in one, in which it stays what the failure before left.
enum class Memory { of_new_thread, of_this_thread };

/// Calls `work`, and returns whether it threw sdm::Error.
inline bool throws_error(Memory memory, const std::function<void()>& work) {
  bool threw = false;
  const auto attempt = [&] {
    try {
      work();
    } catch (const Error&) {
      threw = true;
    } catch (const std::bad_alloc&) {
      threw = true;
      ADD_FAILURE() << "std::bad_alloc, which public functions translate";
    }
  };
  if (memory == Memory::of_new_thread)
    std::jthread{attempt};
  else
    attempt();
  return threw;
}

/// Makes an object, fails the k-th allocation of a change to it, for every k, and compares with an untouched
/// one. Returns how many of the failures left a broken object.
template <class Make, class Object = typename std::invoke_result_t<Make>::element_type>
std::size_t expect_all_or_nothing(const Make& make, const std::function<void(Object&)>& change,
                                  const Calls<Object>& calls, Guarantee guarantee,
                                  FailingAllocation::Tasks tasks = FailingAllocation::Tasks::made_by_tasks) {
  const ThreadLimit one(1);
  const auto untouched = observe(*make(), calls);
  const auto changed_object = make();
  change(*changed_object);
  const auto changed = observe(*changed_object, calls);
  EXPECT_FALSE(untouched == changed) << "the change does nothing";

  std::size_t failures = 0, broken = 0;
  for (const Memory memory : {Memory::of_new_thread, Memory::of_this_thread}) {
    bool failed = true;
    for (std::size_t k = 0; failed; ++k) {
      SCOPED_TRACE(k);
      const auto object = make();
      bool threw = throws_error(memory, [&] {
        const FailingAllocation failing(k, failed, tasks);
        change(*object);
      });
      if (!threw) {  // memory that is only wanted, as by std::stable_sort, may be missing
        EXPECT_TRUE(observe(*object, calls) == changed);
        continue;
      }
      ++failures;
      const auto left = observe(*object, calls);
      if (std::ranges::none_of(left, [](const auto& result) { return result.has_value(); })) {
        ++broken;
        EXPECT_EQ(guarantee, Guarantee::unchanged_or_broken);
        EXPECT_THROW(change(*object), Error);
        continue;
      }
      EXPECT_TRUE(left == untouched);
      change(*object);
      EXPECT_TRUE(observe(*object, calls) == changed) << "after another attempt";
    }
  }
  EXPECT_GT(failures, 0u);
  return broken;
}

/// Fails the k-th allocation of a call that changes nothing, for every k. Each time it must throw sdm::Error
/// or return its result, and afterwards return that result.
template <class Make, class Object = typename std::invoke_result_t<Make>::element_type>
void expect_repeatable(const Make& make, const std::function<Numbers(Object&)>& call) {
  const ThreadLimit one(1);
  const Numbers result = call(*make());
  for (const Memory memory : {Memory::of_new_thread, Memory::of_this_thread}) {
    bool failed = true;
    for (std::size_t k = 0; failed; ++k) {
      SCOPED_TRACE(k);
      const auto object = make();
      Numbers found;
      const bool threw = throws_error(memory, [&] {
        const FailingAllocation failing(k, failed);
        found = call(*object);
      });
      EXPECT_TRUE(threw || found == result);
      EXPECT_TRUE(call(*object) == result);
    }
  }
}

}  // namespace sdm::test
