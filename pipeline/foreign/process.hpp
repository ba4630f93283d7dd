// A process that answers on a pipe: started, asked, and ended whatever it does.
#pragma once
#include <sys/resource.h>
#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/foreign/frames.hpp"
#include "pipeline/system/file_bytes.hpp"

namespace pipeline {

/// What a method of others may take.
struct Budget {
  double step = 60;                               // s to answer once about a step
  double all = 3600;                              // s in all, its set-up included
  std::uint64_t memory = std::uint64_t{4} << 30;  // bytes of data
};

/// A program as it is started.
struct Command {
  std::vector<std::string> words;  // [0]: with a '/' a file, relative to the folder; else looked for along PATH
  std::filesystem::path folder;    // where it works; empty: where we do
};

/// The file that a command starts; empty when there is none.
std::filesystem::path program_of(const Command& command);

/// A child of ours with pipes at its stdin and stdout; the last that it says on stderr is kept. It is the leader of a
/// group of its own, so that Ctrl-C is ours to judge and those that it starts end with it; and it dies with us.
class Process {
 public:
  /// Starts a program. Its environment is ours; what sizes pools of threads (OMP_NUM_THREADS, ...) is 1 unless it is
  /// set. Throws Fault when it cannot be started, Error(kFile) when no process can be had.
  Process(const Command& command, std::uint64_t memory);

  /// Forks: `work(in, out)` is done in a child, which then ends. What it prints on stdout goes where stderr goes.
  Process(const std::function<void(int in, int out)>& work, std::uint64_t memory);

  /// Closes its stdin, gives it a moment to end by itself, and ends it.
  ~Process();

  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  struct Answer {
    std::string_view content;      // until the next call
    std::int64_t exchange_ns = 0;  // from the first byte sent to the last received
  };

  /// Sends a frame, numbered by the questions before it, and waits for its answer. Throws TooLate when the answer does
  /// not come within so many seconds (those for which all of us were stopped do not count), Fault when it is no such
  /// frame, says FAIL, or more than it follows; or when the process ends. Throws Error(kInterrupted) when a stop is
  /// wanted. After either it is of no use any more.
  Answer ask(std::string_view kind, std::string_view content, Expected expected, double seconds);

  /// Seconds that it has been waited for.
  double waited() const { return waited_; }

  pid_t pid() const { return pid_; }

 private:
  void adopt(pid_t pid);
  /// Why it ended, with what it said last.
  std::string ending();
  [[noreturn]] void fail(const std::string& why);  // ends it
  std::string with_last_words(const std::string& why);
  void hear();

  pid_t pid_ = -1;
  Descriptor in_, out_, said_;
  std::string bytes_, words_;
  std::size_t used_ = 0;     // of bytes_, by the answer given last
  std::uint32_t asked_ = 0;  // questions
  double waited_ = 0;
};

}  // namespace pipeline
