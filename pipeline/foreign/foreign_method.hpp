// A method of others as the rest of the program asks it: the same contract as a method of our own, kept by a process.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "algorithms/contract/algorithm.hpp"
#include "pipeline/foreign/hello.hpp"
#include "pipeline/foreign/process.hpp"
#include "pipeline/system/heap.hpp"

namespace pipeline {

/// What answering once took.
struct ForeignTime {
  std::int64_t time_ns = 0, prepare_ns = 0;  // by its own clock
  std::int64_t exchange_ns = 0;              // by ours, the way there and back included
};

/// Every call may throw Fault; the method is then of no use any more.
class ForeignMethod final : public algorithms::Method {
 public:
  /// Says hello to a new process. `heap` is what that counts of its heap; null: it does not.
  ForeignMethod(std::unique_ptr<Process> process, std::string_view hello, const Budget& budget,
                std::shared_ptr<const HeapCount> heap = nullptr);

  pid_t pid() const { return process_->pid(); }

  const About& about() const { return about_; }

  /// Which step the next questions are about: told to the method for its messages.
  void at(std::uint32_t step) { step_ = step; }

  /// Asks about a step so many times, or for a second, and forgets it.
  void warm_up(std::span<const geometry::Pose> poses, std::span<const geometry::PairRun> runs, int times);

  /// Kept for the question; nothing is sent yet.
  void prepare(std::span<const geometry::Pose> poses, double enlarge = 0) override;

  /// Prepares and answers. The hits are sorted, and pairs of `runs`.
  void answer(std::span<const geometry::PairRun> runs, std::vector<geometry::Pair>& hits) override;

  /// Likewise; 0 where it does not count.
  std::uint64_t count(std::span<const geometry::PairRun> runs, std::vector<geometry::Pair>& hits) override;

  void remember() override;
  void forget() override;

  /// Of the last `answer`.
  const ForeignTime& time() const { return time_; }

  /// Bytes of heap that it held at the most until now; -1: not known.
  std::int64_t greatest_heap() const { return heap_ ? heap_->greatest : about_.memory_bytes; }

  /// Seconds that it has been waited for; those of an earlier process of the same label can be added.
  double waited() const { return before_ + process_->waited(); }
  void add_waited(double seconds) { before_ += seconds; }

 private:
  Process::Answer ask(std::string_view kind, std::string_view content, const Expected& expected, double seconds);
  std::uint64_t reply(std::string_view kind, std::span<const geometry::PairRun> runs,
                      std::vector<geometry::Pair>& hits);

  std::shared_ptr<const HeapCount> heap_;
  std::unique_ptr<Process> process_;
  Budget budget_;
  About about_;
  std::uint32_t step_ = 0;
  double enlarge_ = 0, before_ = 0;
  std::span<const geometry::Pose> poses_;
  ForeignTime time_;
};

/// What a child makes of itself.
struct Hosted {
  About about;  // setup_ns is measured around its making
  std::unique_ptr<algorithms::Method> method;
};

/// A method that runs in a forked child of this process: whatever it does, this process goes on. `make` is called in
/// the child; what it throws, and any other end, is told by a Fault. Its time is taken in the child around prepare and
/// answer. What it prints counts as said on stderr and is not shown.
std::unique_ptr<ForeignMethod> isolated(const std::function<Hosted()>& make, std::size_t bodies, const Budget& budget);

/// A program that speaks frames on its stdin and stdout; `knobs` is a JSON object.
std::unique_ptr<ForeignMethod> started(const Command& command, const std::string& label, const geometry::Bodies& bodies,
                                       const std::string& knobs, const Budget& budget);

}  // namespace pipeline
