// Jobs in child processes: what they give, and every way in which they end badly.
#include "pipeline/system/child.hpp"

#include <fcntl.h>
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

#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/progress.hpp"

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

// 22 November 2026: of 25 studies of which the whole group got SIGTERM (as by a service manager) 14 had rows "crashed
// by signal 15" in their part, and kept them when resumed.
TEST(Child, SignalsToTheWholeGroupAreTheParentsToJudge) {
  const auto all = ended(1, 1, {}, [](std::size_t) -> std::string {
    std::raise(SIGINT);
    std::raise(SIGTERM);
    return "well";
  });
  EXPECT_EQ(all.at(0).failure, "");
  EXPECT_EQ(all.at(0).bytes, "well");
}

// A lock lasts as long as any process has its file: in 22 of 40 studies killed with -9 the children, about to die,
// still held it, and the same command at once was refused.
TEST(Child, HoldsNoFileOfItsParent) {
  const int lock = open("/dev/null", O_RDONLY);
  const auto all = ended(2, 2, {}, [lock](std::size_t) -> std::string {
    for (int file = 0; file < 1000; ++file)
      if (fcntl(file, F_GETFD) != -1 && file > 3) return "has file " + std::to_string(file);
    return fcntl(lock, F_GETFD) == -1 || lock <= 3 ? "well" : "has the lock";
  });
  close(lock);
  EXPECT_EQ(all.at(0).bytes, "well");
  EXPECT_EQ(all.at(1).bytes, "well");
}

TEST(Child, WhatItSaidLastIsTold) {
  const auto all = ended(1, 1, {}, [](std::size_t) -> std::string {
    for (int i = 0; i < 20000; ++i) std::fputs("step refused\n", stderr);
    std::fputs("the end\n", stderr);
    std::abort();
  });
  EXPECT_TRUE(all.at(0).failure.starts_with("aborted: ")) << all.at(0).failure;
  EXPECT_TRUE(all.at(0).failure.ends_with("step refused the end") || all.at(0).failure.ends_with("?the end"))
      << all.at(0).failure;
  EXPECT_LT(all.at(0).failure.size(), 320u);
}

TEST(Child, TimeForWhichCtrlZStoppedAllIsNobodys) {
  const pid_t program = fork();
  if (program == 0) {
    setpgid(0, 0);
    bool well = false;
    in_children(
        1, 1, {.wall_seconds = 0.4},
        [](std::size_t) -> std::string {
          for (int i = 0; i < 10; ++i) usleep(10'000);  // one long sleep would go on while it is stopped
          return "";
        },
        [&](std::size_t, const std::string&, const std::string& failure) { well = failure.empty(); });
    _exit(well ? 0 : 1);
  }
  setpgid(program, program);
  usleep(30'000);
  ASSERT_EQ(kill(-program, SIGSTOP), 0);
  usleep(450'000);
  ASSERT_EQ(kill(-program, SIGCONT), 0);
  int status = 0;
  ASSERT_EQ(waitpid(program, &status, 0), program);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
}

// A whole second is the least that the system counts.
TEST(Child, OneThatSpinsIsEndedByItsProcessorTime) {
  const auto all = ended(1, 1, {.processor_seconds = 1, .wall_seconds = 600}, [](std::size_t) -> std::string {
    for (volatile unsigned spins = 0;;) spins = spins + 1;
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
