#include "pipeline/system/lease.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>
#include <vector>

#include "pipeline/system/file_bytes.hpp"
#include "tests/support/files.hpp"
#include "tests/support/temporary_folder.hpp"

using namespace pipeline;
namespace fs = std::filesystem;

namespace {

constexpr Lease::Seconds kLong{60};

struct Folder {
  TemporaryFolder folder;
  Descriptor opened = open_folder(folder / "");
  int in = opened.number();

  fs::path at(const char* name) const { return folder / name; }
  std::string text(const char* name) const { return tests::bytes_of(at(name)); }
  /// As if it had been touched so long ago, by the folder's clock.
  void age(const char* name, double seconds) const {
    timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    const timespec then{now.tv_sec - time_t(seconds), now.tv_nsec};
    const timespec times[2] = {then, then};
    ASSERT_EQ(utimensat(in, name, times, 0), 0);
  }
  std::size_t files() const { return tests::names_in(folder / "").size(); }
};

constexpr char kElsewhere[] =
    R"({"host":"elsewhere","boot":"1","numbers":"pid:[1]","process":1,"started":"1","lease_s":10})";

}  // namespace

TEST(Lease, IsOnesUntilItIsGivenBack) {
  const Folder folder;
  auto mine = take_lease(folder.in, "a", kLong);
  ASSERT_TRUE(mine);
  EXPECT_FALSE(take_lease(folder.in, "a", kLong));
  EXPECT_TRUE(is_leased(folder.in, "a", kLong));
  EXPECT_TRUE(take_lease(folder.in, "b", kLong)) << "another name";
  EXPECT_NE(holder_text(folder.in, "a").find(std::to_string(getpid())), std::string::npos);
  mine.reset();
  EXPECT_EQ(holder_text(folder.in, "a"), "");
  EXPECT_TRUE(take_lease(folder.in, "a", kLong));
  EXPECT_EQ(folder.files(), 0u);
}

TEST(Lease, OfTheDeadIsTakenOverAtOnce) {
  const Folder folder;
  const pid_t child = fork();
  if (child == 0) _exit(new std::unique_ptr<Lease>(take_lease(folder.in, "a", kLong)) ? 0 : 1);  // never given back
  // Until it is waited for it is a zombie: dead, though its number is still taken.
  siginfo_t info;
  ASSERT_EQ(waitid(P_PID, id_t(child), &info, WEXITED | WNOWAIT), 0);
  ASSERT_TRUE(fs::exists(folder.at("a")));
  EXPECT_EQ(holder_text(folder.in, "a"), "");
  EXPECT_FALSE(is_leased(folder.in, "a", kLong));
  EXPECT_TRUE(take_lease(folder.in, "a", kLong));
  waitpid(child, nullptr, 0);
}

// A number is given again: whoever has it now, and started at another time, is not the holder.
TEST(Lease, OfAProcessWhoseNumberIsAnothersIsTakenOver) {
  const Folder folder;
  {
    const auto mine = take_lease(folder.in, "a", kLong);
    std::string text = folder.text("a");
    const std::size_t at = text.find("\"started\":\"") + 11;
    text.insert(at, "7");
    std::ofstream(folder.at("b")) << text;
  }
  EXPECT_TRUE(take_lease(folder.in, "b", kLong));
}

TEST(Lease, OfAnotherHostIsKeptForItsOwnTime) {
  const Folder folder;
  std::ofstream(folder.at("a")) << kElsewhere;
  EXPECT_FALSE(take_lease(folder.in, "a", Lease::Seconds(1)));
  EXPECT_EQ(holder_text(folder.in, "a"), "process 1 on elsewhere");
  folder.age("a", 9);
  EXPECT_FALSE(take_lease(folder.in, "a", Lease::Seconds(1))) << "its lease is 10 s, whatever mine is";
  folder.age("a", 11);
  EXPECT_FALSE(is_leased(folder.in, "a", kLong));
  EXPECT_TRUE(take_lease(folder.in, "a", kLong));
  // What says nothing of itself is kept for the time of whoever asks.
  std::ofstream(folder.at("b")) << "";
  folder.age("b", 30);
  EXPECT_FALSE(take_lease(folder.in, "b", kLong));
  EXPECT_TRUE(take_lease(folder.in, "b", Lease::Seconds(20)));
}

TEST(Lease, IsRenewedWhileItsHolderLives) {
  const Folder folder;
  const auto mine = take_lease(folder.in, "a", Lease::Seconds(0.2));
  struct stat before, after;
  ASSERT_EQ(fstatat(folder.in, "a", &before, 0), 0);
  folder.age("a", 100);
  for (int i = 0; i < 1000; ++i) {  // a busy machine may take seconds
    ASSERT_EQ(fstatat(folder.in, "a", &after, 0), 0);
    if (after.st_mtim.tv_sec >= before.st_mtim.tv_sec) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_GE(after.st_mtim.tv_sec, before.st_mtim.tv_sec);
}

// A holder that was stopped beyond its lease neither renews nor removes what is another's by then.
TEST(Lease, ThatWasTakenOverIsLeftAlone) {
  const Folder folder;
  auto mine = take_lease(folder.in, "a", Lease::Seconds(0.1));
  fs::remove(folder.at("a"));
  std::ofstream(folder.at("a")) << kElsewhere;
  folder.age("a", 5);
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  struct stat now;
  ASSERT_EQ(fstatat(folder.in, "a", &now, 0), 0);
  EXPECT_LT(now.st_mtim.tv_sec, time(nullptr) - 2) << "it was renewed";
  mine.reset();
  EXPECT_EQ(folder.text("a"), kElsewhere);
}

TEST(Lease, HasOneHolderOfMany) {
  const Folder folder;
  std::atomic<int> inside = 0, together = 0;
  const auto contend = [&] {
    for (int taken = 0; taken < 20;) {
      if (const auto mine = take_lease(folder.in, "a", kLong)) {
        if (++inside > 1) ++together;
        ++taken;
        std::this_thread::yield();
        --inside;
      }
      std::this_thread::yield();
    }
  };
  {
    std::vector<std::jthread> all;
    for (int i = 0; i < 4; ++i) all.emplace_back(contend);
  }
  EXPECT_EQ(together, 0);
  EXPECT_EQ(folder.files(), 0u);
}

// Many see that the holder is dead: it is taken over, nobody removes the fresh one, and hardly ever two think that they
// have it (one looks aside at the other's in the moment in which a third comes), as lease.hpp says.
TEST(Lease, ThatIsStaleIsTakenOver) {
  for (int round = 0; round < 10; ++round) {
    const Folder folder;
    std::ofstream(folder.at("a")) << kElsewhere;
    folder.age("a", 100);
    std::atomic<int> ready = 0, taken = 0;
    std::vector<std::unique_ptr<Lease>> held(4);
    {
      std::vector<std::jthread> all;
      for (auto& one : held)
        all.emplace_back([&] {
          ++ready;
          while (ready < 4) std::this_thread::yield();
          one = take_lease(folder.in, "a", kLong);
          taken += one != nullptr;
        });
    }
    EXPECT_GE(taken, 1) << round;
    EXPECT_LE(taken, 2) << round;
    EXPECT_TRUE(is_leased(folder.in, "a", kLong));
  }
}

TEST(Lease, IsNoLinkAndNoFolder) {
  const Folder folder;
  fs::create_symlink("elsewhere", folder.at("a"));
  fs::create_directory(folder.at("b"));
  for (const char* name : {"a", "b"}) EXPECT_THROW(take_lease(folder.in, name, kLong), FileFailure) << name;
  EXPECT_FALSE(fs::exists(folder.at("elsewhere")));
  EXPECT_EQ(folder.files(), 2u);
}
