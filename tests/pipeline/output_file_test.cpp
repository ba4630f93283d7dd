// Where results go: whole or not at all, and nothing of others is touched.
#include "pipeline/result/output_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <functional>
#include <memory>
#include <set>

#include "pipeline/terminal/error.hpp"
#include "tests/support/files.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/temporary_folder.hpp"

using namespace pipeline;
namespace fs = std::filesystem;
using tests::bytes_of, tests::names_in;

namespace {

void put(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }

void write(OutputFile& target, const std::string& text) { target.write(std::as_bytes(std::span(text))); }

/// The file in the making: ".NAME.<8 digits>.new".
fs::path in_the_making(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".new") return entry.path();
  ADD_FAILURE() << "no file in the making";
  return {};
}

template <class Act>
std::string refusal(Act act) {
  return tests::refusal_of(act, kFile);
}

mode_t mode_of(const fs::path& file) {
  struct stat status;
  return stat(file.c_str(), &status) == 0 ? status.st_mode & 07777 : 0;
}

class OutputFileTest : public testing::Test {
 protected:
  OutputFileTest() { fs::create_directory(folder); }
  const TemporaryFolder temporary;
  const fs::path folder = temporary / "results", file = folder / "x.h5";
};

}  // namespace

TEST_F(OutputFileTest, ComesToItsPlaceWholeAndLeavesNothingElse) {
  {
    OutputFile target(file, Existing::refuse);
    EXPECT_FALSE(fs::exists(file));
    write(target, "whole");
  }
  EXPECT_EQ(bytes_of(file), "whole");
  EXPECT_EQ(names_in(folder), std::set<std::string>{"x.h5"});
}

TEST_F(OutputFileTest, KeepsASecondWriterOutUntilItEnds) {
  const auto second = [&] { OutputFile(file, Existing::replace); };
  {
    const OutputFile first(file, Existing::replace);
    EXPECT_NE(refusal(second).find("being written by another run"), std::string::npos);
  }
  EXPECT_EQ(refusal(second), "");
  EXPECT_EQ(names_in(folder), std::set<std::string>{});
}

TEST_F(OutputFileTest, SweepsWhatAKillLeftAndNothingElse) {
  const std::set<std::string> others{".x.h5.new",          "x.h5.0123abcd.new",  ".y.h5.0123abcd.new",
                                     ".x.h5.0123abcd.old", ".x.h5.0123ABCD.new", ".x.h5.123.new"};
  for (const std::string& name : others) put(folder / name, "other");
  put(folder / ".x.h5.0123abcd.new", "half a result");
  put(folder / ".x.h5.lock", "");
  fs::create_directory(folder / ".x.h5.00000000.new");
  { OutputFile(file, Existing::refuse); }
  auto left = others;
  left.insert(".x.h5.00000000.new");
  EXPECT_EQ(names_in(folder), left);
}

// Killed after the result's rename: the same command is refused, and yet clears away.
TEST_F(OutputFileTest, SweepsAlsoWhereItRefuses) {
  put(file, "result");
  put(folder / ".x.h5.lock", "");
  put(folder / ".x.h5.0123abcd.new", "half a result");
  EXPECT_NE(refusal([&] { OutputFile(file, Existing::refuse); }).find("exists"), std::string::npos);
  EXPECT_EQ(names_in(folder), std::set<std::string>{"x.h5"});
}

// Results were written through a link that stood at their predictable name with ".new".
TEST_F(OutputFileTest, FollowsNoLink) {
  put(folder / "precious", "precious");
  fs::create_symlink("precious", folder / ".x.h5.new");
  {
    OutputFile target(file, Existing::refuse);
    write(target, "result");
  }
  EXPECT_EQ(bytes_of(folder / "precious"), "precious");
  EXPECT_TRUE(fs::is_symlink(folder / ".x.h5.new"));

  fs::create_symlink("precious", folder / ".y.h5.lock");
  EXPECT_NE(refusal([&] { OutputFile(folder / "y.h5", Existing::refuse); }), "");
  fs::create_symlink("precious", folder / "z.h5");
  for (const Existing existing : {Existing::refuse, Existing::replace, Existing::update})
    EXPECT_NE(refusal([&] { OutputFile(folder / "z.h5", existing); }), "");
  EXPECT_EQ(bytes_of(folder / "precious"), "precious");
}

TEST_F(OutputFileTest, TakesNoLockFileOfAnother) {
  put(folder / ".x.h5.lock", "pid 7");
  EXPECT_NE(refusal([&] { OutputFile(file, Existing::refuse); }).find("another program's .x.h5.lock"),
            std::string::npos);
  EXPECT_EQ(bytes_of(folder / ".x.h5.lock"), "pid 7");
}

// What stood at the name in the end became the result, whoever had put it there.
TEST_F(OutputFileTest, AFileSwappedInTheMakingNeverBecomesTheResult) {
  put(file, "before");
  for (const bool link : {false, true}) {
    OutputFile target(file, Existing::replace);
    const fs::path making = in_the_making(folder);
    fs::remove(making);
    if (link)
      fs::create_symlink("elsewhere", making);
    else
      put(making, "forged");
    EXPECT_NE(refusal([&] { write(target, "result"); }).find("another program put its file"), std::string::npos);
    EXPECT_EQ(bytes_of(file), "before");
    fs::remove(making);
  }
}

// Whatever wrote into the file meanwhile (it was stderr's number once): what is on the disk is what was meant, or it is
// told.
TEST_F(OutputFileTest, IsReadBack) {
  {
    OutputFile target(file, Existing::refuse);
    std::ofstream(in_the_making(folder), std::ios::app) << "resuming";
    EXPECT_NE(refusal([&] { write(target, "result"); }).find("does not hold what was written"), std::string::npos);
  }
  EXPECT_EQ(names_in(folder), std::set<std::string>{});
}

TEST_F(OutputFileTest, KeepsTheModeOfTheFileThatItReplaces) {
  for (const mode_t mode : {0600, 0640, 0666, 0444}) {
    put(file, "before");
    ASSERT_EQ(chmod(file.c_str(), mode), 0);
    {
      OutputFile target(file, Existing::update);
      EXPECT_EQ(mode_of(in_the_making(folder)), mode) << "before there is anything to read";
      write(target, "after");
    }
    EXPECT_EQ(mode_of(file), mode);
    EXPECT_EQ(bytes_of(file), "after");
    fs::remove(file);
  }
}

TEST_F(OutputFileTest, KeepsTheOwnerWhereThatIsAllowed) {
  if (geteuid() != 0) GTEST_SKIP() << "only root gives files to others";
  put(file, "before");
  ASSERT_EQ(chown(file.c_str(), 1234, 4321), 0);
  {
    OutputFile target(file, Existing::update);
    write(target, "after");
  }
  struct stat status;
  ASSERT_EQ(stat(file.c_str(), &status), 0);
  EXPECT_EQ(status.st_uid, 1234u);
  EXPECT_EQ(status.st_gid, 4321u);
}

TEST_F(OutputFileTest, AnUpdateNeverReplacesWhatWasReplacedOrChangedMeanwhile) {
  const auto replaced = [&] {
    put(folder / "newer", "newer");
    fs::rename(folder / "newer", file);
  };
  const auto changed = [&] { std::ofstream(file, std::ios::app) << " and changed"; };
  const auto removed = [&] { fs::remove(file); };
  for (const std::function<void()>& meanwhile :
       std::initializer_list<std::function<void()>>{replaced, changed, removed}) {
    put(file, "before");
    OutputFile target(file, Existing::update);
    meanwhile();
    const std::string kept = fs::exists(file) ? bytes_of(file) : "";
    EXPECT_NE(refusal([&] { write(target, "result"); }).find("changed by another program meanwhile"),
              std::string::npos);
    EXPECT_EQ(fs::exists(file) ? bytes_of(file) : "", kept);
  }
  fs::remove(file);
  OutputFile target(file, Existing::update);
  put(file, "appeared");
  EXPECT_NE(refusal([&] { write(target, "result"); }).find("meanwhile"), std::string::npos);
  EXPECT_EQ(bytes_of(file), "appeared");
}

TEST_F(OutputFileTest, RemovesAllFoldersThatItMadeWhenNothingWasWritten) {
  { OutputFile(folder / "a/b/c/x.h5", Existing::refuse); }
  EXPECT_EQ(names_in(folder), std::set<std::string>{});
  fs::create_directory(folder / "a");
  { OutputFile(folder / "a/b/c/x.h5", Existing::refuse); }
  EXPECT_EQ(names_in(folder), std::set<std::string>{"a"});
  EXPECT_EQ(names_in(folder / "a"), std::set<std::string>{});
  {
    OutputFile target(folder / "a/b/x.h5", Existing::refuse);
    write(target, "result");
  }
  EXPECT_EQ(bytes_of(folder / "a/b/x.h5"), "result");
}
