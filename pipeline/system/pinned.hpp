// A thread that stays on one processor, as timings may want it.
#pragma once
#include <sched.h>

#include <cstdint>
#include <optional>
#include <string>

namespace pipeline {

/// Whether this process may use the processor of that number.
bool has_processor(std::int64_t number);

/// Those that it may use: "0 to 3, 8".
std::string processors_text();

/// Keeps the thread that makes it on one processor while it lives; without a number, or of one that it may not use, it
/// does nothing.
class Pinned {
 public:
  explicit Pinned(std::optional<std::int64_t> number);
  ~Pinned();
  Pinned(const Pinned&) = delete;
  Pinned& operator=(const Pinned&) = delete;

  /// The processor it runs on; -1: any.
  std::int64_t processor() const { return processor_; }

 private:
  cpu_set_t before_;
  std::int64_t processor_ = -1;
};

}  // namespace pipeline
