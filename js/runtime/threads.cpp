// The threads of libc++ (__external_threading) on the atomic instructions of WebAssembly. Without shared
// memory, there is one thread: what would wait for another one is an error.
#include <__external_threading>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <new>

#include "runtime/host.h"

namespace {

/// Whether this module shares its memory with others: those of the threads.
bool shared() {
  return sdm_host_threads() > 1;
}

/// Ends this thread, too, if one has failed that it may be waiting for.
void end_with_failed_threads() {
  if (sdm_host_thread_failed()) std::abort();
}

/// Waits while the word has the value, until it is woken or the time is over.
void wait(int* word, int value, std::int64_t nanoseconds) {
  if (!shared()) return;
  __builtin_wasm_memory_atomic_wait32(word, value, nanoseconds);
  end_with_failed_threads();
}

/// The same without a time, but wakes may be spurious: callers look again. Node 20 loses notifications now
/// and then where two threads contend, so that waits end by themselves, later and later while nothing
/// happens.
void wait(int* word, int value) {
  constexpr std::int64_t kLeast = 1'000'000, kMost = 256'000'000;
  constexpr int kTimedOut = 2;
  thread_local std::int64_t patience = kLeast;
  if (!shared()) std::abort();  // nobody could change it
  const bool idle = __builtin_wasm_memory_atomic_wait32(word, value, patience) == kTimedOut;
  patience = idle ? std::min(2 * patience, kMost) : kLeast;
  end_with_failed_threads();
}
void wake(int* word, unsigned count) {
  if (shared()) __builtin_wasm_memory_atomic_notify(word, count);
}

constexpr unsigned kAll = ~0u;

std::atomic<unsigned> last_id{1};
thread_local unsigned this_id = 0;

}  // namespace

_LIBCPP_BEGIN_NAMESPACE_STD

/// Of a thread and who joins it: whoever lets go of it last frees it.
struct __sdm_thread {
  void* (*function)(void*);
  void* argument;
  unsigned id;
  int ended = 0;  ///< a word to wait for
  std::atomic<int> owners{2};
};

static void let_go(__sdm_thread* thread) {
  if (thread->owners.fetch_sub(1) == 1) delete thread;
}

/// Called by the host in the new thread.
extern "C" __attribute__((export_name("sdm_run_thread"))) void sdm_run_thread(__sdm_thread* thread) {
  this_id = thread->id;
  thread->function(thread->argument);
  __atomic_store_n(&thread->ended, 1, __ATOMIC_SEQ_CST);
  wake(&thread->ended, kAll);
  let_go(thread);
}

// A mutex after Drepper, Futexes Are Tricky, 2011, mutex 2.
int __libcpp_mutex_lock(__libcpp_mutex_t* m) {
  int free = 0;
  if (__atomic_compare_exchange_n(m, &free, 1, false, __ATOMIC_ACQUIRE, __ATOMIC_RELAXED)) return 0;
  while (__atomic_exchange_n(m, 2, __ATOMIC_ACQUIRE) != 0) wait(m, 2);
  return 0;
}
bool __libcpp_mutex_trylock(__libcpp_mutex_t* m) {
  int free = 0;
  return __atomic_compare_exchange_n(m, &free, 1, false, __ATOMIC_ACQUIRE, __ATOMIC_RELAXED);
}
int __libcpp_mutex_unlock(__libcpp_mutex_t* m) {
  if (__atomic_exchange_n(m, 0, __ATOMIC_RELEASE) == 2) wake(m, 1);
  return 0;
}
int __libcpp_mutex_destroy(__libcpp_mutex_t*) {
  return 0;
}

int __libcpp_recursive_mutex_init(__libcpp_recursive_mutex_t* m) {
  *m = {0, 0, 0};
  return 0;
}
int __libcpp_recursive_mutex_lock(__libcpp_recursive_mutex_t* m) {
  const unsigned id = __libcpp_thread_get_current_id();
  if (__atomic_load_n(&m->owner, __ATOMIC_RELAXED) != id) {
    __libcpp_mutex_lock(&m->mutex);
    __atomic_store_n(&m->owner, id, __ATOMIC_RELAXED);
  }
  ++m->depth;
  return 0;
}
bool __libcpp_recursive_mutex_trylock(__libcpp_recursive_mutex_t* m) {
  const unsigned id = __libcpp_thread_get_current_id();
  if (__atomic_load_n(&m->owner, __ATOMIC_RELAXED) != id) {
    if (!__libcpp_mutex_trylock(&m->mutex)) return false;
    __atomic_store_n(&m->owner, id, __ATOMIC_RELAXED);
  }
  ++m->depth;
  return true;
}
int __libcpp_recursive_mutex_unlock(__libcpp_recursive_mutex_t* m) {
  if (--m->depth > 0) return 0;
  __atomic_store_n(&m->owner, 0u, __ATOMIC_RELAXED);
  return __libcpp_mutex_unlock(&m->mutex);
}
int __libcpp_recursive_mutex_destroy(__libcpp_recursive_mutex_t*) {
  return 0;
}

// A notification changes the number, so that who has read it before does not begin to wait.
int __libcpp_condvar_signal(__libcpp_condvar_t* c) {
  __atomic_fetch_add(c, 1, __ATOMIC_SEQ_CST);
  wake(c, 1);
  return 0;
}
int __libcpp_condvar_broadcast(__libcpp_condvar_t* c) {
  __atomic_fetch_add(c, 1, __ATOMIC_SEQ_CST);
  wake(c, kAll);
  return 0;
}
int __libcpp_condvar_wait(__libcpp_condvar_t* c, __libcpp_mutex_t* m) {
  const int before = __atomic_load_n(c, __ATOMIC_SEQ_CST);
  __libcpp_mutex_unlock(m);
  wait(c, before);
  return __libcpp_mutex_lock(m);
}
int __libcpp_condvar_timedwait(__libcpp_condvar_t* c, __libcpp_mutex_t* m, __libcpp_timespec_t* until) {
  const int before = __atomic_load_n(c, __ATOMIC_SEQ_CST);
  timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  const std::int64_t left =
      (until->tv_sec - now.tv_sec) * std::int64_t{1000000000} + (until->tv_nsec - now.tv_nsec);
  __libcpp_mutex_unlock(m);
  if (left > 0) wait(c, before, left);
  __libcpp_mutex_lock(m);
  return left > 0 ? 0 : ETIMEDOUT;
}
int __libcpp_condvar_destroy(__libcpp_condvar_t*) {
  return 0;
}

int __libcpp_execute_once(__libcpp_exec_once_flag* flag, void (*function)()) {
  int state = 0;
  if (__atomic_compare_exchange_n(flag, &state, 1, false, __ATOMIC_ACQUIRE, __ATOMIC_ACQUIRE)) {
    function();
    __atomic_store_n(flag, 2, __ATOMIC_RELEASE);
    wake(flag, kAll);
  } else {
    while (__atomic_load_n(flag, __ATOMIC_ACQUIRE) != 2) wait(flag, 1);
  }
  return 0;
}

bool __libcpp_thread_id_equal(__libcpp_thread_id a, __libcpp_thread_id b) {
  return a == b;
}
bool __libcpp_thread_id_less(__libcpp_thread_id a, __libcpp_thread_id b) {
  return a < b;
}
bool __libcpp_thread_isnull(const __libcpp_thread_t* t) {
  return *t == nullptr;
}
__libcpp_thread_id __libcpp_thread_get_current_id() {
  if (this_id == 0) this_id = last_id.fetch_add(1);
  return this_id;
}
__libcpp_thread_id __libcpp_thread_get_id(const __libcpp_thread_t* t) {
  return *t ? (*t)->id : 0;
}

int __libcpp_thread_create(__libcpp_thread_t* t, void* (*function)(void*), void* argument) {
  auto* thread = new (std::nothrow) __sdm_thread{function, argument, last_id.fetch_add(1)};
  if (!thread) return EAGAIN;
  if (!shared() || !sdm_host_start_thread(thread)) {
    delete thread;
    return EAGAIN;
  }
  *t = thread;
  return 0;
}
int __libcpp_thread_join(__libcpp_thread_t* t) {
  while (__atomic_load_n(&(*t)->ended, __ATOMIC_SEQ_CST) == 0) wait(&(*t)->ended, 0);
  return __libcpp_thread_detach(t);
}
int __libcpp_thread_detach(__libcpp_thread_t* t) {
  let_go(*t);
  *t = nullptr;
  return 0;
}
void __libcpp_thread_yield() {}
void __libcpp_thread_sleep_for(const chrono::nanoseconds& time) {
  int word = 0;
  wait(&word, 0, std::max<std::int64_t>(0, time.count()));
}

// Keys of libc++abi's and the library's own threads; values are not destroyed, as threads do not end.
namespace {
constexpr unsigned kKeys = 16;
std::atomic<unsigned> keys{0};
thread_local void* values[kKeys];
}  // namespace

int __libcpp_tls_create(__libcpp_tls_key* key, void (*)(void*)) {
  *key = keys.fetch_add(1);
  return *key < kKeys ? 0 : EAGAIN;
}
void* __libcpp_tls_get(__libcpp_tls_key key) {
  return values[key];
}
int __libcpp_tls_set(__libcpp_tls_key key, void* value) {
  values[key] = value;
  return 0;
}

_LIBCPP_END_NAMESPACE_STD
