#include "pipeline/stages/detect.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "geometry/meshes/shapes.hpp"
#include "pipeline/config.hpp"
#include "pipeline/result/products/machines.hpp"
#include "pipeline/stages/chunks.hpp"
#include "pipeline/stages/summary.hpp"
#include "pipeline/stages/truth.hpp"
#include "pipeline/system/heap.hpp"
#include "tests/support/temporary_folder.hpp"

using namespace pipeline;
using geometry::Pose;

namespace {

/// Three unit spheres on the x axis; the middle one moves from left to right in `steps` steps.
struct Row {
  geometry::Bodies bodies;
  std::vector<std::vector<Pose>> poses;

  explicit Row(int steps) {
    bodies.meshes.push_back(geometry::sphere("sphere", 1, 8));
    for (const char* name : {"left", "middle", "right"}) {
      bodies.add(name, 0);
    }
    for (int s = 0; s < steps; ++s) {
      std::vector<Pose> step(3);
      step[0].t = {-3, 0, 0};
      step[1].t = {-1.5 + 3.0 * s / (steps - 1), 0, 0};
      step[2].t = {3, 0, 0};
      poses.push_back(step);
    }
  }

  Truth truth() const {
    const TemporaryFolder folder;
    Checkpoint part(folder / "p", {}, "", std::int64_t(poses.size()), false);
    Progress quiet("truth", poses.size(), true);
    return decide(bodies, poses, 1, part, quiet);
  }
};

std::vector<AlgorithmChoice> choices(std::initializer_list<const char*> names) {
  std::vector<AlgorithmChoice> out;
  for (const char* name : names) out.push_back(parse_algorithm(name));
  return out;
}

std::vector<Answers> detected(const Row& row, const Truth& truth, const std::vector<AlgorithmChoice>& algorithms,
                              const Checkpoint* part = nullptr, std::int64_t repeats = 2) {
  Progress quiet("detect", row.poses.size(), true);
  return detect(row.bodies, row.poses, truth, algorithms, repeats, {}, part, quiet);
}

}  // namespace

Machine machine(const std::string& host, const std::string& processor) {
  Machine out;
  out.host = host;
  out.processor = processor;
  return out;
}

TEST(Truth, FollowsASphereFromOneNeighbourToTheOther) {
  const Row row(13);
  const Truth truth = row.truth();
  ASSERT_EQ(truth.hits.steps(), 13u);
  const auto at = [&](std::size_t s) { return std::vector<Pair>(truth.hits.at(s).begin(), truth.hits.at(s).end()); };
  EXPECT_EQ(at(0), (std::vector<Pair>{{0, 1}}));
  EXPECT_TRUE(at(6).empty());
  EXPECT_EQ(at(12), (std::vector<Pair>{{1, 2}}));
}

TEST(Truth, DoesNotDependOnThreadsAndIsResumed) {
  const Row row(120);  // three chunks
  const TemporaryFolder folder;
  Progress quiet("truth", 0, true);
  Checkpoint one(folder / "one", {}, "", 120, false), many(folder / "many", {}, "", 120, false);
  const Truth alone = decide(row.bodies, row.poses, 1, one, quiet);
  const Truth together = decide(row.bodies, row.poses, 3, many, quiet);
  EXPECT_EQ(alone.hits.pair, together.hits.pair);
  EXPECT_EQ(alone.hits.offset, together.hits.offset);
  // Kept chunks are taken as they are: also their times, which a second computation would not repeat.
  EXPECT_EQ(decide(row.bodies, row.poses, 1, one, quiet).time_ns, alone.time_ns);
}

TEST(Detect, TakesTheProcessorsTimeBesideTheWalls) {
  const Row row(13);
  const Answers answers = detected(row, row.truth(), choices({"exact_cold"}))[0];
  ASSERT_EQ(answers.processor_ns.size(), 13u);
  for (const std::int64_t time : answers.processor_ns) EXPECT_GT(time, 0);
}

TEST(Detect, CountsWhatAMethodCostsBesides) {
  const Row row(13);
  const Truth truth = row.truth();
  const auto answers = detected(row, truth, choices({"bounding_sphere", "exact_cold"}));
  for (const Answers& one : answers) {
    EXPECT_GT(one.costs.setup_ns, 0);
    if (!counts_heap()) continue;
    EXPECT_GE(one.costs.memory_greatest_bytes, one.costs.memory_bytes);
    EXPECT_GT(one.costs.memory_bytes, 0);
  }
  if (!counts_heap()) GTEST_SKIP() << "a sanitizer has its own malloc";
  // Five doubles a body in five blocks; a hierarchy takes more than its mesh's 112 triangles.
  EXPECT_LE(answers[0].costs.memory_bytes, 5 * 3 * 8 + 6 * 64 + 256);
  EXPECT_GT(answers[1].costs.memory_bytes, 112 * 12);
}

// Its list of hits is the caller's, however long it is.
TEST(Detect, DoesNotCountHitsAsAMethodsMemory) {
  if (!counts_heap()) GTEST_SKIP() << "a sanitizer has its own malloc";
  geometry::Bodies bodies;
  bodies.meshes.push_back(geometry::sphere("sphere", 1, 8));
  constexpr int kCount = 200;  // all in one place: 19,900 hits of 8 bytes
  for (int body = 0; body < kCount; ++body) bodies.add("b" + std::to_string(body), 0);
  Truth truth;
  truth.hits.append({});
  truth.time_ns = {0};
  Progress quiet("detect", 1, true);
  const Answers answers =
      detect(bodies, {std::vector<Pose>(kCount)}, truth, choices({"bounding_sphere"}), 1, {}, nullptr, quiet)[0];
  ASSERT_EQ(answers.hits.at(0).size(), std::size_t(kCount * (kCount - 1) / 2));
  EXPECT_LE(answers.costs.memory_greatest_bytes, 5 * kCount * 8 + 6 * 64 + 256);
}

TEST(Detect, TimesTheFirstOnceMoreForTheNoise) {
  const Row row(60);
  const Truth truth = row.truth();
  const TemporaryFolder folder;
  Checkpoint part(folder / "p", {}, "", 60, false);
  Progress quiet("detect", 60, true);
  const auto asked = choices({"aabb", "exact"});
  const auto ask = [&] { return detect(row.bodies, row.poses, truth, asked, 1, {}, &part, quiet, /*noise=*/true); };
  const auto first = ask();
  ASSERT_EQ(first.size(), 3u);
  EXPECT_EQ(first[2].name, "aabb");
  EXPECT_EQ(first[2].hits.pair, first[0].hits.pair);
  EXPECT_EQ(first[2].time_ns.size(), 60u);
  const auto again = ask();  // from the chunks
  EXPECT_EQ(again[2].time_ns, first[2].time_ns);
  EXPECT_EQ(again[0].costs.setup_ns, first[0].costs.setup_ns);
  if (counts_heap()) {
    EXPECT_EQ(again[1].costs.memory_greatest_bytes, first[1].costs.memory_greatest_bytes);
  }
}

TEST(Truth, FindsGapsOnlyWhereAsked) {
  const Row row(13);
  EXPECT_FALSE(row.truth().gaps);
  const TemporaryFolder folder;
  Checkpoint part(folder / "p", {}, "", 13, false);
  Progress quiet("truth", 13, true);
  const Truth truth = decide(row.bodies, row.poses, 1, part, quiet, Containment::ignore, 0.6);
  ASSERT_TRUE(truth.gaps);
  EXPECT_EQ(truth.gaps->margin, 0.6);
  // The middle sphere starts 0.5 m inside the left one, and its pole on the x axis moves 0.25 m a step: poles of the
  // others are at -2 and 2.
  for (std::size_t s = 0; s < 13; ++s) {
    const double left = -0.5 + 0.25 * double(s), right = 2.5 - 0.25 * double(s);
    std::vector<Pair> near;
    if (left > 0 && left <= 0.6) near.push_back({0, 1});
    if (right > 0 && right <= 0.6) near.push_back({1, 2});
    const auto found = truth.gaps->pairs.at(s);
    EXPECT_EQ(std::vector<Pair>(found.begin(), found.end()), near) << s;
    for (std::uint64_t i = truth.gaps->pairs.offset[s]; i < truth.gaps->pairs.offset[s + 1]; ++i) {
      const double distance = truth.gaps->pairs.pair[i].a == 0 ? left : right;
      EXPECT_LE(truth.gaps->lower[i], distance);
      EXPECT_GE(truth.gaps->upper[i], distance);
      EXPECT_NEAR(truth.gaps->lower[i], truth.gaps->upper[i], 1e-11);
    }
  }
}

TEST(Truth, GapsDoNotDependOnThreadsAndAreResumed) {
  const Row row(120);
  const TemporaryFolder folder;
  Progress quiet("truth", 0, true);
  Checkpoint one(folder / "one", {}, "", 120, false), many(folder / "many", {}, "", 120, false);
  const auto asked = [&](int threads, const Checkpoint& part) {
    return *decide(row.bodies, row.poses, threads, part, quiet, Containment::ignore, 1).gaps;
  };
  const GapLists alone = asked(1, one);
  ASSERT_GT(alone.lower.size(), 40u);
  const GapLists resumed = asked(1, one);
  for (const GapLists& other : {asked(3, many), resumed}) {
    EXPECT_EQ(alone.pairs.offset, other.pairs.offset);
    EXPECT_EQ(alone.pairs.pair, other.pairs.pair);
    EXPECT_EQ(alone.lower, other.lower);
    EXPECT_EQ(alone.upper, other.upper);
  }
}

TEST(Detect, ScoresEveryStepAgainstTheTruth) {
  const Row row(13);
  const Truth truth = row.truth();
  const std::vector<Answers> all = detected(row, truth, choices({"bounding_sphere", "rotated_aabb", "obb_sat"}));
  ASSERT_EQ(all.size(), 3u);
  for (const Answers& answers : all) {
    ASSERT_EQ(answers.hits.steps(), 13u);
    ASSERT_EQ(answers.time_ns.size(), 13u);
    for (std::size_t s = 0; s < 13; ++s) {
      EXPECT_EQ(answers.true_positive[s] + answers.false_positive[s], answers.hits.at(s).size());
      EXPECT_EQ(answers.true_positive[s] + answers.false_negative[s], truth.hits.at(s).size());
      EXPECT_GT(answers.time_ns[s], 0);
      EXPECT_GE(answers.time_median_ns[s], answers.time_ns[s]);
      EXPECT_GE(answers.time_ns[s], answers.prepare_ns[s]);
      EXPECT_GE(answers.operations[s], 3u) << "every pair is visited";
    }
  }
  // r = |h| = sqrt(3) for H: at 1.5 m from each neighbour's place all are reported.
  EXPECT_EQ(all[0].hits.at(6).size(), 2u);
}

TEST(Detect, TakesChunksFromThePartAndGoesOnAfterThem) {
  const Row row(120);
  const Truth truth = row.truth();
  const auto algorithms = choices({"bounding_sphere", "obb_sat", "exact"});  // the last one remembers
  const std::vector<Answers> whole = detected(row, truth, algorithms);
  const TemporaryFolder folder;
  Checkpoint part(folder / "p", {}, "", 120, false);
  const std::vector<Answers> first = detected(row, truth, algorithms, &part);
  std::filesystem::remove(folder / ("p/" + chunk_name("answers", 50)));
  const std::vector<Answers> again = detected(row, truth, algorithms, &part);
  for (std::size_t a = 0; a < algorithms.size(); ++a) {
    EXPECT_EQ(again[a].hits.pair, whole[a].hits.pair);
    EXPECT_EQ(again[a].hits.offset, whole[a].hits.offset);
    EXPECT_EQ(again[a].operations, whole[a].operations);
    ASSERT_EQ(again[a].time_ns.size(), 120u);
    EXPECT_EQ(again[a].time_ns[0], first[a].time_ns[0]);
    EXPECT_EQ(again[a].time_ns[119], first[a].time_ns[119]);
  }
}

// Workers take chunks in any order, and what one remembers is not what another does.
TEST(Detect, GivesTheSameInAnyOrderOfChunks) {
  const Row row(120);
  const Truth truth = row.truth();
  const auto algorithms = choices({"exact", "obb_sat", "bounding_sphere"});
  const std::vector<Answers> whole = detected(row, truth, algorithms);
  std::vector<std::size_t> order = {0, 1, 2};
  Progress quiet("detect", 0, true);
  do {
    Detector one(row.bodies, algorithms, 1, false), other(row.bodies, algorithms, 1, false);
    std::vector<std::string> chunks(3);
    for (const std::size_t chunk : order) {
      const auto [first, last] = steps_of_chunk(chunk, 120);
      Detector& worker = chunk == order[1] ? other : one;
      chunks[chunk] = worker.make(first, std::span(row.poses).subspan(std::size_t(first), std::size_t(last - first)),
                                  truth.some(std::size_t(first), std::size_t(last)),
                                  machine(chunk == order[1] ? "b" : "a", ""), nullptr, quiet);
    }
    std::vector<Answers> all = one.none();
    for (std::size_t chunk = 0; chunk < 3; ++chunk) one.append(chunks[chunk], steps_of_chunk(chunk, 120).count(), all);
    for (std::size_t a = 0; a < algorithms.size(); ++a) {
      EXPECT_EQ(all[a].hits.pair, whole[a].hits.pair);
      EXPECT_EQ(all[a].hits.offset, whole[a].hits.offset);
      EXPECT_EQ(all[a].operations, whole[a].operations);
      EXPECT_EQ(all[a].time_ns.size(), 120u);
      ASSERT_EQ(all[a].timed_on.size(), 3u);
      for (std::size_t chunk = 0; chunk < 3; ++chunk)
        EXPECT_EQ(all[a].timed_on[chunk].host, chunk == order[1] ? "b" : "a");
    }
  } while (std::ranges::next_permutation(order).found);
}

TEST(Truth, IsTheSameInAnyOrderOfChunks) {
  const Row row(120);
  const Truth whole = row.truth();
  TruthChunks chunks(row.bodies, {});
  Progress quiet("truth", 0, true);
  std::vector<std::string> bytes(3);
  for (const std::size_t chunk : {2u, 0u, 1u}) {
    const ChunkSteps at = steps_of_chunk(chunk, 120);
    bytes[chunk] = chunks.make(std::span(row.poses).subspan(std::size_t(at.first), at.count()), quiet);
  }
  Truth truth = chunks.none();
  for (std::size_t chunk = 0; chunk < 3; ++chunk)
    chunks.append(bytes[chunk], steps_of_chunk(chunk, 120).count(), truth);
  EXPECT_EQ(truth.hits.pair, whole.hits.pair);
  EXPECT_EQ(truth.hits.offset, whole.hits.offset);
  EXPECT_TRUE(truth.decided_on.empty()) << "one machine decided all";
}

// Times of two processors are no times of one: the label keeps those of its steps and has none of the run.
TEST(Detect, HasNoTimeOfTheRunOnUnlikeProcessors) {
  const Row row(120);
  const Truth truth = row.truth();
  std::vector<Answers> all = detected(row, truth, choices({"aabb", "obb_sat"}));
  all[1].machine = machine("n1", "slow");
  all[1].timed_on = {all[1].machine, machine("n2", "quick"), machine("n3", "slow")};
  EXPECT_FALSE(timed_on_unlike(all[0]));
  EXPECT_TRUE(timed_on_unlike(all[1]));
  EXPECT_GT(summarise(all[0], 360).time_mean_ns, 0);
  const Summary row_of_two = summarise(all[1], 360);
  for (const double time : {row_of_two.time_mean_ns, row_of_two.time_median_ns, row_of_two.time_p95_ns,
                            *row_of_two.time_mean_low_ns, *row_of_two.processor_mean_ns})
    EXPECT_TRUE(std::isnan(time));
  const auto times = times_by_processor(all[1]);
  ASSERT_EQ(times.size(), 2u);
  EXPECT_EQ(times[0].processor, "slow");
  EXPECT_EQ(times[0].steps, 70u);
  EXPECT_EQ(times[0].hosts, (std::vector<std::string>{"n1", "n3"}));
  EXPECT_EQ(times[1].steps, 50u);
  double sum = 0;
  for (std::size_t step = 50; step < 100; ++step) sum += double(all[1].time_ns[step]);
  EXPECT_DOUBLE_EQ(times[1].mean_ns, sum / 50);
  // The same processor in two machines is one.
  all[1].timed_on[1].processor = "slow";
  EXPECT_FALSE(timed_on_unlike(all[1]));
  EXPECT_GT(summarise(all[1], 360).time_mean_ns, 0);
}

TEST(Detect, MemoriesAreEmptyAtEveryChunkAndOnlyThere) {
  const Row row(120);
  const std::vector<Answers> all = detected(row, row.truth(), choices({"exact", "exact_cold"}));
  const std::vector<std::uint64_t>&warm = all[0].operations, &cold = all[1].operations;
  EXPECT_EQ(all[0].hits.pair, all[1].hits.pair);
  std::size_t cheaper = 0;
  for (std::size_t s = 0; s < 120; ++s) {
    if (s % kChunkSteps == 0) {
      EXPECT_EQ(warm[s], cold[s]) << s;
    }
    cheaper += warm[s] < cold[s];
  }
  EXPECT_GT(cheaper, 0u);
}

TEST(Detect, RepeatingChangesNothingThatIsRemembered) {
  const Row row(60);
  const Truth truth = row.truth();
  const std::vector<Answers> once = detected(row, truth, choices({"exact", "obb_sat"}), nullptr, 1);
  const std::vector<Answers> often = detected(row, truth, choices({"exact", "obb_sat"}), nullptr, 5);
  for (std::size_t a = 0; a < 2; ++a) {
    EXPECT_EQ(often[a].operations, once[a].operations);
    EXPECT_EQ(often[a].hits.pair, once[a].hits.pair);
  }
}

// A body that is not born takes part in no pair, whatever the algorithm.
TEST(Detect, UnbornBodiesTakePartInNoPair) {
  Row row(3);
  for (auto& step : row.poses) step[1] = geometry::unborn();
  row.poses[0][1] = Pose{.q = {}, .t = {-3, 0, 0}};
  const Truth truth = row.truth();
  std::vector<AlgorithmChoice> every;
  for (const auto& algorithm : algorithms::all()) every.push_back(parse_algorithm(algorithm.name));
  for (const Answers& answers : detected(row, truth, every)) {
    EXPECT_EQ(answers.hits.at(1).size(), 0u) << answers.label;
    EXPECT_EQ(answers.hits.at(2).size(), 0u) << answers.label;
  }
}

// What Method::answer must keep: an own broad phase that reports (b, a), strangers or a pair twice was scored as if it
// had reported them falsely.
TEST(Detect, RefusesHitsThatWereNotAskedAboutOnce) {
  using geometry::Pair;
  const std::vector<geometry::PairRun> runs = {{0, 1, 3}, {0, 4, 5}, {2, 3, 5}};
  const auto said = [&](std::vector<Pair> hits) -> std::string {
    try {
      check_hits(hits, runs);
    } catch (const std::logic_error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(said({}), "");
  EXPECT_EQ(said({{0, 1}, {0, 2}, {0, 4}, {2, 3}, {2, 4}}), "");
  EXPECT_EQ(said({{0, 4}, {2, 4}}), "");
  for (const Pair stranger : {Pair{0, 0}, {0, 3}, {0, 5}, {1, 0}, {1, 2}, {2, 2}, {2, 5}, {3, 2}, {9, 9}})
    EXPECT_NE(said({stranger}).find("was not asked about"), std::string::npos) << stranger.a << ' ' << stranger.b;
  EXPECT_NE(said({{0, 4}, {2, 3}, {2, 3}}).find("pair 2, 3 was reported before"), std::string::npos);
}
