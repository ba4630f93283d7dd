#include "pipeline/scene/step_clock.hpp"

#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace {

// A time without its unit is in seconds; steps so far apart are of another unit, most likely nanoseconds.
constexpr double kLongStep = 1e4;

}  // namespace

bool StepClock::begins() {
  const std::uint64_t next = std::uint64_t(steps_);
  const bool timed = columns.time != kNoColumn;
  double time = 0;
  if (timed) time = columns.time_unit * csv_.real(columns.time, 1e300, "a finite number");
  std::uint64_t step = next == 0 ? 0 : next - 1;
  if (columns.step != kNoColumn)
    step = csv_.integer(columns.step);
  else if (next > 0 && time != times_.back())
    step = next;
  if (timed && next > 0) check_time(time, step + 1 > next);
  if (step + 1 == next) return false;
  if (step < next)
    csv_.fail("step " + std::to_string(step) + " comes after step " + std::to_string(next - 1) +
              "; steps do not go back");
  if (step > next)
    csv_.fail(next == 0 ? "steps must begin with 0, not " + std::to_string(step)
                        : "step " + std::to_string(step) + " comes after step " + std::to_string(next - 1) +
                              "; no step may be left out");
  if (timed) times_.push_back(time);
  ++steps_;
  return true;
}

void StepClock::check_time(double time, bool fresh) const {
  const double last = times_.back();
  const auto text = [&](double t) { return real_text(t / columns.time_unit); };
  if (!fresh && time != last) csv_.fail("time " + text(time) + " within a step whose time is " + text(last));
  if (fresh && !(time > last)) csv_.fail("time " + text(time) + " comes after " + text(last) + "; times must increase");
  if (fresh && !columns.time_unit_named && time - last > kLongStep)
    csv_.fail("the time is " + text(time - last) +
              " after the step before, in seconds when nothing is said: name the column time_ns, or time_s if it is "
              "meant so");
}

}  // namespace pipeline
