#include "pipeline/terminal/progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <ctime>

#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/print.hpp"

namespace pipeline {

std::atomic<bool> stop_wanted = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets it");

void stop_if_wanted() {
  if (stop_wanted)
    throw Error(kInterrupted, "interrupted; the same command resumes a run and begins anything else anew");
}

Shown Shown::on_stderr(bool quiet) {
  if (quiet) return {};
  return {.to = stderr, .bar = isatty(STDERR_FILENO) != 0};
}

std::string rate_text(double items, double seconds, const std::string& item) {
  if (items <= 0 || seconds <= 0) return "";
  const double rate = items / seconds;
  if (rate >= 1) return print(rate < 10 ? "%.1f " : "%.0f ", rate) + item + "s/s";
  return print(rate > 0.1 ? "%.1f s/" : "%.0f s/", 1 / rate) + item;
}

std::string clock_text(double seconds) {
  const long all = long(seconds + 0.5), minutes = all / 60;
  if (minutes < 60) return print("%ld:%02ld", minutes, all % 60);
  return print("%ld:%02ld:%02ld", minutes / 60, minutes % 60, all % 60);
}

namespace {

/// When a line was last written without a terminal: runs of many short stages say something too.
std::chrono::steady_clock::time_point last_line = std::chrono::steady_clock::now();

}  // namespace

Progress::Progress(std::string stage, std::uint64_t total, Shown shown, Forecast* forecast, std::string item)
    : stage_(std::move(stage)),
      item_(std::move(item)),
      total_(total),
      shown_(shown),
      forecast_(forecast ? forecast : &own_) {
  if (!shown_.to) return;
  forecast_->begin(stage_, total_);
  if (shown_.bar) draw(start_, false);
}

Progress::~Progress() {
  if (shown_.bar) draw(Clock::now(), true);
}

void Progress::add(std::uint64_t items, bool fresh) {
  if (!shown_.to) return;
  const std::lock_guard lock(mutex_);
  const auto now = Clock::now();
  if (items > 0) {
    done_ += items;
    if (fresh) fresh_ += items;
    const double spent = double(std::clock() - spent_) / CLOCKS_PER_SEC;
    const double busy = spent > 0.1 ? std::chrono::duration<double>(now - start_).count() / spent : 0;
    forecast_->done(items, std::chrono::duration<double>(now - added_).count(), fresh, busy);
    added_ = now;
  }
  if (shown_.bar ? now - drawn_ > std::chrono::milliseconds(100) : now - last_line >= shown_.every) draw(now, false);
}

void Progress::say(const std::string& line) {
  if (!shown_.to) return;
  const std::lock_guard lock(mutex_);
  std::fprintf(shown_.to, shown_.bar ? "\r\033[K%s\n" : "%s\n", line.c_str());
  std::fflush(shown_.to);
}

std::string Progress::left_text(Clock::time_point now) const {
  const std::optional<double> left = forecast_->left();
  if (!left) return "";
  const double under_way = std::chrono::duration<double>(now - added_).count();
  return "about " + clock_text(std::max(0.0, *left - under_way)) + " left" + (forecast_->whole() ? " of the run" : "");
}

void Progress::draw(Clock::time_point now, bool last) {
  const double seconds = std::chrono::duration<double>(now - start_).count();
  const double share = total_ ? double(done_) / double(total_) : 1;
  const std::string rate = rate_text(double(fresh_), seconds, item_);
  if (shown_.bar) {
    constexpr int kWidth = 30;
    drawn_ = now;
    std::string bar(std::size_t(share * kWidth), '#');
    bar.resize(kWidth, '.');
    const std::string end = last ? print("%.1f s\n", seconds) : left_text(now);
    std::fprintf(shown_.to, "\r\033[K%-8s [%s] %3.0f %%  %s  %s", stage_.c_str(), bar.c_str(), 100 * share,
                 rate.c_str(), end.c_str());
  } else {
    last_line = now;
    const std::string left = left_text(now);
    std::fprintf(shown_.to, "%s %.0f %%%s%s\n", stage_.c_str(), 100 * share, rate.empty() ? "" : (", " + rate).c_str(),
                 left.empty() ? "" : (", " + left).c_str());
  }
  std::fflush(shown_.to);
}

}  // namespace pipeline
