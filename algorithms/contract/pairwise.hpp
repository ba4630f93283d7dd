// From a test of one pair to a Method: the loop over pairs that the pairwise algorithms share.
//
// A test is a struct
//   Test(const Bodies&, const Knobs&)                          once per run
//   void prepare(std::span<const Pose>, double enlarge)        once per step
//   template <class Count> bool hit(uint32 a, uint32 b, Count& count)
//   static Memory memory(const Bodies&, const Knobs&)          what it takes; for Algorithm::memory
// where `count += n` notes n elementary tests; in the timed pass Count does nothing and vanishes. What is made counts:
// a cheap rejection is one test, tests that a loop makes together (points, directions) are all of them. Axes of a pair
// count up to the first that parts it, also where a row looks at all of them by one mask. A test may offer
//   void row(uint32 a, uint32 first, uint32 last, uint8* hit)  hit[i] = 1 when (a, first + i) is a hit, else 0
// with the same answers as `hit`, which then counts for it: one body against a contiguous block of others, for loops
// that vectorise. The loop sees the test's body, so a test lives in its .cpp and is inlined here.
#pragma once
#include <algorithm>
#include <array>
#include <cstring>

#include "algorithms/contract/algorithm.hpp"

namespace algorithms {

/// Counts nothing: the timed pass.
struct NoCount {
  void operator+=(std::uint64_t) {}
};

/// Counts elementary tests.
struct Counter {
  std::uint64_t total = 0;
  void operator+=(std::uint64_t n) { total += n; }
};

/// A test that answers a row at a time.
template <class Test>
concept HasRow = requires(Test& test, std::uint32_t body, std::uint8_t* hit) {
  test.row(body, body, body, hit);
};

/// Appends the hits of every pair of `runs`, one pair at a time.
template <class Test, class Count>
void visit_pairs(Test& test, std::span<const PairRun> runs, std::vector<Pair>& hits, Count& count) {
  for (const PairRun& run : runs)
    for (std::uint32_t b = run.first; b < run.last; ++b)
      if (test.hit(run.a, b, count)) hits.push_back({run.a, b});
}

/// The same answers by the test's rows.
template <HasRow Test>
void visit_rows(Test& test, std::span<const PairRun> runs, std::vector<Pair>& hits) {
  constexpr std::uint32_t block = 1024, word = sizeof(std::uint64_t);
  alignas(64) std::array<std::uint8_t, block> hit;
  for (const PairRun& run : runs)
    for (std::uint32_t first = run.first; first < run.last; first += block) {
      const std::uint32_t size = std::min(block, run.last - first), whole = (size + word - 1) / word * word;
      test.row(run.a, first, first + size, hit.data());
      std::fill(hit.begin() + size, hit.begin() + whole, std::uint8_t{0});
      for (std::uint32_t i = 0; i < whole; i += word) {  // hits are rare: eight answers are skipped at once
        std::uint64_t eight;
        std::memcpy(&eight, hit.data() + i, word);
        if (!eight) continue;
        for (std::uint32_t k = i; k < i + word; ++k)
          if (hit[k]) hits.push_back({run.a, first + k});
      }
    }
}

/// Timed: by rows when the test has them.
template <class Test>
void visit(Test& test, std::span<const PairRun> runs, std::vector<Pair>& hits) {
  if constexpr (HasRow<Test>) {
    visit_rows(test, runs, hits);
  } else {
    NoCount none;
    visit_pairs(test, runs, hits, none);
  }
}

/// A Method from a test of one pair.
template <class Test>
class Pairwise final : public Method {
 public:
  Pairwise(const Bodies& bodies, const Knobs& knobs) : test_(bodies, knobs) {}

  void prepare(std::span<const Pose> poses, double enlarge) override { test_.prepare(poses, enlarge); }

  void answer(std::span<const PairRun> runs, std::vector<Pair>& hits) override { visit(test_, runs, hits); }

  std::uint64_t count(std::span<const PairRun> runs, std::vector<Pair>& hits) override {
    Counter counter;
    visit_pairs(test_, runs, hits, counter);
    return counter.total;
  }

 private:
  Test test_;
};

/// Algorithm::make for a test.
template <class Test>
std::unique_ptr<Method> make_pairwise(const Bodies& bodies, const Knobs& knobs) {
  return std::make_unique<Pairwise<Test>>(bodies, knobs);
}

/// Of a test that keeps `bytes` of each body, and nothing else.
inline Memory memory_by_body(const Bodies& bodies, std::size_t bytes) {
  return {bytes * bodies.size(), bytes * bodies.size()};
}

}  // namespace algorithms
