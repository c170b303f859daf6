// What the modules import from JavaScript (js/src/host.ts).
#pragma once

extern "C" {

#define SDM_IMPORT(name) __attribute__((import_module("host"), import_name(#name)))

/// The number of threads that may work at once; 1 without shared memory.
SDM_IMPORT(threads) int sdm_host_threads();
/// Lets an idle worker call sdm_run_thread() with the argument. Returns 0 if there is none.
SDM_IMPORT(start_thread) int sdm_host_start_thread(void* argument);
/// Whether a thread has failed, so that what others wait for may never happen.
SDM_IMPORT(thread_failed) int sdm_host_thread_failed();
/// Milliseconds since some time.
SDM_IMPORT(now) double sdm_host_now();
/// Whether the caller wants the call to go on, from a callback of progress.
SDM_IMPORT(progress) int sdm_host_progress(const char* step, int length, double fraction);
}
