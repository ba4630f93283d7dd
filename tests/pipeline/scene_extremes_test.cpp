#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "geometry/decision/oracle.hpp"
#include "pipeline/config.hpp"
#include "pipeline/scene/kinds/extremes.hpp"
#include "pipeline/scene/scene.hpp"
#include "pipeline/stages/extremes.hpp"
#include "pipeline/stages/truth.hpp"
#include "pipeline/terminal/error.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/scene_size.hpp"
#include "tests/support/temporary_folder.hpp"

using namespace pipeline;
using geometry::Pose;
using geometry::Vec3;

namespace {

const std::string kScene = "[scene]\nkind = \"extremes\"\n";
const std::string kSmall =
    "pairs = [\"box-capsule\", \"needle-box\", \"sliver-sliver\", \"box-nested_box\", \"coplanar_boxes\", "
    "\"coplanar_sheets\"]\nscales = [1e-9, 1, 1e9]\noffsets = [0, 1e3, 1e9]\n";

Config extremes(const std::string& keys = kSmall, const std::string& root = "") {
  return parse_config(root + kScene + keys, "t.toml");
}

Scene made(const Config& config) { return config.scene_kind->make(config); }

bool oracle_meets(const geometry::Bodies& bodies, std::uint32_t a, const Pose& at_a, std::uint32_t b,
                  const Pose& at_b) {
  return geometry::brute_force::meet(geometry::brute_force::world_triangles(bodies.mesh_of(a), at_a),
                                     geometry::brute_force::world_triangles(bodies.mesh_of(b), at_b));
}

std::string refusal(const std::string& keys, const std::string& root = "") {
  return tests::refusal_of([&] { extremes(keys, root); });
}

Truth truth_of(const Scene& scene, Containment containment = Containment::ignore) {
  const TemporaryFolder folder;
  const auto steps = std::int64_t(scene.script.size());
  Checkpoint part(folder / "p", {}, "", steps, false);
  Progress quiet("truth", 0, true);
  return decide(scene.bodies, scene.script, 1, part, quiet, containment);
}

}  // namespace

// By the oracle: the pair at gap 0 meets, one ulp apart it does not, whatever scale and offset.
TEST(Extremes, GapNothingTouchesAndOneUlpFartherDoesNot) {
  const Scene scene = made(extremes());
  std::size_t touching = 0;
  for (const CaseSet& set : scene.case_sets)
    for (auto s = std::size_t(set.first_step); s < std::size_t(set.first_step + set.steps); ++s) {
      const std::int64_t ulps = scene.cases[s].gap_ulps;
      if (ulps != 0 && ulps != 1) continue;
      EXPECT_EQ(oracle_meets(scene.bodies, set.a, scene.script[s][set.a], set.b, scene.script[s][set.b]), ulps == 0)
          << scene.cases[s].pair << " at scale " << scene.cases[s].scale << ", offset " << scene.cases[s].offset;
      touching += ulps == 0;
    }
  EXPECT_EQ(touching, scene.case_sets.size());
}

TEST(Extremes, TheGapIsTheDisplacementAlongOneAxis) {
  const Scene scene = made(extremes());
  for (const CaseSet& set : scene.case_sets) {
    const auto at = [&](std::int64_t i) { return scene.script[std::size_t(set.first_step + i)][set.b].t; };
    std::int64_t zero = 0;
    while (scene.cases[std::size_t(set.first_step + zero)].gap_ulps != 0) ++zero;
    double before = -1e300;
    for (std::int64_t i = 0; i < set.steps; ++i) {
      const ExtremeCase& row = scene.cases[std::size_t(set.first_step + i)];
      const Vec3 by = at(i) - at(zero);  // exact: multiples of one ulp
      EXPECT_EQ(by, double(row.gap_ulps) * set.outward);
      EXPECT_EQ(by.cwiseAbs().sum(), std::fabs(row.gap));
      EXPECT_EQ(set.outward.cwiseAbs().sum(), row.ulp);
      EXPECT_EQ(scene.script[std::size_t(set.first_step + i)][set.a].t, Vec3::Constant(row.offset));
      if (row.gap_class.ends_with("ulp")) {
        std::string text = row.gap_ulps > 0 ? "+" : "";  // `"" + std::string` has GCC 12 warn of an overlap (PR 105651)
        text += std::to_string(row.gap_ulps) + " ulp";
        EXPECT_EQ(row.gap_class, text);
      } else {
        EXPECT_NEAR(row.gap, std::strtod(row.gap_class.c_str(), nullptr) * row.scale, 0.5 * row.ulp);
        EXPECT_GE(row.gap, before);  // from deep to apart
        before = row.gap;
      }
      // Twice as far as either body goes, doubles are no farther apart than an ulp.
      const double greatest = std::max(at(i).cwiseAbs().maxCoeff(), row.offset) + 2 * row.scale;
      EXPECT_LE(std::nextafter(greatest, 1e300) - greatest, row.ulp);
    }
  }
}

TEST(Extremes, MovingBothIsExact) {
  const Scene scene = made(extremes());
  for (const CaseSet& set : scene.case_sets)
    for (auto s = std::size_t(set.first_step); s < std::size_t(set.first_step + set.steps); ++s)
      for (const std::uint32_t body : {set.a, set.b}) {
        const Vec3& t = scene.script[s][body].t;
        EXPECT_EQ((t + set.moved) - t, set.moved);
        EXPECT_EQ((t + set.moved) - set.moved, t);
      }
}

TEST(Extremes, OnePairIsThereAtAStep) {
  const Scene scene = made(extremes());
  for (const CaseSet& set : scene.case_sets)
    for (std::int64_t s = set.first_step; s < set.first_step + set.steps; ++s) {
      const auto& poses = scene.script[std::size_t(s)];
      ASSERT_EQ(std::ranges::count_if(poses, geometry::is_born), 2);
      ASSERT_TRUE(geometry::is_born(poses[set.a]) && geometry::is_born(poses[set.b]));
      ASSERT_EQ(geometry::pair_count(geometry::pair_runs(scene.bodies, poses)), 1u);
    }
}

TEST(Extremes, HasEveryBuiltInPairAndLimitsOffsets) {
  const Config config = extremes("");
  const auto& scene = config.keys<ExtremesScene>();
  EXPECT_EQ(scene.pairs.size(), 24u);
  for (const char* a : {"sphere", "box", "capsule", "torus", "torus_knot"})
    for (const char* b : {"sphere", "box", "capsule", "torus", "torus_knot"}) {
      const bool one = std::ranges::count(scene.pairs, std::string(a) + "-" + b) == 1;
      const bool other = std::ranges::count(scene.pairs, std::string(b) + "-" + a) == 1;
      EXPECT_TRUE(one || other) << a << b;
    }
  std::set<std::pair<double, double>> places;
  for (const ExtremeCase& row : made(extremes("pairs = [\"box-box\"]\n")).cases) places.insert({row.scale, row.offset});
  EXPECT_EQ(places.size(), 25u);
  for (const auto& [scale, offset] : places) EXPECT_LE(offset, 0x1p40 * scale);
  EXPECT_TRUE(places.contains({1e-9, 1e3}));
  EXPECT_FALSE(places.contains({1e-9, 1e6}));
}

TEST(Extremes, SizeAndStepsAreKnownWithoutMakingIt) {
  const Config config = extremes();
  const SceneSize size = config.scene_kind->size(config);
  const Scene scene = made(config);
  tests::expect_size(size, scene);
  EXPECT_EQ(size.asked.at("case_sets"), scene.case_sets.size());
  EXPECT_EQ(config.steps, std::int64_t(scene.script.size()));
  EXPECT_EQ(scene.cases.size(), scene.script.size());

  const Scene fewer = made(extremes(kSmall, "steps = 50\n"));
  EXPECT_EQ(fewer.script.size(), 50u);
  EXPECT_EQ(fewer.case_sets.back().first_step + fewer.case_sets.back().steps, 50);
}

TEST(Extremes, MeshesAreClosedButForSheetsAndNeedlesAreThin) {
  const Scene scene = made(extremes());
  for (const geometry::Mesh& mesh : scene.bodies.meshes)
    EXPECT_EQ(geometry::is_closed(mesh), !mesh.name.starts_with("sheet")) << mesh.name;
  // At an offset of 1e9 scales the needle is thinner than an ulp: its world triangles have no area.
  for (const CaseSet& set : scene.case_sets) {
    const ExtremeCase& row = scene.cases[std::size_t(set.first_step)];
    if (row.pair != "needle-box" || row.scale != 1 || row.offset != 1e9) continue;
    const auto triangles = geometry::brute_force::world_triangles(scene.bodies.mesh_of(set.a),
                                                                  scene.script[std::size_t(set.first_step)][set.a]);
    EXPECT_TRUE(std::ranges::all_of(triangles, geometry::is_degenerate));
  }
}

TEST(Extremes, SeedsTurnTheBodiesAndTheEffectiveConfigurationGivesTheSame) {
  const Config config = extremes();
  const Config again = parse_config(config.effective, "t.toml");
  EXPECT_EQ(again.effective, config.effective);
  const Scene a = made(config), b = made(again), other = made(extremes(kSmall, "seed = 2\n"));
  for (std::size_t s = 0; s < a.script.size(); ++s)
    for (std::size_t i = 0; i < a.script[s].size(); ++i) {
      if (!geometry::is_born(a.script[s][i])) continue;
      ASSERT_EQ(a.script[s][i].t, b.script[s][i].t);
      ASSERT_EQ(a.script[s][i].q.w, b.script[s][i].q.w);
    }
  EXPECT_NE(a.script[0][a.case_sets[0].a].q.w, other.script[0][other.case_sets[0].a].q.w);
}

// Near touching is what the oracle sees change within a thousand ulps.
TEST(Extremes, RowsTellTruthAndWhatIsNearTouching) {
  const Scene scene = made(extremes("pairs = [\"needle-needle\", \"box-box\"]\nscales = [1]\noffsets = [0, 1e6]\n"));
  const Truth truth = truth_of(scene);
  Progress quiet("cases", 0, true);
  const auto rows = extreme_rows(scene.bodies, scene.script, truth, scene.case_sets, scene.cases, quiet);
  std::size_t near = 0, far = 0;
  for (const CaseSet& set : scene.case_sets)
    for (auto s = std::size_t(set.first_step); s < std::size_t(set.first_step + set.steps); ++s) {
      const Pose &a = scene.script[s][set.a], &b = scene.script[s][set.b];
      const auto meets = [&](double ulps) {
        return oracle_meets(scene.bodies, set.a, a, set.b, {b.q, b.t + ulps * set.outward});
      };
      EXPECT_EQ(rows[s].truth, meets(0));
      EXPECT_EQ(rows[s].truth_moved,
                oracle_meets(scene.bodies, set.a, {a.q, a.t + set.moved}, set.b, {b.q, b.t + set.moved}));
      const bool changes = meets(-1000) != meets(0) || meets(1000) != meets(0);
      EXPECT_EQ(rows[s].near_touching, changes || std::abs(rows[s].gap_ulps) <= 1000) << rows[s].gap_class;
      (rows[s].near_touching ? near : far) += 1;
    }
  EXPECT_GT(near, 20u);
  EXPECT_GT(far, 20u);
}

// What is well inside stays there when both are moved. It was asked by surface alone, and every nested case looked as
// if the truth had changed.
TEST(Extremes, MovingKeepsTheContainedContainedWhereTheyMeet) {
  const Scene scene =
      made(extremes("pairs = [\"box-nested_box\", \"sphere-nested_sphere\"]\nscales = [1]\noffsets = [0]\n"));
  const Truth truth = truth_of(scene, Containment::meet);
  Progress quiet("cases", 0, true);
  std::size_t nested = 0;
  const auto rows = extreme_rows(scene.bodies, scene.script, truth, scene.case_sets, scene.cases, quiet);
  for (std::size_t s = 0; s < rows.size(); ++s) {
    if (truth.contained.at(s).empty() || rows[s].gap_ulps <= 1000) continue;
    EXPECT_EQ(rows[s].truth, 1);
    EXPECT_EQ(rows[s].truth_moved, 1) << rows[s].pair << ' ' << rows[s].gap_class;
    ++nested;
  }
  EXPECT_GT(nested, 10u);
}

// A mesh that an algorithm refuses is data: the other algorithms and the other meshes are answered.
TEST(Extremes, ARefusalIsRecordedAndTheRestIsAnswered) {
  const Scene scene = made(extremes("pairs = [\"box-box\"]\nscales = [1, 1e6]\noffsets = [0]\n"));
  const Truth truth = truth_of(scene);
  std::vector<AlgorithmChoice> choices = {parse_algorithm("facet_distance"), parse_algorithm("aabb")};
  Progress quiet("detect", 0, true);
  const TemporaryFolder folder;
  Checkpoint part(folder / "p", {}, "", std::int64_t(scene.script.size()), false);
  const auto found = detect_extremes(scene.bodies, scene.script, truth, scene.case_sets, choices, 1, {}, &part, quiet);
  ASSERT_EQ(found.cases.size(), 2u);
  for (std::size_t s = 0; s < scene.script.size(); ++s) {
    EXPECT_EQ(found.cases[0].failed[s], scene.cases[s].scale == 1 ? 0 : 1);
    EXPECT_EQ(found.cases[1].failed[s], 0);
    EXPECT_EQ(found.cases[0].reported[s], found.answers[0].hits.at(s).size());
    EXPECT_EQ(found.answers[0].false_negative[s] + found.answers[0].true_positive[s], truth.hits.at(s).size());
    if (found.cases[0].failed[s]) {
      EXPECT_EQ(found.answers[0].hits.at(s).size(), 0u);
    }
    // aabb is conservative, symmetric, and knows no origin.
    if (!truth.hits.at(s).empty()) {
      EXPECT_EQ(found.cases[1].reported[s], 1);
    }
    EXPECT_EQ(found.cases[1].swapped[s], found.cases[1].reported[s]);
    for (const geometry::Pair& pair : found.answers[1].hits.at(s)) EXPECT_LT(pair.a, pair.b);
  }
  EXPECT_NE(found.cases[0].reason.find("denser"), std::string::npos) << found.cases[0].reason;
  EXPECT_EQ(found.cases[1].reason, "");

  // From its chunks: the same, times too.
  const auto again = detect_extremes(scene.bodies, scene.script, truth, scene.case_sets, choices, 1, {}, &part, quiet);
  for (std::size_t a = 0; a < 2; ++a) {
    EXPECT_EQ(again.answers[a].time_ns, found.answers[a].time_ns);
    EXPECT_EQ(again.answers[a].hits.pair, found.answers[a].hits.pair);
    EXPECT_EQ(again.answers[a].operations, found.answers[a].operations);
    EXPECT_EQ(again.cases[a].failed, found.cases[a].failed);
    EXPECT_EQ(again.cases[a].swapped, found.cases[a].swapped);
    EXPECT_EQ(again.cases[a].reason, found.cases[a].reason);
  }
}

// Moved so far that the coordinates swallow the bodies, all of them meet: `moved` is an answer about the moved ones.
TEST(Extremes, MovedIsTheAnswerAboutTheMovedBodies) {
  Scene scene = made(extremes("pairs = [\"box-box\"]\nscales = [1]\noffsets = [0]\n"));
  for (CaseSet& set : scene.case_sets) set.moved = Vec3::Constant(1e30);
  const std::vector<AlgorithmChoice> choices = {parse_algorithm("aabb")};
  Progress quiet("detect", 0, true);
  const auto found =
      detect_extremes(scene.bodies, scene.script, truth_of(scene), scene.case_sets, choices, 1, {}, nullptr, quiet);
  EXPECT_TRUE(std::ranges::all_of(found.cases[0].moved, [](std::uint8_t moved) { return moved == 1; }));
  EXPECT_FALSE(std::ranges::all_of(found.cases[0].reported, [](std::uint8_t reported) { return reported == 1; }));
}

TEST(Extremes, CountsLeaveFailuresOut) {
  Extremes extremes;
  extremes.rows.resize(5);
  for (const std::size_t s : {0, 1, 4}) extremes.rows[s].truth = extremes.rows[s].truth_moved = 1;
  extremes.rows[3].truth_moved = 1;
  extremes.answers.push_back({.reported = {1, 0, 1, 0, 0},
                              .swapped = {1, 1, 1, 0, 0},
                              .moved = {0, 0, 1, 1, 0},
                              .failed = {0, 0, 0, 0, 2},
                              .reason = {}});
  const ExtremesCount all = count(extremes, 0, [](const ExtremeCase&) { return true; });
  EXPECT_EQ(all.cases, 5u);
  EXPECT_EQ(all.failed, 1u);
  EXPECT_EQ(all.true_positive, 1u);
  EXPECT_EQ(all.false_positive, 1u);
  EXPECT_EQ(all.false_negative, 1u);
  EXPECT_DOUBLE_EQ(all.error(), 2.0 / 3);
  EXPECT_EQ(instability(extremes, 0).swapped, 1u);
  EXPECT_EQ(instability(extremes, 0).moved, 1u);  // of 0; at 3 the truth changed too
  EXPECT_TRUE(std::isnan(count(extremes, 0, [](const ExtremeCase&) { return false; }).error()));
}

TEST(Extremes, BadKeysAreRefusedWithPlaceAndRule) {
  const auto refused = [](const std::string& keys, const std::string& place, const std::string& words) {
    const std::string message = refusal(keys);
    EXPECT_EQ(message.substr(0, place.size()), place) << message;
    EXPECT_NE(message.find(words), std::string::npos) << message;
  };
  refused("pairs = [\"box-bix\"]\n", "t.toml:3:10: ", "'scene.pairs.0' must be");
  refused("pairs = [\"box-box\", \"box-box\"]\n", "t.toml:3:9: ", "name each only once");
  refused("scales = []\n", "t.toml:3:10: ", "be an array of at least one number");
  refused("scales = [1, 2, 1]\n", "t.toml:3:10: ", "name each only once");
  refused("scales = [1e10]\n", "t.toml:3:11: ", "'scene.scales.0' must be a number of at least 1e-9 and at most 1e9");
  refused("scales = [nan]\n", "t.toml:3:11: ", "not nan");
  refused("offsets = [-1]\n", "t.toml:3:12: ", "'scene.offsets.0' must be");
  refused("offsets = 1\n", "t.toml:3:11: ", "be an array");
  refused("scales = [1e-9]\noffsets = [1e9]\n", "t.toml:4:11: ", "hold one of at most 2^40 times a scale");
  refused("orientations = 0\n", "t.toml:3:16: ", "an integer between 1 and 1000");
  refused("segments = 3\n", "t.toml:3:1: ", "unknown key 'scene.segments'");
  refused("\n[physics]\naccuracy = 1\n", "t.toml:4:1: ", "'physics' is not for this kind of scene");
}
