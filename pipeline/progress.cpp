#include "pipeline/progress.hpp"

#include <unistd.h>

#include <cstdio>

#include "pipeline/error.hpp"

namespace pipeline {

std::atomic<bool> stop_wanted = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets it");

void stop_if_wanted() {
  if (stop_wanted) throw Error(kInterrupted, "interrupted; the same command resumes a run and begins anything else anew");
}

Progress::Progress(std::string stage, std::uint64_t total, bool quiet)
    : stage_(std::move(stage)), total_(total), shown_(!quiet && isatty(STDERR_FILENO)) {
  if (shown_) draw(false);
}

Progress::~Progress() {
  if (shown_) draw(true);
}

void Progress::add(std::uint64_t steps, bool fresh) {
  const std::lock_guard lock(mutex_);
  done_ += steps;
  if (fresh) fresh_ += steps;
  if (shown_ && Clock::now() - drawn_ > std::chrono::milliseconds(100)) draw(false);
}

void Progress::draw(bool last) {
  constexpr int kWidth = 30;
  drawn_ = Clock::now();
  const double seconds = std::chrono::duration<double>(drawn_ - start_).count();
  const double rate = seconds > 0 ? double(fresh_) / seconds : 0;
  const double share = total_ ? double(done_) / double(total_) : 1;
  std::string bar(std::size_t(share * kWidth), '#');
  bar.resize(kWidth, '.');
  const long left = rate > 0 ? long(double(total_ - done_) / rate + 0.5) : 0;
  std::fprintf(stderr, "\r\033[K%-8s [%s] %3.0f %%  %.0f steps/s  ", stage_.c_str(), bar.c_str(), 100 * share, rate);
  if (last)
    std::fprintf(stderr, "%.1f s\n", seconds);
  else if (rate > 0)
    std::fprintf(stderr, "%ld:%02ld left", left / 60, left % 60);
  std::fflush(stderr);
}

}  // namespace pipeline
