// Boxes that hold what they claim, exactly, and the pairs against comparing all with all.
#include "geometry/decision/broad_phase.hpp"

#include <CGAL/Gmpq.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "geometry/meshes/shapes.hpp"
#include "tests/support/adversary.hpp"
#include "tests/support/oracle.hpp"

namespace {

using namespace geometry;
using adversary::Random;

struct Crowd {
  Bodies bodies;
  std::vector<Pose> poses;

  void add(std::uint32_t mesh, const Pose& pose, bool fixed = false) {
    bodies.add(std::to_string(bodies.size()), mesh, fixed);
    poses.push_back(pose);
  }
};

std::vector<Pair> all_with_all(const BroadPhase& broad, std::span<const PairRun> runs) {
  std::vector<Pair> out;
  for (const PairRun& run : runs)
    for (std::uint32_t b = run.first; b < run.last; ++b)
      if (touch(broad.box(run.a), broad.box(b))) out.push_back({run.a, b});
  return out;
}

TEST(BroadPhase, FindsThePairsThatComparingAllWithAllFinds) {
  Random random;
  std::size_t found = 0;
  for (int i = 0; i < 24; ++i) {
    Crowd crowd;
    crowd.bodies.meshes = {sphere("ball", 1, 4), box("plate", Vec3(60, 1, 60)), box("rod", Vec3(0.2, 30, 0.2)),
                           box("crumb", Vec3(0.01, 0.01, 0.01))};
    const std::uint32_t count = i % 3 == 0 ? 40 : i % 3 == 1 ? 300 : 1500;
    const Vec3 spread = i % 5 == 0 ? Vec3(40, 0, 0) : i % 5 == 1 ? Vec3(20, 1, 20) : Vec3(12, 12, 12);
    for (std::uint32_t k = 0; k < count; ++k) {
      const std::uint32_t mesh = k % 100 == 7 ? 1 : k % 100 == 9 ? 2 : k % 7 == 0 ? 3 : 0;
      crowd.add(mesh, k % 50 == 49 ? unborn() : Pose{random.turn(), spread.cwiseProduct(random.point())}, k % 13 == 0);
    }
    if (i % 2)
      for (std::uint32_t k = 0; k < count; ++k) crowd.bodies.chosen.push_back(k % 4 == 0);
    BroadPhase broad(crowd.bodies);
    std::vector<Pair> pairs;
    for (int step = 0; step < 4; ++step) {  // a small move, a jump, a birth
      broad.prepare(crowd.poses);
      const auto runs = pair_runs(crowd.bodies, crowd.poses);
      broad.pairs(runs, pairs);
      ASSERT_EQ(pairs, all_with_all(broad, runs)) << "seed " << adversary::kSeed << ", crowd " << i;
      found += pairs.size();
      for (Pose& pose : crowd.poses)
        if (is_born(pose))
          pose.t = step == 1 ? spread.cwiseProduct(random.point()) : Vec3(pose.t + 0.1 * random.point());
      if (step == 2) crowd.poses[crowd.poses.size() - 1 - step] = unborn();
    }
  }
  EXPECT_GT(found, 20000u);
}

TEST(BroadPhase, AnswersAboutNobodyAndAboutTheWholeSpace) {
  Crowd crowd;
  crowd.bodies.meshes = {sphere("ball", 1, 2)};
  std::vector<Pair> pairs{{7, 8}};
  BroadPhase nobody(crowd.bodies);
  nobody.prepare(crowd.poses);
  nobody.pairs({}, pairs);
  EXPECT_TRUE(pairs.empty());
  // Where a bound overflows the body may be anywhere.
  for (Vec3& v : crowd.bodies.meshes[0].vertices) v *= 1.7e308;
  crowd.bodies.meshes.push_back(sphere("small", 1, 2));
  for (int i = 0; i < 200; ++i)
    crowd.add(i % 40 != 3,
              {normalised({1, 0.3, 0.2, i % 40 == 3 ? 0.5 : 0}), Vec3(10 * i, 0, i % 40 == 5 ? -1.7e308 : i)});
  BroadPhase broad(crowd.bodies);
  broad.prepare(crowd.poses);
  const auto runs = pair_runs(crowd.bodies, crowd.poses);
  broad.pairs(runs, pairs);
  EXPECT_EQ(pairs, all_with_all(broad, runs));
  EXPECT_EQ(pairs.size(), 5u * 195 + 10) << "five bodies are anywhere, the others touch nobody";
}

// Every world vertex lies in the box, and the pad is no decoration: poses are found that need a good part of it.
TEST(BroadPhase, BoxesHoldEveryWorldVertexOfAdversarialPoses) {
  using Exact = CGAL::Gmpq;
  Random random;
  double used = 0;
  for (int i = 0; i < 4000; ++i) {
    const Mesh mesh = adversary::mesh(random);
    const Enclosure around = enclosure(mesh);
    const Pose pose = adversary::pose(random, around.reach);
    const Placement at = placement(around, pose);
    const Box box = world_box(around, at);
    for (const Vec3& v : mesh.vertices) {
      const Vec3 world = to_world(at.r, at.t, v);
      for (int k = 0; k < 3; ++k) {
        ASSERT_LE(box.min[k], world[k]) << "seed " << adversary::kSeed << ", case " << i;
        ASSERT_GE(box.max[k], world[k]) << "seed " << adversary::kSeed << ", case " << i;
        if (i % 8 || !(around.reach > 1e-150 && around.reach < 1e150)) continue;
        // Of the pad, what rounding needs: beyond the exact extent about the computed middle.
        Exact extent = 0, most = 0;
        for (int c = 0; c < 3; ++c) {
          extent += Exact(std::fabs(at.r(k, c))) * Exact(around.half[c]);
          most += Exact(std::fabs(at.r(k, c))) * (Exact(around.half[c]) + Exact(std::fabs(around.centre[c])));
        }
        most += Exact(std::fabs(at.t[k]));
        const Exact need = CGAL::abs(Exact(world[k]) - Exact(at.middle[k])) - extent;
        if (most > 0) used = std::max(used, CGAL::to_double(Exact(need / (most * Exact(0x1p-49)))));
      }
    }
  }
  RecordProperty("pad_used", std::to_string(used));
  std::printf("the pad of world boxes is used to %.0f %%\n", 100 * used);
  EXPECT_LE(used, 1);
  EXPECT_GE(used, 0.05) << "a pad twenty times smaller would do: the poses are no adversaries";
}

// What kDefect claims of the rotation, in exact arithmetic, for quaternions as far from unit as any pose may be.
TEST(BroadPhase, RotationsAreAsNearToOrthonormalAsProved) {
  using Exact = CGAL::Gmpq;
  Random random;
  double used = 0;
  for (int i = 0; i < 3000; ++i) {
    const Quaternion q = adversary::quaternion(random);
    const Placement at = placement({}, {q, Vec3::Zero()});
    ASSERT_TRUE(at.rigid);
    // The greatest row sum of |R^T R - 1| bounds its norm, the Frobenius norm divided by sqrt(3) is below it.
    Exact squares = 0;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) {
        Exact e = r == c ? -1 : 0;
        for (int k = 0; k < 3; ++k) e += Exact(at.r(k, r)) * Exact(at.r(k, c));
        squares += e * e;
      }
    used = std::max(used, std::sqrt(CGAL::to_double(squares)) / kDefect);
  }
  std::printf("the Frobenius norm of the defect reaches %.0f %% of kDefect\n", 100 * used);
  EXPECT_LE(used, std::sqrt(2.0));  // [v]^2 has the eigenvalue -|v|^2 twice: the norm itself is at most 1 of it
  EXPECT_GE(used, 0.2);
  EXPECT_FALSE(placement({}, {{1 + 0x1p-48, 0, 0, 0}, Vec3::Zero()}).rigid);
}

// A sphere's box does not depend on how it is turned: the bounding sphere is smaller than the turned box.
TEST(BroadPhase, BoxesOfSpheresAreTight) {
  Random random;
  const Mesh ball = sphere("ball", 1, 16);
  for (int i = 0; i < 50; ++i) {
    const Box box = world_box(enclosure(ball), placement(enclosure(ball), {random.turn(), random.point()}));
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(box.max[k] - box.min[k], 2, 1e-12);
  }
}

}  // namespace
