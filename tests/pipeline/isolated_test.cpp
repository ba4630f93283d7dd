// Methods in a child of ours: the same answers as here, and every way in which they end badly.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <stdexcept>
#include <vector>

#include "pipeline/foreign/foreign_method.hpp"
#include "pipeline/system/heap.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/progress.hpp"
#include "tests/support/refusal.hpp"

namespace pipeline {
namespace {

using geometry::Bodies;
using geometry::Pair;
using geometry::PairRun;
using geometry::Pose;
using Act = std::function<void(std::vector<Pair>& hits)>;

const std::vector<Pose> kPoses(3);
const std::vector<PairRun> kRuns = {{0, 1, 3}, {1, 2, 3}};

/// Does what it is told when it answers.
struct Told final : algorithms::Method {
  explicit Told(Act act) : act(std::move(act)) {}
  void prepare(std::span<const Pose>, double) override {}
  void answer(std::span<const PairRun>, std::vector<Pair>& hits) override { act(hits); }
  std::uint64_t count(std::span<const PairRun>, std::vector<Pair>& hits) override {
    act(hits);
    return 7;
  }
  void remember() override {
    act = [](std::vector<Pair>& hits) { hits = {{1, 2}}; };
  }
  void forget() override {
    act = [](std::vector<Pair>& hits) { hits = {{0, 2}}; };
  }
  Act act;
};

std::unique_ptr<ForeignMethod> told(Act act, Budget budget = {}) {
  return isolated(
      [act] {
        return Hosted{{.name = "told", .operations_unit = "calls", .remembers = true}, std::make_unique<Told>(act)};
      },
      kPoses.size(), budget);
}

std::vector<Pair> answer(ForeignMethod& method) {
  std::vector<Pair> hits;
  method.prepare(kPoses);
  method.answer(kRuns, hits);
  return hits;
}

std::string fault(Act act, Budget budget = {}) {
  const auto method = told(std::move(act), budget);
  try {
    answer(*method);
  } catch (const Fault& fault) {
    return fault.what();
  }
  return "no fault";
}

bool no_child_is_left() { return waitpid(-1, nullptr, WNOHANG) == -1 && errno == ECHILD; }

TEST(Isolated, AnswersCountsRemembersAndForgets) {
  {
    const auto method = told([](std::vector<Pair>& hits) { hits = {{1, 2}, {0, 1}}; });
    EXPECT_EQ(method->about().name, "told");
    EXPECT_EQ(answer(*method), (std::vector<Pair>{{0, 1}, {1, 2}})) << "sorted";
    std::vector<Pair> hits;
    EXPECT_EQ(method->count(kRuns, hits), 7u);
    method->remember();
    EXPECT_EQ(answer(*method), (std::vector<Pair>{{1, 2}}));
    method->forget();
    EXPECT_EQ(answer(*method), (std::vector<Pair>{{0, 2}}));
  }
  EXPECT_TRUE(no_child_is_left());
}

TEST(Isolated, TheTimeIsTakenInTheChildAndWithinTheExchange) {
  const auto method = told([](std::vector<Pair>&) { usleep(20'000); });
  answer(*method);
  EXPECT_GE(method->time().time_ns, 20'000'000);
  EXPECT_GE(method->time().exchange_ns, method->time().time_ns);
  EXPECT_LE(method->time().prepare_ns, method->time().time_ns);
}

TEST(Isolated, WhateverItDoesIsAFault) {
  EXPECT_EQ(fault([](auto&) { throw std::runtime_error("no such thing"); }), "it gives up: no such thing");
  EXPECT_EQ(fault([](auto&) { throw 7; }), "it gives up: it threw what is no std::exception");
  EXPECT_EQ(fault([](auto&) {
              std::fprintf(stderr, "first\nAssertion `x > 0' failed.\n");
              std::abort();
            }),
            "it aborted; it said: first | Assertion `x > 0' failed.");
  EXPECT_EQ(fault([](auto&) { std::raise(SIGSEGV); }), "it crashed by signal 11");
  EXPECT_EQ(fault([](auto&) { _exit(0); }), "it ended with code 0");
  EXPECT_EQ(fault([](auto&) { pause(); }, {.step = 0.15}), "no answer within 0.15 s");
  EXPECT_EQ(fault([](auto& hits) { hits = {{1, 1}}; }), "it reports the pair 1, 1: a body with itself");
  EXPECT_EQ(fault([](auto& hits) {
              hits.resize(4, {0, 1});
            }),
            "its frame HITS says that it has 56 bytes; at most 48 are possible here")
      << "more pairs than were asked about";
  EXPECT_TRUE(no_child_is_left());
}

TEST(Isolated, ItsHeapIsCountedAlsoWhereItEndsBadly) {
  if (!counts_heap()) GTEST_SKIP() << "a sanitizer has its own malloc";
  constexpr std::int64_t kOne = 1 << 20, kLittle = 64 << 10;
  const auto near = [](std::int64_t bytes, std::int64_t wanted) { return wanted <= bytes && bytes < wanted + kLittle; };
  const auto for_a_while = told([](auto&) {
    char* volatile taken = new char[kOne]();
    delete[] taken;
  });
  EXPECT_LT(for_a_while->greatest_heap(), kLittle);
  for (int i = 0; i < 3; ++i) answer(*for_a_while);
  EXPECT_TRUE(near(for_a_while->greatest_heap(), kOne)) << for_a_while->greatest_heap();

  const auto leaks = told([count = 0](auto&) mutable {
    [[maybe_unused]] char* volatile kept = new char[kOne]();
    if (++count == 3) std::abort();
  });
  EXPECT_THROW(for (int i = 0; i < 3; ++i) answer(*leaks), Fault);
  EXPECT_TRUE(near(leaks->greatest_heap(), 3 * kOne)) << leaks->greatest_heap();

  const auto reports = told([](std::vector<Pair>& hits) { hits = {{0, 1}, {0, 2}, {1, 2}}; });
  for (int i = 0; i < 100; ++i) answer(*reports);
  EXPECT_LT(reports->greatest_heap(), 8 << 10) << "the lists of hits are not the method's";
}

TEST(Isolated, WhatItPrintsIsNoAnswer) {
  EXPECT_EQ(fault([](auto&) {
              std::puts("HITS of the year");
              std::fflush(stdout);
            }),
            "no fault");
}

TEST(Isolated, WhatThrowsWhenItIsMadeIsToldToo) {
  try {
    isolated([]() -> Hosted { throw std::invalid_argument("needs closed meshes"); }, 3, {});
    FAIL();
  } catch (const Fault& fault) {
    EXPECT_STREQ(fault.what(), "it gives up: needs closed meshes");
  }
}

TEST(Isolated, ALeakEndsAtItsBudgetOfMemory) {
  if (!counts_heap()) GTEST_SKIP() << "a sanitizer's shadow has no budget";
  EXPECT_EQ(fault(
                [](auto&) {
                  std::vector<char*> kept;
                  for (;;) kept.push_back(new char[1 << 20]());
                },
                {.memory = 64 << 20}),
            "it gives up: out of memory");
}

TEST(Isolated, TheBudgetInAllEndsIt) {
  const auto method = told([](auto&) { usleep(60'000); }, {.step = 60, .all = 0.1});
  answer(*method);
  try {
    answer(*method);
    FAIL();
  } catch (const Fault& fault) {
    EXPECT_STREQ(fault.what(), "more than 0.1 s in all");
  }
}

TEST(Isolated, AWishToStopLeavesNone) {
  {
    const auto method = told([](auto&) { pause(); });
    stop_wanted = true;
    EXPECT_NE(tests::refusal_of([&] { answer(*method); }, kInterrupted), "");
  }
  stop_wanted = false;
  EXPECT_TRUE(no_child_is_left());
}

TEST(Isolated, HoldsNoFileOfItsParent) {
  EXPECT_EQ(fault([](auto&) {
              for (int file = 5; file < 1000; ++file)
                if (fcntl(file, F_GETFD) != -1) throw std::runtime_error("has file " + std::to_string(file));
            }),
            "no fault");
}

// The parent is killed with -9 while the child works.
TEST(Isolated, DiesWithItsParent) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const pid_t parent = fork();
  if (parent == 0) {
    const auto method = told([&](auto&) {
      for (;;) pause();
    });
    const pid_t child = method->pid();
    if (write(ends[1], &child, sizeof child) == sizeof child) answer(*method);
    _exit(0);
  }
  pid_t child = 0;
  ASSERT_EQ(read(ends[0], &child, sizeof child), ssize_t(sizeof child));
  ASSERT_EQ(kill(child, 0), 0) << "it is there";
  kill(parent, SIGKILL);
  waitpid(parent, nullptr, 0);
  bool gone = false;
  for (int i = 0; i < 400 && !gone; ++i, usleep(5'000)) {
    // Whoever adopts it may not have buried it yet: a zombie is dead.
    std::FILE* file = std::fopen(("/proc/" + std::to_string(child) + "/stat").c_str(), "r");
    char state = 'X';
    if (file && std::fscanf(file, "%*d (%*[^)]) %c", &state) != 1) state = 'X';
    if (file) std::fclose(file);
    gone = state == 'Z' || state == 'X';
  }
  EXPECT_TRUE(gone);
}

}  // namespace
}  // namespace pipeline
