// exact and exact_cold: right in every case, whatever they remember.
#include "geometry/decision/exact.hpp"

#include <gtest/gtest.h>

#include "tests/support/setting.hpp"

namespace algorithms {
namespace {

using namespace setting;

class Exact : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Row, Exact, testing::Values("exact", "exact_cold"),
                         [](const auto& info) { return info.param; });

/// Every triangle against every triangle.
bool any_triangles_meet(const Mesh& a, const Pose& at_a, const Mesh& b, const Pose& at_b) {
  std::vector<Vec3> p(a.vertices.size()), q(b.vertices.size());
  to_world(at_a, a.vertices, p);
  to_world(at_b, b.vertices, q);
  for (const geometry::Facet& f : a.triangles)
    for (const geometry::Facet& g : b.triangles)
      if (geometry::triangles_meet({p[f[0]], p[f[1]], p[f[2]]}, {q[g[0]], q[g[1]], q[g[2]]})) return true;
  return false;
}

/// Bodies that move and turn a little from step to step.
std::vector<Setting> motion(std::mt19937& random, int count, double half_width, int steps) {
  std::vector<Setting> out{crowd(random, count, half_width)};
  std::vector<Vec3> way;
  for (int i = 0; i < count; ++i) way.push_back(uniform_point(random, 0.05));
  for (int step = 1; step < steps; ++step) {
    out.push_back(out.back());
    for (int i = 0; i < count; ++i) {
      if (out.back().bodies.fixed[i]) continue;
      Pose& pose = out.back().poses[i];
      pose.t += way[i];
      pose.q = geometry::normalised(turn_deg({0, 1, 0}, 2) * pose.q);
    }
  }
  return out;
}

TEST_P(Exact, ReportsWhatAllTrianglesTogetherSay) {
  for (std::uint32_t seed = 1; seed <= 2; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const Setting setting = crowd(random, 14, 2.5);
    const std::vector<Pair> expected = by_definition(setting, any_triangles_meet);
    EXPECT_FALSE(expected.empty());
    EXPECT_EQ(hits(GetParam(), setting), expected);
  }
}

TEST_P(Exact, TouchingCounts) {
  const Mesh cube = geometry::box("cube", {2, 2, 2});
  EXPECT_TRUE(hit(GetParam(), cube, {}, cube, {{}, {2, 0, 0}}));
  EXPECT_TRUE(hit(GetParam(), cube, {}, cube, {{}, {2, 2, 2}})) << "by one corner";
  EXPECT_FALSE(hit(GetParam(), cube, {}, cube, {{}, {std::nextafter(2.0, 3.0), 0, 0}}));
}

TEST_P(Exact, ReportsABodyInsideAnotherOnlyWhereContainmentIsWanted) {
  const Mesh cube = geometry::box("cube", {2, 2, 2}), pea = geometry::sphere("pea", 0.1, 4);
  EXPECT_FALSE(hit(GetParam(), cube, {}, pea, {}));
  EXPECT_TRUE(hit(GetParam(), cube, {}, pea, {}, {{"containment", true}}));
  EXPECT_TRUE(hit(GetParam(), cube, {}, pea, {{}, {1, 0, 0}}, {{"containment", true}})) << "surfaces cross";
  EXPECT_FALSE(hit(GetParam(), cube, {}, pea, {{}, {3, 0, 0}}, {{"containment", true}}));
}

TEST_P(Exact, NothingIsInsideAnOpenMesh) {
  Mesh open = geometry::box("bucket", {2, 2, 2});
  open.triangles.pop_back();
  const Setting setting = Setting().add(open, {});
  EXPECT_NO_THROW(make(GetParam(), setting.bodies));
  try {
    make(GetParam(), setting.bodies, {{"containment", true}});
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("'bucket' is open, the edge from ("), std::string::npos) << error.what();
  }
  // Beside a closed one there is something to ask.
  const Mesh pea = geometry::sphere("pea", 0.1, 4), room = geometry::box("room", {8, 8, 8});
  EXPECT_FALSE(hit(GetParam(), open, {}, pea, {}, {{"containment", true}}));
  EXPECT_TRUE(hit(GetParam(), open, {}, room, {}, {{"containment", true}}));
}

TEST_P(Exact, AnswersTheSameWhateverWasRemembered) {
  std::mt19937 random(31);
  SCOPED_TRACE("seed 31");
  std::vector<Setting> steps = motion(random, 25, 3, 12);
  std::swap(steps[5], steps[9]);  // a jump, there and back
  const auto method = make(GetParam(), steps[0].bodies);
  for (const Setting& step : steps) {
    std::vector<Pair> found;
    method->prepare(step.poses);
    method->answer(step.runs(), found);
    method->remember();
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, hits(GetParam(), step));
  }
}

std::vector<std::uint64_t> operations(const std::string& name, const std::vector<Setting>& steps) {
  const auto method = make(name, steps[0].bodies);
  std::vector<std::uint64_t> out;
  for (const Setting& step : steps) {
    std::vector<Pair> found;
    method->prepare(step.poses);
    out.push_back(method->count(step.runs(), found));
    method->remember();
  }
  return out;
}

TEST(ExactCold, EveryStepIsTheFirst) {
  std::mt19937 random(32);
  SCOPED_TRACE("seed 32");
  const std::vector<Setting> steps = motion(random, 25, 3, 6);
  const std::vector<std::uint64_t> cold = operations("exact_cold", steps);
  for (std::size_t s = 0; s < steps.size(); ++s) EXPECT_EQ(cold[s], operations("exact", {steps[s]})[0]) << s;
}

// The broad phase sweeps along the axis of the greatest spread, and stays with it while another is little better: its
// comparisons show which.
TEST_P(Exact, ForgetsAlongWhichAxisItSwept) {
  std::mt19937 random(33);
  SCOPED_TRACE("seed 33");
  Setting tall = crowd(random, 60, 1), wide = tall;
  for (std::size_t i = 0; i < tall.poses.size(); ++i) {
    const Vec3 place = 8 * tall.poses[i].t;
    tall.poses[i].t = {place.x(), 3 * place.y(), place.z()};
    wide.poses[i].t = {1.02 * place.x(), place.y(), 0.1 * place.z()};
  }
  const auto method = make(GetParam(), tall.bodies), fresh = make(GetParam(), tall.bodies);
  std::vector<Pair> found;
  method->prepare(tall.poses);
  method->answer(tall.runs(), found);
  method->remember();
  method->forget();
  method->prepare(wide.poses);
  fresh->prepare(wide.poses);
  EXPECT_EQ(method->count(wide.runs(), found), fresh->count(wide.runs(), found));
}

TEST(ExactWithMemory, MakesFewerTestsAfterTheFirstStep) {
  std::mt19937 random(32);
  SCOPED_TRACE("seed 32");
  const std::vector<Setting> steps = motion(random, 25, 3, 6);
  const std::vector<std::uint64_t> warm = operations("exact", steps), cold = operations("exact_cold", steps);
  EXPECT_EQ(warm[0], cold[0]);
  for (std::size_t s = 1; s < steps.size(); ++s) EXPECT_LT(warm[s], cold[s]) << s;
}

}  // namespace
}  // namespace algorithms
