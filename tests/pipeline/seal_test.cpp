// The last line of a result. That it is XXH3-128 of what stands before it is compared with another library in
// tests/test_file.py.
#include "pipeline/result/seal.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/temporary_folder.hpp"

namespace pipeline {
namespace {

Seal judged(const std::filesystem::path& path, const std::string& content) {
  std::ofstream(path, std::ios::binary) << content;
  return seal_of(InputFile(path, ""), path);
}

std::string sealed(const std::string& content) { return content + seal_of(std::as_bytes(std::span(content))); }

TEST(Seal, HoldsOverAnyContent) {
  const TemporaryFolder folder;
  for (const std::size_t size : {0, 1, 200, 1 << 20, (1 << 20) + 7})  // it is read by blocks of 1 MiB
    EXPECT_EQ(judged(folder / "a", sealed(std::string(size, 'x'))), Seal::holds) << size;
}

// Every seventh bit of a small file, those of the seal itself included.
TEST(Seal, HoldsForNoFileOfWhichABitChanged) {
  const TemporaryFolder folder;
  const std::string whole = sealed("some content");
  for (std::size_t bit = 0; bit < 8 * whole.size(); bit += 7) {
    std::string changed = whole;
    changed[bit / 8] = static_cast<char>(changed[bit / 8] ^ 1 << bit % 8);
    ASSERT_NE(judged(folder / "a", changed), Seal::holds) << bit;
  }
}

TEST(Seal, HoldsForNoPartAndNothingLonger) {
  const TemporaryFolder folder;
  const std::string whole = sealed("some content");
  for (std::size_t size = 0; size < whole.size(); ++size)
    ASSERT_EQ(judged(folder / "a", whole.substr(0, size)), Seal::none) << size;
  EXPECT_EQ(judged(folder / "a", whole + "x"), Seal::none);
  EXPECT_EQ(judged(folder / "a", "x" + whole), Seal::differs);
  EXPECT_EQ(judged(folder / "a", sealed(whole)), Seal::holds);
}

TEST(Seal, OfALaterFormIsNotTakenForDamage) {
  const TemporaryFolder folder;
  std::string later = sealed("some content");
  later[later.find("seal 1") + 5] = '2';
  EXPECT_EQ(judged(folder / "a", later), Seal::unknown);
}

}  // namespace
}  // namespace pipeline
