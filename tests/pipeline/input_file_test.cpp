// What is opened at all, and how deep JSON may be.
#include "pipeline/system/input_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "pipeline/terminal/error.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/temporary_folder.hpp"

namespace pipeline {
namespace {

std::string refusal(const std::filesystem::path& path, std::uint64_t most = 100) {
  return tests::refusal_of([&] { text_of_file(path, most, "name another"); }, kFile);
}

TEST(Foreign, ReadsARegularFileUpToItsBound) {
  const TemporaryFolder folder;
  std::ofstream(folder / "a") << "content";
  EXPECT_EQ(text_of_file(folder / "a", 7, ""), "content");
  EXPECT_EQ(refusal(folder / "a", 6),
            (folder / "a").string() + ": has 7 bytes; such a file has at most 6; name another");
  std::filesystem::create_symlink("a", folder / "link");
  EXPECT_EQ(text_of_file(folder / "link", 7, ""), "content");
}

TEST(Foreign, KnowsWhetherItsPathStillLeadsToIt) {
  const TemporaryFolder folder;
  std::ofstream(folder / "a") << "content";
  std::ofstream(folder / "b") << "content";
  const InputFile file(folder / "a", "");
  EXPECT_TRUE(file.in_place());
  std::filesystem::rename(folder / "b", folder / "a");
  EXPECT_FALSE(file.in_place());
  std::filesystem::remove(folder / "a");
  EXPECT_FALSE(file.in_place());
}

TEST(Foreign, OpensNothingElse) {
  const TemporaryFolder folder;
  ASSERT_EQ(mkfifo((folder / "fifo").c_str(), 0600), 0);
  std::filesystem::create_symlink("fifo", folder / "link");
  for (const std::filesystem::path& path : {folder / "fifo", folder / "link"})
    EXPECT_EQ(refusal(path), path.string() + ": is a pipe, not a regular file; name another");
  EXPECT_EQ(refusal("/dev/zero"), "/dev/zero: is a device, not a regular file; name another");
  EXPECT_EQ(refusal("/tmp"), "/tmp: is a folder, not a regular file; name another");
  EXPECT_NE(refusal(folder / "none").find("No such file"), std::string::npos);
}

TEST(Foreign, KnowsTheSameFileAgain) {
  const TemporaryFolder folder;
  std::ofstream(folder / "a") << "1";
  const InputFile before(folder / "a", "");
  EXPECT_TRUE(InputFile(folder / "a", "").same_as(before));
  std::ofstream(folder / "b") << "1";
  std::filesystem::rename(folder / "b", folder / "a");
  EXPECT_FALSE(InputFile(folder / "a", "").same_as(before));
}

TEST(Foreign, CountsBracketsOutsideOfTexts) {
  EXPECT_TRUE(is_shallow(R"([[{"a": 1}]])", 3));
  EXPECT_FALSE(is_shallow(R"([[{"a": 1}]])", 2));
  EXPECT_TRUE(is_shallow(R"(["[[[[", "\"[[["])", 1));
  EXPECT_TRUE(is_shallow("[],[],[],[]", 1));
  EXPECT_FALSE(is_shallow(std::string(100'000, '[')));
  EXPECT_TRUE(is_shallow("\"\\"));  // no JSON, and no reason to read beyond its end
}

}  // namespace
}  // namespace pipeline
