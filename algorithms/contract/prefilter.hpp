// A fast method in front of a precise one: the pair goes on only if the prefilter reports it.
//
// The thesis proposes to find the best combination (section 6.1), so the prefilter is a knob: "none", or the name of
// any pairwise algorithm, which then runs with its presets. It answers all pairs of a step first; the precise test
// then visits its candidates. Operations are those of both.
#pragma once
#include "algorithms/contract/pairwise.hpp"

namespace algorithms {

/// The knob `prefilter`, rotated_aabb by default; the table of all algorithms adds what it may name.
Knob prefilter_knob();

/// Algorithm::operations_unit of a row with a prefilter, from the unit of its own tests: names the prefilter's as well.
std::string with_prefilter(std::string_view unit);

/// The prefilter that `knobs` name, for these bodies; nullptr for "none". `knobs` has a prefilter.
std::unique_ptr<Method> make_prefilter(const Bodies& bodies, const Knobs& knobs);

/// A Method from a test of one pair behind a prefilter. The test is as pairwise.hpp says; its `prepare` is called for
/// every body, also those that no candidate has, so costly work per body is better left to the body's first pair.
template <class Test>
class Filtered final : public Method {
 public:
  Filtered(const Bodies& bodies, const Knobs& knobs)
      : prefilter_(make_prefilter(bodies, knobs)), test_(bodies, knobs) {}

  void prepare(std::span<const Pose> poses, double enlarge) override {
    if (prefilter_) prefilter_->prepare(poses, enlarge);
    test_.prepare(poses, enlarge);
  }

  void answer(std::span<const PairRun> runs, std::vector<Pair>& hits) override {
    if (!prefilter_) return visit(test_, runs, hits);
    candidates_.clear();
    prefilter_->answer(runs, candidates_);
    NoCount none;
    visit_candidates(hits, none);
  }

  std::uint64_t count(std::span<const PairRun> runs, std::vector<Pair>& hits) override {
    Counter counter;
    if (!prefilter_) {
      visit_pairs(test_, runs, hits, counter);
      return counter.total;
    }
    candidates_.clear();
    counter += prefilter_->count(runs, candidates_);
    visit_candidates(hits, counter);
    return counter.total;
  }

 private:
  template <class Count>
  void visit_candidates(std::vector<Pair>& hits, Count& count) {
    for (const Pair pair : candidates_)
      if (test_.hit(pair.a, pair.b, count)) hits.push_back(pair);
  }

  std::unique_ptr<Method> prefilter_;
  Test test_;
  std::vector<Pair> candidates_;  // of the step; keeps its capacity
};

/// What the prefilter that `knobs` name takes; nothing for "none".
Memory prefilter_memory(const Bodies& bodies, const Knobs& knobs);

/// Algorithm::memory for a test behind a prefilter.
template <class Test>
Memory filtered_memory(const Bodies& bodies, const Knobs& knobs) {
  const Memory first = prefilter_memory(bodies, knobs), test = Test::memory(bodies, knobs);
  return {first.held + test.held, std::max(first.greatest, first.held + test.greatest)};
}

/// Algorithm::make for a test behind a prefilter. The row's knobs hold prefilter_knob().
template <class Test>
std::unique_ptr<Method> make_filtered(const Bodies& bodies, const Knobs& knobs) {
  return std::make_unique<Filtered<Test>>(bodies, knobs);
}

}  // namespace algorithms
