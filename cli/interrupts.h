// Interrupts of the command: Ctrl-C (SIGINT), SIGTERM and SIGHUP.
#pragma once

#include <sdm/execution.h>

/// During its lifetime, which is that of the program, the first interrupt cancels the work: the library polls
/// a flag (sdm::CancelScope). Where it does not stop in time, a thread ends the program, after removing what
/// output folders have staged: half a second later if it waits, as in a system call that blocks, and at most
/// three seconds later. A second interrupt
/// terminates at once. Interrupts that were ignored before, as under nohup, stay ignored.
class Interrupts {
 public:
  Interrupts();
  ~Interrupts();
  Interrupts(const Interrupts&) = delete;
  Interrupts& operator=(const Interrupts&) = delete;

  [[nodiscard]] static bool received();
  /// Terminates the program with the signal that interrupted it, so that a loop in a shell script ends too.
  /// Returns if there was none. To be called after the cleanup.
  static void end();

  /// Work that an interrupt must not cut off, such as moving files into place or keeping what is finished:
  /// during its lifetime the library does not poll, and the program goes on after that time. Only on
  /// the main thread.
  class Protected {
   public:
    Protected();
    ~Protected();
    Protected(const Protected&) = delete;
    Protected& operator=(const Protected&) = delete;

   private:
    sdm::CancelScope scope_;
  };

 private:
  sdm::CancelScope scope_;
};
