// Work on several threads.
#pragma once
#include <time.h>

#include <algorithm>
#include <cstddef>
#include <exception>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "pipeline/terminal/error.hpp"

namespace pipeline {

/// `wanted`, or for 0 as many as there are cores.
inline int thread_count(int wanted) {
  return wanted > 0 ? wanted : int(std::max(1u, std::thread::hardware_concurrency()));
}

/// Seconds of processor time that this thread has spent.
inline double processor_seconds() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

/// Calls work() on that many threads at once, this one among them. One that throws calls stop(), which should end the
/// others; what the first of them threw is thrown on when all have ended.
template <class Work, class Stop>
void on_threads(std::size_t threads, const Work& work, const Stop& stop) {
  std::vector<std::exception_ptr> errors(threads);
  const auto guarded = [&](std::size_t thread) {
    try {
      work();
    } catch (...) {
      errors[thread] = std::current_exception();
      stop();
    }
  };
  std::vector<std::jthread> others;
  try {
    for (std::size_t thread = 1; thread < threads; ++thread) others.emplace_back(guarded, thread);
  } catch (const std::system_error& error) {
    stop();
    const std::size_t started = others.size() + 1;
    others.clear();
    throw Error(kFile, "threads: only " + std::to_string(started) + " of " + std::to_string(threads) +
                           " could start (" + error.code().message() +
                           "); give fewer --threads, or raise the limits of this shell (ulimit -u, -v)");
  }
  guarded(0);
  others.clear();  // joins
  for (const std::exception_ptr& error : errors)
    if (error) std::rethrow_exception(error);
}

}  // namespace pipeline
