#include "pipeline/stages/passes.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/config.hpp"
#include "pipeline/result/products/physics.hpp"
#include "pipeline/result/store.hpp"
#include "pipeline/run.hpp"
#include "pipeline/scene/scene.hpp"
#include "pipeline/stages/detect.hpp"
#include "pipeline/stages/truth.hpp"
#include "pipeline/terminal/error.hpp"
#include "tests/support/files.hpp"
#include "tests/support/synthetic_result.hpp"
#include "tests/support/temporary_folder.hpp"

using namespace pipeline;

namespace {

/// A ball of radius 1 on its way through a cube of side 2 by paths along x at three distances, and past a torus of
/// diameter 6 and thickness 1 (about y). The ball has vertices on its axes.
const std::string kScene =
    "[scene]\nkind = 'playground'\n"
    "[scene.hero]\nshape = 'sphere'\nradius = 1\nsegments = 6\n"
    "[[scene.obstacle]]\nname = 'cube'\nshape = 'box'\nsize = [2, 2, 2]\n"
    "[[scene.obstacle]]\nname = 'torus'\nshape = 'torus'\ndiameter = 6\nthickness = 1\n"
    "[[scene.path]]\naxis = 'x'\ntargets = ['cube']\n"
    "[[scene.path]]\naxis = 'x'\noffset = 3\ntargets = ['cube']\n"
    "[[scene.path]]\naxis = 'y'\ntargets = ['torus']\n";

struct Fixture {
  explicit Fixture(const std::string& scene_keys = kScene) : config(parse_config(scene_keys, "t.toml")) {
    scene = config.scene_kind->make(config);
    Checkpoint part(folder / "p", {}, "", config.steps, false);
    Progress quiet("truth", 1, true);
    truth = decide(scene.bodies, scene.script, 1, part, quiet);
    rows = pass_rows(scene.bodies, scene.script, truth, scene.passes, quiet);
  }

  Answers answers(const std::string& algorithm) const {
    Progress quiet("detect", 1, true);
    return detect(scene.bodies, scene.script, truth, {parse_algorithm(algorithm)}, 1, {}, nullptr, quiet)[0];
  }
  PassAnswers measured(const std::string& algorithm, Answers answers) const {
    Progress quiet("passes", 1, true);
    return pass_answers(scene.bodies, scene.script, truth, scene.passes, rows, answers, parse_algorithm(algorithm),
                        quiet);
  }
  PassAnswers measured(const std::string& algorithm) const { return measured(algorithm, answers(algorithm)); }

  TemporaryFolder folder;
  Config config;
  Scene scene;
  Truth truth;
  std::vector<PassRow> rows;
};

const double kRoot3 = std::sqrt(3.0);
const double kHalfWay = kRoot3 + kRoot3 + 1;  // bounding radii |(1, 1, 1)| of ball and cube, and 1 m

}  // namespace

// Answers that cannot be asked for again change half way between two samples.
TEST(Passes, OfGivenAnswersAreKnownToHalfASample) {
  const Fixture f;
  for (const char* algorithm : {"bounding_sphere", "obb_sat", "exact"}) {
    const Answers answers = f.answers(algorithm);
    const PassAnswers found = f.measured(algorithm, answers),
                      sampled = sampled_pass_answers(f.scene.passes, f.truth, f.rows, answers);
    EXPECT_EQ(sampled.hits, found.hits);
    EXPECT_EQ(sampled.flicker, found.flicker);
    for (std::size_t p = 0; p < f.rows.size(); ++p) {
      const double half = 0.5 * (position(f.scene.passes[p], 1) - position(f.scene.passes[p], 0));
      EXPECT_EQ(std::isnan(sampled.first[p]), std::isnan(found.first[p]));
      if (std::isnan(found.first[p])) continue;
      EXPECT_LE(std::abs(sampled.first[p] - found.first[p]), half * (1 + 1e-9) + kAlgorithmTolerance);
      EXPECT_LE(std::abs(sampled.last[p] - found.last[p]), half * (1 + 1e-9) + kAlgorithmTolerance);
    }
  }
}

// The foremost vertex of the ball touches the cube's face when its centre is 2 m before the cube's, and leaves it so.
TEST(Passes, TruthIsFoundToANanometre) {
  const Fixture f;
  ASSERT_EQ(f.rows.size(), 3u);
  EXPECT_EQ(f.rows[0].target, "cube");
  EXPECT_EQ(f.rows[0].path, "x");
  EXPECT_EQ(f.rows[0].orientation, "along");
  EXPECT_NEAR(f.rows[0].truth_first, kHalfWay - 2, kTruthTolerance);
  EXPECT_NEAR(f.rows[0].truth_last, kHalfWay + 2, kTruthTolerance);
  // Samples lie at equal distances, so those that meet can be counted.
  const double each = length(f.scene.passes[0]) / double(f.rows[0].samples - 1);
  EXPECT_EQ(f.rows[0].truth_hits, std::uint64_t(2 * std::floor(2 / each) + (f.rows[0].samples % 2)));
}

TEST(Passes, PositionsAreFoundFromTheSideWhereTheyMeet) {
  const Fixture f;
  const std::vector<geometry::Bvh> bvhs = geometry::build_bvhs(f.scene.bodies);
  geometry::Decision decision(f.scene.bodies, bvhs);
  const auto meets = [&](double metres) {
    auto at = f.scene.script[0];
    at[0] = pose_at(f.scene.passes[0], metres);
    return decision.meet(at, {0, 1});
  };
  EXPECT_TRUE(meets(f.rows[0].truth_first));
  EXPECT_FALSE(meets(f.rows[0].truth_first - 1.01 * kTruthTolerance));
  EXPECT_TRUE(meets(f.rows[0].truth_last));
  EXPECT_FALSE(meets(f.rows[0].truth_last + 1.01 * kTruthTolerance));
}

// Spheres around both boxes: 2 root 3 from centre to centre instead of 2.
TEST(Passes, BoundingSphereIsEarlyAndLateByTheCornersOfTheBoxes) {
  const Fixture f;
  const PassAnswers h = f.measured("bounding_sphere");
  EXPECT_NEAR(h.first[0], 2 * kRoot3 - 2, kAlgorithmTolerance + kTruthTolerance);
  EXPECT_NEAR(h.last[0], -(2 * kRoot3 - 2), kAlgorithmTolerance + kTruthTolerance);
  EXPECT_EQ(h.flicker[0], 0u);
  // Cannon.js knows the ball's own radius.
  EXPECT_NEAR(f.measured("cannon_sap").first[0], 1 + kRoot3 - 2, kAlgorithmTolerance + kTruthTolerance);
}

TEST(Passes, BoxesAreExactOnTheFaceOfACube) {
  const Fixture f;
  for (const char* algorithm : {"obb_sat", "rotated_aabb", "aabb"}) {
    const PassAnswers answers = f.measured(algorithm);
    EXPECT_NEAR(answers.first[0], 0, kAlgorithmTolerance + kTruthTolerance) << algorithm;
    EXPECT_NEAR(answers.last[0], 0, kAlgorithmTolerance + kTruthTolerance) << algorithm;
  }
}

TEST(Passes, APassThatNeverMeetsHasNoPositionsButItsReportsAreCounted) {
  const Fixture f;
  EXPECT_TRUE(std::isnan(f.rows[1].truth_first));  // 3 m beside, where 2 m meet
  EXPECT_EQ(f.rows[1].truth_hits, 0u);
  EXPECT_TRUE(std::isnan(f.rows[2].truth_first));  // through the middle of the ring
  EXPECT_TRUE(std::isnan(f.rows[2].truth_last));

  const PassAnswers g = f.measured("obb_sat");
  EXPECT_TRUE(std::isnan(g.first[1]));
  EXPECT_EQ(g.hits[1], 0u);
  EXPECT_TRUE(std::isnan(g.first[2]));
  // The ball's box and the ring's are 1 + 0.5 m high: reported within 1.5 m of the middle.
  const double each = length(f.scene.passes[2]) / double(f.rows[2].samples - 1);
  EXPECT_EQ(g.hits[2], std::uint64_t(2 * std::floor(1.5 / each) + (f.rows[2].samples % 2)));
  EXPECT_EQ(g.flicker[2], 0u);

  EXPECT_EQ(f.measured("facet_distance").hits[2], 0u);  // sees the hole

  const TargetSummary ring = summarise(f.rows, g, "torus");
  EXPECT_EQ(ring.passes, 1u);
  EXPECT_EQ(ring.met, 0u);
  EXPECT_EQ(ring.false_positives, 1u);
  EXPECT_TRUE(std::isnan(ring.median));
}

TEST(Passes, AnAlgorithmThatNeverReportsHasNoPositions) {
  const Fixture f;
  const PassAnswers i = f.measured("facet_triangles");  // one facet point on a box: no triangle
  EXPECT_TRUE(std::isnan(i.first[0]));
  EXPECT_TRUE(std::isnan(i.last[0]));
  EXPECT_EQ(i.hits[0], 0u);
  EXPECT_EQ(summarise(f.rows, i, "cube").missed, 1u);
}

// The lists of answers are changed by hand; the positions are asked of the algorithm.
TEST(Passes, FlickerCountsChangesWithinTheExactContactOnly) {
  const Fixture f;
  Answers answers = f.answers("aabb");
  const auto first = std::size_t(f.rows[0].first_step);
  std::vector<std::size_t> met;
  for (std::size_t i = 0; i < f.rows[0].samples; ++i)
    if (!f.truth.hits.at(first + i).empty()) met.push_back(first + i);
  ASSERT_GT(met.size(), 8u);
  PairLists changed;
  for (std::size_t s = 0; s < f.scene.script.size(); ++s) {
    const bool hidden = s == met[2] || s == met[4] || s == met[5];  // yes yes no yes no no yes: 4 changes
    const bool invented = s == met.front() - 2;                     // changes outside do not count
    const Pair pair{0, 1};
    if (invented)
      changed.append({&pair, 1});
    else if (hidden)
      changed.append({});
    else
      changed.append(answers.hits.at(s));
  }
  answers.hits = changed;
  const PassAnswers out = f.measured("aabb", answers);
  EXPECT_EQ(out.flicker[0], 4u);
  EXPECT_EQ(out.hits[0], met.size() - 3 + 1);
  EXPECT_EQ(f.measured("aabb").flicker[0], 0u);
}

// A first report at the first sample is one there: what was before is not known.
TEST(Passes, AReportAtBothEndsIsThatOfTheEnds) {
  const Fixture f(
      "[scene]\nkind = 'playground'\n[scene.hero]\nshape = 'sphere'\nradius = 1\n"
      "[[scene.obstacle]]\nname = 'cube'\nshape = 'box'\nsize = [2, 2, 2]\n"
      "[[scene.path]]\nfrom = [-2.5, 0, 0]\nto = [3, 0, 0]\n");
  const PassAnswers h = f.measured("bounding_sphere");  // reports up to 3.46 m
  EXPECT_NEAR(f.rows[0].truth_first, 0.5, kTruthTolerance);
  EXPECT_EQ(h.first[0], f.rows[0].truth_first);
  EXPECT_EQ(h.last[0], f.rows[0].truth_last - 5.5);
}

TEST(Passes, ADifferentStepFindsTheSamePositions) {
  const Fixture coarse, fine("[scene]\nstep = 0.03\n" + kScene.substr(std::string("[scene]\n").size()));
  EXPECT_NEAR(coarse.rows[0].truth_first, fine.rows[0].truth_first, kTruthTolerance);
  for (const char* algorithm : {"bounding_sphere", "facet_distance", "obb_triangles"}) {
    const double a = coarse.measured(algorithm).first[0], b = fine.measured(algorithm).first[0];
    EXPECT_NEAR(a, b, kAlgorithmTolerance + kTruthTolerance) << algorithm;
  }
}

TEST(Passes, WrittenReadAndWrittenAgainAreTheSameBytes) {
  const double kNaN = std::numeric_limits<double>::quiet_NaN();
  Result result = synthetic_result();
  result.products.put<Passes>({});
  result.products.find<Passes>()->rows = {{"cube", "x", "along", 1.7, 0, 3, 1.25, 2.5, 2},
                                          {"torus", "up", "given", 0, 3, 4}};
  for (double a = 0; a < 3; ++a)
    result.products.find<Passes>()->answers.push_back({{0.25 + a, kNaN}, {-a, kNaN}, {1, 2}, {3, 4}});

  const TemporaryFolder folder;
  write_result(result, folder / "a.h5");
  Result again = read_result(folder / "a.h5");
  ASSERT_TRUE(again.products.find<Passes>());
  ASSERT_EQ(again.products.find<Passes>()->rows.size(), 2u);
  EXPECT_EQ(again.products.find<Passes>()->rows[1].target, "torus");
  EXPECT_EQ(again.products.find<Passes>()->rows[1].orientation, "given");
  EXPECT_EQ(again.products.find<Passes>()->rows[1].first_step, 3u);
  EXPECT_EQ(again.products.find<Passes>()->rows[0].truth_last, 2.5);
  EXPECT_TRUE(std::isnan(again.products.find<Passes>()->rows[1].truth_first));
  EXPECT_EQ(again.products.find<Passes>()->answers[2].first[0], 2.25);
  EXPECT_EQ(again.products.find<Passes>()->answers[1].last[0], -1);
  EXPECT_TRUE(std::isnan(again.products.find<Passes>()->answers[0].first[1]));
  EXPECT_EQ(again.products.find<Passes>()->answers[0].hits, (std::vector<std::uint64_t>{3, 4}));
  write_result(again, folder / "b.h5");
  EXPECT_EQ(tests::bytes_of(folder / "a.h5"), tests::bytes_of(folder / "b.h5"));

  // They count into the root's digest.
  again.products.find<Passes>()->answers[0].flicker[1] = 9;
  write_result(again, folder / "c.h5");
  EXPECT_NE(again.digest, result.digest);
}

TEST(Passes, DetectAddsTheSameColumnsThatARunWrites) {
  const TemporaryFolder folder;
  const auto config = [](const std::string& algorithms) { return parse_config(kScene + algorithms, "t.toml"); };
  const std::string h = "[[algorithm]]\nname = 'bounding_sphere'\n", k = "[[algorithm]]\nname = 'facet_distance'\n";
  run(config(h), {.output = folder / "one.h5", .quiet = true});
  detect_again(folder / "one.h5", {"facet_distance"}, {.output = {}, .quiet = true});
  const Result added = read_result(folder / "one.h5");
  const Result both = run(config(h + k), {.output = folder / "both.h5", .quiet = true});
  ASSERT_TRUE(added.products.find<Passes>() && both.products.find<Passes>());
  EXPECT_FALSE(both.products.find<PhysicsRows>());
  ASSERT_EQ(added.products.find<Passes>()->answers.size(), 2u);
  for (std::size_t a = 0; a < 2; ++a) {
    EXPECT_EQ(added.products.find<Passes>()->answers[a].first[0], both.products.find<Passes>()->answers[a].first[0]);
    EXPECT_EQ(added.products.find<Passes>()->answers[a].last[0], both.products.find<Passes>()->answers[a].last[0]);
    EXPECT_EQ(added.products.find<Passes>()->answers[a].flicker, both.products.find<Passes>()->answers[a].flicker);
    EXPECT_EQ(added.products.find<Passes>()->answers[a].hits, both.products.find<Passes>()->answers[a].hits);
  }
  EXPECT_EQ(added.digest, both.digest);
}

TEST(Passes, AStopEndsTheStage) {
  const Fixture f;
  const Answers answers = f.answers("aabb");
  stop_wanted = true;
  EXPECT_THROW(f.measured("aabb", answers), Error);
  stop_wanted = false;
}
