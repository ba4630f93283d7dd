#include "pipeline/system/pinned.hpp"

namespace pipeline {
namespace {

cpu_set_t allowed() {
  cpu_set_t set;
  CPU_ZERO(&set);
  sched_getaffinity(0, sizeof set, &set);
  return set;
}

}  // namespace

bool has_processor(std::int64_t number) {
  const cpu_set_t set = allowed();
  return number >= 0 && number < CPU_SETSIZE && CPU_ISSET(std::size_t(number), &set);
}

std::string processors_text() {
  std::string text;
  for (std::int64_t first = 0; first < CPU_SETSIZE; ++first) {
    if (!has_processor(first)) continue;
    std::int64_t last = first;
    while (has_processor(last + 1)) ++last;
    text += (text.empty() ? "" : ", ") + std::to_string(first);
    if (last > first) text += " to " + std::to_string(last);
    first = last;
  }
  return text;
}

Pinned::Pinned(std::optional<std::int64_t> number) : before_(allowed()) {
  if (!number || !has_processor(*number)) return;
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(std::size_t(*number), &one);
  if (sched_setaffinity(0, sizeof one, &one) == 0) processor_ = sched_getcpu();
}

Pinned::~Pinned() {
  if (processor_ >= 0) sched_setaffinity(0, sizeof before_, &before_);
}

}  // namespace pipeline
