// Bytes on the disk: what is read, what is refused before it is read, and names of one's own.
#include "pipeline/system/file_bytes.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

#include "tests/support/temporary_folder.hpp"

using namespace pipeline;
namespace fs = std::filesystem;

namespace {

std::string refusal(const fs::path& path, bool follow = true, std::uint64_t most = 1000) {
  try {
    return "read: " + read_regular(AT_FDCWD, path, follow, most);
  } catch (const FileFailure& failure) {
    return failure.what();
  }
}

}  // namespace

TEST(FileBytes, ReadsARegularFileOfAtMostSoManyBytes) {
  const TemporaryFolder folder;
  const std::string text("a\0\xff\n", 4);
  std::ofstream(folder / "x", std::ios::binary) << text;
  EXPECT_EQ(read_regular(AT_FDCWD, folder / "x"), text);
  EXPECT_EQ(read_regular(AT_FDCWD, folder / "x", true, 4), text);
  EXPECT_EQ(refusal(folder / "x", true, 3), "has 4 bytes; such a file has at most 3");
  std::ofstream(folder / "empty") << "";
  EXPECT_EQ(read_regular(AT_FDCWD, folder / "empty"), "");
}

// A sparse file of 1 TiB is refused by its size, without a byte read.
TEST(FileBytes, TellsTheSizeOfWhatIsTooLong) {
  const TemporaryFolder folder;
  std::ofstream(folder / "x") << "";
  fs::resize_file(folder / "x", std::uintmax_t{1} << 40);
  EXPECT_EQ(refusal(folder / "x"), "has 1099511627776 bytes; such a file has at most 1000");
}

TEST(FileBytes, FilesThatDoNotKnowTheirSizeAreReadToTheirEnd) {
  const std::string limits = read_regular(AT_FDCWD, "/proc/self/limits");
  EXPECT_GT(limits.size(), 500u);
  EXPECT_EQ(limits.back(), '\n');
  EXPECT_NE(refusal("/proc/self/limits", true, 100).find("at most 100"), std::string::npos);
}

// None of them may be waited for: a pipe without a writer, a terminal, an endless device.
TEST(FileBytes, WhatIsNoRegularFileIsRefusedByItsKind) {
  const TemporaryFolder folder;
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(refusal(folder / "pipe"), "is a pipe, not a regular file");
  EXPECT_EQ(refusal(folder / ""), "is a folder, not a regular file");
  EXPECT_EQ(refusal("/dev/zero"), "is a device, not a regular file");
  fs::create_symlink("pipe", folder / "link");
  EXPECT_EQ(refusal(folder / "link"), "is a pipe, not a regular file");
  EXPECT_EQ(refusal(folder / "link", false), "is a symbolic link, not a regular file");
  EXPECT_EQ(refusal(folder / "none"), "cannot be read (No such file or directory)");
}

TEST(FileBytes, KnowsTheNamesOfFilesInTheMaking) {
  const TemporaryFolder folder;
  const Descriptor opened = open_folder(folder / "");
  {
    const NewFile file(opened.number(), "x.h5");
    ASSERT_EQ(names_in(opened.number()).size(), 1u);
    EXPECT_EQ(new_file_of(names_in(opened.number()).front()), "x.h5");
  }
  EXPECT_TRUE(names_in(opened.number()).empty());
  for (const char* other : {"", ".new", "x.h5", ".x.h5.new", "..0123abcd.new", "x.h5.0123abcd.new", ".x.0123abcg.new",
                            ".x0123abcd.new", ".x.0123abcd.new2"})
    EXPECT_FALSE(new_file_of(other)) << other;
}

TEST(FileBytes, HexHasTwoDigitsAByte) {
  const unsigned char bytes[] = {0x00, 0x0f, 0xa0, 0xff};
  EXPECT_EQ(hex(bytes), "000fa0ff");
}

// A closed stdout must not become success, and a closed stdin is at its end.
TEST(FileBytes, StandardDescriptorsAreOpenAfterwards) {
  const pid_t child = fork();
  if (child == 0) {
    for (int closed = 0; closed < 8; ++closed) {
      for (int number = 0; number < 3; ++number)
        if (closed >> number & 1) close(number);
      open_standard_descriptors();
      const int next = open("/dev/null", O_RDONLY);
      if (next < 3) _exit(1);
      close(next);
      char byte = 0;
      if ((closed & 1) && read(0, &byte, 1) != 0) _exit(2);
      if ((closed & 2) && write(1, &byte, 1) != -1) _exit(3);
      if ((closed & 4) && write(2, &byte, 1) != 1) _exit(4);
    }
    _exit(0);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
}
