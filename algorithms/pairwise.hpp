// From a test of one pair to a Method: the loop over pairs that the pairwise algorithms share.
//
// A test is a struct
//   Test(const Bodies&, const Knobs&)                          once per run
//   void prepare(std::span<const Pose>, double enlarge)        once per step
//   template <class Count> bool hit(uint32 a, uint32 b, Count& count) const
// where `count += n` notes n elementary tests; in the timed pass Count does nothing and vanishes.
// The loop sees the test's body, so a test lives in its .cpp and is inlined here.
#pragma once
#include "algorithms/algorithm.hpp"

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

/// A Method from a test of one pair.
template <class Test>
class Pairwise final : public Method {
 public:
  Pairwise(const Bodies& bodies, const Knobs& knobs) : test_(bodies, knobs) {}

  void prepare(std::span<const Pose> poses, double enlarge) override { test_.prepare(poses, enlarge); }

  void answer(std::span<const PairRun> runs, std::vector<Pair>& hits) override {
    NoCount none;
    visit(runs, hits, none);
  }

  std::uint64_t count(std::span<const PairRun> runs, std::vector<Pair>& hits) override {
    Counter counter;
    visit(runs, hits, counter);
    return counter.total;
  }

 private:
  template <class Count>
  void visit(std::span<const PairRun> runs, std::vector<Pair>& hits, Count& count) {
    for (const PairRun& run : runs)
      for (std::uint32_t b = run.first; b < run.last; ++b)
        if (test_.hit(run.a, b, count)) hits.push_back({run.a, b});
  }

  Test test_;
};

/// Algorithm::make for a test.
template <class Test>
std::unique_ptr<Method> make_pairwise(const Bodies& bodies, const Knobs& knobs) {
  return std::make_unique<Pairwise<Test>>(bodies, knobs);
}

}  // namespace algorithms
