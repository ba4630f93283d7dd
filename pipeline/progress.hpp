// A bar on stderr, and the wish to stop.
#pragma once
#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>

namespace pipeline {

/// Set by the first Ctrl-C (or SIGTERM). Stages look at it at every step.
extern std::atomic<bool> stop_wanted;

/// Throws Error(kInterrupted) when a stop is wanted.
void stop_if_wanted();

/// One line "stage  [bar] 40 %  123 steps/s  0:12 left" on a terminal, rewritten at most ten times a second; nothing
/// elsewhere. add() may be called from several threads.
class Progress {
 public:
  Progress(std::string stage, std::uint64_t total, bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `fresh` steps were worked on now; steps taken over from an earlier run do not count into the rate.
  void add(std::uint64_t steps, bool fresh = true);

 private:
  void draw(bool last);

  using Clock = std::chrono::steady_clock;
  std::string stage_;
  std::uint64_t total_, done_ = 0, fresh_ = 0;
  bool shown_;
  Clock::time_point start_ = Clock::now(), drawn_ = {};
  std::mutex mutex_;
};

}  // namespace pipeline
