// The recheck of a truth in memory: every kind of wrong list is found, whatever the threads.
#include "pipeline/commands/verify.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "geometry/decision/oracle.hpp"
#include "geometry/meshes/shapes.hpp"
#include "pipeline/terminal/error.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/setting.hpp"

namespace pipeline {
namespace {

using geometry::Pose;
using geometry::Vec3;

constexpr unsigned kSeed = 5;

/// Boxes and balls, some fixed, some born late, one by one closer together; the truth is the oracle's own.
Result crowd(std::size_t steps = 4, int count = 14, bool containment = false) {
  std::mt19937 random(kSeed);
  Result result;
  result.title = "crowd";
  result.bodies.meshes = {geometry::box("cube", {1, 1, 1}), geometry::sphere("ball", 0.7, 2),
                          geometry::box("room", {4, 4, 4})};
  for (int i = 0; i < count; ++i) {
    result.bodies.add("body" + std::to_string(i), i == 0 && containment ? 2 : std::uint32_t(i % 2), i % 5 == 0);
  }
  result.truth.containment = containment ? Containment::record : Containment::ignore;
  for (std::size_t s = 0; s < steps; ++s) {
    std::vector<Pose> poses;
    for (int i = 0; i < count; ++i) {
      const Vec3 t = setting::uniform_point(random, 2.5);
      const Pose pose{setting::uniform_turn(random), i == 0 && containment ? Vec3(0, 0, 0) : t};
      poses.push_back(i == 3 && s == 0 ? geometry::unborn() : pose);
    }
    result.motion.push_back(poses);
    std::vector<Pair> hits, contained;
    if (containment && s == 0) result.truth.contained_inside.emplace();
    for (const geometry::PairRun& run : geometry::pair_runs(result.bodies, poses))
      for (std::uint32_t b = run.first; b < run.last; ++b) {
        const auto t = geometry::brute_force::world_triangles(result.bodies.mesh_of(run.a), poses[run.a]);
        const auto u = geometry::brute_force::world_triangles(result.bodies.mesh_of(b), poses[b]);
        if (geometry::brute_force::meet(t, u))
          hits.push_back({run.a, b});
        else if (containment && (geometry::brute_force::contained(t, u) || geometry::brute_force::contained(u, t))) {
          contained.push_back({run.a, b});
          result.truth.contained_inside->push_back(geometry::brute_force::contained(t, u) ? run.a : b);
        }
      }
    result.truth.hits.append(hits);
    if (containment) result.truth.contained.append(contained);
  }
  return result;
}

Verified verify_all(const Result& result, int threads = 1) {
  return verify(result, {0, result.steps()}, std::nullopt, threads, true);
}

/// The lists with another list at one step.
PairLists with_step(const PairLists& lists, std::size_t step, std::vector<Pair> pairs) {
  std::ranges::sort(pairs);
  PairLists out;
  for (std::size_t s = 0; s < lists.steps(); ++s) {
    const auto kept = lists.at(s);
    out.append(s == step ? std::span<const Pair>(pairs) : kept);
  }
  return out;
}

std::vector<Pair> at(const PairLists& lists, std::size_t step) {
  const auto span = lists.at(step);
  return {span.begin(), span.end()};
}

TEST(Verify, CountsEveryPairInOneClass) {
  const Result result = crowd(4, 14, true);
  const Verified found = verify_all(result);
  EXPECT_FALSE(found.difference) << "seed " << kSeed;
  std::uint64_t touching = 0, pairs = 0;
  for (const auto& poses : result.motion)
    for (const geometry::PairRun& run : geometry::pair_runs(result.bodies, poses))
      for (std::uint32_t b = run.first; b < run.last; ++b) {
        const auto extent = [&](std::uint32_t body) {
          return geometry::brute_force::world_extent(result.bodies.mesh_of(body), poses[body]);
        };
        touching += geometry::brute_force::touch(extent(run.a), extent(b));
        ++pairs;
      }
  EXPECT_EQ(found.pairs(), pairs);
  EXPECT_EQ(found.meet.pairs, result.truth.hits.pair.size());
  EXPECT_EQ(found.contained.pairs, result.truth.contained.pair.size());
  EXPECT_EQ(found.meet.pairs + found.contained.pairs + found.near.pairs, touching);
  EXPECT_EQ(found.checked(), touching);
  EXPECT_GT(found.contained.pairs, 0u);
  EXPECT_GT(found.near.pairs, 0u);
  EXPECT_GT(found.far, 0u);
}

TEST(Verify, CountsOnlyPairsWithAChosenBody) {
  Result result = crowd();
  result.bodies.chosen.assign(result.bodies.size(), 0);
  result.bodies.chosen[2] = result.bodies.chosen[5] = 1;
  std::uint64_t pairs = 0;
  for (std::size_t s = 0; s < result.steps(); ++s) {
    std::vector<Pair> kept = at(result.truth.hits, s);
    std::erase_if(kept, [&](Pair p) { return !result.bodies.chosen[p.a] && !result.bodies.chosen[p.b]; });
    result.truth.hits = with_step(result.truth.hits, s, kept);
    pairs += geometry::pair_count(geometry::pair_runs(result.bodies, result.motion[s]));
  }
  const Verified found = verify_all(result);
  EXPECT_FALSE(found.difference);
  EXPECT_EQ(found.pairs(), pairs);
}

TEST(Verify, FindsAPairLeftOut) {
  Result result = crowd();
  std::vector<Pair> pairs = at(result.truth.hits, 2);
  const Pair lost = pairs.back();
  pairs.pop_back();
  result.truth.hits = with_step(result.truth.hits, 2, pairs);
  for (const int threads : {1, 4}) {
    const Verified found = verify_all(result, threads);
    ASSERT_TRUE(found.difference);
    EXPECT_EQ(found.difference->step, 2u);
    EXPECT_EQ(found.difference->pair, lost);
    EXPECT_EQ(found.difference->truth, Relation::apart);
    EXPECT_EQ(found.difference->oracle, Relation::meet);
    EXPECT_EQ(found.checked(), verify_all(result, 1).checked());
  }
  EXPECT_NE(difference_text(verify_all(result), result).find("the truth says apart, the oracle says meet"),
            std::string::npos);
}

TEST(Verify, FindsEveryPairThatIsInvented) {
  const Result right = crowd();
  int near = 0, far = 0, none = 0;
  for (std::uint32_t a = 0; a < 6; ++a)
    for (std::uint32_t b = a + 1; b < right.bodies.size(); ++b) {
      Result result = right;
      std::vector<Pair> pairs = at(right.truth.hits, 0);
      if (std::ranges::binary_search(pairs, Pair{a, b})) continue;
      pairs.push_back({a, b});
      result.truth.hits = with_step(right.truth.hits, 0, pairs);
      const Verified found = verify(result, {0, 1}, std::nullopt, 1, true);
      ASSERT_TRUE(found.difference) << a << ", " << b;
      EXPECT_EQ(found.difference->pair, (Pair{a, b}));
      EXPECT_EQ(found.difference->truth, Relation::meet);
      const bool counts = geometry::is_born(right.motion[0][a]) && geometry::is_born(right.motion[0][b]) &&
                          !(right.bodies.fixed[a] && right.bodies.fixed[b]);
      EXPECT_EQ(found.difference->oracle, counts ? Relation::apart : Relation::no_pair);
      // Without the oracle's help where the boxes are apart: also when no pair of this step is drawn.
      const Verified sampled = verify(result, {0, 1}, 1, 1, true);
      far += counts && sampled.difference && sampled.checked() == 0;
      none += !counts;
      near += counts;
    }
  EXPECT_GT(near, 10);
  EXPECT_GT(far, 3);
  EXPECT_GT(none, 3);
}

TEST(Verify, TellsTheFirstOfSeveralDifferences) {
  Result result = crowd();
  for (const std::size_t step : {3u, 1u}) {
    std::vector<Pair> pairs = at(result.truth.hits, step);
    pairs.erase(pairs.begin());
    result.truth.hits = with_step(result.truth.hits, step, pairs);
  }
  for (const int threads : {1, 2, 4}) EXPECT_EQ(verify_all(result, threads).difference->step, 1u);
}

TEST(Verify, FindsWrongContainment) {
  const Result right = crowd(4, 14, true);
  std::size_t step = 0;
  while (right.truth.contained.at(step).empty()) ++step;
  Result left_out = right;
  left_out.truth.contained = with_step(right.truth.contained, step, {});
  left_out.truth.contained_inside.reset();
  auto found = verify_all(left_out).difference;
  ASSERT_TRUE(found);
  EXPECT_EQ(found->truth, Relation::apart);
  EXPECT_TRUE(found->oracle == Relation::a_inside || found->oracle == Relation::b_inside);

  Result invented = right;
  invented.truth.contained = with_step(right.truth.contained, step, at(right.truth.hits, step));
  invented.truth.contained_inside.reset();
  found = verify_all(invented).difference;
  ASSERT_TRUE(found);
  EXPECT_EQ(found->truth, Relation::contained);
  EXPECT_EQ(found->oracle, Relation::meet);

  // The room is body 0: others lie in it, not it in them.
  Result turned = right;
  const std::size_t entry = right.truth.contained.offset[step];
  const Pair pair = right.truth.contained.pair[entry];
  ASSERT_EQ(pair.a, 0u);
  ASSERT_EQ(right.truth.contained_inside->at(entry), pair.b);
  turned.truth.contained_inside->at(entry) = pair.a;
  found = verify_all(turned).difference;
  ASSERT_TRUE(found);
  EXPECT_EQ(found->pair, pair);
  EXPECT_EQ(found->truth, Relation::a_inside);
  EXPECT_EQ(found->oracle, Relation::b_inside);
}

// Closed by its corners a hair apart: the oracle finds the same surface by itself, and differs where it is told another
// width.
TEST(Verify, JudgesMeshesWithHairsByTheirWidth) {
  Result result = crowd(4, 14, true);
  ASSERT_GT(result.truth.contained.pair.size(), 0u);
  geometry::Mesh& room = result.bodies.meshes[2];
  room.vertices.push_back(room.vertices[room.triangles[0][0]] + Vec3(0x1p-40, 0, 0));
  room.triangles[0][0] = std::uint32_t(room.vertices.size() - 1);
  EXPECT_FALSE(verify_all(result).difference);
  result.bodies.closed_within = 0;
  const auto found = verify_all(result).difference;
  ASSERT_TRUE(found);
  EXPECT_EQ(found->truth, Relation::b_inside);
  EXPECT_EQ(found->oracle, Relation::apart);
}

TEST(Verify, DrawsTheSamePairsAgainInEqualShares) {
  const Result result = crowd(8, 24);
  const Verified one = verify(result, {0, 8}, 40, 1, true), two = verify(result, {0, 8}, 40, 3, true);
  EXPECT_EQ(one.meet.checked, 20u);
  EXPECT_EQ(one.near.checked, 20u);
  EXPECT_EQ(verified_json(one, result, "x"), verified_json(two, result, "x"));
}

TEST(Verify, SaysThatEndlessMotionCannotBeJudged) {
  Result result = crowd();
  result.motion[1][4].t.x() = std::numeric_limits<double>::infinity();
  EXPECT_NE(tests::refusal_of([&] { verify_all(result); }, kFailed).find("step 1: the world vertices of 'body4'"),
            std::string::npos);
  EXPECT_FALSE(verify(result, {2, 4}, std::nullopt, 1, true).difference);
}

TEST(StepRange, IsHalfOpenAndItsEndsMayBeLeftOut) {
  const auto is = [](const std::string& text, std::uint64_t first, std::uint64_t last) {
    const StepRange range = step_range(text, 10, "x.h5");
    return range.first == first && range.last == last;
  };
  EXPECT_TRUE(is("2:5", 2, 5));
  EXPECT_TRUE(is(":5", 0, 5));
  EXPECT_TRUE(is("2:", 2, 10));
  EXPECT_TRUE(is(":", 0, 10));
  EXPECT_TRUE(is("9:10", 9, 10));
  for (const char* text : {"", "3", "a:", "1:b", "1:2:3", "-1:2", "+1:2", " 1:2", "1:2 ", "0x1:2"})
    EXPECT_NE(step_range_flaw(text), "") << text;
  for (const char* text : {"5:5", "6:5", "0:11", "10:"}) EXPECT_THROW(step_range(text, 10, "x.h5"), Error) << text;
}

}  // namespace
}  // namespace pipeline
