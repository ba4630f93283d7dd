#include "pipeline/foreign/foreign_method.hpp"

#include <sys/mman.h>

#include <algorithm>
#include <cmath>
#include <new>

#include "pipeline/foreign/host.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {

using geometry::Bodies;
using geometry::Pair;
using geometry::PairRun;
using geometry::Pose;

ForeignMethod::ForeignMethod(std::unique_ptr<Process> process, std::string_view hello, const Budget& budget,
                             std::shared_ptr<const HeapCount> heap)
    : heap_(std::move(heap)), process_(std::move(process)), budget_(budget) {
  const Process::Answer answer = ask("HELO", hello, {"HELO", kMostHelloAnswer}, budget_.all);
  about_ = about_in(answer.content);
  if (about_.setup_ns > answer.exchange_ns)
    throw Fault("its hello: a set-up of " + std::to_string(about_.setup_ns) + " ns is longer than the exchange, " +
                std::to_string(answer.exchange_ns) + " ns");
}

Process::Answer ForeignMethod::ask(std::string_view kind, std::string_view content, const Expected& expected,
                                   double seconds) {
  const double left = budget_.all - waited();
  const Fault all("more than " + real_text(budget_.all) + " s in all");
  if (left <= 0) throw all;
  try {
    return process_->ask(kind, content, expected, std::min(seconds, left));
  } catch (const TooLate&) {
    if (left <= seconds) throw all;
    throw;
  }
}

void ForeignMethod::warm_up(std::span<const Pose> poses, std::span<const PairRun> runs, int times) {
  constexpr double kEnough = 1;  // s
  const double start = waited();
  std::vector<Pair> hits;
  prepare(poses);
  for (int i = 0; i < times && waited() - start < kEnough; ++i) {
    hits.clear();
    answer(runs, hits);
  }
  forget();
}

void ForeignMethod::prepare(std::span<const Pose> poses, double enlarge) {
  poses_ = poses;
  enlarge_ = enlarge;
}

std::uint64_t ForeignMethod::reply(std::string_view kind, std::span<const PairRun> runs, std::vector<Pair>& hits) {
  const std::uint64_t asked = geometry::pair_count(runs);
  const Process::Answer answer =
      ask(kind, content_of(step_, enlarge_, poses_, runs), {"HITS", kReplyHead + asked * sizeof(Pair)}, budget_.step);
  Reply said = reply_in(answer.content);
  if (said.time_ns > double(answer.exchange_ns))
    throw Fault("its time is " + real_text(said.time_ns) + " ns, longer than the exchange, " +
                std::to_string(answer.exchange_ns) + " ns");
  if (const std::string flaw = flaw_of(said.hits, runs, poses_); !flaw.empty()) throw Fault(flaw);
  time_ = {std::llround(said.time_ns), std::llround(said.prepare_ns), answer.exchange_ns};
  hits.insert(hits.end(), said.hits.begin(), said.hits.end());
  return static_cast<std::uint64_t>(said.operations);
}

void ForeignMethod::answer(std::span<const PairRun> runs, std::vector<Pair>& hits) { reply("STEP", runs, hits); }

std::uint64_t ForeignMethod::count(std::span<const PairRun> runs, std::vector<Pair>& hits) {
  if (!about_.operations_unit.empty()) return reply("OPER", runs, hits);
  reply("STEP", runs, hits);
  return 0;
}

void ForeignMethod::remember() {
  if (about_.remembers) ask("KEEP", "", {"DONE", 0}, budget_.step);
}

void ForeignMethod::forget() {
  if (about_.remembers) ask("WIPE", "", {"DONE", 0}, budget_.step);
}

namespace {

/// A count in memory that a child forked later shares: what it held is known however it ends.
std::shared_ptr<HeapCount> shared_count() {
  void* const at = mmap(nullptr, sizeof(HeapCount), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (at == MAP_FAILED) throw std::bad_alloc();
  return {new (at) HeapCount, [](HeapCount* count) { munmap(count, sizeof *count); }};
}

}  // namespace

std::unique_ptr<ForeignMethod> isolated(const std::function<Hosted()>& make, std::size_t bodies, const Budget& budget) {
  const std::shared_ptr<HeapCount> heap = shared_count();
  auto process =
      std::make_unique<Process>([&](int in, int out) { serve(make, bodies, in, out, *heap); }, budget.memory);
  // It has the bodies: it is our child.
  return std::make_unique<ForeignMethod>(std::move(process), "{}", budget, counts_heap() ? heap : nullptr);
}

std::unique_ptr<ForeignMethod> started(const Command& command, const std::string& label, const Bodies& bodies,
                                       const std::string& knobs, const Budget& budget) {
  const std::string hello = hello_text(label, bodies, knobs);
  return std::make_unique<ForeignMethod>(std::make_unique<Process>(command, budget.memory), hello, budget);
}

}  // namespace pipeline
