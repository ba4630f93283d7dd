#include "pipeline/system/heap.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace pipeline {
namespace {

#define NEEDS_OUR_MALLOC \
  if (!counts_heap()) GTEST_SKIP() << "a sanitizer has its own malloc"

// malloc rounds blocks up by less than a page.
constexpr std::int64_t kRoundingUp = 4096 + 64;

TEST(Heap, CountsWhatIsHeldAndTheMost) {
  NEEDS_OUR_MALLOC;
  HeapCount count;
  std::vector<char> kept;
  {
    const CountingHeap now(count);
    std::vector<char> passing(1 << 20);
    kept.reserve(1 << 16);
  }
  EXPECT_GE(count.held, 1 << 16);
  EXPECT_LE(count.held, (1 << 16) + kRoundingUp);
  EXPECT_GE(count.greatest, (1 << 20) + (1 << 16));
  EXPECT_LE(count.greatest, (1 << 20) + (1 << 16) + 2 * kRoundingUp);
}

TEST(Heap, CountsNothingUnasked) {
  HeapCount count;
  { const CountingHeap now(count); }
  const std::vector<char> uncounted(1 << 20);
  EXPECT_EQ(count.held, 0);
  EXPECT_EQ(count.greatest, 0);
}

TEST(Heap, GoesOnWhereItStopped) {
  NEEDS_OUR_MALLOC;
  HeapCount count;
  void* volatile block = nullptr;  // volatile: or the compiler leaves both out
  {
    const CountingHeap now(count);
    block = std::malloc(100'000);
  }
  const auto held = count.held;
  EXPECT_GE(held, 100'000);
  {
    const CountingHeap now(count);
    std::free(block);
  }
  EXPECT_EQ(count.held, 0);
  EXPECT_EQ(count.greatest, held);
}

TEST(Heap, CountsEveryWayToAsk) {
  NEEDS_OUR_MALLOC;
  constexpr std::size_t kSize = 200'000;
  HeapCount count;
  void* blocks[5] = {};
  {
    const CountingHeap now(count);
    blocks[0] = std::malloc(kSize);
    blocks[1] = std::calloc(kSize / 8, 8);
    blocks[2] = std::aligned_alloc(4096, 4096 * 49);
    if (posix_memalign(&blocks[3], 64, kSize) != 0) blocks[3] = nullptr;
    blocks[4] = std::realloc(std::malloc(1000), kSize);
  }
  for (void* block : blocks) ASSERT_NE(block, nullptr);
  EXPECT_GE(count.held, std::int64_t(5 * kSize));
  EXPECT_LE(count.held, std::int64_t(5 * kSize) + 5 * kRoundingUp + 4096);
  {
    const CountingHeap now(count);
    for (void* block : blocks) std::free(block);
  }
  EXPECT_EQ(count.held, 0);
}

TEST(Heap, AlignsAsAsked) {
  for (std::size_t alignment : {16u, 64u, 4096u}) {
    const std::unique_ptr<void, decltype(&std::free)> block(std::aligned_alloc(alignment, 3 * alignment), &std::free);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(block.get()) % alignment, 0u);
  }
  if (!counts_heap()) return;  // a sanitizer ends the program then
  void* none = nullptr;
  EXPECT_NE(posix_memalign(&none, 24, 100), 0);
  EXPECT_EQ(none, nullptr);
}

// What other threads take meanwhile is theirs.
TEST(Heap, IsOfOneThread) {
  HeapCount count;
  std::string* made = nullptr;
  std::thread other;
  {
    other = std::thread([&] { made = new std::string(1 << 20, 'x'); });
    const CountingHeap now(count);
    other.join();
  }
  delete made;
  EXPECT_LT(count.held, 10'000);
}

}  // namespace
}  // namespace pipeline
