// How far a stage is, on stderr, and the wish to stop.
#pragma once
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <mutex>
#include <string>

#include "pipeline/terminal/forecast.hpp"

namespace pipeline {

/// Set by the first Ctrl-C (or SIGTERM). Stages look at it at every step.
extern std::atomic<bool> stop_wanted;

/// Throws Error(kInterrupted) when a stop is wanted.
void stop_if_wanted();

/// Where progress is shown, and how.
struct Shown {
  std::FILE* to = nullptr;                 // null: nowhere
  bool bar = false;                        // one line that is rewritten, at most ten times a second
  std::chrono::milliseconds every{30000};  // else a line so often, counted from the start of the program

  /// On stderr: a bar on a terminal, else lines; nothing when quiet.
  static Shown on_stderr(bool quiet);
};

/// "motion   [####......]  40 %  123 steps/s  about 0:12 left of the run" of a stage with that many items. The time
/// left is that of the whole run where `forecast` knows the stage, else of the stage. add() may be called from several
/// threads.
class Progress {
 public:
  Progress(std::string stage, std::uint64_t total, Shown shown, Forecast* forecast = nullptr,
           std::string item = "step");
  Progress(std::string stage, std::uint64_t total, bool quiet, Forecast* forecast = nullptr, std::string item = "step")
      : Progress(std::move(stage), total, Shown::on_stderr(quiet), forecast, std::move(item)) {}
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `fresh` items were worked on now; items taken over from an earlier run do not count into the rate.
  void add(std::uint64_t items, bool fresh = true);

  /// Shows how far it is without anything more being done: for items that take long.
  void tick() { add(0, false); }

  /// A line of its own: what it waits for.
  void say(const std::string& line);

 private:
  using Clock = std::chrono::steady_clock;
  void draw(Clock::time_point now, bool last);
  std::string left_text(Clock::time_point now) const;

  std::string stage_, item_;
  std::uint64_t total_, done_ = 0, fresh_ = 0;
  Shown shown_;
  Forecast own_, *forecast_;
  Clock::time_point start_ = Clock::now(), added_ = start_, drawn_ = {};
  std::clock_t spent_ = std::clock();  // processor time of the program at the start
  std::mutex mutex_;
};

/// "12 steps/s", "0.7 s/step"; slow work never shows as 0.
std::string rate_text(double items, double seconds, const std::string& item);

/// "0:12", "1:02:03".
std::string clock_text(double seconds);

}  // namespace pipeline
