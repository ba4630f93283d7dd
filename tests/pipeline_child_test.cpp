// Jobs in child processes: what they give, and every way in which they end badly.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <stdexcept>
#include <string>

#include "pipeline/child.hpp"
#include "pipeline/error.hpp"
#include "pipeline/progress.hpp"

namespace {

using pipeline::ChildLimits;
using pipeline::in_children;

struct Ended {
  std::string bytes, failure;
};

std::map<std::size_t, Ended> ended(std::size_t count, int processes, const ChildLimits& limits,
                                   const std::function<std::string(std::size_t)>& work) {
  std::map<std::size_t, Ended> out;
  in_children(count, processes, limits, work, [&](std::size_t job, const std::string& bytes, const std::string& why) {
    EXPECT_TRUE(out.emplace(job, Ended{bytes, why}).second) << "job " << job << " ended twice";
  });
  return out;
}

bool no_child_is_left() { return waitpid(-1, nullptr, WNOHANG) == -1 && errno == ECHILD; }

TEST(Child, GivesTheBytesOfEveryJob) {
  const auto all = ended(7, 3, {}, [](std::size_t job) {
    return std::string(job * 40000, static_cast<char>(job)) + std::string("\0\n", 2);  // more than a pipe holds
  });
  ASSERT_EQ(all.size(), 7u);
  for (const auto& [job, end] : all) {
    EXPECT_EQ(end.failure, "");
    EXPECT_EQ(end.bytes, std::string(job * 40000, static_cast<char>(job)) + std::string("\0\n", 2));
  }
  EXPECT_TRUE(no_child_is_left());
}

TEST(Child, WhatAbortsOrCrashesIsToldAndTheOthersGoOn) {
  const auto all = ended(4, 2, {}, [](std::size_t job) -> std::string {
    if (job == 0) {
      std::fprintf(stderr, "Assertion `x > 0' failed.\n");
      std::abort();
    }
    if (job == 1) std::raise(SIGSEGV);
    if (job == 2) throw std::runtime_error("no such thing");
    return "well";
  });
  EXPECT_EQ(all.at(0).failure, "aborted: Assertion `x > 0' failed.");
  EXPECT_EQ(all.at(1).failure, "crashed by signal 11");
  EXPECT_EQ(all.at(2).failure, "ended with code 1: no such thing");
  EXPECT_EQ(all.at(3).failure, "");
  EXPECT_EQ(all.at(3).bytes, "well");
}

TEST(Child, OneThatEndsEarlyIsNotTakenForWhole) {
  const auto all = ended(1, 1, {}, [](std::size_t) -> std::string { _exit(0); });
  EXPECT_EQ(all.at(0).failure, "ended with code 0");
}

TEST(Child, OneThatSleepsIsEndedInTime) {
  const auto start = std::chrono::steady_clock::now();
  const auto all = ended(1, 1, {.processor_seconds = 60, .wall_seconds = 0.1}, [](std::size_t) -> std::string {
    for (;;) pause();
  });
  EXPECT_EQ(all.at(0).failure, "more than 0.1 s of wall time");
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
}

// A whole second is the least that the system counts.
TEST(Child, OneThatSpinsIsEndedByItsProcessorTime) {
  const auto all = ended(1, 1, {.processor_seconds = 1, .wall_seconds = 600}, [](std::size_t) -> std::string {
    for (volatile int spins = 0;;) spins = spins + 1;
  });
  EXPECT_EQ(all.at(0).failure, "more than 1.0 s of processor time");
}

TEST(Child, AWishToStopLeavesNone) {
  int code = 0;
  try {
    in_children(
        3, 2, {},
        [](std::size_t job) -> std::string {
          if (job == 0) return "first";
          for (;;) pause();
        },
        [](std::size_t, const std::string&, const std::string&) { pipeline::stop_wanted = true; });
  } catch (const pipeline::Error& error) {
    code = error.code();
  }
  pipeline::stop_wanted = false;
  EXPECT_EQ(code, pipeline::kInterrupted);
  EXPECT_TRUE(no_child_is_left());
}

}  // namespace
