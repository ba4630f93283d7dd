// Work in child processes: what aborts, crashes or hangs there ends that one job only.
#pragma once
#include <cstddef>
#include <functional>
#include <string>

namespace pipeline {

/// When a job is ended from outside.
struct ChildLimits {
  double processor_seconds = 60;  // rounded up to a whole second
  double wall_seconds = 600;      // without those for which the whole program was stopped (Ctrl-Z)
};

/// How a process ended: "aborted", "crashed by signal 11", "ended with code 1". `status` as waitpid gives it.
std::string ended_text(int status);

/// Jobs 0 to `count` - 1, each in a child process of its own, at most `processes` at a time. `work` runs in the child
/// and gives bytes; `done` in this process, in the order in which jobs end, with the bytes, or with none and why:
/// "aborted: what it said last on stderr", "crashed by signal 11", "more than 60 s of processor time", .... The child's
/// stdout and stderr are not shown. Throws Error(kInterrupted) when a stop is wanted, and whatever `done` throws; no
/// child is left then. To be called while this process has one thread.
void in_children(std::size_t count, int processes, const ChildLimits& limits,
                 const std::function<std::string(std::size_t)>& work,
                 const std::function<void(std::size_t, const std::string& bytes, const std::string& failure)>& done);

}  // namespace pipeline
