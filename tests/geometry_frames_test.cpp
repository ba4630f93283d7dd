// Each margin against exact arithmetic: it holds, and by how much it is used.
#include <CGAL/Gmpq.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "geometry/frames.hpp"
#include "geometry/shapes.hpp"
#include "tests/adversary.hpp"

namespace {

using namespace geometry;
using adversary::Random;
using Exact = CGAL::Gmpq;

/// A mesh that owns what a Body refers to.
struct Owned {
  Mesh mesh;
  Bvh bvh = build_bvh(mesh);
  Enclosure around = enclosure(mesh);
  Placement at{};

  explicit Owned(Mesh m) : mesh(std::move(m)) {}
  Body at_pose(const Pose& pose) {
    at = placement(around, pose);
    return {mesh, bvh, around, at};
  }
};

Exact dot(const Vec3& d, const Vec3& p) {
  Exact sum = 0;
  for (int k = 0; k < 3; ++k) sum += Exact(d[k]) * Exact(p[k]);
  return sum;
}

/// A pose up to a million sizes away: farther out no margin is useful.
Pose near_pose(Random& random, double size) {
  const double far = random.below(2) ? std::pow(10, 6 * random.real()) : 0;
  return {adversary::quaternion(random), far * size * random.point()};
}

Mesh usual_mesh(Random& random, double scale) {
  Mesh mesh = random.below(3) ? sphere("ball", 1, 2) : box("box", Vec3(1, 0.01, 3));
  for (Vec3& v : mesh.vertices) v = scale * (v + (random.below(4) ? 0 : 0.3) * random.point());
  return mesh;
}

// The gap along a direction, as computed, against the exact one between the very world vertices.
TEST(Frames, GapsAlongDirectionsAreWithinTheirMargin) {
  Random random;
  double used = 0;
  int asked = 0;
  for (int i = 0; i < 800; ++i) {
    const double scale = std::pow(10, 12 * random.real());
    Owned a(usual_mesh(random, scale)), b(usual_mesh(random, scale * (random.below(3) ? 1 : 0.01)));
    const Pose pose = near_pose(random, scale);
    const Body a_body = a.at_pose(pose);
    const Body b_body = b.at_pose({adversary::quaternion(random), pose.t + 3 * scale * random.point()});
    const Margin close = margin(a_body, b_body);
    if (!close.useful) continue;
    ++asked;
    Vec3 d = random.point();
    d /= d.norm();
    for (double& x : d) x = static_cast<float>(x);
    std::uint64_t operations = 0;
    const Slab slab = find_slab(a_body, b_body, d, close, operations);
    bool first = true;
    Exact top = 0, bottom = 0;
    for (const Vec3& v : a.mesh.vertices) {
      const Exact along = dot(d, to_world(a.at.r, a.at.t, v));
      if (first || along > top) top = along;
      first = false;
    }
    first = true;
    for (const Vec3& v : b.mesh.vertices) {
      const Exact along = dot(d, to_world(b.at.r, b.at.t, v));
      if (first || along < bottom) bottom = along;
      first = false;
    }
    const Exact error = CGAL::abs(Exact(slab.gap) - (bottom - top));
    used = std::max(used, CGAL::to_double(Exact(error / Exact(close.fine))));
    ASSERT_LE(error, Exact(close.fine)) << "seed " << adversary::kSeed << ", case " << i;
    ASSERT_EQ(slab.apart, slab.gap > close.fine);
  }
  std::printf("the margin of planes is used to %.2f %% in %d cases\n", 100 * used, asked);
  EXPECT_GT(asked, 400);
  EXPECT_GE(used, 1e-3) << "a margin a thousand times smaller would do: the poses are no adversaries";
}

// World vertices beyond the bounding sphere about the computed middle.
TEST(Frames, BoundingSpheresHoldTheWorldVerticesWithinTheirMargin) {
  Random random;
  double used = -1;
  for (int i = 0; i < 800; ++i) {
    const double scale = std::pow(10, 12 * random.real());
    Owned a(usual_mesh(random, scale));
    const Body body = a.at_pose(near_pose(random, scale));
    const Margin close = margin(body, body);
    if (!close.useful) continue;
    const Exact share = Exact(close.fine) / 2, radius = Exact(a.around.radius);
    for (const Vec3& v : a.mesh.vertices) {
      const Vec3 world = to_world(a.at.r, a.at.t, v);
      Exact square = 0;
      for (int k = 0; k < 3; ++k)
        square += (Exact(world[k]) - Exact(a.at.middle[k])) * (Exact(world[k]) - Exact(a.at.middle[k]));
      ASSERT_LE(square, (radius + share) * (radius + share)) << "seed " << adversary::kSeed << ", case " << i;
      // square = (radius + x)^2, where x is small
      used = std::max(used, CGAL::to_double(Exact((square - radius * radius) / (2 * radius * share))));
    }
  }
  std::printf("the margin of bounding spheres is used to %.2f %%\n", 100 * used);
  EXPECT_GE(used, 1e-3) << "a margin a thousand times smaller would do: the poses are no adversaries";
}

// One vertex of each body in one place of the world, the farthest of a along some axis that the test of nodes asks and
// the farthest of b against it: a test without margin would separate one half of them.
TEST(Frames, NodesThatTouchAreNeverSeparated) {
  Random random;
  double used = 0;
  int asked = 0;
  for (int i = 0; i < 6000; ++i) {
    const double scale = std::pow(10, 12 * random.real());
    Owned a(i % 2 ? adversary::mesh(random) : usual_mesh(random, scale));
    Owned b(i % 3 ? adversary::mesh(random) : usual_mesh(random, scale));
    if (a.around.radius < 1e-15 || b.around.radius < 1e-15 || a.around.reach > 1e15 || b.around.reach > 1e15) continue;
    const double ratio = a.around.radius / b.around.radius * (random.below(3) ? 1 : 0.01);
    for (Vec3& v : b.mesh.vertices) v *= ratio;
    b = Owned(b.mesh);
    Pose pose = near_pose(random, a.around.reach), other{adversary::quaternion(random), pose.t};
    Mat3 ra = rotation(pose.q), rb = rotation(other.q);
    const Bvh::Bound &m = a.bvh.bounds[0], &n = b.bvh.bounds[0];
    const int k = static_cast<int>(random.below(8));
    Vec3 d = k < 3 ? Vec3(ra.col(k)) : k < 6 ? Vec3(rb.col(k - 3)) : Vec3(0, 0, 0);
    if (k == 6) d = ra * Eigen::Map<const Eigen::Vector3f>(m.normal).cast<double>();
    if (k == 7) d = rb * Eigen::Map<const Eigen::Vector3f>(n.normal).cast<double>();
    if (random.below(2)) d = -d;
    const auto farthest = [](const Mesh& mesh, const Vec3& local) {
      return *std::ranges::max_element(mesh.vertices, {}, [&](const Vec3& v) { return local.dot(v); });
    };
    const Vec3 x = farthest(a.mesh, ra.transpose() * d), y = farthest(b.mesh, rb.transpose() * -d);
    other.t = to_world(ra, pose.t, x) - to_world(rb, Vec3::Zero(), y);
    const Body a_body = a.at_pose(pose), b_body = b.at_pose(other);
    const Margin close = margin(a_body, b_body);
    if (!close.useful) continue;
    ++asked;
    EXPECT_FALSE(spheres_apart(a_body, b_body, close)) << "seed " << adversary::kSeed << ", case " << i;
    const float overlap = Relative(a_body, b_body, close).overlap(m, n);
    ASSERT_GE(overlap, 0) << "seed " << adversary::kSeed << ", case " << i;
    used = std::max(used, 1 - double{overlap} / double{close.coarse});
  }
  std::printf("the margin of nodes is used to %.2f %% in %d cases\n", 100 * used, asked);
  EXPECT_GT(asked, 3000);
  EXPECT_GE(used, 1e-3) << "a margin a thousand times smaller would do: the poses are no adversaries";
}

TEST(Frames, NodesFarApartAreSeparatedAlongEveryAxis) {
  Owned a(box("a", Vec3(1, 1, 1))), b(box("b", Vec3(1, 1, 1)));
  const Quaternion turn = normalised({1, 0.2, 0.3, 0.4});
  for (const bool turned : {false, true})
    for (int k = 0; k < 3; ++k)
      for (const double side : {-1.0, 1.0}) {
        const Quaternion q = turned ? turn : Quaternion{};
        const Vec3 t = side * (1 + 1e-3) * rotation(q).col(k);
        const Body a_body = a.at_pose({q, Vec3::Zero()}), b_body = b.at_pose({q, t});
        EXPECT_LT(Relative(a_body, b_body, margin(a_body, b_body)).overlap(a.bvh.bounds[0], b.bvh.bounds[0]), 0);
      }
}

// Where a margin would not be small against the bodies, or a bound may not hold, there is none.
TEST(Frames, NoMarginIsUsefulAtTheEndsOfTheRange) {
  const auto useful = [](double scale, const Pose& pose) {
    Mesh mesh = sphere("ball", 1, 2);
    for (Vec3& v : mesh.vertices) v *= scale;
    Owned a(mesh);
    const Body body = a.at_pose(pose);
    return margin(body, body).useful;
  };
  EXPECT_TRUE(useful(1, {}));
  EXPECT_TRUE(useful(1e-12, {}));
  EXPECT_TRUE(useful(1e12, {}));
  EXPECT_FALSE(useful(1, {{}, Vec3(1e12, 0, 0)}));
  EXPECT_FALSE(useful(1e-30, {}));
  EXPECT_FALSE(useful(1e-310, {}));
  EXPECT_FALSE(useful(1e30, {}));
  EXPECT_FALSE(useful(1e306, {}));
  EXPECT_FALSE(useful(1, {{2, 0, 0, 0}, Vec3::Zero()}));
  EXPECT_FALSE(useful(1, {{}, Vec3(std::numeric_limits<double>::infinity(), 0, 0)}));
}

}  // namespace
